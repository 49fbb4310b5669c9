"""Recorded motion: times, and what was measured at them."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from modelgen.errors import SimulationError
from modelgen.name_suggestions import nearest
from modelgen.notation import component_names

Array = np.ndarray[Any, Any]
TIME, START = "t", "start"


@dataclass(frozen=True)
class Recording:
    """What was measured of one motion, from the start of a run on."""

    name: str
    t: Array  # (nt,), s
    columns: tuple[str, ...]
    values: Array  # (nt, n_columns); NaN: not measured
    start: Mapping[str, Array] = field(default_factory=dict)  # quantities of bodies at t = 0, by name


def recording_of(columns: Mapping[str, Any], name: str, of: Collection[str] | None = None) -> Recording:
    """A recording from its columns: "t" (nt,), and sensors or quantities of bodies, (nt,) or (nt, 3 or 4);
    "start" may hold quantities of bodies at t = 0 by name, {"ball.velocity": (3,)}. `of`: the columns that
    count, by name or quantity; all when None.

    Masked entries were not measured. Raises SimulationError where there is no such array, a number is not
    finite, or times do not ascend.
    """
    if TIME not in columns:
        raise SimulationError(name, f"no column {TIME!r}", "times in s", "name the times t")
    start = {str(key): np.asarray(value, dtype=float) for key, value in columns.get(START, {}).items()}
    _check_wanted(columns, name, of)
    arrays: dict[str, Any] = {
        str(key): np.ma.asarray(each, dtype=float) for key, each in columns.items() if is_wanted(key, of)
    }
    t = arrays.pop(TIME)
    _check_times(t, name)
    names: list[str] = []
    parts: list[Array] = []
    for key, values in arrays.items():
        block = values[:, None] if values.ndim == 1 else values
        if block.ndim != 2 or len(block) != len(t):
            found = f"an array of shape {values.shape}"
            raise SimulationError(f"{name}: {key}", found, f"{len(t)} rows, as t has", "give one row a time")
        filled = np.asarray(block.filled(0.0))
        if not np.all(np.isfinite(filled)):
            row = int(np.argwhere(~np.isfinite(filled))[0, 0])
            raise not_finite(f"{name}: {key}, row {row + 1}", repr(float(filled[~np.isfinite(filled)][0])))
        if np.ma.getmaskarray(block).all():
            raise SimulationError(f"{name}: {key}", "nothing was measured", "", "leave the column out")
        names += component_names([(key, block.shape[1])]) if values.ndim == 2 else [key]
        parts.append(np.asarray(block.filled(np.nan)))
    if not names:
        raise SimulationError(name, "only times", "columns of sensors or bodies beside t")
    return Recording(name, np.asarray(t), tuple(names), np.hstack(parts), start)


def is_wanted(column: str, of: Collection[str] | None) -> bool:
    """Whether a column counts: one that is named, or whose quantity is, as `ball.velocity` of
    `ball.velocity_x`; the times do."""
    if column == TIME or of is None:
        return column != START
    return column in of or column.rpartition("_")[0] in of


def _check_wanted(columns: Iterable[str], name: str, of: Collection[str] | None) -> None:
    """Raise SimulationError for a name in `of` that no column has."""
    known = list(columns)
    for each in of or ():
        if not any(is_wanted(column, [each]) for column in known if column != TIME):
            raise SimulationError(
                f"{name}: of", repr(each), f"columns: {', '.join(known)}", nearest(each, known)
            )


def not_finite(where: str, found: str) -> SimulationError:
    remedy = "leave a cell empty (an array: masked) where nothing was measured"
    return SimulationError(where, found, "a finite number", remedy)


def _check_times(t: Any, name: str) -> None:
    where = f"{name}: {TIME}"
    if t.ndim != 1 or not len(t):
        raise SimulationError(where, f"an array of shape {t.shape}", "at least one time")
    times = np.asarray(t.filled(np.nan))
    if not np.all(np.isfinite(times)):
        row = int(np.flatnonzero(~np.isfinite(times))[0])
        raise SimulationError(f"{where}, row {row + 1}", repr(float(times[row])), "a finite time in s")
    falls = np.flatnonzero(np.diff(times) <= 0)
    if len(falls):
        row = int(falls[0]) + 1
        found = f"{times[row]:.9g} s after {times[row - 1]:.9g} s"
        raise SimulationError(f"{where}, row {row + 1}", found, "ascending times", "sort the rows by t")
    if times[0] < 0:
        found = f"{times[0]:.9g} s"
        raise SimulationError(where, found, "times from 0 s, the start of the run, on", "subtract the first")
