"""Numbers of a scene at many values of its parameters, so that a program without Python can set parameters.

Masses, inertia, bounds and the other numbers of the tables follow from the scene, read again with each set of
values: they are those of `simulate(..., parameters=...)` to the last bit.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from modelgen.codegen.library import Library
from modelgen.errors import ModelgenError, SimulationError
from modelgen.runtime.accuracy import Accuracy
from modelgen.runtime.arguments import with_parameters
from modelgen.runtime.c_initialisers import RunArray, scene_tables
from modelgen.runtime.core_session import Session
from modelgen.runtime.tables.ctypes_structures import Array

POSITIONS = (41, 15, 7, 4)  # of each slider, for one, two, three and four of them


@dataclass(frozen=True, slots=True)
class Slider:
    """A parameter with the values that its slider takes, ascending; its own value is among them."""

    name: str
    own: float
    values: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class Numbers:
    """Numbers that follow from parameters.

    Attributes:
        entries: (n, 2) which array of `arrays_of`, and which of its entries.
        table: (product of the numbers of values, n) the numbers, the values of the last slider fastest.
    """

    entries: Array
    table: Array


def sliders_of(ranges: Mapping[str, tuple[float, float, float]]) -> tuple[Slider, ...]:
    """Sliders of parameters, given by name as own value, least and largest one.

    Raises ModelgenError where there are too many.
    """
    if len(ranges) > len(POSITIONS):
        found = f"{len(ranges)} parameters: {', '.join(ranges)}"
        remedy = "fix some of them: --set NAME=VALUE"
        raise ModelgenError("--to browser", found, f"sliders for {len(POSITIONS)} at most", remedy)
    sliders = []
    for name, (own, low, high) in ranges.items():
        values = np.linspace(low, high, POSITIONS[len(ranges) - 1])
        values[np.abs(values - own).argmin()] = own
        sliders.append(Slider(name, own, tuple(values.tolist())))
    return tuple(sliders)


def arrays_of(session: Session) -> tuple[list[Array], tuple[RunArray, ...]]:
    """The arrays of the tables of a session that has not begun, and those of its runs."""
    return list(session.shared.arrays), scene_tables(session, "0", session.system).arrays


def numbers_of(
    library: Library,
    accuracy: Accuracy,
    sliders: Sequence[Slider],
    look: Callable[[Library, Mapping[str, float]], None],
) -> Numbers:
    """The numbers of a scene that follow from some of its parameters; `look` is called with each set of
    values and the library that has them.

    Raises ModelgenError where a set is refused, or changes more than numbers.
    """
    own = _flat(library, accuracy)
    rows = []
    for values in product(*(slider.values for slider in sliders)):
        given = {slider.name: value for slider, value in zip(sliders, values, strict=True)}
        try:
            other = with_parameters(library, given)
        except SimulationError as error:
            raise _refused(given, error.found, error.allowed) from None
        flat = _flat(other, accuracy)
        if not np.array_equal(flat["i"], own["i"]):
            raise _refused(given, "more than numbers would change", "")
        rows.append(flat["f"])
        look(other, given)
    table = np.array(rows)
    varies = np.flatnonzero((table != table[0]).any(axis=0))
    tables, of_run = arrays_of(Session(library, accuracy))
    arrays = [*tables, *(each.start for each in of_run)]
    places = [(k, i) for k, array in enumerate(arrays) if array.dtype.kind == "f" for i in range(array.size)]
    return Numbers(np.array(places).reshape(-1, 2)[varies], table[:, varies])


def _flat(library: Library, accuracy: Accuracy) -> dict[str, Array]:
    """The real numbers, "f", and the integers, "i", of the tables and of the starts of runs."""
    tables, of_run = arrays_of(Session(library, accuracy))
    arrays = [*tables, *(each.start for each in of_run)]
    return {
        kind: np.concatenate([array.ravel() for array in arrays if array.dtype.kind == kind]) for kind in "fi"
    }


def _refused(given: Mapping[str, float], found: str, allowed: str) -> ModelgenError:
    where = "slider at " + ", ".join(f"{name} = {value:.6g}" for name, value in given.items())
    remedy = "give `minimum` and `maximum` in the [[parameter]], or fix it: --set NAME=VALUE"
    return ModelgenError(where, found, allowed, remedy)
