"""The pictures of the shipped scenes for the gallery of the manual.

They show the bodies at three times of the run, the paths of their centres up to then, and the contact forces.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from modelgen import read, record_of, require, simulate
from modelgen.model import Model
from modelgen.report.body_pictures import draw_bodies, on_picture
from modelgen.report.displayed_bodies import Stage, stage_of
from modelgen.report.run_record import Record
from modelgen.report.snapshots import frame_samples
from modelgen.view.arrows import arrows_of
from tests.running import SCENES, library_of

Array = np.ndarray[Any, Any]

FRAMES, FINE = 3, 5e-3  # pictures of one scene; tolerance of the meshes, as a part of the size of a shape
UNTIL = {"balancing_wheel": 0.6, "bicycle": 0.6, "block_on_incline": 0.9}  # s, shorter than the scene says
WHOLE = (  # scenes of which the whole space is shown, though bodies are small in it
    *("ball_in_torus", "ball_leaves_sphere", "block_on_incline", "bouncing_ball", "ellipsoid_on_ellipsoid"),
    *("sphere_slide_to_roll", "turntable"),
)
SCALE = {  # of the space that is shown
    "ball_in_bowl": 1.15,
    "ball_leaves_sphere": 1.2,
    "bean_with_poles": 1.2,
    "bouncing_ball": 1.25,
    "box_dropped": 1.2,
    "brake_shoe": 1.6,
    "cylinder_dropped": 1.2,
    "egg_on_spline": 0.7,
    "ellipsoid_on_ellipsoid": 1.2,
    "gripper": 1.3,
    "helix_on_cylinder": 0.4,
    "linked_rings": 1.2,
    "painleve_rod": 1.2,
    "rolling_disc": 1.15,
}
NEARER = 0.8  # size of all pictures, as what they show is hardly as high as the space
ARROW = 0.6  # of half the picture: the longest force
COLOURS = {"normal": "tab:red", "friction": "tab:orange", "pressure": "tab:purple"}


def scene_figure(name: str) -> Figure:
    """The picture of a shipped scene."""
    scene = read(SCENES / f"{name}.toml")
    library = library_of(scene)
    record = record_of(simulate(library, until=UNTIL.get(name), estimate=False), library, scene)
    stage = _stage(name, record, require(scene))
    instance = library.manifest.instance
    figure = Figure(figsize=(10.5, 3.1))
    figure.subplots_adjust(left=0.0, right=1.0, bottom=0.0, top=0.92, wspace=0.02)
    for sample, axes in zip(frame_samples(record, FRAMES), figure.subplots(1, FRAMES), strict=True):
        draw_bodies(axes, record, stage, sample)
        _draw_paths(axes, record, stage, sample)
        _draw_forces(axes, record, stage, instance, sample)
        axes.set_axis_off()
    return figure


def _stage(name: str, record: Record, model: Model) -> Stage:
    """The space of a scene that its picture shows."""
    stage = stage_of(record, model, FINE)
    if name in WHOLE:
        low, high = _bounds(record, stage)
        stage = replace(stage, follow=False, centre=(low + high) / 2, size=float((high - low).max()) / 2)
    return replace(stage, size=stage.size * NEARER * SCALE.get(name, 1.0))


def _bounds(record: Record, stage: Stage) -> tuple[Array, Array]:
    """Corners of the box, along the axes, that holds all bodies with an end at all times."""
    boxes = []
    for index, actor in enumerate(stage.actors):
        if actor.bounded:
            points = np.concatenate([np.zeros((1, 3)), actor.mesh.vertices, actor.mesh.lines.reshape(-1, 3)])
            radius, centres = np.linalg.norm(points, axis=1).max(), record.columns["p"][:, index]
            boxes.append((centres.min(axis=0) - radius, centres.max(axis=0) + radius))
    return np.min([low for low, _ in boxes], axis=0), np.max([high for _, high in boxes], axis=0)


def _draw_paths(axes: Axes, record: Record, stage: Stage, sample: int) -> None:
    """The paths of the centres of mass of the bodies that move, up to a sample."""
    for index in stage.followed:
        axes.plot(*on_picture(record.columns["p"][: sample + 1, index]).T, color="0.1", linewidth=0.8)


def _draw_forces(axes: Axes, record: Record, stage: Stage, instance: Mapping[str, Any], sample: int) -> None:
    """The contact forces at a sample; the longest arrow is the largest force of the picture."""
    column = {name: values[sample : sample + 1] for name, values in record.columns.items()}
    column["patch"] = column["patch"].astype(int)
    moving = [actor.moves for actor in stage.actors]
    arrows = [
        (COLOURS[name], point, force)
        for name, (points, forces) in arrows_of(column, instance, moving).items()
        for point, force in zip(points, forces, strict=True)
        if np.isfinite(point).all() and np.linalg.norm(force) > 0
    ]
    largest = max((float(np.linalg.norm(force)) for _, _, force in arrows), default=0.0)
    for colour, point, force in arrows:
        tip = point + force * (ARROW * stage.size / largest)
        (x, y), (to_x, to_y) = on_picture(np.array([point, tip]))
        axes.annotate(
            "", (to_x, to_y), (x, y), annotation_clip=False,
            arrowprops={"arrowstyle": "->", "color": colour, "shrinkA": 0, "shrinkB": 0},
        )  # fmt: skip
