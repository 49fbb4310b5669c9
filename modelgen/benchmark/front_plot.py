"""The work-precision plot: error over cost, of every setting and of the fronts."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from modelgen.benchmark.measurement import Measurement
from modelgen.benchmark.work_precision_front import Point, is_measured, place
from modelgen.report.run_files import check_suffix
from modelgen.report.run_plot import FORMATS, require_matplotlib, save_figure


def draw_measurement(found: Measurement, path: Path) -> None:
    """Write the picture; the suffix says how (.png or .svg). Raises ModelgenError without matplotlib."""
    check_suffix(path, FORMATS)
    figure = require_matplotlib()(figsize=(8.0, 5.5), layout="constrained")
    axes = figure.add_subplot()
    for number, (name, points, front) in enumerate(_series(found)):
        _scatter(axes, points, f"C{number}")
        cost, error = _columns(front)
        axes.plot(cost, error, "o-", color=f"C{number}", markersize=3.5, label=name)
    axes.axhline(found.reference["error"], color="0.5", linewidth=0.8, linestyle="--", label="error bar")
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlabel("µs of CPU time per simulated second")
    axes.set_ylabel(f"largest distance from the reference, over {found.length:.3g} m")
    horizon = found.reference["horizon"]
    span = f"{found.subject.until:g} s" if horizon is None else f"{horizon:g} s, its horizon"
    axes.set_title(f"{found.subject.scene.name}, up to {span}")
    axes.grid(alpha=0.3)
    axes.legend(fontsize="small")
    save_figure(figure, path)


def _series(found: Measurement) -> list[tuple[str, Sequence[Point], Sequence[Point]]]:
    peers = [(peer.name, peer.points, peer.front) for peer in found.peers if not peer.cannot]
    return [("modelgen", found.points, found.front), *peers]


def _scatter(axes: Any, points: Sequence[Point], color: str) -> None:
    cost, error = _columns([point for point in points if is_measured(point)])
    axes.plot(cost, error, ".", color=color, alpha=0.25, markersize=4)


def _columns(points: Sequence[Point]) -> tuple[list[float], list[float]]:
    placed = [place(point) for point in points]
    return [cost / 1e3 for cost, _ in placed], [error for _, error in placed]
