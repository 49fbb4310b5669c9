"""Random extremal pairs by construction: choose both points and the gap, then pose the bodies to fit."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from math import isfinite
from typing import Any

import casadi as ca
import numpy as np
from scipy.optimize import least_squares

from modelgen.contact.form_table import eta_layout
from modelgen.geometry.curves import curve_of, is_curve
from modelgen.geometry.points import is_point
from modelgen.geometry.surface_catalogue import surface_of
from modelgen.model import ContactKind, ShapeKind, Side
from modelgen.verification.contact_sides import Feature, feature_of

Array = np.ndarray[Any, Any]
GAPS = (0.3, 0.0, -0.15)  # of the size of the shapes, times a random number from 0.2 to 1
TRIES = 12  # of a pair that no rotation can pose


@dataclass(frozen=True)
class Partnership:
    """A kind of contact with the numbers of its shapes: what configurations are drawn of."""

    kind: ContactKind
    parameters: Array  # (n,) as the kernels take them
    o: Feature
    f: Feature
    numbers: tuple[Array, Array]  # lengths of both shapes
    placements: tuple[Array, Array]  # (12,) each, of the shapes in their bodies
    length: float  # m

    @property
    def sides(self) -> tuple[Side, Side]:
        return self.kind.o, self.kind.f


def partnership(kind: ContactKind, parameters: tuple[float, ...], length: float) -> Partnership:
    """Splits a feature pair's parameters into lengths and placements; `length` is that of the scene, m."""
    rest = list(parameters)
    numbers, placements = [], []
    for side in (kind.o, kind.f):
        folded = side.shape.folded
        size = 0 if folded is not None else len(side.shape.parameter_names)
        numbers.append(np.array(folded if folded is not None else rest[:size], dtype=float))
        rest = rest[size:]
        placed = 12 if side.placement == "general" else 0
        placements.append(np.array(rest[:placed] or (*(0.0,) * 3, *np.eye(3).ravel())))
        rest = rest[placed:]
    reach = _reach(kind, numbers, length)
    o, f = (feature_of(side.shape, reach) for side in (kind.o, kind.f))
    return Partnership(
        kind, np.array(parameters, dtype=float), o, f, (numbers[0], numbers[1]),
        (placements[0], placements[1]), reach,
    )  # fmt: skip


def _reach(kind: ContactKind, numbers: list[Array], length: float) -> float:
    """Size of the smaller shape, m; of a ball in a cavity, how far it can go from the middle."""
    shapes = kind.o.shape, kind.f.shape
    sizes = [_size(shape, own, length) for shape, own in zip(shapes, numbers, strict=True)]
    inside = all(shape.kind == "sphere" for shape in shapes) and shapes[0].cavity != shapes[1].cavity
    return min(*sizes, abs(sizes[0] - sizes[1])) if inside else min(sizes)


def _size(shape: ShapeKind, numbers: Array, length: float) -> float:
    if is_point(shape):
        return length
    known = (curve_of if is_curve(shape) else surface_of)(shape)
    radius = float(known.bounding(numbers.tolist()))
    return radius if isfinite(radius) else length


@dataclass(frozen=True)
class Configurations:
    """n extremal pairs; every array has one column per configuration."""

    alpha: Array  # (k,n) coordinates of o, then of f
    pose_o: Array  # (12,n)
    pose_f: Array
    twist_o: Array  # (6,n) world linear, body angular
    twist_f: Array
    accel_o: Array  # (6,n)
    accel_f: Array
    d: Array  # (n,) m
    sign: Array  # (n,) of N against the cross product of two curves' tangents; 1 otherwise

    @property
    def n(self) -> int:
        return len(self.d)


def draw(at: Partnership, n: int, seed: int) -> Configurations:
    """Configurations with gaps apart, touching and overlapping in turn; the bodies move and accelerate."""
    random = np.random.default_rng(seed)
    drawn = [_configuration(at, random, GAPS[k % len(GAPS)]) for k in range(n)]
    alpha, pose_o, pose_f, d, sign = (np.array(column).T for column in zip(*drawn, strict=True))
    o, f, o_too, f_too = (_motions(side, random, n, at.length) for _ in range(2) for side in at.sides)
    return Configurations(alpha.reshape(-1, n), pose_o, pose_f, o, f, o_too, f_too, d.ravel(), sign.ravel())


def _motions(side: Side, random: np.random.Generator, n: int, length: float) -> Array:
    """(6,n): nothing of a fixed body, no turning of a point."""
    motion = random.normal(size=(6, n))
    motion[:3] *= 0.0 if side.motion == "fixed" else length
    motion[3:] *= 0.0 if side.motion in ("fixed", "point") else 1.0
    return motion


@dataclass(frozen=True)
class _Local:
    """A point of a shape in the axes of its body: x, and the normal or the tangent."""

    x: Array
    axis: Array  # exterior unit normal, unit tangent, or nothing


@cache
def _local_function(feature: Feature) -> ca.Function:
    alpha, p = ca.SX.sym("alpha", feature.dimension), ca.SX.sym("p", len(feature.shape.parameter_names))
    x = feature.point(alpha, p)
    tangents = ca.jacobian(x, alpha)
    axis = ca.SX(0, 1)
    if feature.dimension == 2:
        axis = feature.normal(tangents)
    if feature.dimension == 1:
        axis = tangents / ca.norm_2(tangents)
    return ca.Function("local", [alpha, p], [ca.densify(x), ca.densify(axis)])


def _local(feature: Feature, alpha: Array, numbers: Array, placement: Array) -> _Local:
    x, axis = (np.asarray(entry).ravel() for entry in _local_function(feature)(alpha, numbers))
    R = placement[3:].reshape(3, 3, order="F")
    return _Local(placement[:3] + R @ x, R @ axis if axis.size else axis)


def _coordinates(feature: Feature, random: np.random.Generator) -> Array:
    return np.array([random.uniform(*ends) for ends in feature.ranges])


def _turns(side: Side, parametrisation: str) -> bool:
    """Whether the axes of a body are free to choose; a point has none that its sphere could show."""
    return side.pose == "general" and not (side.motion == "point" and parametrisation == "chart")


def _configuration(at: Partnership, random: np.random.Generator, gap: float) -> tuple[Any, ...]:
    """alpha, both poses, d and the sign of N."""
    o, f = at.sides
    turns_o, turns_f = map(_turns, at.sides, eta_layout(at.kind))
    alpha_o, alpha_f = _coordinates(at.o, random), _coordinates(at.f, random)
    if not turns_o and not turns_f:
        alpha_f = _facing(at, alpha_o, alpha_f, random)
    one = _local(at.o, alpha_o, at.numbers[0], at.placements[0])
    two = _local(at.f, alpha_f, at.numbers[1], at.placements[1])
    if turns_f:
        R_o = _rotation(random) if turns_o else np.eye(3)
        N = R_o @ one.axis if at.o.dimension == 2 else _across(R_o @ one.axis, random)
        R_f = _posed(two.axis, at.f.dimension, -N, random)
    else:
        R_f = np.eye(3)
        N = -two.axis if at.f.dimension == 2 else _normal_to(two.axis, random)
        R_o = _posed(one.axis, at.o.dimension, N, random) if turns_o else np.eye(3)
        N = R_o @ one.axis if at.o.dimension == 2 else N
    d = gap * random.uniform(0.2, 1.0) * at.length
    d = abs(d) + 0.1 * at.length if at.o.dimension + at.f.dimension == 1 else d
    between = R_o @ one.x + d * N - R_f @ two.x
    p_o = np.zeros(3) if o.pose == "identity" else at.length * random.normal(size=3)
    p_o, p_f = (-between, np.zeros(3)) if f.pose == "identity" else (p_o, p_o + between)
    sign = 1.0
    if at.o.dimension == at.f.dimension == 1:
        sign = float(np.sign(N @ np.cross(R_o @ one.axis, R_f @ two.axis)))
    return np.concatenate([alpha_o, alpha_f]), _pose(p_o, R_o), _pose(p_f, R_f), [d], [sign]


def _facing(at: Partnership, alpha_o: Array, start: Array, random: np.random.Generator) -> Array:
    """Coordinates of f where its normal is opposite to that of o, or its tangent across it; none turns."""
    N = _local(at.o, alpha_o, at.numbers[0], at.placements[0]).axis
    if at.f.dimension == 0 or at.o.dimension != 2:
        return start

    def residual(alpha: Array) -> Array:
        axis = _local(at.f, alpha, at.numbers[1], at.placements[1]).axis
        return axis + N if at.f.dimension == 2 else np.array([axis @ N])

    for _ in range(TRIES):
        found = least_squares(residual, start, xtol=1e-15, ftol=1e-15, gtol=1e-15)
        if np.abs(found.fun).max() < 1e-14:
            break
        start = _coordinates(at.f, random)
    return np.asarray(found.x)


def _posed(axis: Array, dimension: int, normal: Array, random: np.random.Generator) -> Array:
    """A rotation that turns a surface's normal into `normal`, a curve's tangent across it."""
    if dimension == 0:
        return _rotation(random)
    return taking(axis, normal if dimension == 2 else _across(normal, random), random)


def _normal_to(tangent: Array, random: np.random.Generator) -> Array:
    return _across(tangent, random) if tangent.size else _unit(random.normal(size=3))


def _unit(x: Array) -> Array:
    return np.asarray(x / np.linalg.norm(x))


def _across(axis: Array, random: np.random.Generator) -> Array:
    other = random.normal(size=3)
    return _unit(other - axis * (axis @ other))


def _rotation(random: np.random.Generator) -> Array:
    return taking(_unit(random.normal(size=3)), _unit(random.normal(size=3)), random)


def taking(a: Array, b: Array, random: np.random.Generator) -> Array:
    """R with R a = b for unit vectors, and a random turn about b."""
    one, two = (
        np.array([x, y, np.cross(x, y)]).T for x, y in ((a, _across(a, random)), (b, _across(b, random)))
    )
    return np.asarray(two @ one.T)


def _pose(p: Array, R: Array) -> Array:
    return np.concatenate([p, R.T.ravel()])


def local_axes(feature: Feature, alpha: Array, numbers: Array, placement: Array) -> tuple[Array, Array]:
    """Points (n,3) and axes (n,3,3) in body axes: the first tangent, and last the exterior normal of a
    surface, or of a curve a direction across it; any axes of a point."""
    n = alpha.shape[1]
    lengths = np.tile(numbers.reshape(-1, 1), (1, n))
    x, first, last = (np.asarray(out).T for out in _axes_function(feature).map(n).call([alpha, lengths]))
    y = np.cross(last, first)
    R = placement[3:].reshape(3, 3, order="F")
    axes = np.stack([first, y, np.cross(first, y)], axis=2)
    return placement[:3] + x @ R.T, R @ axes


@cache
def _axes_function(feature: Feature) -> ca.Function:
    alpha, p = ca.SX.sym("alpha", feature.dimension), ca.SX.sym("p", len(feature.shape.parameter_names))
    x = ca.densify(feature.point(alpha, p))
    if not feature.dimension:
        return ca.Function("axes", [alpha, p], [x, ca.DM([1, 0, 0]), ca.DM([0, 0, 1])])
    tangents = ca.densify(ca.jacobian(x, alpha))
    first = tangents[:, 0] / ca.norm_2(tangents[:, 0])
    if feature.dimension == 2:
        return ca.Function("axes", [alpha, p], [x, first, ca.densify(feature.normal(tangents))])
    across = ca.cross(first, ca.DM([0.48, 0.6, 0.64]))
    return ca.Function("axes", [alpha, p], [x, first, across / ca.norm_2(across)])
