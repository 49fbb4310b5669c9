"""The table of the outcomes of a sweep, with a row for each run: its columns, and how a folder is read."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from modelgen.errors import ModelgenError, path_of
from modelgen.name_suggestions import nearest
from modelgen.parameter_study.rows import TEXT
from modelgen.parameter_study.sweep_folder import SweepFolder
from modelgen.runtime.by_name import ByName
from modelgen.runtime.trajectory import Array

DONE = "done"


@dataclass(frozen=True, slots=True, repr=False)
class Sweep:
    """The table of a sweep.

    Attributes:
        plan: what was to be done: scene, design, settings, number of runs.
        varied: the columns of the numbers that vary.
        columns: the values of all runs that are done, by column; None where there is none.
        sensors: the columns of the sensors of the scene.
        folder: where it is kept; None where it is not.
        known: how many runs were done before this call.
    """

    plan: Mapping[str, Any]
    varied: tuple[str, ...]
    sensors: tuple[str, ...]
    columns: Mapping[str, Sequence[Any]]
    folder: Path | None = None
    known: int = 0

    def __len__(self) -> int:
        return len(self.columns["run"])

    def __repr__(self) -> str:
        """Scene, number of runs and outcomes."""
        told = ", ".join(f"{count} {name}" for name, count in self.outcomes.items())
        return f"<Sweep of {self.plan['scene']}: {len(self)} of {self.plan['runs']} runs; {told}>"

    def __getitem__(self, name: str) -> Array:
        """A column: (runs,) floats, NaN where there is none, or texts. Raises ModelgenError if there is none
        of that name."""
        check_column("column", name, list(self.columns))
        if self.plan["columns"][name] == TEXT:
            return np.array([value or "" for value in self.columns[name]], dtype=object)
        return np.array([np.nan if value is None else value for value in self.columns[name]], dtype=float)

    @property
    def outcomes(self) -> Mapping[str, int]:
        """How many runs ended how, the most frequent first; `refused`: it could not start."""
        return ByName(Counter(self.columns["outcome"]).most_common(), "outcome")

    @property
    def failed(self) -> Array:
        """(runs,) whether a run did not come to its end."""
        return np.asarray(self["outcome"] != DONE)

    def rows(self, indices: Sequence[int]) -> list[dict[str, Any]]:
        """Some rows as dicts."""
        return [{name: column[k] for name, column in self.columns.items()} for k in indices]


def check_column(where: str, name: str, columns: Sequence[str]) -> None:
    """Raises ModelgenError for a column that a table has not."""
    if not isinstance(name, str) or name not in columns:
        raise ModelgenError(where, repr(name), f"columns: {', '.join(columns)}", nearest(name, columns))


def load_sweep(folder: str | Path) -> Sweep:
    """The table in a folder that a sweep wrote, also of one that is not finished.

    Raises ModelgenError where there is none, or without pyarrow.
    """
    path = path_of("load_sweep", folder)
    store = SweepFolder(path)
    plan = store.plan()
    return table_of(plan, store.table(), path)


def table_of(
    plan: Mapping[str, Any], columns: Mapping[str, Sequence[Any]], folder: Path | None, known: int = 0
) -> Sweep:
    """The table of a plan."""
    varied, sensors = tuple(plan["varied"]), tuple(plan["sensors"])
    return Sweep(plan, varied, sensors, ByName(columns, "column"), folder, known)
