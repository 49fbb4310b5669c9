"""The bodies of a run as meshes, and the space in which they move: what pictures and pages show."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import cycle
from typing import Any

import numpy as np

from modelgen.geometry.body_meshes import Mesh, body_mesh
from modelgen.model import Model
from modelgen.report.run_record import Record
from modelgen.rotations import rotation_of
from modelgen.scene.scene_types import Body, Shape

Array = np.ndarray[Any, Any]
Colour = tuple[float, float, float]  # red, green, blue, 0 to 1

REACH = 1.6  # of unbounded surfaces, against half the size of the space in which bodies move
AHEAD = 6.0  # of those of a run that only begins, against half the size of its start
FOLLOWED = 5.0  # of all motion, against the group of bodies that move, from which on the picture follows
NEAR = 2.2  # of a picture that follows, against the group
WIDE = 3.0  # of what stands still, against all motion, from which on the picture shows the motion alone
LEVER = (
    1.2  # of the distance of a joint or point, against the radius of a body, from which on a lever is drawn
)
UNBOUNDED = ("plane", "halfspace", "line", "paraboloid", "cone", "helix")
PALETTE = (  # of bodies that move, in turn
    *((0.20, 0.52, 0.80), (0.88, 0.50, 0.20), (0.28, 0.65, 0.42), (0.62, 0.42, 0.74)),
    *((0.80, 0.36, 0.38), (0.38, 0.62, 0.70), (0.68, 0.58, 0.25), (0.50, 0.50, 0.82)),
)
COARSE = 0.05  # tolerance of the meshes by which the space is measured
INSTANTS = 60  # samples by which it is measured


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
    places = {index: _places(columns, index, mesh) for index, mesh in enumerate(rough) if bounded[index]}
    centre, reach = _ball(list(places.values()))
    radii = {index: _radius(rough[index]) for index in places if index in moving}
    follow = False
    size = reach
    away = [_distance(columns, k, centre) for k in range(len(bodies))]
    if radii:
        centre_of_motion, motion = _ball([places[index] for index in radii])
        group = _group(columns, radii)
        follow = motion > FOLLOWED * group
        if follow or reach > WIDE * motion:
            centre, size = centre_of_motion, NEAR * group if follow else motion
    actors = tuple(
        Actor(
            entry.name,
            body_shape(model, index, reaches * reach + away[index], tolerance),
            index in moving,
            bounded[index],
            bounded[index] and not any(shape.cavity for shape in body.shapes),
        )
        for index, (body, entry) in enumerate(zip(bodies, entries, strict=True))
    )
    return Stage(actors, centre, size, follow)


def body_shape(model: Model, index: int, reach: float, tolerance: float) -> Mesh:
    """The mesh of a body. Surfaces without end are cut at `reach`, m; `tolerance` is a part of the size of a
    shape."""
    body, entry = model.whole.bodies[index], model.bodies[index]
    return _with_levers(body_mesh(body, entry.centre_of_mass, reach, tolerance), model, index)


def pose_at(columns: Mapping[str, Array], body: int, sample: int) -> tuple[Array, Array]:
    """Rotation (3, 3) and centre of mass (3,) of a body at a sample; not turned, or in the origin, where
    that is not known."""
    q, p = columns["quaternion"][sample, body], columns["p"][sample, body]
    turned = rotation_of(q) if np.isfinite(q).all() else np.eye(3)
    return turned, np.nan_to_num(p)


def _is_bounded(body: Body) -> bool:
    return all(
        shape.kind not in UNBOUNDED and not _is_endless(body, k) for k, shape in enumerate(body.shapes)
    )


def _is_endless(body: Body, k: int) -> bool:
    shape = body.shapes[k]
    return shape.kind == "cylinder" and len(shape.parameters) == 1


def _own_points(mesh: Mesh) -> Array:
    points = np.concatenate([mesh.vertices, mesh.lines.reshape(-1, 3)])
    return points if len(points) else np.zeros((1, 3))


def _radius(mesh: Mesh) -> float:
    return float(np.linalg.norm(_own_points(mesh), axis=1).max())


def _samples(columns: Mapping[str, Array]) -> list[int]:
    """Samples by which a run is measured."""
    count = len(columns["t"])
    return np.unique(np.linspace(0, count - 1, min(count, INSTANTS)).astype(int)).tolist() if count else []


def _distance(columns: Mapping[str, Array], body: int, centre: Array) -> float:
    """How far a body is from the middle of the space at first."""
    return float(np.linalg.norm(centre - pose_at(columns, body, 0)[1])) if len(columns["t"]) else 0.0


def _places(columns: Mapping[str, Array], body: int, mesh: Mesh) -> Array:
    """Where the points of a body come to lie in the run, (n, 3)."""
    own = _own_points(mesh)
    poses = (pose_at(columns, body, k) for k in _samples(columns))
    return np.concatenate([np.zeros((0, 3)), *(own @ turn.T + place for turn, place in poses)])


def _group(columns: Mapping[str, Array], radii: Mapping[int, float]) -> float:
    """How far bodies reach, at any time, from the mean of their centres, m."""
    found = 1e-6
    for sample in _samples(columns):
        centres = np.array([pose_at(columns, body, sample)[1] for body in radii])
        off = np.linalg.norm(centres - centres.mean(axis=0), axis=1) + list(radii.values())
        found = max(found, float(off.max()))
    return found


def _ball(points: Sequence[Array]) -> tuple[Array, float]:
    """Centre of the box around points, and their largest distance from it."""
    whole = np.concatenate([np.zeros((0, 3)), *points])
    if not len(whole):
        return np.zeros(3), 1.0
    centre = (whole.min(axis=0) + whole.max(axis=0)) / 2
    return centre, max(float(np.linalg.norm(whole - centre, axis=1).max()), 1e-6)


def _with_levers(mesh: Mesh, model: Model, index: int) -> Mesh:
    """The mesh, with lines from the centre of mass to the joints and points that are beyond the shapes."""
    centre, radius = np.array(model.bodies[index].centre_of_mass), _radius(mesh)
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
