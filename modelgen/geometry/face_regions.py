"""The planar regions of a shape: its flat faces, those in one plane together, and what bounds them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from math import isfinite
from typing import Any

import casadi as ca
import numpy as np

from modelgen.geometry.convex_cells import range_of
from modelgen.geometry.curves import curve_of, is_curve
from modelgen.geometry.extent import bounding_radius
from modelgen.geometry.shape_features import features_of
from modelgen.rotations import rotation_of
from modelgen.scene.expression import Number
from modelgen.scene.pose_arithmetic import UPSIDE_DOWN, compose, frame, to_inner, to_outer
from modelgen.scene.scene_types import Condition, Feature, Pose, Shape

Array = np.ndarray[Any, np.dtype[np.float64]]

LEVEL = (
    1e-9  # distance from a plane, against the size of the region, and sine of an angle, of what lies in it
)
JOINED = 1e-7  # distance of two ends that meet, against the size of the region
HALF_TURN = (0.0, 0.0, 0.0, 1.0)  # about z
MIRRORS = {"edge": HALF_TURN, "circle": UPSIDE_DOWN, "ellipse_curve": UPSIDE_DOWN}  # that turn t into -t
SAMPLES = 16  # of a boundary curve, for its side and the size of the region


@dataclass(frozen=True, slots=True)
class Arc:
    """A piece of a boundary: a curve, its pose in the axes of the face, and the range that is run through."""

    curve: Shape
    ends: tuple[float, float]
    loop: int


@dataclass(frozen=True, slots=True)
class Region:
    """A planar part of a surface; without arcs it is a whole plane.

    `features` are the faces, edges and vertices that lie in it; `pose`, with z outward, is in the frame of
    the shape; `radius` is that of a circle about `centre` in its axes, m, that holds it.
    """

    name: str
    features: frozenset[str]
    pose: Pose
    arcs: tuple[Arc, ...]
    centre: tuple[float, float] = (0.0, 0.0)
    radius: float = 0.0


@dataclass(frozen=True)
class _Run:
    """A boundary curve in the axes of the face with its direction, before it has a place in a loop."""

    curve: Shape
    ends: tuple[float, float]

    def at(self, t: float) -> Array:
        found: Array = self._points((t,))[0]
        return found

    @cached_property
    def start(self) -> Array:
        return self.at(self.ends[0])

    @cached_property
    def end(self) -> Array:
        return self.at(self.ends[1])

    @property
    def turned(self) -> _Run | None:
        """The other way round; None for a curve without a mirror image in itself."""
        mirror = MIRRORS.get(self.curve.kind)
        if mirror is None:
            return None
        curve = replace(self.curve, pose=compose(self.curve.pose, Pose(quaternion=mirror)))
        return _Run(curve, (-self.ends[1], -self.ends[0]))

    @cached_property
    def samples(self) -> Array:
        """Points (SAMPLES + 1, 3) from its start to its end."""
        return self._points(np.linspace(*self.ends, SAMPLES + 1))

    def _points(self, t: Sequence[float] | Array) -> Array:
        return to_outer(self.curve.pose, points_of(self.curve, t))


@lru_cache(maxsize=512)
def regions_of(shape: Shape) -> tuple[Region, ...]:
    """The planar regions of a shape; flat faces of which the boundary is not known are left out."""
    flat = [feature for feature in features_of(shape).features if _is_flat(feature)]
    found = (_region(shape, members) for members in _coplanar(flat, _height_within(shape)))
    return tuple(region for region in found if region is not None)


def point_of(curve: Shape, t: float) -> Array:
    """The point (3,) of a curve at t in its own axes, m."""
    found: Array = points_of(curve, (t,))[0]
    return found


def points_of(curve: Shape, t: Sequence[float] | Array) -> Array:
    """Points (n, 3) of a curve at t (n,) in its own axes, m."""
    at = np.asarray(t, dtype=float)
    found: Array = np.zeros((len(at), 3))
    if curve.kind == "edge":
        found[:, 0] = at
    elif curve.kind in ("circle", "ellipse_curve"):
        a, b = curve.parameters[0][1], curve.parameters[-1][1]
        found[:, 0], found[:, 1] = a * np.cos(at), b * np.sin(at)
    else:
        evaluate = _evaluated(replace(curve, pose=Pose()))
        found[:] = [np.asarray(evaluate(each), dtype=float).ravel() for each in at]
    return found


@lru_cache(maxsize=128)
def _evaluated(curve: Shape) -> ca.Function:
    t = ca.SX.sym("t")
    numbers = ca.SX(ca.DM([value for _, value in curve.parameters]))
    return ca.Function("curve", [t], [curve_of(curve).components(t, numbers)])


def _is_flat(feature: Feature) -> bool:
    chart = feature.shape.chart
    level = chart is not None and isinstance(chart.components[2].tree, Number)
    return feature.dimension == 2 and (feature.shape.kind == "plane" or level)


def _outward(feature: Feature) -> Pose:
    """The axes of a flat face, z outward."""
    pose = feature.shape.pose
    return compose(pose, Pose(quaternion=UPSIDE_DOWN)) if feature.shape.cavity else pose


def _height_within(shape: Shape) -> float:
    """Height (m) up to which faces of one shape are in one plane."""
    size = bounding_radius(shape)
    return LEVEL * size if isfinite(size) else 0.0


def _coplanar(flat: Sequence[Feature], flush: float) -> list[list[Feature]]:
    """Flat faces by the plane that they lie in, planes of the catalogue first."""
    groups: list[list[Feature]] = []
    for feature in sorted(flat, key=lambda each: each.shape.chart is not None):
        mates = (group for group in groups if _in_one_plane(group[0], feature, flush))
        group = next(mates, None)
        if group is None:
            groups.append([feature])
        else:
            group.append(feature)
    return groups


def _in_one_plane(a: Feature, b: Feature, flush: float) -> bool:
    turned = b.shape.chart is not None  # a chart's normal depends on the order of u and v
    return in_one_plane(_outward(a), _outward(b), flush, turned)


def in_one_plane(a: Pose, b: Pose, flush: float, turned: bool = False) -> bool:
    """Whether frames have their first two axes in one plane, within `flush` (m), and, unless they may be
    turned, z on one side."""
    level, across = to_inner(a, b.position), rotation_of(a.quaternion).T @ rotation_of(b.quaternion)[:, 2]
    aligned = (turned or across[2] > 0) and np.hypot(*across[:2]) < LEVEL
    return bool(aligned and abs(level[2]) <= flush + LEVEL * np.hypot(*level[:2]))


def _region(shape: Shape, members: Sequence[Feature]) -> Region | None:
    first = members[0]
    if first.shape.kind != "plane":
        return None
    pose = _outward(first)
    if not any(feature.conditions for feature in members):
        return Region(first.name, frozenset({first.name}), pose, ())
    edges = {each.name: each for each in features_of(shape).features if each.dimension == 1}
    runs: list[_Run] = []
    for member in members:
        found = _boundary(member, pose, edges, frozenset(each.name for each in members))
        if found is None:
            return None
        runs += found
    loops = _loops(runs)
    if loops is None:
        return None
    arcs = tuple(Arc(run.curve, run.ends, k) for k, loop in enumerate(loops) for run in loop)
    points = np.vstack([run.samples[:, :2] for run in runs])
    centre = (points.min(axis=0) + points.max(axis=0)) / 2
    radius = float(np.linalg.norm(points - centre, axis=1).max())
    inside = frozenset(_in_plane(shape, pose, radius)) | {each.name for each in members}
    name = min((each.name for each in members), key=len)  # "bottom" of "bottom" and "bottom_core"
    return Region(name, inside, pose, arcs, (float(centre[0]), float(centre[1])), radius)


def _boundary(
    face: Feature, pose: Pose, edges: dict[str, Feature], members: frozenset[str]
) -> list[_Run] | None:
    """The boundary curves of a face that are not joins with other members; None where one is not known."""
    mine = to_axes(pose, face.shape.pose)
    if all(is_linear(condition) for condition in face.conditions):
        return _polygon(face.conditions, mine, members)
    runs = []
    for condition in face.conditions:
        if condition.next in members:
            continue
        edge = edges.get(condition.next or "")
        if edge is None:
            return None
        curve = replace(edge.shape, pose=to_axes(pose, edge.shape.pose))
        runs.append(_Run(curve, range_of(edge)))
    return runs


def to_axes(outer: Pose, inner: Pose) -> Pose:
    """The pose of `inner` in the axes of `outer`, both given in one frame."""
    w, x, y, z = outer.quaternion
    back = Pose(quaternion=(w, -x, -y, -z))
    return compose(replace(back, position=_vector(to_outer(back, [-c for c in outer.position]))), inner)


def _vector(x: Array) -> tuple[float, float, float]:
    return float(x[0]), float(x[1]), float(x[2])


def is_linear(condition: Condition) -> bool:
    """Whether a condition of a face is a half-plane."""
    return condition.kind == "quadric" and not any(condition.numbers[4:])


def polygon_of(conditions: Sequence[Condition]) -> tuple[list[Condition], Array] | None:
    """Half-planes in turn, and the corners (n, 2) m at which the sides on them begin; None where two sides
    in turn are parallel."""
    sides = _in_turn(conditions)
    lines = [(np.array(each.numbers[1:3]), each.numbers[0]) for each in sides]
    corners = []
    for k, (normal, offset) in enumerate(lines):
        before, start = lines[k - 1]
        A = np.array([before, normal])
        if abs(np.linalg.det(A)) < LEVEL:
            return None
        corners.append(np.linalg.solve(A, [-start, -offset]))
    return sides, np.array(corners)


def _polygon(conditions: Sequence[Condition], pose: Pose, members: frozenset[str]) -> list[_Run] | None:
    """The sides of a convex polygon, given by its half-planes, but for those to other members."""
    found = polygon_of(conditions)
    if found is None:
        return None
    corners = [to_outer(pose, (*corner, 0.0)) for corner in found[1]]
    sides = zip(corners, [*corners[1:], corners[0]], found[0], strict=True)
    return [_side(a, b) for a, b, condition in sides if condition.next not in members]


def _in_turn(conditions: Sequence[Condition]) -> list[Condition]:
    """Half-planes by the direction of their normals, from the first on."""
    angles = [float(np.arctan2(each.numbers[2], each.numbers[1])) for each in conditions]
    order = sorted(range(len(angles)), key=lambda k: (angles[k] - angles[0]) % (2 * np.pi))
    return [conditions[k] for k in order]


def _side(a: Array, b: Array) -> _Run:
    length = float(np.linalg.norm(b - a))
    curve = Shape(
        "edge", (("length", length),), pose=frame((a + b) / 2, (b - a) / length, np.array([0.0, 0.0, 1.0]))
    )
    return _Run(replace(curve, name="edge"), (-length / 2, length / 2))


def _loops(runs: Sequence[_Run]) -> list[list[_Run]] | None:
    """The curves end to start; None where they do not close."""
    size = max((float(np.abs(run.samples).max()) for run in runs), default=0.0)
    left, loops = list(runs), []
    while left:
        loop = [left.pop(0)]
        start = loop[0].start
        while not _meet(loop[-1].end, start, size):
            end = loop[-1].end
            after = next((k for k, run in enumerate(left) if _touches(run, end, size)), None)
            if after is None:
                return None
            run = left.pop(after)
            on = run if _meet(run.start, end, size) else run.turned
            if on is None:
                return None
            loop.append(on)
        loops.append(loop)
    return loops


def _touches(run: _Run, x: Array, size: float) -> bool:
    return _meet(run.start, x, size) or _meet(run.end, x, size)


def _meet(a: Array, b: Array, size: float) -> bool:
    return bool(np.linalg.norm(a - b) <= JOINED * size)


def _in_plane(shape: Shape, pose: Pose, radius: float) -> list[str]:
    """The names of the edges and vertices that lie in the plane z = 0 of a frame."""
    return [
        feature.name
        for feature in features_of(shape).features
        if feature.dimension < 2 and (np.abs(to_inner(pose, _places(feature))[:, 2]) <= LEVEL * radius).all()
    ]


def _places(feature: Feature) -> Array:
    """Points (n, 3) of an edge or vertex."""
    if not is_curve(feature.shape):
        return to_outer(feature.shape.pose, np.array([[value for _, value in feature.shape.parameters]]))
    return _Run(feature.shape, range_of(feature)).samples
