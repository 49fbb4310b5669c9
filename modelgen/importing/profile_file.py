"""Points of a profile from a text file of columns."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from modelgen.errors import ModelgenError
from modelgen.importing.profile_fit import Array
from modelgen.name_suggestions import nearest

UNITS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "in": 0.0254}
LARGEST = 64 * 2**20  # bytes


def read_points(path: Path, columns: str | None, unit: str) -> tuple[Array, tuple[int, ...]]:
    """Points (n, 2) m of two columns, and their lines in the file.

    Columns are separated by commas, semicolons, tabs or blanks; the first line may name them; empty lines and
    those that begin with # are passed over.

    Args:
        columns: two names, or numbers from 1, as "r,z"; the first two when None.
        unit: a key of UNITS.

    Raises:
        ModelgenError: a line, name or unit that is none.
    """
    if unit not in UNITS:
        raise ModelgenError("--unit", repr(unit), "allowed: " + ", ".join(UNITS), nearest(unit, UNITS))
    rows = _rows(path)
    header = [] if not rows or _is_numeric(rows[0][1]) else rows.pop(0)[1]
    chosen = _columns(columns, header)
    values = np.empty((len(rows), 2))
    for k, (line, words) in enumerate(rows):
        if len(words) <= max(chosen) or not all(words[c] and _is_numeric([words[c]]) for c in chosen):
            told = " ".join(words)[:40]
            raise ModelgenError(
                f"{path}: line {line}", repr(told), "two numbers in these columns", "mend the line"
            )
        values[k] = [float(words[c]) for c in chosen]
    return values * UNITS[unit], tuple(line for line, _ in rows)


def _rows(path: Path) -> list[tuple[int, list[str]]]:
    """Numbers of lines, and their words."""
    if path.stat().st_size > LARGEST:
        raise ModelgenError(
            str(path), "a file that large", f"at most {LARGEST} bytes are read", "take fewer points"
        )
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except UnicodeDecodeError:
        raise ModelgenError(
            str(path), "no UTF-8 text", "a profile is a text of columns", "save it as CSV"
        ) from None
    found = []
    for number, text in enumerate(lines, start=1):
        plain = text.strip()
        if plain and not plain.startswith("#"):
            split = re.split(r"\s*[,;\t]\s*|\s+", plain)
            found.append((number, [word.strip('"') for word in split]))
    return found


def _is_numeric(words: list[str]) -> bool:
    try:
        return bool(np.isfinite([float(word) for word in words if word]).all())
    except ValueError:
        return False


def _columns(written: str | None, header: list[str]) -> tuple[int, int]:
    words = ["1", "2"] if written is None else [each.strip() for each in written.split(",")]
    if len(words) != 2:
        raise ModelgenError("--columns", repr(written), "two columns", 'write --columns "r,z" or 1,2')
    found = []
    for word in words:
        if word in header:
            found.append(header.index(word))
        elif word.isascii() and word.isdigit() and int(word) > 0:
            found.append(int(word) - 1)
        else:
            allowed = f"columns: {', '.join(header)}" if header else "numbers of columns, from 1"
            raise ModelgenError("--columns", f"no column {word!r}", allowed, nearest(word, header))
    return found[0], found[1]
