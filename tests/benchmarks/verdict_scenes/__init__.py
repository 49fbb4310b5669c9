"""Random scenes by class, as plain tables, for `tests.benchmarks.verdicts`.

A class is a function of a random generator that returns the tables of one scene and how long it runs. The
distributions are fixed: they were written before any scene was run, and are not changed to fit the results.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from tests.benchmarks.verdict_scenes import contacts, loads, long_runs, machines

Tables = dict[str, Any]
CLASSES: Mapping[str, Callable[[np.random.Generator], Tables]] = {
    "mechanisms": machines.mechanism,
    "stacks and piles": contacts.stack_or_pile,
    "driven bodies": machines.driven,
    "mixed sizes and masses": contacts.mixed,
    "thin and spline shapes": contacts.thin_or_spline,
    "resistances": loads.resisted,
    "long runs": long_runs.long_run,
    "tossed solids": contacts.tossed,
    "grips nuts dominoes": machines.held,
}


def drawn(name: str, seed: int) -> Tables:
    """The tables of a scene of a class, by its number."""
    return CLASSES[name](np.random.default_rng([52, seed, *name.encode()]))
