"""Recordings in CSV files: a line of names, then a row of numbers for each time.

Lines that begin with # are comments; `# start ball.velocity = 1.0, 0.0, 0.0` says how the run starts.
"""

from __future__ import annotations

import csv
import re
from collections import Counter
from collections.abc import Collection
from pathlib import Path
from typing import Any

import numpy as np

from modelgen.errors import SimulationError
from modelgen.identification.recordings import (
    START,
    Array,
    Recording,
    is_wanted,
    not_finite,
    recording_of,
)

LARGEST = 2**30  # bytes
OF_START = re.compile(r"\s*#\s*start\s+([\w.]+)\s*=(.*)")


def read_recording(path: Path, of: Collection[str] | None = None) -> Recording:
    """The recording in a CSV file; an empty cell was not measured. `of`: the columns that count; others are
    not read.

    Raises SimulationError with line and column where the file has no rows, a row has another length than the
    names, or a cell is no finite number; OSError where it cannot be read.
    """
    if path.exists() and not (path.is_file() and path.stat().st_size <= LARGEST):
        raise SimulationError(str(path), "no file, or one that large", f"a file of at most {LARGEST} bytes")
    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            lines = list(enumerate(csv.reader(file), 1))
    except UnicodeDecodeError as cause:
        raise SimulationError(str(path), "it is no text", "a CSV file in UTF-8") from cause
    except csv.Error as cause:
        raise SimulationError(str(path), f"{cause}", "cells of numbers, apart by commas") from cause
    rows = [(number, row) for number, row in lines if _is_said(row)]
    if not rows:
        raise SimulationError(str(path), "the file is empty", "a line of names, then rows of numbers")
    names = [name.strip() for name in rows[0][1]]
    _check_names(path, names)
    if len(rows) == 1:
        raise SimulationError(str(path), "names, but no rows", "a row of numbers for each time")
    shape = len(rows) - 1, len(names)
    table: Any = np.ma.array(np.zeros(shape), mask=np.ones(shape, dtype=bool))
    for k, (line, row) in enumerate(rows[1:]):
        if len(row) != len(names):
            found = f"{len(row)} cells"
            raise SimulationError(f"{path}: line {line}", found, f"{len(names)}, as there are names")
        for j, cell in enumerate(row):
            if cell.strip() and is_wanted(names[j], of):
                table[k, j] = _number(cell.strip(), f"{path}: line {line}, column {names[j]!r}")
    columns = {name: table[:, j] for j, name in enumerate(names)}
    return recording_of({**columns, START: _start(path, lines)}, str(path), of)


def _start(path: Path, lines: list[tuple[int, list[str]]]) -> dict[str, Array]:
    """What comments say of the start."""
    found = {}
    for number, row in lines:
        match = OF_START.fullmatch(",".join(row))
        if match:
            where = f"{path}: line {number}, start of {match[1]}"
            found[match[1]] = np.array([_number(cell.strip(), where) for cell in match[2].split(",")])
    return found


def _is_said(row: list[str]) -> bool:
    return any(cell.strip() for cell in row) and not row[0].lstrip().startswith("#")


def _check_names(path: Path, names: list[str]) -> None:
    counts = Counter(names)
    for name in names:
        if separator := re.search(r"[;\t]", name):
            found, allowed = f"columns apart by {separator[0]!r}", "commas between columns"
            raise SimulationError(f"{path}: line of names", found, allowed, "write numbers with a point")
        if not name:
            raise SimulationError(f"{path}: line of names", "a column without a name", "", "name it")
        if counts[name] > 1:
            raise SimulationError(f"{path}: line of names", f"{name!r} twice", "", "leave one out")


def _number(cell: str, where: str) -> float:
    try:
        value = float(cell if cell.isascii() and "_" not in cell else "")  # as Python writes numbers
    except ValueError:
        raise SimulationError(where, repr(cell), "a number, with a point, in SI units") from None
    if not np.isfinite(value):
        raise not_finite(where, repr(cell))
    return value
