"""Bodies of a run as polygons of a plane picture: placed, shaded, and sorted from far to near."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from modelgen.report.displayed_bodies import Actor, Stage
from modelgen.report.picture_space import pose_at
from modelgen.report.run_record import Record

Array = np.ndarray[Any, Any]

YAW, PITCH = -1.05, 0.32  # rad, of the direction from the scene to the eye
LIGHT = np.array([0.3, -0.4, 0.87])
ROOM = 1.05  # of the height of the picture, against the space
WIDTH = 1.25  # of the picture, against its height
AMBIENT = 0.45
NEARER = 0.01  # of the picture, by which edges are before their faces
STILL, EDGE = (0.84, 0.86, 0.89), (0.12, 0.16, 0.20)


@dataclass(frozen=True, slots=True)
class _Part:
    """Polygons of one body in the picture."""

    corners: list[Array]  # (3, 2) faces, (2, 2) lines
    depths: Array  # towards the eye
    colours: Array  # (n, 3)
    widths: Array  # of lines; 0 of faces


def draw_bodies(axes: Any, record: Record, stage: Stage, sample: int) -> None:
    """Draw the bodies at a sample into axes of matplotlib."""
    from matplotlib.collections import PolyCollection

    colours = stage.colours(STILL)
    order: tuple[list[_Part], list[_Part]] = ([], [])  # what has no end, which is behind, and the others
    for index, actor in enumerate(stage.actors):
        turn, place = pose_at(record.columns, index, sample)
        order[actor.bounded].append(_part(actor, turn, place, np.array(colours[index]), stage.size))
    for level, parts in enumerate(order):
        corners = [each for part in parts for each in part.corners]
        if not corners:
            continue
        depths = np.concatenate([part.depths for part in parts])
        shades = np.concatenate([part.colours for part in parts])
        widths = np.concatenate([part.widths for part in parts])
        sequence = np.argsort(depths, kind="stable")
        axes.add_collection(
            PolyCollection(
                [corners[k] for k in sequence], facecolors=shades[sequence], edgecolors=shades[sequence],
                linewidths=np.maximum(widths[sequence], 0.3), zorder=level,
            )
        )  # fmt: skip
    centre = _centre(record, stage, sample)
    half = ROOM * stage.size
    ((x, y),) = on_picture(centre[None])
    axes.set_xlim(x - WIDTH * half, x + WIDTH * half)
    axes.set_ylim(y - half, y + half)
    axes.set_aspect("equal")
    axes.set_xticks([])
    axes.set_yticks([])
    axes.set_title(f"t = {record.columns['t'][sample]:.4g} s", fontsize="small")


def on_picture(points: Array) -> Array:
    """(.., 2) where points (.., 3) m, world axes, are seen in the axes that `draw_bodies` draws into."""
    right, up, _ = _eye()
    return np.asarray(points @ np.stack([right, up], axis=1))


def _eye() -> tuple[Array, Array, Array]:
    """Axes of the picture to the right, up, and towards the eye."""
    back = np.array([np.cos(PITCH) * np.cos(YAW), np.cos(PITCH) * np.sin(YAW), np.sin(PITCH)])
    right = np.array([-np.sin(YAW), np.cos(YAW), 0.0])
    return right, np.cross(back, right), back


def _centre(record: Record, stage: Stage, sample: int) -> Array:
    if not stage.follow or not stage.followed:
        return stage.centre
    return np.asarray(np.mean([pose_at(record.columns, k, sample)[1] for k in stage.followed], axis=0))


def _part(actor: Actor, turn: Array, place: Array, colour: Array, size: float) -> _Part:
    _, _, back = _eye()
    mesh = actor.mesh
    points = mesh.vertices @ turn.T + place
    normals = (
        (mesh.normals @ turn.T)[mesh.triangles].mean(axis=1) if len(mesh.triangles) else np.zeros((0, 3))
    )
    seen = (normals @ back > 0) | actor.two_sided
    triangles, normals = mesh.triangles[seen], normals[seen]
    normals = normals * np.where(normals @ back < 0, -1.0, 1.0)[:, None]
    lit = AMBIENT + (1 - AMBIENT) * np.clip(normals @ LIGHT, 0, 1)
    lines = mesh.lines @ turn.T + place
    ink = np.array(EDGE) if len(mesh.triangles) else colour
    width = 0.7 if len(mesh.triangles) else 2.0
    near = NEARER * size if len(mesh.triangles) else 0.0
    return _Part(
        [*on_picture(points[triangles]), *on_picture(lines)],
        np.concatenate([(points @ back)[triangles].mean(axis=1), (lines @ back).mean(axis=1) + near]),
        np.concatenate([lit[:, None] * colour, np.broadcast_to(ink, (len(lines), 3))]),
        np.concatenate([np.zeros(len(triangles)), np.full(len(lines), width)]),
    )
