"""The bodies of a run as meshes: what pictures and pages show."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import cycle
from typing import Any

import numpy as np

from modelgen.geometry.body_meshes import Mesh, body_mesh
from modelgen.model import Model
from modelgen.report.picture_space import radius_of, space_of
from modelgen.report.run_record import Record
from modelgen.rotations import rotation_of
from modelgen.scene.scene_types import Body, Shape

Array = np.ndarray[Any, Any]
Colour = tuple[float, float, float]  # red, green, blue, 0 to 1

REACH = 1.6  # of unbounded surfaces, against half the size of the space in which bodies move
AHEAD = 6.0  # of those of a run that only begins, against half the size of its start
LEVER = (
    1.2  # of the distance of a joint or point, against the radius of a body, from which on a lever is drawn
)
UNBOUNDED = ("plane", "halfspace", "line", "paraboloid", "cone", "helix")
PALETTE = (  # of bodies that move, in turn
    *((0.20, 0.52, 0.80), (0.88, 0.50, 0.20), (0.28, 0.65, 0.42), (0.62, 0.42, 0.74)),
    *((0.80, 0.36, 0.38), (0.38, 0.62, 0.70), (0.68, 0.58, 0.25), (0.50, 0.50, 0.82)),
)
COARSE = 0.05  # tolerance of the meshes by which the space is measured


@dataclass(frozen=True, slots=True)
class Actor:
    """A body of a run."""

    name: str
    mesh: Mesh
    moves: bool
    bounded: bool  # it has an end in every direction
    two_sided: bool  # its surfaces are seen from both sides; else from outside of the material alone


@dataclass(frozen=True, slots=True)
class Stage:
    """The bodies of a run, m, world axes."""

    actors: tuple[Actor, ...]
    centre: Array  # (3,)
    size: float  # half the size of the picture
    follow: bool  # the picture moves with the bodies

    @property
    def followed(self) -> list[int]:
        """The bodies with which a picture moves."""
        return [k for k, actor in enumerate(self.actors) if actor.moves and actor.bounded]

    def colours(self, still: Colour) -> list[Colour]:
        """Of each body; `still`: of those that do not move."""
        palette = cycle(PALETTE)
        return [next(palette) if actor.moves else still for actor in self.actors]


def stage_of(record: Record, model: Model, tolerance: float, may_move: bool = False) -> Stage:
    """The bodies of a run and where it takes place.

    Args:
        record: what `record_of` returned.
        model: what `require` made of its scene.
        tolerance: of the meshes, as a part of the size of each shape.
        may_move: take bodies for moving that are not fixed; else those that moved in the run.
    """
    moving = not_fixed(model) if may_move else set(record.moving)
    return _stage(record.columns, moving, model, tolerance)


def stage_at_start(columns: Mapping[str, Array], model: Model, tolerance: float) -> Stage:
    """The bodies of a run that begins: `columns` is its first sample, as a Trajectory names them."""
    return _stage(columns, not_fixed(model), model, tolerance, AHEAD)


def not_fixed(model: Model) -> set[int]:
    """The bodies that forces or paths may move."""
    kinds = [model.body_kinds[body.kind].motion for body in model.bodies]
    return {index for index, motion in enumerate(kinds) if motion != "fixed"}


def _stage(
    columns: Mapping[str, Array], moving: set[int], model: Model, tolerance: float, reaches: float = REACH
) -> Stage:
    bodies, entries = model.whole.bodies, model.bodies
    bounded = [_is_bounded(body) for body in bodies]
    rough = [
        _with_levers(body_mesh(body, entry.centre_of_mass, 1e-3, COARSE), model, index)
        for index, (body, entry) in enumerate(zip(bodies, entries, strict=True))
    ]
    space = space_of(columns, rough, bounded, moving)
    actors = tuple(
        Actor(
            entry.name,
            body_shape(model, index, reaches * space.reach + space.away[index], tolerance),
            index in moving,
            bounded[index],
            bounded[index] and not any(shape.cavity for shape in body.shapes),
        )
        for index, (body, entry) in enumerate(zip(bodies, entries, strict=True))
    )
    return Stage(actors, space.centre, space.size, space.follow)


def body_shape(model: Model, index: int, reach: float, tolerance: float) -> Mesh:
    """The mesh of a body. Surfaces without end are cut at `reach`, m; `tolerance` is a part of the size of a
    shape."""
    body, entry = model.whole.bodies[index], model.bodies[index]
    return _with_levers(body_mesh(body, entry.centre_of_mass, reach, tolerance), model, index)


def _is_bounded(body: Body) -> bool:
    return all(
        shape.kind not in UNBOUNDED and not _is_endless(body, k) for k, shape in enumerate(body.shapes)
    )


def _is_endless(body: Body, k: int) -> bool:
    shape = body.shapes[k]
    return shape.kind == "cylinder" and len(shape.parameters) == 1


def _with_levers(mesh: Mesh, model: Model, index: int) -> Mesh:
    """The mesh, with lines from the centre of mass to the joints and points that are beyond the shapes."""
    centre, radius = np.array(model.bodies[index].centre_of_mass), radius_of(mesh)
    joints = [
        np.array(frame.position)
        for joint in model.joints
        for body, frame in zip((joint.a, joint.b), joint.frames, strict=True)
        if body == index
    ]
    points = [_place_of(shape) for shape in model.whole.bodies[index].shapes if shape.kind == "point"]
    ends = [place - centre for place in (*joints, *points)]
    far = [np.array([np.zeros(3), end]) for end in ends if np.linalg.norm(end) > LEVER * radius]
    return replace(mesh, lines=np.concatenate([mesh.lines, np.array(far).reshape(-1, 2, 3)]))


def _place_of(point: Shape) -> Array:
    """Of a point, in the axes of its body as written."""
    at = np.array([value for _, value in point.parameters])
    return np.asarray(rotation_of(point.pose.quaternion) @ at + point.pose.position)
