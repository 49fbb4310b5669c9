"""One picture of a fit: what is left of each recording, by quantity, over time."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from modelgen.errors import expect, path_of
from modelgen.identification.fit import Fit
from modelgen.identification.recordings import Array
from modelgen.report.run_files import check_suffix
from modelgen.report.run_plot import ENTRIES, FORMATS, require_matplotlib, save_figure

WIDE = 1.96  # standard deviations on each side, which 95 % of normal deviations do not exceed
COLOURS = ("tab:blue", "tab:orange", "tab:green", "tab:red", "tab:purple", "tab:brown")


def draw_fit(found: Fit, path: str | Path) -> None:
    """Write the picture of what `fit` returned; the suffix says how (.png or .svg).

    Raises ModelgenError for another suffix, or without matplotlib.
    """
    expect("draw_fit", found, Fit)
    path = path_of("draw_fit", path)
    check_suffix(path, FORMATS)
    figure_class = require_matplotlib()
    groups = list(dict.fromkeys(group for left in found.residuals for group in left.groups))
    figure = figure_class(figsize=(9.0, 1.0 + 2.4 * len(groups)), layout="constrained")
    figure.suptitle(f"{found.scene}: run minus recording, and 95 % of the noise")
    for k, group in enumerate(groups):
        axes = figure.add_subplot(len(groups), 1, k + 1)
        axes.set_title(group)
        _panel(found, group, axes)
    save_figure(figure, path)


def _panel(found: Fit, group: str, axes: Any) -> None:
    for number, left in enumerate(found.residuals):
        columns = [k for k, each in enumerate(left.groups) if each == group]
        for line, k in enumerate(columns):
            colour = COLOURS[line % len(COLOURS)]
            label = left.of[k] if number == 0 and line < ENTRIES else None
            _line(left.t, left.deviations[:, k], axes, colour, label)
    widths = [size for name, size in found.noise.items() if name == group or name.startswith(f"{group}_")]
    for width in dict.fromkeys(widths):
        axes.axhspan(-WIDE * width, WIDE * width, color="0.85", zorder=0)
    axes.set_xlabel("t [s]")
    axes.set_ylabel("SI units")
    axes.grid(alpha=0.3)
    axes.legend(fontsize="x-small", loc="best")


def _line(t: Array, values: Array, axes: Any, colour: str, label: str | None) -> None:
    known = np.isfinite(values)
    axes.plot(t[known], values[known], ".-", markersize=3, linewidth=0.8, color=colour, label=label)
