"""Specimens of every kind of shape, their numbers by decades, for the law of the first touch.

Each has a lower bound of the distance outside with an exact sign, and points of what can touch first:
curved faces, edges, corners. A flat face touches at an edge or a corner, or is touched by what the other
shape lists.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
from scipy.interpolate import BSpline, CubicSpline, RectBivariateSpline

from modelgen.scene import python_scenes as make
from modelgen.scene.scene_format import SHAPE_KINDS
from modelgen.scene.scene_types import Shape
from tests.benchmarks.measured_outlines import curve_distance
from tests.benchmarks.measured_solids import (
    TURN,
    Solid,
    cam,
    ellipsoid,
    hull,
    star,
    torus,
    tube,
    turned,
    unit,
)
from tests.scene.test_solids import tables_of

Array = np.ndarray[Any, Any]
Face = Callable[[Array, Array], Array]
Edge = Callable[[Array], Array]
INNER = 0.97  # of a shape with open edges, where it may be touched
TURNS = 40  # of a helix that are seen on each side, at most
WALL = 8.0  # half the length of a wall, against the size of its profile
SHEET = 1e-11  # half the thickness, against its size, by which a curve is given an inside
FLAT = 1e-13  # the same of a disc, which rays need not find


@dataclass(frozen=True)
class Endless:
    """A shape without a bound; it is seen within a ball of that radius about its origin, m."""

    of: Callable[[float], Solid]


def seen(shape: Solid | Endless, within: float) -> Solid:
    """The solid; of one without bound, what is within that radius, m."""
    return shape.of(within) if isinstance(shape, Endless) else shape


def decades(rng: np.random.Generator, low: float, high: float) -> float:
    """A random number between 10^low and 10^high, by decades."""
    return float(10 ** rng.uniform(low, high))


def _stack(*columns: Any) -> Array:
    return np.stack(np.broadcast_arrays(*columns), axis=-1)


def ring(r: float, z: float = 0.0, sweep: float = TURN) -> Edge:
    return lambda t: _stack(r * np.cos(sweep * t), r * np.sin(sweep * t), z)


def line(a: Sequence[float], b: Sequence[float]) -> Edge:
    start, along = np.array(a, float), np.array(b, float) - np.array(a, float)
    return lambda t: start + np.asarray(t)[..., None] * along


def conical(bottom: tuple[float, float], top: tuple[float, float]) -> Face:
    """The side between two circles, each (radius, z)."""

    def face(u: Array, v: Array) -> Array:
        r, z = (low + u * (high - low) for low, high in zip(bottom, top, strict=True))
        return _stack(r * np.cos(TURN * v), r * np.sin(TURN * v), z)

    return face


def ball_part(r: float, z: float, low: float, high: float) -> Face:
    """Of a ball about (0, 0, z) what lies between two angles to the axis."""

    def face(u: Array, v: Array) -> Array:
        t = low + u * (high - low)
        return _stack(r * np.sin(t) * np.cos(TURN * v), r * np.sin(t) * np.sin(TURN * v), z + r * np.cos(t))

    return face


def sized(
    s: float, shape: Shape, radius: float, distance: Callable[[Array], Array], faces: Sequence[Face] = (),
    edges: Sequence[Edge] = (), cavity: bool = False, inner: float = 0.0,
) -> Solid:  # fmt: skip
    """The solid of a shape whose geometry is given in units of s."""
    return Solid(
        shape, s * radius, lambda x: s * distance(x / s),
        [_scaled(s, face) for face in faces], [_scaled(s, edge) for edge in edges], cavity, s * inner,
    )  # fmt: skip


def _scaled(s: float, at: Callable[..., Array]) -> Callable[..., Array]:
    def scaled(*coordinates: Array) -> Array:
        return s * at(*coordinates)

    return scaled


def _radial(x: Array) -> Array:
    return np.hypot(x[..., 0], x[..., 1])


def sphere(rng: np.random.Generator, s: float, cavity: bool = False) -> Solid:
    def distance(x: Array) -> Array:
        found: Array = np.linalg.norm(x, axis=-1) - 1
        return -found if cavity else found

    shape = make.sphere(s, cavity=cavity)
    return sized(s, shape, 1.0, distance, [ball_part(1.0, 0.0, 0.0, np.pi)], cavity=cavity, inner=1.0)


def oblong(rng: np.random.Generator, s: float) -> Solid:
    axes = [1.0, decades(rng, -2, 0), decades(rng, -2, 0)]
    return ellipsoid(*(s * axes[k] for k in rng.permutation(3)))


def hollow_ellipsoid(rng: np.random.Generator, s: float) -> Solid:
    a, b, c = rng.uniform(0.4, 1, 3)
    solid = ellipsoid(a, b, c)
    least = min(a, b, c)

    def distance(x: Array) -> Array:
        found: Array = (1 - np.linalg.norm(x / np.array([a, b, c]), axis=-1)) * least
        return found

    shape = make.ellipsoid(s * a, s * b, s * c, cavity=True)
    return sized(s, shape, 1.0, distance, solid.faces, cavity=True, inner=least)


def superellipsoid(rng: np.random.Generator, s: float) -> Solid:
    a, b, c = (decades(rng, -1, 0) for _ in range(3))
    p, q = (2 * decades(rng, 0, 0.7) for _ in range(2))

    def gauge(x: Array) -> tuple[Array, Array]:
        """Convex, homogeneous of degree 1; with its gradient."""
        scaled = np.abs(x) / [a, b, c]
        across = np.linalg.norm(scaled[..., :2], ord=p, axis=-1)
        level = np.maximum((across**q + scaled[..., 2] ** q) ** (1 / q), 1e-300)
        slope_across = (across / level) ** (q - 1)
        part = scaled[..., :2] / np.maximum(across, 1e-300)[..., None]
        slope = np.concatenate(
            [slope_across[..., None] * part ** (p - 1), ((scaled[..., 2] / level) ** (q - 1))[..., None]],
            axis=-1,
        ) / [a, b, c]
        return level, np.linalg.norm(slope, axis=-1)

    def distance(x: Array) -> Array:
        level, slope = gauge(x)
        return (level - 1) / np.maximum(slope, 1e-300)

    def face(u: Array, v: Array) -> Array:
        t, turn = np.pi * u, TURN * v
        x = _stack(a * np.sin(t) * np.cos(turn), b * np.sin(t) * np.sin(turn), c * np.cos(t))
        return x / gauge(x)[0][..., None]

    shape = make.superellipsoid(s * a, s * b, s * c, p, q)
    return sized(s, shape, float(np.hypot(np.hypot(a, b), c)), distance, [face])


def rings(rng: np.random.Generator, s: float) -> Solid:
    return torus(s, s * decades(rng, -3, -0.02))


def box(rng: np.random.Generator, s: float, cavity: bool = False) -> Solid:
    half = np.array([decades(rng, -0.4 if cavity else -3, 0) for _ in range(3)])
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * half
    edges = [
        line(corners[i], corners[j])
        for i in range(8)
        for j in range(i)
        if (corners[i] != corners[j]).sum() == 1
    ]

    def distance(x: Array) -> Array:
        out = np.abs(x) - half
        deep: Array = out.max(axis=-1)
        return -deep if cavity else np.linalg.norm(np.maximum(out, 0), axis=-1) + np.minimum(deep, 0)

    shape = make.box(*map(float, 2 * s * half), cavity=cavity)
    return sized(s, shape, float(np.linalg.norm(half)), distance, [], edges, cavity, float(half.min()))


def capsule(rng: np.random.Generator, s: float, cavity: bool = False) -> Solid:
    radius, length = 1.0, decades(rng, -1 if cavity else -3, 0.5 if cavity else 3)
    half = length / 2

    def distance(x: Array) -> Array:
        z = x[..., 2] - np.clip(x[..., 2], -half, half)
        found: Array = np.hypot(_radial(x), z) - radius
        return -found if cavity else found

    caps = [ball_part(radius, half, 0, np.pi / 2), ball_part(radius, -half, np.pi / 2, np.pi)]
    faces = [conical((radius, -half), (radius, half)), *caps]
    shape = make.capsule(s * radius, s * length, cavity=cavity)
    return sized(s, shape, radius + half, distance, faces, cavity=cavity, inner=radius)


def can(rng: np.random.Generator, s: float) -> Solid:
    return tube(s, 0.0, s * decades(rng, -3, 3))


def pipe(rng: np.random.Generator, s: float) -> Solid:
    return tube(s, s * (1 - decades(rng, -3, -0.05)), s * decades(rng, -3, 2))


def frustum(rng: np.random.Generator, s: float, cavity: bool = False) -> Solid:
    length, slope = decades(rng, -1 if cavity else -3, 0.5 if cavity else 2), decades(rng, -2.9, 0.7)
    slope = min(slope, 0.9 * 2 / length) if not cavity else min(slope, 0.5 / length)
    slope = max(slope, 1.2e-3)
    half, middle = length / 2, 1.0
    if half * slope >= 1:
        length, half, slope = 20.0, 10.0, 0.05
    ends = middle + half * slope, middle - half * slope
    if rng.integers(2):
        ends, slope = ends[::-1], -slope
    steep = 1 / np.hypot(1, slope)

    def distance(x: Array) -> Array:
        side = (_radial(x) - (middle - slope * x[..., 2])) * steep
        found: Array = np.maximum(side, np.abs(x[..., 2]) - half)
        return -found if cavity else found

    edges = [] if cavity else [ring(ends[0], -half), ring(ends[1], half)]
    faces = [conical((ends[0], -half), (ends[1], half))]
    shape = make.frustum(float(s * ends[0]), float(s * ends[1]), s * length, cavity=cavity)
    inner = min(half, float(steep))
    return sized(s, shape, float(np.hypot(max(ends), half)), distance, faces, edges, cavity, inner)


def dome(rng: np.random.Generator, s: float) -> Solid:
    radius, length = 1.0, decades(rng, -2.9, 0)
    if rng.integers(2):
        length = 2 - length
    depth, rim = radius - length, float(np.sqrt(length * (2 - length)))

    def distance(x: Array) -> Array:
        ball = np.linalg.norm(x + np.array([0, 0, depth]), axis=-1) - radius
        found: Array = np.maximum(ball, -x[..., 2])
        return found

    faces = [ball_part(radius, -depth, 0.0, float(np.arccos(depth / radius)))]
    return sized(s, make.dome(s * radius, s * length), max(length, rim), distance, faces, [ring(rim)])


def half_torus(rng: np.random.Generator, s: float) -> Solid:
    minor = decades(rng, -2.5, -0.02)

    def distance(x: Array) -> Array:
        found: Array = np.maximum(np.hypot(_radial(x) - 1, x[..., 2]) - minor, -x[..., 1])
        return found

    def face(u: Array, v: Array) -> Array:
        r = 1 + minor * np.cos(TURN * v)
        return _stack(r * np.cos(np.pi * u), r * np.sin(np.pi * u), minor * np.sin(TURN * v))

    def rim(at: float) -> Edge:
        return lambda t: _stack(at + minor * np.cos(TURN * t), 0.0, minor * np.sin(TURN * t))

    return sized(s, make.half_torus(s, s * minor), 1 + minor, distance, [face], [rim(-1.0), rim(1.0)])


def polyhedron(rng: np.random.Generator, s: float) -> Solid:
    return hull(rng, s)


def flat_hull(rng: np.random.Generator, s: float) -> Solid:
    """A hexagonal plate, its thickness by decades."""
    half = decades(rng, -3, 0)
    angle = TURN * np.arange(6) / 6
    flat = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    corners = np.array([[x, y, z] for z in (-half, half) for x, y in flat])
    edges = [line(corners[k], corners[k + 6]) for k in range(6)]
    edges += [line(corners[b + k], corners[b + (k + 1) % 6]) for b in (0, 6) for k in range(6)]
    normals = np.stack([np.cos(angle + np.pi / 6), np.sin(angle + np.pi / 6)], axis=1)

    def distance(x: Array) -> Array:
        across = (x[..., :2] @ normals.T).max(axis=-1) - np.sqrt(0.75)
        found: Array = np.maximum(across, np.abs(x[..., 2]) - half)
        return found

    shape = make.polyhedron([[float(s * c) for c in each] for each in corners])
    return sized(s, shape, float(np.hypot(1, half)), distance, [], edges)


def stars(rng: np.random.Generator, s: float) -> Solid:
    return star(4, s, s * decades(rng, -1, -0.2), s * decades(rng, -2, 1))


def cams(rng: np.random.Generator, s: float) -> Solid:
    return cam([*map(float, s * rng.uniform(0.6, 1, 7))], s * decades(rng, -2, 1))


def vase(rng: np.random.Generator, s: float) -> Solid:
    return turned(s, s * decades(rng, -1, 0.5), rng.uniform(0.1, 0.5), rng.uniform(-0.05, 0.05))


def disc(rng: np.random.Generator, s: float) -> Solid:
    def distance(x: Array) -> Array:
        found: Array = np.hypot(np.maximum(_radial(x) - 1, 0), x[..., 2]) - FLAT
        return found

    return sized(s, make.disc(s), 1.0, distance, [], [ring(1.0)])


def egg(rng: np.random.Generator, s: float) -> Solid:
    """A chart of the user's own: an ellipsoid that is thicker at one end."""
    a, k = decades(rng, -1, 0.5), float(rng.uniform(0.1, 0.4))

    def distance(x: Array) -> Array:
        """From the cylinder that contains it, or by the largest slope within that."""
        r, z = np.minimum(_radial(x), 1.2 * a), np.clip(x[..., 2], -1, 1)
        level = r**2 - a * a * (1 + k * z) * (1 - z**2)
        beyond, level = np.hypot(_radial(x) - r, x[..., 2] - z), level / (2.4 * a + 3.2 * a * a)
        found: Array = np.where(beyond > 0, np.maximum(beyond, level), level)
        return found

    def face(u: Array, v: Array) -> Array:
        t, turn = np.pi * (u - 0.5), TURN * v
        r = a * np.cos(t) * np.sqrt(1 + k * np.sin(t))
        return _stack(r * np.cos(turn), r * np.sin(turn), np.sin(t))

    shape = make.chart(
        "s*a*cos(v)*sqrt(1 + k*sin(v))*cos(u)", "s*a*cos(v)*sqrt(1 + k*sin(v))*sin(u)", "s*sin(v)",
        domain=[[0.0, TURN], [-np.pi / 2, np.pi / 2]], periodic=[True, False], poles=["v_min", "v_max"],
        parameters={"s": s, "a": a, "k": k},
    )  # fmt: skip
    return sized(s, shape, float(np.hypot(1.2 * a, 1)), distance, [face])


def _of_curve(s: float, shape: Shape, nearest: Callable[[Array], Array], *edges: Edge) -> Solid:
    """`nearest`: the distance of points from the curve."""
    return sized(s, shape, 1.0, lambda x: nearest(x) - SHEET, [], edges)


def apex(t: Array) -> Array:
    """The origin."""
    return _stack(0 * np.asarray(t), 0.0, 0.0)


def circle(rng: np.random.Generator, s: float) -> Solid:
    return _of_curve(s, make.circle(s), lambda x: np.hypot(_radial(x) - 1, x[..., 2]), ring(1.0))


def segment(rng: np.random.Generator, s: float) -> Solid:
    def nearest(x: Array) -> Array:
        found: Array = np.hypot(_radial(x), x[..., 2] - np.clip(x[..., 2], -1, 1))
        return found

    return _of_curve(s, make.segment(2 * s), nearest, line([0, 0, -1], [0, 0, 1]))


def oval(rng: np.random.Generator, s: float) -> Solid:
    """An elliptical wire; what falls on it is seen by its points alone."""
    b = decades(rng, -1.5, 0)
    edge: Edge = lambda t: _stack(np.cos(TURN * t), b * np.sin(TURN * t), 0.0)  # noqa: E731
    shape = make.shape("ellipse_curve", semi_axes=[s, s * b])
    return sized(s, shape, 1.0, lambda x: np.full(x.shape[:-1], np.inf), [], [edge])


def point(rng: np.random.Generator, s: float) -> Solid:
    return sized(s, make.point(), 0.0, lambda x: np.asarray(np.linalg.norm(x, axis=-1)), [], [apex])


def plane(rng: np.random.Generator, s: float) -> Endless:
    return Endless(lambda seen: Solid(make.plane(), np.inf, lambda x: x[..., 2]))


def rod(rng: np.random.Generator, s: float, cavity: bool = False) -> Endless:
    def of(seen: float) -> Solid:
        seen /= s

        def distance(x: Array) -> Array:
            return (_radial(x) - 1) * (-1 if cavity else 1)

        faces = [conical((1.0, -seen), (1.0, seen))]
        return sized(s, make.cylinder(s, cavity=cavity), np.inf, distance, faces, cavity=cavity, inner=1.0)

    return Endless(of)


def cone(rng: np.random.Generator, s: float) -> Endless:
    angle = float(np.clip(decades(rng, -2.9, 0.19), 1.1e-3, 1.5))

    def of(seen: float) -> Solid:
        seen /= s

        def distance(x: Array) -> Array:
            found: Array = _radial(x) * np.cos(angle) + x[..., 2] * np.sin(angle)
            return np.where(x[..., 2] > 0, np.maximum(found, x[..., 2]), found)

        along = seen * np.array([0.0, 1e-4, 1e-3, 1e-2, 0.1, 1.0])
        ends = [
            (float(r), float(-z)) for r, z in zip(along * np.sin(angle), along * np.cos(angle), strict=True)
        ]
        faces = [conical(one, two) for one, two in pairwise(ends)]
        return sized(s, make.cone(angle), np.inf, distance, faces, [apex])

    return Endless(of)


def paraboloid(rng: np.random.Generator, s: float) -> Endless:
    """Convex: with exterior +z, it opens downwards."""
    a, b = decades(rng, -1.5, 1.5), decades(rng, -1.5, 1.5)

    def of(seen: float) -> Solid:
        seen /= s

        def distance(x: Array) -> Array:
            level = x[..., 2] + x[..., 0] ** 2 / (2 * a) + x[..., 1] ** 2 / (2 * b)
            found: Array = level / np.sqrt(1 + (x[..., 0] / a) ** 2 + (x[..., 1] / b) ** 2)
            return found

        def face(u: Array, v: Array) -> Array:
            reach = np.minimum(seen, np.sqrt(2 * np.array([a, b]) * seen))
            x, y = reach[0] * (2 * u - 1), reach[1] * (2 * v - 1)
            return _stack(x, y, -(x**2) / (2 * a) - y**2 / (2 * b))

        return sized(s, make.paraboloid(-s * a, -s * b), np.inf, distance, [face])

    return Endless(of)


def wire_line(rng: np.random.Generator, s: float) -> Endless:
    def of(seen: float) -> Solid:
        z = seen * np.linspace(-8, 8, 33)
        pieces = [line([0, 0, a], [0, 0, b]) for a, b in pairwise(z)]
        return Solid(make.line(), np.inf, lambda x: _radial(x) - SHEET * s, [], pieces)

    return Endless(of)


def straight_edge(rng: np.random.Generator, s: float) -> Solid:
    def nearest(x: Array) -> Array:
        out = x[..., 0] - np.clip(x[..., 0], -1, 1)
        found: Array = np.linalg.norm(_stack(out, x[..., 1], x[..., 2]), axis=-1)
        return found

    return _of_curve(s, make.edge(2 * s), nearest, line([-1, 0, 0], [1, 0, 0]))


def _wire(s: float, shape: Shape, *edges: Edge, open_: bool = False) -> Solid:
    """A curve that is seen by its points alone; the ends of an open one touch nothing."""
    t = np.linspace(0, 1, 200)
    radius = max(float(np.linalg.norm(edge(t), axis=-1).max()) for edge in edges)
    solid = sized(s, shape, 1.01 * radius, lambda x: np.full(x.shape[:-1], np.inf), [], edges)
    ends = s * np.array([edges[0](np.zeros(1))[0], edges[-1](np.ones(1))[0]])
    within = lambda x: np.linalg.norm(x - ends, axis=1).min() > (1 - INNER) * s  # noqa: E731
    return replace(solid, extra={"within": within}) if open_ else solid


def helix(rng: np.random.Generator, s: float) -> Endless:
    lead = decades(rng, -0.3, 1.5) * float(rng.choice([-1, 1]))

    def turn(k: int) -> Edge:
        return lambda t: _stack(np.cos(TURN * t), np.sin(TURN * t), lead * (t + k))

    def of(seen: float) -> Solid:
        most = int(min(np.ceil(seen / s / abs(lead)), TURNS))
        shape, far = make.helix(s, s * lead), lambda x: np.full(x.shape[:-1], np.inf)
        solid = sized(s, shape, np.inf, far, [], [turn(k) for k in range(-most, most)])
        return replace(solid, extra={"along": np.array([0.0, 0, 1])})

    return Endless(of)


def knot(rng: np.random.Generator, s: float) -> Solid:
    """A curve of the user's own: closed, or a piece of it with two ends."""
    a, b, c = rng.uniform(0.2, 0.6), decades(rng, -1.5, 0), float(rng.uniform(-0.3, 0.3))
    closed = bool(rng.integers(2))
    end = TURN if closed else float(rng.uniform(2, 5))

    def edge(t: Array) -> Array:
        at = end * t
        return _stack(np.cos(at) + c * np.cos(2 * at), a * np.sin(at), b * np.sin(2 * at + 1))

    shape = make.curve(
        "s*(cos(t) + c*cos(2*t))", "s*a*sin(t)", "s*b*sin(2*t + 1)",
        domain=[0.0, end], periodic=closed, parameters={"s": s, "a": a, "b": b, "c": c},
    )  # fmt: skip
    return _wire(s, shape, edge, open_=not closed)


def spline_wire(rng: np.random.Generator, s: float) -> Solid:
    """A cubic B-spline, closed or open."""
    points, closed = rng.uniform(-0.7, 0.7, (7, 3)) * [1, 1, decades(rng, -2, 0)], bool(rng.integers(2))
    if closed:
        around = np.stack([np.cos(TURN * np.arange(7) / 7), np.sin(TURN * np.arange(7) / 7)], axis=1)
        points[:, :2] = around * rng.uniform(0.6, 1, (7, 1))
        spline = BSpline(np.arange(-3.0, 11.0), np.vstack([points, points[:3]]), 3)
        edge: Edge = lambda t: np.asarray(spline(7 * t))  # noqa: E731
    else:
        spline = BSpline(np.concatenate([[0.0] * 3, np.arange(5.0), [4.0] * 3]), points, 3)
        edge = lambda t: np.asarray(spline(4 * t))  # noqa: E731
    rows = [[float(s * c) for c in each] for each in points]
    return _wire(s, make.bspline_curve(rows, periodic=closed), edge, open_=not closed)


def bent_wire(rng: np.random.Generator, s: float) -> Solid:
    """Straight pieces with rounded corners."""
    steps = unit(rng.normal(size=(4, 3)))
    for k in range(1, 4):  # no turn beyond 100 degrees or so
        if steps[k] @ steps[k - 1] < -0.2:
            steps[k] *= -1
    points = np.vstack([np.zeros(3), np.cumsum(steps * rng.uniform(0.5, 1, (4, 1)), axis=0)])
    points -= points.mean(axis=0)
    points /= np.linalg.norm(points, axis=1).max()
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    tangents = np.diff(points, axis=0) / lengths[:, None]
    half = np.arccos(np.clip((tangents[1:] * tangents[:-1]).sum(axis=1), -1, 1)) / 2
    radius = 0.4 * float(lengths.min() / np.tan(half).max()) * decades(rng, -2, 0)
    cut = np.concatenate([[0.0], radius * np.tan(half), [0.0]])
    edges = [
        line(points[k] + cut[k] * tangents[k], points[k + 1] - cut[k + 1] * tangents[k]) for k in range(4)
    ]

    def arc(k: int) -> Edge:
        a, b = tangents[k], tangents[k + 1]
        across = unit(b - (a @ b) * a)
        start = points[k + 1] - cut[k + 1] * a

        def at(t: Array) -> Array:
            angle = np.asarray(2 * half[k] * np.asarray(t))[..., None]
            found: Array = start + radius * (np.sin(angle) * a + (1 - np.cos(angle)) * across)
            return found

        return at

    rows = [[float(s * c) for c in each] for each in points]
    pieces = [edges[0], *[each for k in range(3) for each in (arc(k), edges[k + 1])]]
    return _wire(s, make.polyline(rows, s * radius), *pieces, open_=True)


def parameter_line(rng: np.random.Generator, s: float) -> Solid:
    """A line of a chart, with two ends."""
    a, v = float(rng.uniform(-0.5, 0.5)), float(rng.uniform(-0.6, 0.6))

    def edge(t: Array) -> Array:
        u = 2 * np.asarray(t) - 1
        return _stack(0.8 * u, v + 0.1 * u**2, a * (u**2 - v) + 0.1 * np.sin(3 * u))

    surface = {
        "kind": "chart", "x": "s*0.8*u", "y": "s*(v + 0.1*u**2)", "z": "s*(a*(u**2 - v) + 0.1*sin(3*u))",
        "domain": [[-1.0, 1.0], [-1.0, 1.0]], "parameters": {"s": s, "a": a},
    }  # fmt: skip
    return _wire(s, make.surface_line(surface, v=v), edge, open_=True)


def _segment_of_disc(rng: np.random.Generator, s: float) -> tuple[list[dict[str, object]], float]:
    """Pieces of a disc that is cut straight, and half the angle of its arc."""
    half = float(rng.uniform(0.5, 2.6))
    return [{"kind": "arc", "radius": s, "angles": [-half, half]}, {"kind": "line"}], half


def plate_outline(rng: np.random.Generator, s: float) -> Solid:
    pieces, half = _segment_of_disc(rng, s)
    x, y = np.cos(half), np.sin(half)
    arc: Edge = lambda t: _stack(np.cos(half * (2 * t - 1)), np.sin(half * (2 * t - 1)), 0.0)  # noqa: E731

    def outward(at: Array) -> Array:
        on_arc = np.hypot(at[0], at[1]) > s * (1 - 1e-9)
        return np.array([at[0], at[1], 0.0]) if on_arc else np.array([-1.0, 0, 0])

    solid = _wire(s, make.outline(pieces), arc, line([x, y, 0], [x, -y, 0]))
    return replace(solid, extra={"along": np.array([0.0, 0, 1]), "outward": outward})


def wall(rng: np.random.Generator, s: float) -> Solid:
    """The sides of a disc that is cut straight, without its ends."""
    pieces, half = _segment_of_disc(rng, s)
    x, y, long = np.cos(half), np.sin(half), WALL

    def distance(at: Array) -> Array:
        found: Array = np.maximum(_radial(at) - 1, x - at[..., 0])
        return np.maximum(found, np.abs(at[..., 2]) - long)

    def side(u: Array, v: Array) -> Array:
        return _stack(np.cos(half * (2 * u - 1)), np.sin(half * (2 * u - 1)), long * (2 * v - 1))

    edges = [line([x, at, -long], [x, at, long]) for at in (-y, y)]
    shape = make.outline_wall(pieces, float(2 * long * s))
    solid = sized(s, shape, float(np.hypot(1, long)), distance, [side], edges)
    within = lambda x: np.abs(x[2]) < INNER * long * s  # noqa: E731
    return replace(solid, extra={"along": np.array([0.0, 0, 1]), "within": within})


def _sheet(s: float, shape: Shape, height: Callable[[Array, Array], Array], slope: float) -> Solid:
    """A surface over [-1, 1]^2 with its exterior above, of at most this slope."""

    def distance(x: Array) -> Array:
        beyond = np.maximum(np.abs(x[..., 0]), np.abs(x[..., 1])) - 1
        above = x[..., 2] - height(np.clip(x[..., 0], -1, 1), np.clip(x[..., 1], -1, 1))
        found: Array = np.maximum(above / np.hypot(1, slope), beyond)
        return np.where(above < -1, 1.0, found)

    def face(u: Array, v: Array) -> Array:
        x, y = 2 * u - 1, 2 * v - 1
        return _stack(x, y, height(x, y))

    solid = sized(s, shape, 1.8, distance, [face])
    within = lambda x: np.abs(x[:2]).max() < INNER * s  # noqa: E731
    return replace(solid, extra={"up": np.array([0.0, 0, 1]), "within": within})


def _bump(rng: np.random.Generator) -> Callable[[Array, Array], Array]:
    a, b, c = rng.uniform(0.2, 0.5, 2), rng.uniform(0.0, 0.02), rng.uniform(0, TURN, 2)
    return lambda x, y: -a[0] * x**2 - a[1] * y**2 + b * np.cos(4 * x + c[0]) * np.cos(4 * y + c[1])


def terrain(rng: np.random.Generator, s: float) -> Solid:
    """A bump, as the spline through its heights on a grid."""
    bump, grid = _bump(rng), np.linspace(-1, 1, 9)
    heights = bump(*np.meshgrid(grid, grid, indexing="ij"))
    spline = RectBivariateSpline(grid, grid, heights, kx=3, ky=3, s=0)
    at = [float(s * x) for x in grid]
    shape = make.height_field(at, at, [[float(s * h) for h in row] for row in heights])
    return _sheet(s, shape, lambda x, y: np.asarray(spline.ev(x, y)), 1.6)


def patch(rng: np.random.Generator, s: float) -> Solid:
    """A bump as a B-spline surface whose control points stand above the means of their knots."""
    bump, knots = _bump(rng), np.concatenate([[-1.0] * 3, np.linspace(-1, 1, 5), [1.0] * 3])
    means = np.array([knots[k + 1 : k + 4].mean() for k in range(7)])
    net = bump(*np.meshgrid(means, means, indexing="ij"))
    spline = RectBivariateSpline._from_tck((knots, knots, net.ravel(), 3, 3))
    points = [
        [[float(s * x), float(s * y), float(s * net[i, j])] for j, y in enumerate(means)]
        for i, x in enumerate(means)
    ]
    return _sheet(s, make.bspline(points), lambda x, y: np.asarray(spline.ev(x, y)), 1.6)


def rail(rng: np.random.Generator, s: float) -> Solid:
    """A wall whose profile is a bump, by the spline through its points."""
    x = np.linspace(1, -1, 9)
    y = -rng.uniform(0.2, 0.5) * x**2 + 0.02 * np.cos(4 * x + rng.uniform(0, TURN))
    points = np.stack([x, y], axis=1)
    chords = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    profile, long = CubicSpline(chords / chords[-1], points), WALL
    flat = curve_distance(profile, profile.derivative(), np.linspace(0, 1, 2001))

    def distance(at: Array) -> Array:
        beyond = np.maximum(np.abs(at[..., 0]) - 1, np.abs(at[..., 2]) - long)
        inner = _stack(np.clip(at[..., 0], -1, 1), at[..., 1])
        return np.where(at[..., 1] < -2, 1.0, np.maximum(flat(inner), beyond))

    def face(u: Array, v: Array) -> Array:
        return _stack(*np.moveaxis(profile(u), -1, 0), long * (2 * v - 1))

    shape = make.profile_wall([[float(s * c) for c in each] for each in points], float(2 * long * s))
    solid = sized(s, shape, float(np.hypot(1.2, long)), distance, [face])
    within = lambda x: np.abs(x[[0, 2]] / [1, long]).max() < INNER * s  # noqa: E731
    return replace(solid, extra={"up": np.array([0.0, 1, 0]), "within": within})


def own(rng: np.random.Generator, s: float) -> Solid:
    """A solid of the catalogue, written as faces, edges and vertices of the user's own."""
    solid = (box, can, pipe, frustum, dome, half_torus, polyhedron, stars)[rng.integers(8)](rng, s)
    return replace(solid, shape=make.solid(**tables_of(solid.shape)))


def _hollowed(solid: Solid, shape: Shape, inner: float, **extra: Any) -> Solid:
    """The outside of a solid as material; a ball of radius `inner` is in the hollow."""
    return replace(
        solid, shape=shape, distance=lambda x: -solid.distance(x), edges=(), cavity=True, inner=inner,
        extra=extra,
    )  # fmt: skip


def hollow_superellipsoid(rng: np.random.Generator, s: float) -> Solid:
    solid = superellipsoid(rng, s)
    return _hollowed(solid, replace(solid.shape, cavity=True), min(v for _, v in solid.shape.parameters[:3]))


def hollow_torus(rng: np.random.Generator, s: float) -> Solid:
    minor = s * decades(rng, -1, -0.1)
    solid = torus(s, minor)
    return _hollowed(solid, replace(solid.shape, cavity=True), minor, centre=np.array([s, 0.0, 0.0]))


def hollow_polyhedron(rng: np.random.Generator, s: float) -> Solid:
    while True:
        solid = hull(rng, s)
        inner = float(-solid.distance(np.zeros((1, 3)))[0])
        if inner > 0.1 * s:
            return _hollowed(solid, replace(solid.shape, cavity=True), inner)


def hollow_revolution(rng: np.random.Generator, s: float) -> Solid:
    height, waist, ripple = s * decades(rng, -0.3, 0.5), rng.uniform(0.1, 0.5), rng.uniform(-0.05, 0.05)
    return turned(s, height, waist, ripple, cavity=True)


def hollow_egg(rng: np.random.Generator, s: float) -> Solid:
    solid = egg(rng, s)
    a = float(dict(solid.shape.parameters)["a"])
    return _hollowed(solid, replace(solid.shape, cavity=True), 0.5 * s * min(a, 1.0))


def bowl(rng: np.random.Generator, s: float) -> Endless:
    """A paraboloid that opens upwards, into which a body falls."""
    a, b = decades(rng, -1, 1), decades(rng, -1, 1)

    def of(seen: float) -> Solid:
        seen /= s

        def distance(x: Array) -> Array:
            level = x[..., 2] - x[..., 0] ** 2 / (2 * a) - x[..., 1] ** 2 / (2 * b)
            found: Array = level / np.sqrt(1 + (x[..., 0] / a) ** 2 + (x[..., 1] / b) ** 2)
            return found

        def face(u: Array, v: Array) -> Array:
            reach = np.minimum(seen, np.sqrt(2 * np.array([a, b]) * seen))
            x, y = reach[0] * (2 * u - 1), reach[1] * (2 * v - 1)
            return _stack(x, y, x**2 / (2 * a) + y**2 / (2 * b))

        solid = sized(s, make.paraboloid(s * a, s * b), np.inf, distance, [face])
        return replace(solid, extra={"up": np.array([0.0, 0, 1])})

    return Endless(of)


KINDS: dict[str, Callable[[np.random.Generator, float], Solid | Endless]] = {
    "sphere": sphere,
    "ellipsoid": oblong,
    "superellipsoid": superellipsoid,
    "torus": rings,
    "capsule": capsule,
    "cylinder": can,
    "tube": pipe,
    "frustum": frustum,
    "dome": dome,
    "half_torus": half_torus,
    "box": box,
    "polyhedron": polyhedron,
    "plate": flat_hull,
    "star": stars,
    "cam": cams,
    "revolution": vase,
    "chart": egg,
    "disc": disc,
    "circle": circle,
    "segment": segment,
    "ellipse_curve": oval,
    "point": point,
    "plane": plane,
    "endless cylinder": rod,
    "cone": cone,
    "paraboloid": paraboloid,
    "hollow sphere": lambda rng, s: sphere(rng, s, cavity=True),
    "hollow ellipsoid": hollow_ellipsoid,
    "hollow box": lambda rng, s: box(rng, s, cavity=True),
    "hollow capsule": lambda rng, s: capsule(rng, s, cavity=True),
    "hollow frustum": lambda rng, s: frustum(rng, s, cavity=True),
    "bore": lambda rng, s: rod(rng, s, cavity=True),
    "line": wire_line,
    "edge": straight_edge,
    "helix": helix,
    "curve": knot,
    "bspline_curve": spline_wire,
    "polyline": bent_wire,
    "surface_line": parameter_line,
    "outline": plate_outline,
    "outline_wall": wall,
    "profile_wall": rail,
    "height_field": terrain,
    "bspline": patch,
    "solid": own,
    "hollow superellipsoid": hollow_superellipsoid,
    "hollow torus": hollow_torus,
    "hollow polyhedron": hollow_polyhedron,
    "hollow revolution": hollow_revolution,
    "hollow egg": hollow_egg,
    "bowl": bowl,
}
CURVES = (
    "circle", "segment", "ellipse_curve", "point", "line", "edge", "helix", "curve", "bspline_curve",
    "polyline", "surface_line", "outline",
)  # fmt: skip
SHEETS = ("outline_wall", "profile_wall", "height_field", "bspline")  # with open edges
ENDLESS = ("plane", "endless cylinder", "cone", "paraboloid", "bore", "line", "helix", "bowl")
HOLLOW = tuple(name for name in KINDS if name.startswith("hollow") or name == "bore")
VARIANTS: dict[str, tuple[str, ...]] = {kind: (kind,) for kind in SHAPE_KINDS} | {
    "sphere": ("sphere", "hollow sphere"),
    "ellipsoid": ("ellipsoid", "hollow ellipsoid"),
    "superellipsoid": ("superellipsoid", "hollow superellipsoid"),
    "torus": ("torus", "hollow torus"),
    "cylinder": ("cylinder", "endless cylinder", "bore"),
    "paraboloid": ("paraboloid", "bowl"),
    "chart": ("chart", "hollow egg"),
    "revolution": ("revolution", "hollow revolution"),
    "box": ("box", "hollow box"),
    "capsule": ("capsule", "hollow capsule"),
    "frustum": ("frustum", "hollow frustum"),
    "polyhedron": ("polyhedron", "plate", "hollow polyhedron"),
    "extrusion": ("star", "cam"),
}
"""Each kind of the scene format with the specimens that stand for it."""
