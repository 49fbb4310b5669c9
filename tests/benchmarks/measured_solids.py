"""Solids with an independent signed distance and points of faces and edges, by which contacts are judged."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.spatial import ConvexHull

from modelgen.scene import python_scenes as make
from modelgen.scene.free_shapes import FREE_SHAPES
from modelgen.scene.scene_types import Shape
from modelgen.scene.shape_catalogue import SHAPES
from tests.benchmarks.measured_outlines import curve_distance, polygon_distance

Array = np.ndarray[Any, Any]
TURN = 2 * np.pi
FACE, EDGE = 48, 240  # parts of each coordinate of a face, of an edge
CURVES = {
    "curve",
    *(kind for kind, spec in SHAPES.items() if spec.curve),
    *(kind for kind, spec in FREE_SHAPES.items() if spec.curve),
}
KEPT = 12  # points of the grid that are refined


@dataclass(frozen=True)
class Solid:
    """A shape, points of its faces and edges as functions of [0, 1]^2 or [0, 1], and its signed distance."""

    shape: Shape
    size: float  # m, radius of a ball about the origin that contains it
    distance: Callable[[Array], Array]  # (n, 3) -> (n,): positive outside; its sign is exact
    faces: Sequence[Callable[[Array, Array], Array]] = ()
    edges: Sequence[Callable[[Array], Array]] = ()
    cavity: bool = False
    inner: float = 0.0  # m, radius of a ball about the origin in a hollow
    extra: dict[str, Any] = field(default_factory=dict)

    @property
    def is_curve(self) -> bool:
        return self.shape.kind in CURVES

    @cached_property
    def dense(self) -> list[Dense]:
        """Dense points of each face and edge."""
        u, v = (g.ravel() for g in np.meshgrid(*[(np.arange(FACE) + 0.5) / FACE] * 2, indexing="ij"))
        faces = [Dense(face, np.stack([u, v], axis=1), face(u, v), FACE) for face in self.faces]
        t = np.linspace(0, 1, EDGE + 1)
        return faces + [Dense(edge, t[:, None], edge(t), EDGE) for edge in self.edges]


@dataclass(frozen=True)
class Dense:
    """Points of a face or an edge on a grid of its coordinates in [0, 1]; the second may leave it."""

    at: Callable[..., Array]
    coordinates: Array  # (n, 1) or (n, 2)
    points: Array  # (n, 3) m
    parts: int  # of each coordinate

    @cached_property
    def spacing(self) -> float:
        """Largest distance of neighbours, m."""
        sizes = (self.parts,) * 2 if self.coordinates.shape[1] == 2 else (self.parts + 1,)
        grid = self.points.reshape(*sizes, 3)
        steps = [np.linalg.norm(np.diff(grid, axis=k), axis=-1).max() for k in range(len(sizes))]
        return float(np.hypot(*steps) if len(steps) == 2 else steps[0])

    def deepest(self, depth: Callable[[Array], Array], above: float) -> float:
        """Largest depth of the points, refined by a pattern search, m; of less than `above` any lower bound.

        No point is more than two spacings from one of the grid, and a depth changes by four times the
        distance at most.
        """
        deep = depth(self.points)
        if deep.max() + 8 * self.spacing < above:
            return float(deep.max())
        best = np.argsort(deep)[-KEPT:]
        at, step, dimension = (
            self.coordinates[best],
            np.full(len(best), 1 / self.parts),
            self.coordinates.shape[1],
        )
        offsets = np.stack(np.meshgrid(*[[-1, 0, 1]] * dimension, indexing="ij"), -1).reshape(-1, dimension)
        rows = np.arange(len(best))
        for _ in range(40):
            tries = at[:, None] + step[:, None, None] * offsets
            tries[..., 0] = np.clip(tries[..., 0], 0, 1)
            which = depth(self.at(*np.moveaxis(tries, -1, 0))).argmax(axis=1)
            at = tries[rows, which]
            step = np.where(which == len(offsets) // 2, step / 2, step)
        return float(depth(self.at(*at.T)).max())


def _stack(*columns: Any) -> Array:
    return np.stack(np.broadcast_arrays(*columns), axis=-1)


def ellipsoid(a: float, b: float, c: float, cavity: bool = False) -> Solid:
    axes, sign = np.array([a, b, c]), -1.0 if cavity else 1.0

    def distance(x: Array) -> Array:
        level = np.linalg.norm(x / axes, axis=-1)
        slope = np.linalg.norm(x / axes**2, axis=-1) / np.maximum(level, 1e-300)
        found: Array = sign * (level - 1) / np.maximum(slope, 1e-300)
        return found

    def face(u: Array, v: Array) -> Array:
        t, turn = np.pi * u, TURN * v
        return axes * _stack(np.sin(t) * np.cos(turn), np.sin(t) * np.sin(turn), np.cos(t))

    shape = make.ellipsoid(a, b, c, cavity=cavity)
    return Solid(shape, max(a, b, c), distance, [face], cavity=cavity, inner=min(a, b, c))


def torus(major: float, minor: float) -> Solid:
    def distance(x: Array) -> Array:
        found: Array = np.hypot(np.hypot(x[..., 0], x[..., 1]) - major, x[..., 2]) - minor
        return found

    def face(u: Array, v: Array) -> Array:
        r = major + minor * np.cos(TURN * v)
        return _stack(r * np.cos(TURN * u), r * np.sin(TURN * u), minor * np.sin(TURN * v))

    shape = make.torus(major, minor)
    return Solid(shape, major + minor, distance, [face], extra={"hole": major - minor, "half": minor})


def wavy_torus(major: float, minor: float, wave: float, skew: float) -> Solid:
    """A torus whose tube has a radius that depends on both angles; the distance is of first order."""
    text = "minor*(1 + wave*cos(3*u)*cos(2*v) + skew*sin(u + v))"

    def radius(u: Array, v: Array) -> Array:
        found: Array = minor * (1 + wave * np.cos(3 * u) * np.cos(2 * v) + skew * np.sin(u + v))
        return found

    def distance(x: Array) -> Array:
        u, across = np.arctan2(x[..., 1], x[..., 0]), np.hypot(x[..., 0], x[..., 1]) - major
        return np.hypot(across, x[..., 2]) - radius(u, np.arctan2(x[..., 2], across))

    def face(u: Array, v: Array) -> Array:
        u, v = TURN * u, TURN * v
        r = radius(u, v)
        return _stack((major + r * np.cos(v)) * np.cos(u), (major + r * np.cos(v)) * np.sin(u), r * np.sin(v))

    shape = make.chart(
        f"(major + {text}*cos(v))*cos(u)", f"(major + {text}*cos(v))*sin(u)", f"{text}*sin(v)",
        domain=[[0.0, TURN], [0.0, TURN]], periodic=[True, True],
        parameters={"major": major, "minor": minor, "wave": wave, "skew": skew},
    )  # fmt: skip
    return Solid(shape, major + 1.5 * minor, distance, [face])


def turned(radius: float, height: float, waist: float, ripple: float, cavity: bool = False) -> Solid:
    """A body of revolution r = radius sin t (1 + waist cos 2t + ripple cos 4t), z = -height cos t."""

    def profile(t: Array) -> Array:
        r = radius * np.sin(t) * (1 + waist * np.cos(2 * t) + ripple * np.cos(4 * t))
        return _stack(r, -height * np.cos(t))

    def slope(t: Array) -> Array:
        swell = 1 + waist * np.cos(2 * t) + ripple * np.cos(4 * t)
        change = -2 * waist * np.sin(2 * t) - 4 * ripple * np.sin(4 * t)
        return _stack(radius * (np.cos(t) * swell + np.sin(t) * change), height * np.sin(t))

    t = np.linspace(0, np.pi, 4001)
    outside = curve_distance(profile, slope, t)
    sign = -1.0 if cavity else 1.0

    def distance(x: Array) -> Array:
        return sign * outside(_stack(np.hypot(x[..., 0], x[..., 1]), x[..., 2]))

    def face(u: Array, v: Array) -> Array:
        r, z = np.moveaxis(profile(np.pi * u), -1, 0)
        return _stack(r * np.cos(TURN * v), r * np.sin(TURN * v), z)

    shape = make.revolution(
        "radius*sin(t)*(1 + waist*cos(2*t) + ripple*cos(4*t))", "-height*cos(t)", domain=[0.0, float(np.pi)],
        parameters={"radius": radius, "height": height, "waist": waist, "ripple": ripple}, cavity=cavity,
    )  # fmt: skip
    size = float(np.linalg.norm(profile(t), axis=1).max())
    return Solid(shape, size, distance, [face], cavity=cavity, inner=float(-outside(np.zeros((1, 2)))[0]))


def tube(radius: float, bore: float, length: float) -> Solid:
    """A tube; with a bore of 0 a cylinder."""
    low, half = bore, length / 2

    def distance(x: Array) -> Array:
        r, z = np.hypot(x[..., 0], x[..., 1]), np.abs(x[..., 2])
        across = np.maximum(r - radius, low - r) if bore else r - radius
        return _box_distance(across, z - half)

    def ring(r: float, z: float) -> Callable[[Array], Array]:
        return lambda t: _stack(r * np.cos(TURN * t), r * np.sin(TURN * t), z)

    def side(r: float) -> Callable[[Array, Array], Array]:
        return lambda u, v: _stack(r * np.cos(TURN * v), r * np.sin(TURN * v), (2 * u - 1) * half)

    rims = [ring(r, z) for r in ([bore, radius] if bore else [radius]) for z in (-half, half)]
    sides = [side(r) for r in ([bore, radius] if bore else [radius])]
    shape = make.tube(radius, bore, length) if bore else make.cylinder(radius, length)
    size = float(np.hypot(radius, half))
    return Solid(shape, size, distance, sides, rims, inner=bore, extra={"hole": bore, "half": half})


def star(points: int, outer: float, inner: float, length: float) -> Solid:
    """A star along z; its edges and its corners, by which it touches first."""
    angle = np.pi * np.arange(2 * points) / points
    r = np.where(np.arange(2 * points) % 2, inner, outer)
    outline = np.stack([r * np.cos(angle), r * np.sin(angle)], axis=1)
    flat, half = polygon_distance(outline), length / 2

    def distance(x: Array) -> Array:
        return _box_distance(flat(x[..., :2]), np.abs(x[..., 2]) - half)

    def straight(a: Array, b: Array) -> Callable[[Array], Array]:
        return lambda t: a + np.asarray(t)[..., None] * (b - a)

    corners = [np.append(each, z) for z in (-half, half) for each in outline]
    edges = [straight(corners[k], corners[k + 2 * points]) for k in range(2 * points)]
    for base in (0, 2 * points):
        edges += [
            straight(corners[base + k], corners[base + (k + 1) % (2 * points)]) for k in range(2 * points)
        ]
    shape = make.extrusion(length, points=[[float(x), float(y)] for x, y in outline])
    return Solid(shape, float(np.hypot(outer, half)), distance, [], edges)


def cam(radii: Sequence[float], length: float) -> Solid:
    """A spline through points at these radii, at equal angles, along z."""
    angle = TURN * np.arange(len(radii)) / len(radii)
    points = np.array(radii)[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    closed = np.vstack([points, points[:1]])
    chords = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(closed, axis=0), axis=1))])
    outline = CubicSpline(chords / chords[-1], closed, bc_type="periodic")
    t, half = np.linspace(0, 1, 4000, endpoint=False), length / 2
    flat = curve_distance(outline, outline.derivative(), t)

    def distance(x: Array) -> Array:
        return _box_distance(flat(x[..., :2]), np.abs(x[..., 2]) - half)

    def side(u: Array, v: Array) -> Array:
        return _stack(*np.moveaxis(outline(v), -1, 0), (2 * u - 1) * half)

    def rim(z: float) -> Callable[[Array], Array]:
        return lambda s: _stack(*np.moveaxis(outline(s), -1, 0), z)

    shape = make.extrusion(length, points=[[float(x), float(y)] for x, y in points], smooth=True)
    size = float(np.hypot(np.linalg.norm(outline(t), axis=1).max(), half))
    return Solid(shape, size, distance, [side], [rim(-half), rim(half)])


def hull(rng: np.random.Generator, size: float) -> Solid:
    """The convex hull of ten points."""
    x = size * unit(rng.normal(size=(10, 3)))
    found = ConvexHull(x)
    planes, corners = found.equations, x[found.vertices]

    def distance(at: Array) -> Array:
        found: Array = (at @ planes[:, :3].T + planes[:, 3]).max(axis=-1)
        return found

    def straight(a: Array, b: Array) -> Callable[[Array], Array]:
        return lambda t: a + np.asarray(t)[..., None] * (b - a)

    sides = {tuple(sorted((s[i], s[i - 1]))) for s in found.simplices for i in range(3)}
    shape = make.polyhedron([[float(c) for c in each] for each in corners])
    return Solid(shape, size, distance, [], [straight(x[i], x[j]) for i, j in sorted(sides)])


def floor() -> Solid:
    return Solid(make.plane(), 0.0, lambda x: x[..., 2])


def _box_distance(a: Array, b: Array) -> Array:
    inside = np.minimum(np.maximum(a, b), 0)
    return inside + np.hypot(np.maximum(a, 0), np.maximum(b, 0))


def unit(x: Array) -> Array:
    return np.asarray(x / np.linalg.norm(x, axis=-1, keepdims=True))


def random_solid(rng: np.random.Generator, size: float) -> Solid:
    """A solid of about this size."""
    r = size * rng.uniform(0.5, 1)
    match rng.integers(7):
        case 0:
            return torus(r, r * rng.uniform(0.15, 0.45))
        case 1:
            return wavy_torus(r, r * rng.uniform(0.2, 0.35), rng.uniform(0.05, 0.2), rng.uniform(0.05, 0.12))
        case 2:
            return turned(r, size * rng.uniform(0.6, 1.2), rng.uniform(0.1, 0.5), rng.uniform(-0.05, 0.05))
        case 3:
            return tube(r, r * rng.uniform(0.4, 0.8), size * rng.uniform(0.4, 1.5))
        case 4:
            return star(int(rng.integers(3, 6)), r, r * rng.uniform(0.4, 0.7), size * rng.uniform(0.3, 1))
        case 5:
            return hull(rng, r)
        case _:
            radii = r * rng.uniform(0.6, 1, size=int(rng.integers(6, 10)))
            return cam([*map(float, radii)], size * rng.uniform(0.3, 1.2))


def depth(points_of: Solid, other: Solid, p: Array, R: Array, above: float = -np.inf) -> float:
    """Deepest penetration of points of one solid, at (p, R) in the axes of the other, m; negative: apart.

    What is less than `above` is not refined.
    """
    deepest = -np.inf
    for each in points_of.dense:
        deepest = max(deepest, each.deepest(lambda x: -other.distance(p + x @ R.T), max(above, deepest)))
    return deepest
