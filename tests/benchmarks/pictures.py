"""The pictures of the README and the manual, in modelgen/manual/images.

    python -m tests.benchmarks.pictures [NAME ...]

draws all, or those named: `run`, `gamma2`, `many_contacts`, a shipped scene (for the gallery), a worked
example. `many_contacts` needs what `tests.benchmarks.many_contacts_peers` needs, and takes minutes.
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

import matplotlib
import numpy as np
from PIL import Image

from modelgen import record_of, simulate
from modelgen.cli.manual import page, script_of
from modelgen.report.snapshots import draw_frames
from tests.benchmarks.gallery_pictures import scene_figure
from tests.benchmarks.gamma2 import BASE, FINEST, SCENES, UNTIL, _tips
from tests.benchmarks.many_contacts_peers import FRONTS, collected
from tests.docs.pages import EXAMPLES, IMAGES
from tests.running import NAMES, scene_of

matplotlib.use("Agg")

from matplotlib import pyplot as plt
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

RUN_SCENE, RUN_UNTIL, RUN_FRAMES = "ellipsoid_on_plane", 0.6, (0, 67, 133, 200)
COLOURS, SHADES = 16, 256  # in a picture with few; in one with light and shade, or many curves
SAMPLES, DPI, FLOOR = 200, 80, 1e-18  # FLOOR in m: the least error that the logarithmic axis shows
DEPTH_FLOOR = 1e-14  # m: the least penetration that the logarithmic axis shows
STYLES = (
    ("tab:blue", "o-"),
    ("tab:cyan", "s-"),
    ("tab:red", "o-"),
    ("tab:orange", "s-"),
    ("tab:green", "^-"),
)


def draw_gamma2(path: Path) -> None:
    """The error over time of each scene of `tests.benchmarks.gamma2`, with Gamma2 and without it."""
    figure, axes = plt.subplots(1, len(SCENES), figsize=(9.0, 3.0), sharey=True, layout="constrained")
    for name, place in zip(SCENES, axes, strict=True):
        for use_gamma, colour in ((False, "tab:red"), (True, "tab:blue")):
            times, errors = error_over_time(name, use_gamma)
            label = "with Gamma2" if use_gamma else "without Gamma2"
            place.semilogy(times[1:], np.maximum(errors, FLOOR)[1:], color=colour, label=label)
        place.set(title=name, xlabel="t, s")
        place.grid(alpha=0.3)
    axes[0].set_ylabel("error of body points, m")
    axes[0].legend(loc="center right")
    _save(figure, path)


def error_over_time(name: str, use_gamma: bool) -> tuple[np.ndarray, np.ndarray]:
    """Times in s, and the largest error in m of points 0.1 m along the body axes, against long double."""
    reference = simulate(
        scene_of(name, "implicit", "long double"),
        until=UNTIL, samples=SAMPLES, accuracy=FINEST, estimate=False,
    )  # fmt: skip
    path = simulate(
        scene_of(name, "implicit"),
        until=UNTIL, samples=SAMPLES, accuracy=replace(BASE, use_gamma=use_gamma), estimate=False,
    )  # fmt: skip
    return path.t, np.abs(_tips(path) - _tips(reference)).max(axis=(1, 2))


def draw_run(path: Path) -> None:
    """Bodies of one run at some of its samples."""
    library = scene_of(RUN_SCENE)
    record = record_of(simulate(library, until=RUN_UNTIL, samples=SAMPLES, estimate=False), library)
    size = (3.0 * len(RUN_FRAMES), 3.0)
    figure, axes = plt.subplots(1, len(RUN_FRAMES), figsize=size, subplot_kw={"projection": "3d"})
    draw_frames(record, list(RUN_FRAMES), list(axes))
    for place in axes:
        place.set_axis_off()
    figure.subplots_adjust(left=0.0, right=1.0, bottom=0.0, top=0.88, wspace=0.0)
    _save(figure, path)


def draw_many_contacts(path: Path) -> None:
    """Cost over penetration of each program in several steps, of the scenes FRONTS."""
    rows = collected("front", [*FRONTS], None)
    figure, axes = plt.subplots(
        2, (len(rows) + 1) // 2, figsize=(10.0, 6.0), sharex=True, layout="constrained"
    )
    for row, place in zip(rows, axes.flat, strict=False):
        lines: dict[str, list[tuple[float, float]]] = {}
        for setting, run in row["programs"].items():
            if not run["failure"]:
                at = max(run["deepest"], DEPTH_FLOOR), run["cpu"]
                lines.setdefault(setting.rpartition(", ")[0], []).append(at)
        for (name, points), (colour, mark) in zip(lines.items(), STYLES, strict=False):
            place.loglog(
                *zip(*points, strict=True), mark, color=colour, label=name, markersize=4, linewidth=1
            )
        place.set_title(row["title"], fontsize=9)
        place.grid(alpha=0.3)
        place.yaxis.set_minor_formatter(NullFormatter())
    for place in axes.flat[len(rows) :]:
        place.set_axis_off()
    for place in axes[-1]:
        place.set_xlabel("deepest penetration, m")
    for place in axes[:, 0]:
        place.set_ylabel("CPU s per s")
    named = axes.flat[0].get_legend_handles_labels()
    figure.legend(*named, loc="outside lower center", ncols=5, fontsize=8)
    figure.savefig(path, dpi=DPI)
    _reduce(path, SHADES)


def draw_scene(name: str, path: Path) -> None:
    """A shipped scene, for the gallery."""
    scene_figure(name).savefig(path, dpi=DPI)
    _reduce(path, SHADES)


def draw_example(topic: str, path: Path) -> None:
    """The picture that a worked example of the manual draws."""
    with TemporaryDirectory() as folder:
        subprocess.run([sys.executable, "-c", script_of(page(topic))], cwd=folder, check=True)
        path.write_bytes((Path(folder) / path.name).read_bytes())
    _reduce(path, SHADES)


def _save(figure: Figure, path: Path) -> None:
    """A PNG file of few colours, which is small."""
    figure.savefig(path, dpi=DPI)
    _reduce(path, COLOURS)


def _reduce(path: Path, colours: int) -> None:
    """Leave a picture so many colours: many are spread evenly, few are those that cover most."""
    method = Image.Quantize.FASTOCTREE if colours == SHADES else Image.Quantize.MEDIANCUT
    Image.open(path).convert("RGB").quantize(colours, method).save(path, optimize=True)


PICTURES: dict[str, tuple[Path, Callable[[Path], None]]] = {
    "run": (IMAGES / "run.png", draw_run),
    "gamma2": (IMAGES / "gamma2.png", draw_gamma2),
    "many_contacts": (IMAGES / "many_contacts.png", draw_many_contacts),
    **{name: (IMAGES / "scenes" / f"{name}.png", partial(draw_scene, name)) for name in NAMES},
    **{topic: (IMAGES / f"{topic}.png", partial(draw_example, topic)) for topic in EXAMPLES},
}

if __name__ == "__main__":
    for picture in sys.argv[1:] or PICTURES:
        place, draw_into = PICTURES[picture]
        place.parent.mkdir(parents=True, exist_ok=True)
        draw_into(place)
        print(place)
