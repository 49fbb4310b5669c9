"""Checks of the arguments of a run."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import fields
from functools import cache
from math import inf
from numbers import Real
from types import MappingProxyType
from typing import Any, get_args

import numpy as np

from modelgen.codegen.library import Library
from modelgen.errors import SimulationError, UnknownNameError
from modelgen.name_suggestions import listed, nearest

LONGEST = 200  # characters of a value in an error


def is_number(value: object) -> bool:
    """Whether a value is a real number, of Python or of numpy, that a float can hold."""
    if isinstance(value, float):  # the usual case, found faster than a Real
        return True
    if not isinstance(value, Real):
        return False
    try:
        float(value)
    except OverflowError:
        return False
    return True


def check_span(where: str, value: Any, remedy: str) -> None:
    """Raises SimulationError unless the value is a positive, finite time."""
    check_positive(where, value, remedy, "time in s")


def check_positive(where: str, value: Any, remedy: str, noun: str = "number") -> None:
    """Raises SimulationError unless the value is a positive, finite number."""
    if not (is_number(value) and 0 < float(value) < inf):
        raise SimulationError(where, shown(value), f"a positive {noun}", remedy)


def shown(value: object) -> str:
    """A value in the words of an error, cut where it is long."""
    text = " ".join(repr(value).split())
    return text if len(text) <= LONGEST else f"{text[: LONGEST - 3]}..."


def check_whole(where: str, value: Any, remedy: str, least: int = 1) -> int:
    """The value as int; raises SimulationError unless it is a whole number from `least` on."""
    if not is_number(value) or not least <= value < inf or value != int(value):
        allowed = "a whole number, " + ("at least 1" if least == 1 else f"from {least} on")
        raise SimulationError(where, shown(value), allowed, remedy)
    return int(value)


def check_flag(where: str, value: object) -> None:
    """Raises SimulationError unless the value is True, False or None."""
    if not (value is None or isinstance(value, bool | np.bool_)):
        raise SimulationError(where, shown(value), "True or False", "give one of these")


def check_function(where: str, value: object) -> None:
    """Raises SimulationError unless the value is a function or None."""
    if not (value is None or callable(value)):
        raise SimulationError(where, shown(value), "a function", "leave it out, or give a function")


def values_by_name(where: str, values: object) -> Mapping[str, Any]:
    """Values by name, none for None; raises SimulationError unless they are a mapping from texts."""
    if values is None:
        return {}
    allowed, remedy = "names with their values are allowed", f'write {where}={{"name": 1.0}}'
    if not isinstance(values, Mapping):
        raise SimulationError(where, f"a {type(values).__name__}", allowed, remedy)
    for name in values:
        if not isinstance(name, str):
            raise SimulationError(where, f"the name {shown(name)}", allowed, remedy)
    return values


def names_in(where: str, values: Any) -> list[str]:
    """The names of a sequence; raises SimulationError for what is none, as a single name."""
    several = isinstance(values, Iterable) and not isinstance(values, str)
    names = list(values) if several else []
    if not several or not all(isinstance(each, str) for each in names):
        name = values if isinstance(values, str) and values else "name"
        raise SimulationError(where, shown(values), "a list of names", f'write {where}=["{name}"]')
    return names


def numbers_in(where: str, values: object, allowed: str, remedy: str = "") -> np.ndarray[Any, Any]:
    """The values as an array of floats; raises SimulationError, with what is allowed, for others."""
    try:
        given = np.asarray(values)
    except (TypeError, ValueError):
        given = np.array(None)
    if given.dtype.kind in "biuf":
        return given.astype(float)
    found = "no array of numbers" if isinstance(values, list | tuple | np.ndarray) else shown(values)
    raise SimulationError(where, found, allowed, remedy)


def lanes_in(where: str, lanes: object, n: int) -> np.ndarray[Any, Any]:
    """The indices of lanes, given as (n,) of bool or as indices; raises SimulationError for others."""
    try:
        given = np.atleast_1d(np.asarray(lanes))
    except ValueError:
        given = np.zeros((0, 0))
    if given.dtype == bool and given.shape == (n,):
        return np.flatnonzero(given)
    is_index = given.ndim == 1 and (given.dtype.kind in "iu" or not given.size)
    if is_index and bool(((given >= 0) & (given < n)).all()):
        return given.astype(int)
    allowed = f"({n},) of True and False, or indices from 0 to {n - 1}"
    raise SimulationError(where, shown(lanes), allowed, "name the lanes")


def lane_in(where: str, lane: Any, n: int) -> int:
    """The index of a lane; raises SimulationError for what is none."""
    if not is_number(lane) or not 0 <= lane < n or lane != int(lane):
        allowed = f"a whole number from 0 to {n - 1}"
        raise SimulationError(where, f"the lane {shown(lane)}", allowed, "name a lane")
    return int(lane)


def one_or_each(where: str, values: object, n: int) -> np.ndarray[Any, Any]:
    """(n,) values, given as one number or one for each lane; raises SimulationError for others."""
    allowed, remedy = f"one number or ({n},)", "give one for each lane"
    array = numbers_in(where, values, allowed, remedy)
    if array.shape not in ((), (n,)):
        raise SimulationError(where, f"an array of shape {array.shape}", allowed, remedy)
    return np.broadcast_to(array, (n,))


def check_step(value: object, where: str = "step") -> None:
    check_span(where, value, "give the step")


def check_name(where: str, value: object, names: Iterable[str], none: str = "") -> None:
    """Raises UnknownNameError unless the value is one of the names; `none` is the remedy without names."""
    known = list(names)
    if not isinstance(value, str) or value not in known:
        allowed = listed(known) or "there is none"
        remedy = nearest(str(value), known) or ("use one of these names" if known else none)
        raise UnknownNameError(where, shown(value), allowed, remedy)


def check_fields(record: Any, names: Mapping[str, Any] = MappingProxyType({})) -> None:
    """Raises SimulationError for a field of a frozen record that is not of its type; numbers are 0 or more.

    `names`: the Literal types of fields that are one of several names.
    """
    for name, kind in _types_of_fields(record.__class__):
        _check_field(name, getattr(record, name), kind, names)


@cache
def _types_of_fields(record: type) -> tuple[tuple[str, str], ...]:
    return tuple((each.name, str(each.type)) for each in fields(record))


def _check_field(name: str, value: Any, kind: str, names: Mapping[str, Any]) -> None:
    if kind in names:
        check_name(name, value, get_args(names[kind]))
    elif kind == "bool":
        check_flag(name, value)
    elif kind == "float | None":
        if value is not None:
            check_step(value, name)
    elif kind[0].isupper() and kind.isalpha():  # a record
        if type(value).__name__ != kind:
            raise SimulationError(name, shown(value), f"a {kind}", "change the one that is there")
    elif kind != "str" and not (is_number(value) and value >= 0):
        raise SimulationError(name, shown(value), "a number from 0 on", "change it, or leave it out")


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
    given = values_by_name("parameters", values)
    if not given:
        return library
    from modelgen.codegen.library_with_parameters import library_with  # reads the scene again, with CasADi

    return library_with(library, given)


def input_range(kind: Mapping[str, Any]) -> tuple[float, float]:
    """Least and largest value of an input of a manifest's instance, infinite where there is no bound."""
    low, high = kind["minimum"], kind["maximum"]
    return -inf if low is None else low, inf if high is None else high


def checked_starts(name: str, values: Any, size: int, n: int | None = None) -> np.ndarray[Any, Any]:
    """Starts of runs as (n, size), of any number of runs where n is None.

    Raises SimulationError unless they are finite numbers of that shape.
    """
    allowed, remedy = f"finite numbers, ({'n' if n is None else n}, {size})", "give one row a run"
    array = np.atleast_2d(numbers_in(name, values, allowed, remedy))
    if array.ndim != 2 or array.shape[1] != size or n not in (None, len(array)):
        raise SimulationError(name, f"shape {array.shape}", allowed, remedy)
    if not np.isfinite(array).all():
        row = int(np.flatnonzero(~np.isfinite(array).all(axis=1))[0])
        raise SimulationError(f"{name}[{row}]", "not finite", allowed, "")
    return array


def rows_of(where: str, values: Any, size: int) -> np.ndarray[Any, Any]:
    """The values as (rows, size); SimulationError if they have another shape."""
    allowed = f"numbers, (n, {size}) or ({size},)"
    given = numbers_in(where, values, allowed)
    array = given[None] if given.ndim == 1 else given
    if array.ndim != 2 or array.shape[1] != size:
        raise SimulationError(where, f"an array of shape {given.shape}", allowed)
    return array


def common_rows(where: str, given: Iterable[np.ndarray[Any, Any]]) -> int:
    """The common number of rows, where one row goes with any number; SimulationError if they differ."""
    counts = {len(rows) for rows in given} - {1}
    if len(counts) > 1:
        found = f"arrays of {' and '.join(str(count) for count in sorted(counts))} rows"
        raise SimulationError(where, found, "as many rows in each, or one")
    return counts.pop() if counts else 1
