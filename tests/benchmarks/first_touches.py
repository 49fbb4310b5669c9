"""The law over pairs of kinds: a shape falls on another without rotation, and the first touch is not missed.

    python -m tests.benchmarks.first_touches --count 50 --out FILE [--kinds sphere frustum] [--part 0/2]

Each pair of kinds is drawn `--count` times: poses at random, ratios of sizes from 1e-3 to 1e3, aspect
ratios, wall thicknesses and half-angles by decades. The time of the first touch follows from the least
way down of any point of one shape into the other, by rays from dense points of curved faces, edges and
corners, refined where they are shortest: each of them is an overlap that is certain. A member fails if
the run has its first touch later than that (missed), or earlier (spurious), or refuses the start. One
line for each member that fails or is not trusted, then a table of the pairs that have one. With `--out`,
verdicts are appended to FILE (JSON lines), and a member that is there is not run again. FILE is to be
deleted when the core has changed.
"""

from __future__ import annotations

import argparse
import json
import time
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, replace
from itertools import combinations_with_replacement, product
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation

from modelgen import ModelgenError, simulate
from modelgen.errors import SceneError
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Scene
from tests.benchmarks.measured_solids import Solid, depth
from tests.benchmarks.solids_by_decades import CURVES, KINDS, Endless, decades, seen
from tests.running import library_of

Array = np.ndarray[Any, Any]
G = 9.81
TRACED, DOUBLED, HALVED = 100, 60, 55  # steps towards a surface; of the way beyond it; of the bracket
HOLED = ("torus", "half_torus", "tube", "extrusion", "chart", "circle")  # or may be: not convex
STEEP, NOT_CONVEX = 0.02, 0.5  # least slope of a distance along a ray by which it is extrapolated
FACE, EDGE = 40, 200  # parts of a coordinate of a face, of an edge
ZOOMS, KEPT = 24, 3  # steps of refinement of as many places
TOLERANCE = 1e-8  # of the way fallen, against the radius of the body that falls and the way
ROUNDING = 1e-10  # the same against the radius of the fixed body, which may be a thousand times larger
DOWN = np.array([0.0, 0.0, -1.0])
ENDLESS = ("plane", "endless cylinder", "cone", "paraboloid", "bore")
FAILS = ("missed", "spurious", "refused")
TOLD = (*FAILS, "doubted")
HOLLOW = tuple(name for name in KINDS if name.startswith("hollow") or name == "bore")


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
        return not shape.cavity and shape.kind not in HOLED

    def points(self, x: Array) -> Array:
        found: Array = self.p + x @ self.R.T
        return found

    def distance(self, x: Array) -> Array:
        found: Array = self.solid.distance((x - self.p) @ self.R)
        return found


def ways(x: Array, towards: Placed, direction: Array, limit: float) -> Array:
    """How far each point moves along `direction` until it is in a solid, inf where that is not seen.

    The distance is extrapolated by its last change: not too far where it is convex along the ray.
    """
    shape, x = x.shape[:-1], x.reshape(-1, 3)
    least = STEEP if towards.is_convex else NOT_CONVEX
    s, scale = np.zeros(len(x)), max(min(towards.radius, limit), 1e-300)
    d, low = np.minimum(towards.distance(x), 2 * limit), np.zeros(len(x))
    step, going = np.maximum(d, 0), np.arange(len(x))
    for _ in range(TRACED):
        s[going] += step[going]
        before = d[going]
        d[going] = towards.distance(x[going] + s[going, None] * direction)
        outside = d[going] > 0
        low[going[outside]] = s[going[outside]]
        steepness = np.clip((before - d[going]) / np.maximum(step[going], 1e-300), least, 1)
        step[going] = np.maximum(d[going], 0) / steepness
        going = going[outside & (d[going] > 1e-14 * scale) & (d[going] < limit) & (s[going] <= limit)]
        if not len(going):
            break
    found = np.full(len(x), np.inf)
    open_ = np.flatnonzero((low <= limit) & (d < 0.05 * scale))
    step = np.maximum(s - low, np.maximum(d, 1e-14 * scale))
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
        middle = (a + b) / 2
        inside = towards.distance(x[hit] + middle[:, None] * direction) <= 0
        a, b = np.where(inside, a, middle), np.where(inside, middle, b)
    found[hit] = b
    return found.reshape(shape)


@dataclass(frozen=True)
class Side:
    """A face or an edge of one shape, and the way of its points into the other."""

    at: Callable[..., Array]  # of coordinates in [0, 1]
    own: Placed
    other: Placed
    direction: Array
    limit: float
    dimension: int

    def ways(self, w: Array) -> Array:
        """Of a point that does not meet the other shape more than the limit, the more the farther beside."""
        x = self.own.points(self.at(*np.moveaxis(w, -1, 0)))
        found = ways(x, self.other, self.direction, self.limit)
        beside = np.hypot(*np.moveaxis(x - self.other.p, -1, 0)[:2])
        return np.where(found < np.inf, found, 2 * self.limit + beside)

    def shortest(self, parts: int = 1) -> tuple[float, Array]:
        """On a grid; with the coordinates there, and those of the next best."""
        n = parts * (FACE if self.dimension == 2 else EDGE)
        grid = np.stack(np.meshgrid(*[np.linspace(0, 1, n + 1)] * self.dimension, indexing="ij"), -1)
        w = grid.reshape(-1, self.dimension)
        found = self.ways(w)
        order = np.argsort(found)
        chosen: list[int] = []
        for k in order:
            if len(chosen) == KEPT * parts:
                break
            if all(np.abs(w[k] - w[j]).max() > 2.5 / n for j in chosen):
                chosen.append(int(k))
        return float(found[order[0]]), w[chosen]

    def refined(self, w: Array, parts: int = 1) -> float:
        """The shortest way near rows of coordinates, by grids that close in on the best."""
        reach = np.full(len(w), 1.0 / (parts * (FACE if self.dimension == 2 else EDGE)))
        steps = np.stack(np.meshgrid(*[np.linspace(-1, 1, 7)] * self.dimension, indexing="ij"), -1)
        steps = steps.reshape(-1, self.dimension)
        for _ in range(ZOOMS):
            tries = np.clip(w[:, None] + reach[:, None, None] * steps, 0, 1)
            found = self.ways(tries)
            which = found.argmin(axis=1)
            w = tries[np.arange(len(w)), which]
            nearest = found.min(axis=1)
            reach = reach * np.where(np.abs(steps[which]).max(axis=1) > 0.9, 0.8, 0.45)
        first = nearest.argmin()
        least = float(nearest[first])
        return self.descended(w[first]) if parts > 1 and least < self.limit else least

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
            found += [Side(edge, own, other, direction, limit, 1) for edge in own.solid.edges]
    return found


def travel(moving: Placed, fixed: Placed, limit: float, parts: int = 1, most: int = 6) -> float:
    """How far the shape falls until it touches, m: no more than any overlap that was found."""
    looked = [(each, *each.shortest(parts)) for each in sides(moving, fixed, limit)]
    looked = sorted(looked, key=lambda each: each[1])
    return min((side.refined(w, parts) for side, _, w in looked[:most]), default=np.inf)


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
        return TOLERANCE * (self.moving.radius + self.way) + ROUNDING * large


def _rotation(rng: np.random.Generator) -> Array:
    x, y, z, w = rng.normal(size=4)
    return np.asarray(Rotation.from_quat([x, y, z, w]).as_matrix())


def _some_point(solid: Solid, rng: np.random.Generator) -> Array:
    parts = [(face, 2) for face in solid.faces] + [(edge, 1) for edge in solid.edges]
    if not parts:
        return np.append(rng.uniform(-1, 1, 2), 0.0)
    at, dimension = parts[rng.integers(len(parts))]
    found: Array = at(*rng.uniform(0, 1, dimension))
    return found


def draw(first: str, second: str, seed: int) -> Member | None:
    """A member; None where the two cannot be set up: both endless or hollow, or too long for the hollow."""
    names = list(KINDS)
    key = [names.index(first), names.index(second), seed]
    rng = np.random.default_rng(key)

    def made(name: str, size: float) -> Solid | Endless:
        return KINDS[name](np.random.default_rng([*key, names.index(name)]), size)

    if first in ENDLESS or (second not in ENDLESS and second not in HOLLOW and rng.integers(2)):
        first, second = second, first
    if first in HOLLOW or first in ENDLESS:
        return None
    one, size = seen(made(first, 1.0), 1.0), decades(rng, -3, 3)
    if second in HOLLOW:
        size = 3 * decades(rng, 0, 3) * max(one.size, 1e-3) / seen(made(second, 1.0), 1.0).inner
    return _set_up(one, seen(made(second, size), 10 * max(size, 1.0)), size, rng)


def _set_up(one: Solid, two: Solid, size: float, rng: np.random.Generator) -> Member | None:
    """The bodies at random orientations, above each other so that they meet; the body inside of a hollow."""
    small = min(x for x in (one.size, two.size if two.size < np.inf else size) if x > 0)
    for _ in range(30):
        fixed, moving = (Placed(each, _rotation(rng), np.zeros(3)) for each in (two, one))
        if two.cavity:
            off = rng.normal(size=3)
            off *= max(two.inner - 1.05 * one.size, 0.0) * rng.uniform(0, 0.9) / np.linalg.norm(off)
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
        way = travel(moving, fixed, limit)
        if way < limit:
            drop = min(small * decades(rng, -2, 0), way)
            start = replace(moving, p=moving.p + (way - drop) * DOWN)
            return Member(start, fixed, drop, limit)
    return None


def _scene(moving: Placed, fixed: Placed) -> Scene:
    def pose(at: Placed) -> dict[str, Any]:
        x, y, z, w = map(float, Rotation.from_matrix(at.R).as_quat())
        return {"position": [*map(float, at.p)], "quaternion": [w, x, y, z]}

    radius = moving.radius or 1.0
    body = make.dynamic(
        "body", moving.solid.shape, mass=1.0, inertia=[0.4 * radius**2] * 3, **pose(moving)
    )  # fmt: skip
    base = make.fixed("base", fixed.solid.shape, **pose(fixed))
    return make.scene("first-touch", [base, body], contact=[{"between": ["body", "base"]}])


@dataclass(frozen=True)
class Verdict:
    """What became of a member."""

    first: str
    second: str
    seed: int
    outcome: str  # right, missed, doubted (missed, and not trusted), spurious, refused, no pair, not set up
    error: float = 0.0  # m, of the way to the first touch
    told: str = ""
    wall: float = 0.0  # s

    @property
    def fails(self) -> bool:
        return self.outcome in FAILS


def judge(first: str, second: str, seed: int) -> Verdict:
    begun = time.perf_counter()
    member = draw(first, second, seed)
    if member is None:
        return Verdict(first, second, seed, "not set up")
    outcome, error, told = _judged(member)
    return Verdict(first, second, seed, outcome, error, told, time.perf_counter() - begun)


def _judged(member: Member) -> tuple[str, float, str]:
    try:
        library = library_of(member.scene)
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
        outcome = "doubted" if path.doubts else "not set up" if _do_overlap(member) else "missed"
        return outcome, error, told
    if error < -member.tolerance:
        again = travel(member.moving, member.fixed, member.limit, parts=4, most=100)
        error = G * touches[0].t ** 2 / 2 - min(again, member.way)
        if error < -member.tolerance:
            return "spurious", error, told
    return "right", error, ""


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
    for one, two in combinations_with_replacement(KINDS, 2):
        both = {one, two}
        if both <= {*CURVES} or both <= {*ENDLESS, *HOLLOW} or (kinds and not both & {*kinds}):
            continue
        yield one, two


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=50)
    parser.add_argument("--kinds", nargs="*", default=[])
    parser.add_argument("--part", default="0/1", help="k/n: every n-th pair, from the k-th")
    parser.add_argument("--out", type=Path)
    options = parser.parse_args()
    part, parts = map(int, options.part.split("/"))
    known: dict[tuple[str, str, int], Verdict] = {}
    if options.out and options.out.exists():
        for row in options.out.read_text().splitlines():
            verdict = Verdict(**json.loads(row))
            known[verdict.first, verdict.second, verdict.seed] = verdict
    verdicts = []
    for seed, (one, two) in product(range(options.count), list(pairs(options.kinds))[part::parts]):
        verdict = known.get((one, two, seed)) or judge(one, two, seed)
        verdicts.append(verdict)
        if verdict.outcome in TOLD:
            print(verdict, flush=True)
        if options.out and (one, two, seed) not in known:
            with options.out.open("a") as file:
                file.write(json.dumps(asdict(verdict)) + "\n")
    print(summary(verdicts))


def summary(verdicts: list[Verdict]) -> str:
    total = Counter(each.outcome for each in verdicts)
    table = [f"{sum(total.values())} members: " + ", ".join(f"{k} {n}" for k, n in total.most_common())]
    for one, two in sorted({(each.first, each.second) for each in verdicts if each.outcome in TOLD}):
        count = Counter(each.outcome for each in verdicts if (each.first, each.second) == (one, two))
        table.append(f"{one:>18} {two:<18} " + ", ".join(f"{k} {n}" for k, n in count.most_common()))
    return "\n".join(table)


if __name__ == "__main__":
    main()
