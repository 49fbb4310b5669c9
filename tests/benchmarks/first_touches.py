"""The law over pairs of kinds: a shape falls on another without rotation, and the first touch is not missed.

    python -m tests.benchmarks.first_touches --count 50 --out FILE [--kinds sphere frustum] [--part 0/2]

Each pair of kinds of the scene format is drawn `--count` times, by turns with its specimens, solid,
hollow or without end: poses at random, ratios of sizes from 1e-3 to 1e3, aspect ratios, wall thicknesses
and half-angles by decades. The time of the first touch follows from the least way down of any point of
one shape into the other, by rays from dense points of curved faces, edges and corners, refined where they
are shortest: each of them is an overlap that is certain; of two curves, and of a curve and the edges of a
solid that rays between points may miss, it follows from where they cross as seen from above. A member
fails if the run has its first touch later than that (missed), or earlier, by points that are not on both
shapes (spurious), or refuses the start. One line for each member that fails, is not trusted, or starts
although the shapes overlap, why pairs are left out, then a table of the pairs that have such a member, with
the commits at which members ran.
With `--out`, verdicts are appended to FILE (JSON lines), and a member that is there is not run again.
A few drops of all pairs come before the rest; with `--by-pair`, which derives fewer libraries, all drops of
a pair come before those of the next one.
MODELGEN_POOL=FOLDER keeps compiled libraries.
"""

from __future__ import annotations

import argparse
import json
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import asdict, dataclass, replace
from functools import cache
from itertools import combinations_with_replacement, pairwise, product
from pathlib import Path
from subprocess import run
from typing import Any

import numpy as np
from scipy.optimize import minimize, minimize_scalar
from scipy.spatial.transform import Rotation

from modelgen import ModelgenError, derive, emit, require, simulate, start
from modelgen.codegen.library import Library
from modelgen.codegen.library_with_parameters import KINDS as GROUPS
from modelgen.codegen.library_with_parameters import same_but_for_numbers
from modelgen.codegen.manifest import Json
from modelgen.codegen.manifest_model import instance_of
from modelgen.errors import SceneError
from modelgen.model import Model
from modelgen.runtime.trajectory import Event
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Scene
from tests.benchmarks.measured_solids import Solid, depth
from tests.benchmarks.solids_by_decades import (
    CURVES,
    ENDLESS,
    HOLLOW,
    KINDS,
    SHEETS,
    VARIANTS,
    Endless,
    decades,
    seen,
)
from tests.running import compiled

Array = np.ndarray[Any, Any]
G = 9.81
TRACED, DOUBLED, HALVED = 100, 60, 55  # steps towards a surface; of the way beyond it; of the bracket
JUST_BEFORE = 1e-9  # of the time of a touch
NEAR = 1e-14  # of the size of a solid, from which a ray is at its surface
HOLED = (
    "torus", "half_torus", "tube", "extrusion", "chart", "circle", "solid", "bspline", "height_field",
    "outline_wall", "outline",
)  # or may be: not convex  # fmt: skip
STEEP, NOT_CONVEX = 0.02, 0.5  # least slope of a distance along a ray by which it is extrapolated
FACE, EDGE = 40, 200  # parts of a coordinate of a face, of an edge
ZOOMS, KEPT = 24, 3  # steps of refinement of as many places
TOLERANCE = 1e-8  # of the way fallen, against the radius of the body that falls and the way
ROUNDING = 1e-10  # the same against the radius of the fixed body, which may be a thousand times larger
DOWN = np.array([0.0, 0.0, -1.0])
FAILS = ("missed", "spurious", "refused")
TOLD = (*FAILS, "doubted", "overlapping")
CROSSING = ("line", "endless cylinder")  # may cross each other without end
RULED = ("outline_wall", "profile_wall")
TILT = 0.3  # rad, most of a shape with open edges
SEEN = 60.0  # m, of a shape without end that falls
KEPT_LIBRARIES = 16
PASSES = (1, 5, 20)  # drops of each pair after the first passes over all of them
WINDOWS = 10_000  # parts of a curve, by which those near another shape are found
STRAIGHT = ("line", "segment", "edge")  # curves of one part
POLYLINE, NEWTON = 400, 6  # parts of a curve; steps to where two curves cross as seen from above


@dataclass(frozen=True)
class Placed:
    """A solid in the world."""

    solid: Solid
    R: Array
    p: Array

    @property
    def radius(self) -> float:
        return self.solid.size

    @property
    def is_convex(self) -> bool:
        shape = self.solid.shape
        return not shape.cavity and shape.kind not in HOLED and "up" not in self.solid.extra

    @property
    def is_curve(self) -> bool:
        return self.solid.is_curve

    def may_be_touched(self, x: Array, other: Placed, step: Array) -> bool:
        """Whether the other shape may touch it at a point of the world: away from its open edges, and from
        outside if it is an outline, whose tangent is normal to one of the normals that the other shape has
        there; `step`: a part of the way of the point towards the other shape, m."""
        local, extra = (x - self.p) @ self.R, self.solid.extra
        if "within" in extra:
            return bool(extra["within"](local))
        if "outward" not in extra:
            return True
        outward, h = self.R @ extra["outward"](local), float(np.linalg.norm(step)) / 10
        normals = _normals_around(other, x, h)
        off = normals @ np.cross(self.R[:, 2], outward)
        normal = normals.mean(axis=0)
        if off.min() < 0 < off.max():
            normal = off.max() * normals[off.argmin()] - off.min() * normals[off.argmax()]
        return float(normal @ outward) < 0

    def points(self, x: Array) -> Array:
        found: Array = self.p + x @ self.R.T
        return found

    def distance(self, x: Array) -> Array:
        found: Array = self.solid.distance((x - self.p) @ self.R)
        return found


def ways(
    x: Array,
    towards: Placed,
    direction: Array,
    limit: float,
    start: Array | None = None,
    slack: float = np.inf,
) -> Array:
    """How far each point moves along `direction` until it is in a solid, inf where that is not seen.

    The distance is extrapolated by its last change: not too far where it is convex along the ray. A ray
    begins at `start`, or at 0 where it is inside there; it is given up at `slack` beyond the shortest one.
    """
    shape, x = x.shape[:-1], x.reshape(-1, 3)
    least = STEEP if towards.is_convex else NOT_CONVEX
    scale = max(min(towards.radius, limit), 1e-300)
    s = np.zeros(len(x)) if start is None else start.ravel().copy()
    d = towards.distance(x + s[:, None] * direction)
    if start is not None and (d <= 0).any():
        inside = d <= 0
        s[inside], d[inside] = 0.0, towards.distance(x[inside])
    d, low, best = np.minimum(d, 2 * limit), s.copy(), np.inf
    step, going = np.maximum(d, 0), np.arange(len(x))
    for _ in range(TRACED):
        s[going] += step[going]
        before = d[going]
        d[going] = towards.distance(x[going] + s[going, None] * direction)
        outside = d[going] > 0
        low[going[outside]] = s[going[outside]]
        best = min(best, s[going[np.invert(outside)]].min(initial=np.inf))
        steepness = np.clip((before - d[going]) / np.maximum(step[going], 1e-300), least, 1)
        step[going] = np.maximum(d[going], 0) / steepness
        close = d[going] <= NEAR * scale
        going = going[
            outside & np.invert(close) & (d[going] < limit) & (s[going] <= min(limit, best + slack))
        ]
        if not len(going):
            break
    found = np.full(len(x), np.inf)
    open_ = np.flatnonzero((low <= min(limit, best + slack)) & (d < 0.05 * scale))
    step = np.maximum(s - low, np.maximum(d, NEAR * scale))
    for _ in range(DOUBLED):
        if not len(open_):
            break
        high = low[open_] + step[open_]
        entered = towards.distance(x[open_] + high[:, None] * direction) <= 0
        found[open_[entered]] = high[entered]
        open_ = open_[np.invert(entered)]
        low[open_], step[open_] = low[open_] + step[open_], 2 * step[open_]
        open_ = open_[step[open_] < scale]
    hit = np.flatnonzero(found < np.inf)
    a, b = low[hit], found[hit]
    for _ in range(HALVED):
        wide = np.flatnonzero(b - a > 10 * NEAR * scale)
        if not len(wide):
            break
        middle = (a[wide] + b[wide]) / 2
        inside = towards.distance(x[hit[wide]] + middle[:, None] * direction) <= 0
        a[wide], b[wide] = np.where(inside, a[wide], middle), np.where(inside, middle, b[wide])
    found[hit] = b
    return found.reshape(shape)


def _normals_around(towards: Placed, x: Array, h: float) -> Array:
    """Gradients (n,3) of the distance from a shape at points around x, h away from it, m."""
    around = np.array([at for at in product((-1.0, 0.0, 1.0), repeat=3) if any(at)])
    around *= h / np.linalg.norm(around, axis=1)[:, None]
    steps = h / 10 * np.vstack([np.eye(3), -np.eye(3)])
    d = towards.distance(x + around[:, None] + steps)
    found: Array = (d[:, :3] - d[:, 3:]) / (h / 5)
    return found


@dataclass(frozen=True)
class Side:
    """A face or an edge of one shape, and the way of its points into the other."""

    at: Callable[..., Array]  # of coordinates in [0, 1]
    own: Placed
    other: Placed
    direction: Array
    limit: float
    dimension: int

    def ways(self, w: Array, start: Array | None = None, slack: float = np.inf) -> Array:
        """Of a point that does not meet the other shape more than the limit, the more the farther beside."""
        x = self.own.points(self.at(*np.moveaxis(w, -1, 0)))
        found = ways(x, self.other, self.direction, self.limit, start, slack)
        beside = np.hypot(*np.moveaxis(x - self.other.p, -1, 0)[:2])
        return np.where(found < np.inf, found, 2 * self.limit + beside)

    @property
    def parts(self) -> int:
        return FACE if self.dimension == 2 else EDGE

    def shortest(self, parts: int = 1) -> tuple[float, Array, Array]:
        """On a grid; with the coordinates there and of the next best, and the least way near each of them
        that the way between neighbours of the grid allows."""
        n = parts * self.parts
        grid = np.stack(np.meshgrid(*[np.linspace(0, 1, n + 1)] * self.dimension, indexing="ij"), -1)
        found = self.ways(grid)
        best = np.unravel_index(found.argmin(), found.shape)
        if found[best] >= self.limit:
            return np.inf, np.empty((0, self.dimension)), np.empty(0)
        chosen: list[Array] = []
        left, floor = found.copy(), []
        while len(chosen) < KEPT * parts:
            at = np.unravel_index(left.argmin(), left.shape)
            if left[at] >= self.limit:
                break
            chosen.append(grid[at])
            around = found[tuple(slice(max(i - 1, 0), i + 2) for i in at)].max()
            floor.append(2 * found[at] - around if around < self.limit else 0.0)
            left[tuple(slice(max(i - 2, 0), i + 3) for i in at)] = np.inf
        return float(found[best]), np.array(chosen), np.array(floor)

    def refined(self, w: Array, parts: int = 1) -> tuple[float, Array]:
        """The shortest way near rows of coordinates, by grids that close in on the best; with its place."""
        reach = np.full(len(w), 1.0 / (parts * self.parts))
        points, shrunk = (9, 0.4) if self.dimension == 2 else (25, 0.15)
        steps = np.stack(np.meshgrid(*[np.linspace(-1, 1, points)] * self.dimension, indexing="ij"), -1)
        steps = steps.reshape(-1, self.dimension)
        start, exact = None, 1e-3 * TOLERANCE * min(self.own.radius, self.other.radius)
        for _ in range(ZOOMS):
            tries = np.clip(w[:, None] + reach[:, None, None] * steps, 0, 1)
            found = self.ways(tries, start)
            rows, which = np.arange(len(w)), found.argmin(axis=1)
            moved = np.abs(tries[rows, which] - w).max(axis=1) > 0.9 * reach
            w, nearest = tries[rows, which], found[rows, which]
            far = found.max(axis=1)
            spread = np.where(far < self.limit, far - nearest, np.inf)
            first = nearest.argmin()
            kept = nearest - 4 * spread <= nearest[first]
            if (spread[kept] < exact).all():
                break
            w, nearest, spread, reach = w[kept], nearest[kept], spread[kept], reach[kept]
            start = np.repeat(np.clip(nearest - 3 * spread, 0, None)[:, None], len(steps), axis=1)
            reach = reach * np.where(moved[kept], 0.9, shrunk)
        first = nearest.argmin()
        least = float(nearest[first])
        return (self.descended(w[first]), w[first]) if parts > 1 and least < self.limit else (least, w[first])

    def descended(self, w: Array) -> float:
        """The same by the simplex method of Nelder and Mead, which follows valleys across the coordinates."""
        for step in (1e-2, 1e-4):
            start = np.vstack([w, *(w + step * np.where(w > 0.5, -1, 1) * np.eye(self.dimension))])
            options = {"initial_simplex": start, "xatol": 1e-13, "fatol": 0.0, "maxfev": 600}
            found = minimize(
                lambda at: float(self.ways(np.clip(at, 0, 1)[None])[0]),
                w,
                method="Nelder-Mead",
                options=options,
            )
            w = np.clip(found.x, 0, 1)
        return float(found.fun)


def sides(moving: Placed, fixed: Placed, limit: float) -> list[Side]:
    found = []
    for own, other, direction in ((moving, fixed, DOWN), (fixed, moving, -DOWN)):
        if own.solid.size < np.inf or own.solid.faces or own.solid.edges:
            found += [Side(face, own, other, direction, limit, 2) for face in own.solid.faces]
            found += [Side(edge, own, other, direction, limit, 1) for edge in _edges(own, other)]
    return found


def _edges(own: Placed, other: Placed) -> list[Callable[..., Array]]:
    """The edges; of a curve, which is seen by its points alone, those parts that are above or below the other
    shape."""
    if not own.is_curve or other.radius == np.inf or "endless" in other.solid.extra:
        return [*own.solid.edges]
    found: list[Callable[..., Array]] = []
    t = np.linspace(0, 1, WINDOWS + 1)
    for edge in own.solid.edges:
        x = own.points(edge(t))[:, :2]
        spacing = np.linalg.norm(np.diff(x, axis=0), axis=1).max()
        near = np.hypot(*(x - other.p[:2]).T) < 1.01 * other.radius + spacing
        ends = np.flatnonzero(np.diff(np.concatenate([[False], near, [False]])))
        for low, high in ends.reshape(-1, 2):
            found.append(_part_of(edge, t[max(low - 1, 0)], t[min(high, WINDOWS)]))
    return found


def _part_of(edge: Callable[..., Array], low: float, high: float) -> Callable[..., Array]:
    return lambda t: edge(low + (high - low) * t)


def touch(moving: Placed, fixed: Placed, limit: float, parts: int = 1, most: int = 6) -> tuple[float, Array]:
    """How far the shape falls until it touches, m, no more than any overlap that was found; and where."""
    if moving.is_curve and fixed.is_curve:
        return _crossing(moving, fixed, limit, parts)
    looked = [(each, *each.shortest(parts)) for each in sides(moving, fixed, limit)]
    least, place = np.inf, np.full(3, np.nan)
    for side, coarse, w, floor in sorted(looked, key=lambda each: each[1])[:most]:
        open_ = floor < least
        if coarse < np.inf and open_.any():
            way, at = side.refined(w[open_], parts)
            if way < least:
                least, place = way, side.own.points(side.at(*at)) + (way * DOWN if side.own is moving else 0)
    if parts > 1 and moving.is_curve != fixed.is_curve:
        return min((least, place), _crossing(moving, fixed, limit, parts), key=lambda each: each[0])
    return least, place


def travel(moving: Placed, fixed: Placed, limit: float, parts: int = 1, most: int = 6) -> float:
    """How far the shape falls until it touches, m."""
    return touch(moving, fixed, limit, parts, most)[0]


def _crossing(moving: Placed, fixed: Placed, limit: float, parts: int) -> tuple[float, Array]:
    """The same for curves and edges: where they cross as seen from above, by Newton's method from their
    polylines."""
    least, place = np.inf, np.full(3, np.nan)
    first, second = (
        np.linspace(0, 1, 2 if of.solid.shape.kind in STRAIGHT else POLYLINE * parts + 1)
        for of in (moving, fixed)
    )
    for one, two in product(_edges(moving, fixed), _edges(fixed, moving)):
        upper, lower = _placed(moving, one), _placed(fixed, two)
        a, b = upper(first), lower(second)
        along, other = np.diff(a[:, :2], axis=0)[:, None], np.diff(b[:, :2], axis=0)[None]
        apart = b[None, :-1, :2] - a[:-1, None, :2]
        with np.errstate(divide="ignore", invalid="ignore"):
            area = _flat_cross(along, other)
            u, v = _flat_cross(apart, other) / area, _flat_cross(apart, along) / area
        i, j = np.nonzero((u >= -0.01) & (u <= 1.01) & (v >= -0.01) & (v <= 1.01))
        w = np.stack([(i + u[i, j]) * first[1], (j + v[i, j]) * second[1]])
        for _ in range(NEWTON):
            gap = (upper(w[0]) - lower(w[1]))[:, :2]
            slopes = [(f(x + 1e-6) - f(x - 1e-6))[:, :2] / 2e-6 for f, x in ((upper, w[0]), (lower, w[1]))]
            area = _flat_cross(slopes[0], slopes[1])
            area = np.where(area == 0, np.inf, area)
            w = w - np.stack([_flat_cross(gap, slopes[1]), _flat_cross(gap, slopes[0])]) / area
        ways_down = (upper(w[0]) - lower(w[1]))[:, 2]
        ways_down = np.where(((w >= 0) & (w <= 1)).all(axis=0) & (ways_down > 0), ways_down, np.inf)
        if ways_down.min(initial=np.inf) < min(least, limit):
            k = ways_down.argmin()
            least, place = float(ways_down[k]), lower(w[1, k : k + 1])[0]
    return least, place


def _placed(of: Placed, at: Callable[..., Array]) -> Callable[[Array], Array]:
    return lambda t: of.points(at(t))


def _flat_cross(a: Array, b: Array) -> Array:
    found: Array = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    return found


@dataclass(frozen=True)
class Member:
    """A drop: shapes placed at its start, and the way to the first touch, m."""

    moving: Placed
    fixed: Placed
    way: float
    limit: float  # m, of the ways that were looked for

    @property
    def scene(self) -> Scene:
        return _scene(self.moving, self.fixed)

    @property
    def time(self) -> float:
        """s, of the first touch."""
        return float(np.sqrt(2 * self.way / G))

    @property
    def tolerance(self) -> float:
        """m, of the way."""
        large = self.fixed.radius if self.fixed.radius < np.inf else 0.0
        return TOLERANCE * (_length(self.moving, self.fixed) + self.way) + ROUNDING * large


def _rotation(rng: np.random.Generator) -> Array:
    x, y, z, w = rng.normal(size=4)
    return np.asarray(Rotation.from_quat([x, y, z, w]).as_matrix())


def _some_point(solid: Solid, rng: np.random.Generator) -> Array:
    parts = [(face, 2) for face in solid.faces] + [(edge, 1) for edge in solid.edges]
    if not parts:
        return np.append(rng.uniform(-1, 1, 2), 0.0)
    if solid.size == np.inf and solid.is_curve:
        parts = parts[len(parts) // 2 - 1 : len(parts) // 2 + 1]
    at, dimension = parts[rng.integers(len(parts))]
    low, high = (0.35, 0.65) if "within" in solid.extra and not solid.is_curve else (0.0, 1.0)
    found: Array = at(*rng.uniform(low, high, dimension))
    return found


def _orientation(solid: Solid, falls: bool, rng: np.random.Generator) -> Array:
    """Any; of a shape with open edges, and of a bowl, so that it is touched between them."""
    R = _rotation(rng)
    axis = solid.extra.get("up", solid.extra.get("along"))
    if axis is None:
        return R
    towards = np.array([0, 0, -1.0 if falls else 1.0])
    if "along" in solid.extra:
        angle = rng.uniform(0, 2 * np.pi)
        towards = np.array([np.cos(angle), np.sin(angle), 0.0])
    tilt = rng.normal(size=3)
    towards = towards + TILT * rng.uniform() * tilt / np.linalg.norm(tilt)
    now, towards = R @ axis, towards / np.linalg.norm(towards)
    about = np.cross(now, towards)
    about *= np.arccos(np.clip(now @ towards, -1, 1)) / max(float(np.linalg.norm(about)), 1e-300)
    turn: Array = Rotation.from_rotvec(about).as_matrix() @ R
    return turn


def why_not(one: str, two: str) -> str:
    """Why two specimens do not touch first where rays tell, or an empty text."""
    both = {one, two}
    if both <= {*HOLLOW} or (both & {*HOLLOW} and both & {*ENDLESS} - {*HOLLOW}):
        return "the material around a hollow has no end"
    if both == {"plane", "edge"}:
        return "refused: a segment is given instead"
    if both <= {*ENDLESS} and not both <= {*CROSSING}:
        return "two shapes without end meet at the start, or are parallel"
    if "outline" in both and both <= {*CURVES}:
        return "an outline is touched from outside, on which side of it a curve does not tell"
    if "point" in both and both <= {*CURVES}:
        return "a point meets a curve, or a point, in no position but special ones"
    if both & {*RULED} and both & {*HOLLOW, "plane", "bowl"}:
        return "a straight wall touches a plane or a hollow with its open ends"
    return ""


def draw(first: str, second: str, seed: int) -> Member | None:
    """A member; None where no position is found in which the two touch away from open edges."""
    names = list(KINDS)
    key = [names.index(first), names.index(second), seed]
    rng = np.random.default_rng(key)

    def made(name: str, size: float) -> Solid | Endless:
        return KINDS[name](np.random.default_rng([*key, names.index(name)]), size)

    def is_fixed(name: str) -> tuple[bool, ...]:
        """By what should be fixed first."""
        return name in HOLLOW, name in ENDLESS, name == "outline_wall", name in SHEETS

    if is_fixed(first) > is_fixed(second) or (
        is_fixed(first) == is_fixed(second) and second not in ENDLESS and rng.integers(2)
    ):
        first, second = second, first
    if first in HOLLOW or (first in ENDLESS and second not in CROSSING):
        return None
    is_ruled = {first, second} <= {*RULED}
    low, high = (-0.2, 0.5) if is_ruled else _ratios(first, second)
    one, size = seen(made(first, 1.0), SEEN), decades(rng, low, high)
    if one.size == np.inf:
        one = replace(one, size=1.0, extra={**one.extra, "endless": True})
    if second in HOLLOW:
        low = 1 if first in SHEETS else 0
        size = 3 * decades(rng, low, 3) * max(one.size, 1e-3) / seen(made(second, 1.0), 1.0).inner
    within = 10 * max(
        size, one.size if second == "helix" else 1.0
    )  # of a helix what is not seen touches nothing
    return _set_up(one, seen(made(second, size), within), size, rng)


def _ratios(first: str, second: str) -> tuple[float, float]:
    """Decades of the size of the fixed body against that of the one that falls."""
    if second == "outline_wall":
        return -0.3, 3
    if second in SHEETS or (first in SHEETS and second == "bowl"):
        return 0.8, 3
    return (0, 3) if second == "helix" else (-3, 3)


def _set_up(one: Solid, two: Solid, size: float, rng: np.random.Generator) -> Member | None:
    """The bodies at random orientations, above each other so that they meet; the body inside of a hollow."""
    small = min(x for x in (one.size, two.size if two.size < np.inf else size) if x > 0)
    for _ in range(100):
        fixed, moving = (
            Placed(each, _orientation(each, falls, rng), np.zeros(3))
            for each, falls in ((two, False), (one, True))
        )  # fmt: skip
        if two.cavity:
            off = rng.normal(size=3)
            off *= max(two.inner - 1.05 * one.size, 0.0) * rng.uniform(0, 0.9) / np.linalg.norm(off)
            off += fixed.points(two.extra.get("centre", np.zeros(3)))
            moving, limit = replace(moving, p=off), 40 * two.inner + min(two.size, 10 * size)
        else:
            is_bounded = two.size < np.inf
            reach = one.size + (two.size if is_bounded else size)
            lift = 2.1 * reach if is_bounded else 10 * reach
            target = fixed.points(_some_point(two, rng)) - moving.points(_some_point(one, rng))
            target += 0.2 * small * rng.normal(size=3)
            moving, limit = replace(moving, p=target - lift * DOWN), 5 * lift
            if not is_bounded and not float(fixed.distance(moving.p)) > one.size:
                continue
        way, place = touch(moving, fixed, limit)
        if way < limit and _is_touched(moving, fixed, way, place, 1e-4 * small * DOWN):
            drop = min(small * decades(rng, -2, 0), way)
            start = replace(moving, p=moving.p + (way - drop) * DOWN)
            return Member(start, fixed, drop, limit)
    return None


def _is_touched(moving: Placed, fixed: Placed, way: float, place: Array, step: Array) -> bool:
    low = replace(moving, p=moving.p + way * DOWN)
    return fixed.may_be_touched(place, low, -step) and low.may_be_touched(place, fixed, step)


def _length(moving: Placed, fixed: Placed) -> float:
    """Radius of the body that falls, to which the tolerances of its run refer, m; of a point that of the
    other body."""
    return moving.radius or (fixed.radius if fixed.radius < np.inf else 1.0)


def _scene(moving: Placed, fixed: Placed) -> Scene:
    def pose(at: Placed) -> dict[str, Any]:
        x, y, z, w = map(float, Rotation.from_matrix(at.R).as_quat())
        return {"position": [*map(float, at.p)], "quaternion": [w, x, y, z]}

    inertia = [0.4 * _length(moving, fixed) ** 2] * 3
    body = make.dynamic("body", moving.solid.shape, mass=1.0, inertia=inertia, **pose(moving))
    base = make.fixed("base", fixed.solid.shape, **pose(fixed))
    return make.scene("first-touch", [base, body], contact=[{"between": ["body", "base"]}])


@dataclass(frozen=True)
class Verdict:
    """What became of a member.

    `outcome`: right, missed, doubted (missed, and not trusted), spurious, refused, overlapping (started
    although the shapes overlap, and trusted), no pair, not set up.
    """

    first: str
    second: str
    seed: int
    outcome: str
    error: float = 0.0  # m, of the way to the first touch; of one that the run knows better, of its points
    told: str = ""
    seconds: float = 0.0  # of CPU time
    commit: str = ""

    @property
    def fails(self) -> bool:
        return self.outcome in FAILS


@cache
def commit() -> str:
    """That of the working tree, with a + if it has changes."""
    found = run(["git", "describe", "--always", "--dirty=+"], capture_output=True, text=True, check=False)
    return found.stdout.strip()


def judge(first: str, second: str, seed: int) -> Verdict:
    begun = time.process_time()
    member = draw(first, second, seed)
    if member is None:
        return Verdict(first, second, seed, "not set up", commit=commit())
    outcome, error, told = _judged(member)
    return Verdict(first, second, seed, outcome, error, told, time.process_time() - begun, commit())


MADE: list[tuple[Model, Json, Library]] = []  # the last ones, for other numbers of the same kinds


def _library(scene: Scene) -> Library:
    model = require(scene)
    instance = instance_of(model)
    for known, known_instance, library in MADE:
        is_same = all(getattr(known, f"{each}_kinds") == getattr(model, f"{each}_kinds") for each in GROUPS)
        if is_same and same_but_for_numbers(known_instance, instance):
            return library.with_instance(instance)
    MADE.append((model, instance, compiled(emit(derive(model)))))
    del MADE[:-KEPT_LIBRARIES]
    return MADE[-1][2]


def _judged(member: Member) -> tuple[str, float, str]:
    try:
        library = _library(member.scene)
    except SceneError as found:
        return "no pair", 0.0, str(found)
    try:
        path = simulate(library, until=1.05 * member.time, samples=2, estimate=False)
    except ModelgenError as found:
        return ("not set up" if _do_overlap(member) else "refused"), 0.0, str(found)
    touches = [event for event in path.events if event.kind in ("touch-down", "impact")]
    told = f"{path.outcome.name} {list(path.events)[:2]} {path.doubts}"
    error = G * touches[0].t ** 2 / 2 - member.way if touches else np.inf
    if error > member.tolerance:
        outcome = "doubted" if path.doubts else "overlapping" if _do_overlap(member) else "missed"
        return outcome, error, told
    if error < -member.tolerance:
        again = travel(member.moving, member.fixed, member.limit, parts=4, most=100)
        error = G * touches[0].t ** 2 / 2 - min(again, member.way)
        if error < -member.tolerance:
            apart = _apart(member, library, touches[0])
            return ("right", apart, "") if apart <= member.tolerance else ("spurious", error, told)
    return "right", error, ""


def _apart(member: Member, library: Library, touch: Event) -> float:
    """Distance of the points at which a run says that the bodies touch from both, m, just before that."""
    simulation, t = start(library), touch.t * (1 - JUST_BEFORE)
    simulation.step(t)
    low = replace(member.moving, p=member.moving.p + G * t**2 / 2 * DOWN)
    points = np.array(simulation.contacts[touch.contact].points)
    return max(_distance_from(each, x) for each in (low, member.fixed) for x in points)


def _distance_from(placed: Placed, x: Array) -> float:
    """Distance of a point of the world from a shape, m; from a curve without a distance by its points."""
    known = float(placed.distance(x[None])[0])
    if known < np.inf:
        return known
    t, local = np.linspace(0, 1, WINDOWS + 1), (x - placed.p) @ placed.R
    return min(_distance_along(edge, local, t) for edge in placed.solid.edges)


def _distance_along(edge: Callable[..., Array], x: Array, t: Array) -> float:
    """Distance of a point from an edge, whose coordinates are t, m."""
    nearest = float(t[np.linalg.norm(edge(t) - x, axis=-1).argmin()])
    found = minimize_scalar(
        lambda off: float(np.linalg.norm(edge(np.clip(nearest + off, 0, 1)) - x)),
        bounds=(-t[1], t[1]),
        options={"xatol": 1e-15},
    )
    return float(found.fun)


def _do_overlap(member: Member) -> bool:
    """Whether the shapes overlap at the start after all."""
    both = member.moving, member.fixed
    way = travel(*both, member.limit, parts=4, most=100)
    return way < member.way - member.tolerance or any(
        depth(a.solid, b.solid, b.R.T @ (a.p - b.p), b.R.T @ a.R) > member.tolerance
        for a, b in (both, both[::-1])
        if a.solid.faces or a.solid.edges
    )


def pairs(kinds: list[str]) -> Iterator[tuple[str, str]]:
    """Pairs of specimens."""
    for one, two in combinations_with_replacement(KINDS, 2):
        if not why_not(one, two) and (not kinds or {one, two} & {*kinds}):
            yield one, two


def specimens(one: str, two: str) -> list[tuple[str, str]]:
    """The pairs of specimens that stand for a pair of kinds."""
    names = list(KINDS)
    found = {
        (a, b) if names.index(a) <= names.index(b) else (b, a)
        for a, b in product(VARIANTS[one], VARIANTS[two])
    }
    return sorted(both for both in found if not why_not(*both))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=50)
    parser.add_argument("--kinds", nargs="*", default=[])
    parser.add_argument("--part", default="0/1", help="k/n: every n-th pair, from the k-th")
    parser.add_argument("--out", type=Path)
    parser.add_argument("--by-pair", action="store_true", help="all drops of a pair before the next pair")
    options = parser.parse_args()
    part, parts = map(int, options.part.split("/"))
    passes = () if options.by_pair else (n for n in PASSES if n < options.count)
    known: dict[tuple[str, str, int], Verdict] = {}
    if options.out and options.out.exists():
        for row in options.out.read_text().splitlines():
            verdict = Verdict(**json.loads(row))
            known[verdict.first, verdict.second, verdict.seed] = verdict
    of_kinds = [
        (kinds, specimens(*kinds))
        for kinds in combinations_with_replacement(VARIANTS, 2)
        if not options.kinds or {*kinds} & {*options.kinds}
    ]
    impossible = [kinds for kinds, found in of_kinds if not found]
    of_kinds = [each for each in of_kinds if each[1]][part::parts]
    verdicts: dict[tuple[str, str], list[Verdict]] = {kinds: [] for kinds, _ in of_kinds}
    for first, end in pairwise([0, *passes, options.count]):
        for kinds, found in of_kinds:
            for seed in range(first, end):
                one, two = found[seed % len(found)]
                verdict = known.get((one, two, seed)) or judge(one, two, seed)
                verdicts[kinds].append(verdict)
                if verdict.outcome in TOLD:
                    print(verdict, flush=True)
                if options.out and (one, two, seed) not in known:
                    with options.out.open("a") as file:
                        file.write(json.dumps(asdict(verdict)) + "\n")
    for one, two in impossible:
        reasons = {why_not(*both) for both in product(VARIANTS[one], VARIANTS[two])}
        print(f"{one:>18} {two:<18} left out: {'; '.join(sorted(reasons))}")
    print(summary(verdicts))


def summary(verdicts: Mapping[tuple[str, str], list[Verdict]]) -> str:
    every = [each for found in verdicts.values() for each in found]
    seconds = sum(each.seconds for each in every)
    table = [
        f"{len(verdicts)} pairs of kinds, {len(every)} drops: {_counted(each.outcome for each in every)}; "
        f"{seconds:.0f} s of CPU time",
        f"commits: {_counted(each.commit for each in every)}",
    ]
    for (one, two), found in verdicts.items():
        if any(each.outcome in TOLD for each in found):
            table.append(f"{one:>18} {two:<18} {_counted(each.outcome for each in found)}")
    return "\n".join(table)


def _counted(words: Iterable[str]) -> str:
    return ", ".join(f"{word} {count}" for word, count in Counter(words).most_common())


if __name__ == "__main__":
    main()
