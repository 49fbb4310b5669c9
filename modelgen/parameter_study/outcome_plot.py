"""The picture of a sweep: outcomes over the numbers that varied.

Over one number they are curves, over two a map, over more a map for each pair of them.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np

from modelgen.errors import ModelgenError, expect, path_of
from modelgen.parameter_study.outcome_table import DONE, Sweep, check_column
from modelgen.parameter_study.rows import TEXT
from modelgen.report.run_files import check_suffix
from modelgen.report.run_plot import require_matplotlib, save_figure
from modelgen.runtime.trajectory import Array

PICTURES = (".png", ".svg")
PANELS = 6  # of outcomes that are drawn where none are named, at least one of each pair of numbers
NUMBERS = 5  # that are drawn against each other, the first ones
WIDE = 3  # panels side by side
POINT = 26.0  # area of the mark of a run, pt^2
EVEN = 1e-9  # of the range: values of a grid that are equal
FAILED: dict[str, Any] = {"marker": "x", "s": 22.0, "linewidths": 1.0}
DOUBTED: dict[str, Any] = {
    "marker": "o",
    "s": 40.0,
    "linewidths": 1.0,
    "facecolors": "none",
    "edgecolors": "C3",
}


def draw_sweep(found: Sweep, path: str | Path, of: Sequence[str] | None = None) -> None:
    """Write the picture of a sweep; the suffix says how (.png or .svg).

    Args:
        of: the columns that are drawn; sensors, or the outcome and the end time, when None.

    Raises ModelgenError for another suffix or column, a sweep without runs, or without matplotlib.
    """
    expect("draw_sweep", found, Sweep)
    path = path_of("draw_sweep", path)
    check_suffix(path, PICTURES)
    if not len(found):
        remedy = "go on with the sweep first"
        raise ModelgenError(str(found.folder or "draw_sweep"), "no run of the sweep is done", "", remedy)
    pairs = list(combinations(found.varied[:NUMBERS], 2)) or [(found.varied[0], "")]
    names = _drawn(found, of, PANELS // len(pairs))
    panels = [(name, *pair) for name in names for pair in pairs]
    rows = -(-len(panels) // WIDE)
    wide = min(WIDE, len(panels))
    figure = require_matplotlib()(figsize=(1.0 + 4.2 * wide, 0.8 + 3.4 * rows), layout="constrained")
    doubted = int((_doubted(found)).sum())
    counts = f"{len(found)} runs, {int(found.failed.sum())} failed, {doubted} others not trusted"
    figure.suptitle(f"{found.plan['scene']}: {counts}")
    for k, (name, x, y) in enumerate(panels):
        axes = figure.add_subplot(rows, wide, k + 1)
        if y:
            _map(found, name, x, y, axes)
        else:
            _curve(found, name, x, axes)
    save_figure(figure, path)


def _drawn(found: Sweep, of: Sequence[str] | None, most: int) -> list[str]:
    """The columns that are drawn, at most so many, or one, where none are named."""
    if of is None:
        return [*found.sensors, *(() if found.sensors else ("outcome", "t_end"))][: max(most, 1)]
    return check_drawn(of, list(found.columns))


def check_drawn(of: Sequence[str], columns: Sequence[str]) -> list[str]:
    """The columns to be drawn. Raises ModelgenError where there is none, or one that a table has not."""
    if not of:
        raise ModelgenError("of", "nothing to draw", "columns of the table", "leave it out for the sensors")
    for name in of:
        check_column("of", name, columns)
    return list(of)


def _curve(found: Sweep, name: str, x: str, axes: Any) -> None:
    values, labels = _numbers(found, name)
    order = np.argsort(found[x], kind="stable")
    at, shown, failed = found[x][order], values[order], found.failed[order]
    axes.plot(at[~failed], shown[~failed], ".-", markersize=4, linewidth=0.9, color="C0")
    doubted = _doubted(found)[order] & np.isfinite(shown)
    if doubted.any():
        axes.scatter(at[doubted], shown[doubted], label="not trusted", **DOUBTED)
    if failed.any():
        known = failed & np.isfinite(shown)
        axes.scatter(at[known], shown[known], color="C3", label="failed", **FAILED)
        rest = at[failed & ~known]  # of which nothing is known, along the bottom
        axes.plot(rest, np.full(len(rest), 0.03), "x", color="C3", transform=axes.get_xaxis_transform())
    _name_axes(axes, x, name)
    if labels:
        axes.set_yticks(range(len(labels)), labels)
    axes.grid(alpha=0.3)


def _map(found: Sweep, name: str, x: str, y: str, axes: Any) -> None:
    values, labels = _numbers(found, name)
    at, over, failed = found[x], found[y], found.failed & (name != "outcome")
    known = np.isfinite(values) & ~failed
    grid = _grid(at, over, np.where(known, values, np.nan)) if len(found.varied) == 2 else None
    options: dict[str, Any] = {"cmap": "tab10" if labels else "viridis"}
    if labels:
        options |= {"vmin": -0.5, "vmax": 9.5}
    if grid is not None:
        drawn = axes.pcolormesh(*grid, shading="nearest", **options)
    else:
        drawn = axes.scatter(at[known], over[known], c=values[known], s=POINT, **options)
    doubted = _doubted(found)
    if doubted.any():
        axes.scatter(at[doubted], over[doubted], **DOUBTED)
    if failed.any():
        axes.scatter(at[failed], over[failed], color="C3", **FAILED)
    bar = axes.figure.colorbar(drawn, ax=axes)
    if labels:
        bar.set_ticks(range(len(labels)), labels=labels)
        bar.ax.set_ylim(-0.5, len(labels) - 0.5)
    _name_axes(axes, x, y)
    axes.set_title(name, fontsize="medium")


def _doubted(found: Sweep) -> Array:
    """Runs that came to their end and are not trusted: (n,) of bool."""
    return np.asarray(~found.failed & (found["trusted"] == 0))


def _name_axes(axes: Any, x: str, y: str) -> None:
    axes.set_xlabel(x)
    axes.set_ylabel(y)


def _numbers(found: Sweep, name: str) -> tuple[Array, list[str]]:
    """The values of a column as numbers, and what they stand for where they are texts."""
    values: Array = found[name]
    if found.plan["columns"][name] != TEXT:
        return values, []
    labels = sorted(set(values.tolist()), key=lambda text: (text != DONE, text))
    return np.array([labels.index(value) for value in values.tolist()], dtype=float), labels


def _grid(x: Array, y: Array, values: Array) -> tuple[Array, Array, Array] | None:
    """The values on a grid; None where the runs are no grid."""
    columns, rows = _distinct(x), _distinct(y)
    if len(columns) * len(rows) != len(values):
        return None
    table = np.full((len(rows), len(columns)), np.nan)
    table[_nearest(rows, y), _nearest(columns, x)] = values
    return columns, rows, table


def _distinct(values: Array) -> Array:
    found = np.sort(values)
    gap = EVEN * (found[-1] - found[0]) if len(found) else 0.0
    return np.asarray(found[np.concatenate([[True], np.diff(found) > gap])])


def _nearest(places: Array, values: Array) -> Array:
    return np.asarray(np.abs(places[None, :] - values[:, None]).argmin(axis=1))
