"""Checks of the arguments of a run."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import inf
from numbers import Real
from typing import Any

import numpy as np

from modelgen.codegen.library import Library
from modelgen.errors import SimulationError, UnknownNameError
from modelgen.name_suggestions import nearest


def is_number(value: object) -> bool:
    """Whether a value is a real number, of Python or of numpy."""
    return isinstance(value, Real)


def check_span(where: str, value: object, remedy: str) -> None:
    """Raises SimulationError unless the value is a positive, finite time."""
    if not (isinstance(value, Real) and 0 < float(value) < float("inf")):
        raise SimulationError(where, repr(value), "a positive time in s", remedy)


def check_step(value: object, where: str = "step") -> None:
    check_span(where, value, "give the step")


def check_name(where: str, value: object, names: Iterable[str]) -> None:
    """Raises UnknownNameError unless the value is one of the names."""
    known = list(names)
    if not isinstance(value, str) or value not in known:
        allowed = ", ".join(known) or "there is none"
        remedy = nearest(str(value), known) or ("use one of these names" if known else "")
        raise UnknownNameError(where, repr(value), allowed, remedy)


def check_keywords(verb: str, given: Iterable[str], known: Iterable[str]) -> None:
    """Raises SimulationError for unknown keywords; for a tolerance the message points to `Accuracy`."""
    names = list(known)
    for key in given:
        if key not in names:
            remedy = nearest(key, [*names, "tolerance"])
            if "'tolerance'" in remedy:
                remedy = "write accuracy=Accuracy.of(...) for a tolerance"
            raise SimulationError(verb, f"unknown keyword {key!r}", "allowed are " + ", ".join(names), remedy)


def with_parameters(library: Library, values: object) -> Library:
    """The library with these values of its parameters; raises SimulationError (see `library_with`)."""
    if not values:
        return library
    if not isinstance(values, Mapping):
        found, remedy = f"a {type(values).__name__}", 'write parameters={"name": 1.0}'
        raise SimulationError("parameters", found, "names with their values are allowed", remedy)
    from modelgen.codegen.library_with_parameters import library_with  # reads the scene again, with CasADi

    return library_with(library, values)


def input_range(kind: Mapping[str, Any]) -> tuple[float, float]:
    """Least and largest value of an input of a manifest's instance, infinite where there is no bound."""
    low, high = kind["minimum"], kind["maximum"]
    return -inf if low is None else low, inf if high is None else high


def checked_starts(name: str, values: Any, size: int, n: int | None = None) -> np.ndarray[Any, Any]:
    """Starts of runs as (n, size), of any number of runs where n is None.

    Raises SimulationError unless they are finite numbers of that shape.
    """
    allowed, remedy = f"finite numbers, ({'n' if n is None else n}, {size})", "give one row a run"
    try:
        array = np.atleast_2d(np.asarray(values, dtype=float))
    except (TypeError, ValueError):
        raise SimulationError(name, "no array of numbers", allowed, remedy) from None
    if array.ndim != 2 or array.shape[1] != size or n not in (None, len(array)):
        raise SimulationError(name, f"shape {array.shape}", allowed, remedy)
    if not np.isfinite(array).all():
        row = int(np.flatnonzero(~np.isfinite(array).all(axis=1))[0])
        raise SimulationError(f"{name}[{row}]", "not finite", allowed, "")
    return array


def rows_of(where: str, values: Any, size: int) -> np.ndarray[Any, Any]:
    """The values as (rows, size); SimulationError if they have another shape."""
    array = np.asarray(values)
    array = array[None] if array.ndim == 1 else array
    if array.ndim != 2 or array.shape[1] != size:
        raise SimulationError(where, f"an array of shape {np.shape(values)}", f"(n, {size}) or ({size},)")
    return array


def common_rows(where: str, given: Iterable[np.ndarray[Any, Any]]) -> int:
    """The common number of rows, where one row goes with any number; SimulationError if they differ."""
    counts = {len(rows) for rows in given} - {1}
    if len(counts) > 1:
        found = f"arrays of {' and '.join(str(count) for count in sorted(counts))} rows"
        raise SimulationError(where, found, "as many rows in each, or one")
    return counts.pop() if counts else 1
