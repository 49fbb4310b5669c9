"""Seeded scenes of shapes that are not convex, with clearances by decades, judged by an independent distance.

    python -m tests.benchmarks.non_convex_scenes --first 0 --count 1000

Each seed draws two or three bodies: solids that fly at each other, fall on each other, or move in a
hollow, in a tube or on a post with a clearance of 1e-5 to 0.3 of their size. Dense points of the faces
and edges of each body, refined where they are deepest, are put into the signed distance of the other. A
run fails if it is `done` and trusted, and penetrates by more than TOLERANCE. One line for each seed that
fails or is not trusted, then a summary.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.spatial import ConvexHull

from modelgen import ModelgenError, simulate
from modelgen.rotations import rotation_of
from modelgen.runtime.trajectory import Outcome, Trajectory
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Scene, Shape
from tests.running import library_of

Array = np.ndarray[Any, Any]
TOLERANCE = 3e-6  # of the characteristic length; the polygon in place of a profile is as exact
TURN = 2 * np.pi
KINDS = ("fall", "flight", "hollow", "peg", "post")


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


def _stack(*columns: Any) -> Array:
    return np.stack(np.broadcast_arrays(*columns), axis=-1)


def ellipsoid(a: float, b: float, c: float, cavity: bool = False) -> Solid:
    axes, sign = np.array([a, b, c]), -1.0 if cavity else 1.0

    def distance(x: Array) -> Array:
        level = np.linalg.norm(x / axes, axis=-1)
        slope = np.linalg.norm(x / axes**2, axis=-1) / np.maximum(level, 1e-300)
        return sign * (level - 1) / np.maximum(slope, 1e-300)

    def face(u: Array, v: Array) -> Array:
        t, turn = np.pi * u, TURN * v
        return axes * _stack(np.sin(t) * np.cos(turn), np.sin(t) * np.sin(turn), np.cos(t))

    shape = make.ellipsoid(a, b, c, cavity=cavity)
    return Solid(shape, max(a, b, c), distance, [face], cavity=cavity, inner=min(a, b, c))


def torus(major: float, minor: float) -> Solid:
    def distance(x: Array) -> Array:
        return np.hypot(np.hypot(x[..., 0], x[..., 1]) - major, x[..., 2]) - minor

    def face(u: Array, v: Array) -> Array:
        r = major + minor * np.cos(TURN * v)
        return _stack(r * np.cos(TURN * u), r * np.sin(TURN * u), minor * np.sin(TURN * v))

    shape = make.torus(major, minor)
    return Solid(shape, major + minor, distance, [face], extra={"hole": major - minor, "half": minor})


def wavy_torus(major: float, minor: float, wave: float, skew: float) -> Solid:
    """A torus whose tube has a radius that depends on both angles; the distance is of first order."""
    text = "minor*(1 + wave*cos(3*u)*cos(2*v) + skew*sin(u + v))"

    def radius(u: Array, v: Array) -> Array:
        return minor * (1 + wave * np.cos(3 * u) * np.cos(2 * v) + skew * np.sin(u + v))

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
    t = np.linspace(0, np.pi, 4001)
    profile = np.stack(
        [radius * np.sin(t) * (1 + waist * np.cos(2 * t) + ripple * np.cos(4 * t)), -height * np.cos(t)],
        axis=1,
    )
    outside = _polygon_distance(np.vstack([profile, profile[::-1] * [-1, 1]]))
    sign = -1.0 if cavity else 1.0

    def distance(x: Array) -> Array:
        return sign * outside(_stack(np.hypot(x[..., 0], x[..., 1]), x[..., 2]))

    def face(u: Array, v: Array) -> Array:
        s = np.pi * u
        r = radius * np.sin(s) * (1 + waist * np.cos(2 * s) + ripple * np.cos(4 * s))
        return _stack(r * np.cos(TURN * v), r * np.sin(TURN * v), -height * np.cos(s))

    shape = make.revolution(
        "radius*sin(t)*(1 + waist*cos(2*t) + ripple*cos(4*t))", "-height*cos(t)", domain=[0.0, float(np.pi)],
        parameters={"radius": radius, "height": height, "waist": waist, "ripple": ripple}, cavity=cavity,
    )  # fmt: skip
    size = float(np.linalg.norm(profile, axis=1).max())
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
    flat, half = _polygon_distance(outline), length / 2

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


def hull(rng: np.random.Generator, size: float) -> Solid:
    """The convex hull of ten points."""
    x = size * _unit(rng.normal(size=(10, 3)))
    found = ConvexHull(x)
    planes, corners = found.equations, x[found.vertices]

    def distance(at: Array) -> Array:
        return (at @ planes[:, :3].T + planes[:, 3]).max(axis=-1)

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


def _polygon_distance(outline: Array) -> Callable[[Array], Array]:
    """Signed distance from a polygon in the plane, positive outside."""
    from matplotlib.path import Path as Outline
    from scipy.spatial import cKDTree

    start, end = outline, np.roll(outline, -1, axis=0)
    area, count = Outline(np.vstack([outline, outline[:1]])), len(outline)
    near = cKDTree(outline) if count > 100 else None

    def distance(x: Array) -> Array:
        flat = x.reshape(-1, 2)
        if near is None:
            which = np.broadcast_to(np.arange(count), (len(flat), count))
        else:
            nearest = near.query(flat)[1]
            which = (nearest[:, None] + np.arange(-2, 2)) % count
        a, b = start[which], end[which]
        along = b - a
        part = ((flat[:, None] - a) * along).sum(-1) / np.maximum((along**2).sum(-1), 1e-300)
        foot = a + np.clip(part, 0, 1)[..., None] * along
        depth = np.linalg.norm(flat[:, None] - foot, axis=-1).min(axis=1)
        return np.where(area.contains_points(flat), -depth, depth).reshape(x.shape[:-1])

    return distance


def _unit(x: Array) -> Array:
    return np.asarray(x / np.linalg.norm(x, axis=-1, keepdims=True))


def random_solid(rng: np.random.Generator, size: float) -> Solid:
    """A solid of about this size."""
    r = size * rng.uniform(0.5, 1)
    match rng.integers(6):
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
        case _:
            return hull(rng, r)


@dataclass(frozen=True)
class Drawn:
    """A scene and the solids of its bodies."""

    scene: Scene
    solids: dict[str, Solid]
    kind: str
    clearance: float  # of the size


def _moving(name: str, solid: Solid, rng: np.random.Generator, at: Array, v: float, w: float) -> Any:
    mass = 1.0
    inertia = mass * solid.size**2 * rng.uniform(0.3, 0.4, size=3)
    return make.dynamic(
        name, solid.shape, mass=mass, inertia=[*map(float, inertia)], position=[*map(float, at)],
        quaternion=[*map(float, _unit(rng.normal(size=4)))],
        velocity=[*map(float, v * rng.normal(size=3))],
        angular_velocity=[*map(float, w * rng.normal(size=3))],
    )  # fmt: skip


def draw(seed: int) -> Drawn:
    """The scene of a seed."""
    rng = np.random.default_rng(seed)
    kind, size = KINDS[seed % len(KINDS)], float(10 ** rng.uniform(-2, 1))
    clearance = float(10 ** rng.uniform(-5, -0.5))
    speed = float(np.sqrt(9.81 * size))
    spin, gravity = speed / size, [0.0, 0.0, -9.81]
    contact = {"restitution": float(rng.choice([0.0, 0.5, 0.8])), "friction": float(rng.choice([0.0, 0.3]))}
    if kind == "fall":
        a, b = random_solid(rng, size), random_solid(rng, size)
        bodies = [
            make.fixed("floor", floor().shape),
            _moving("a", a, rng, np.array([0, 0, 1.3 * a.size]), speed / 3, spin),
            _moving("b", b, rng, np.array([0, 0, 2.6 * a.size + 1.4 * b.size]), speed / 3, spin),
        ]
        solids, pairs = {"floor": floor(), "a": a, "b": b}, [("a", "floor"), ("b", "floor"), ("a", "b")]
    elif kind == "flight":
        a, b = random_solid(rng, size), random_solid(rng, size)
        away = _unit(rng.normal(size=3)) * (a.size + b.size) * 1.1
        bodies = [
            _moving("a", a, rng, np.zeros(3), 0.1 * speed, spin),
            make.dynamic(
                "b", b.shape, mass=1.0, inertia=[0.35 * b.size**2] * 3, position=[*map(float, away)],
                velocity=[*map(float, -away / np.linalg.norm(away) * 2 * speed)],
                angular_velocity=[*map(float, spin * rng.normal(size=3))],
            ),
        ]  # fmt: skip
        gravity, solids, pairs = [0.0, 0.0, 0.0], {"a": a, "b": b}, [("a", "b")]
    elif kind == "hollow":
        if rng.random() < 0.5:
            b = ellipsoid(*map(float, size * rng.uniform(1, 2, size=3)), cavity=True)
        else:
            b = turned(
                size, size * rng.uniform(0.8, 1.5), rng.uniform(0.1, 0.4), rng.uniform(-0.05, 0.05), True
            )
        a = _fitting(seed, b.inner * (1 - clearance))
        bodies = [make.fixed("b", b.shape), _moving("a", a, rng, np.zeros(3), speed, spin)]
        solids, pairs = {"a": a, "b": b}, [("a", "b")]
    elif kind == "peg":
        bore = size * rng.uniform(0.5, 1)
        b = tube(bore * 1.4, bore, 4 * size)
        half = size * rng.uniform(0.3, 1)
        a = tube(bore * (1 - clearance), 0.0, 2 * half)
        lean = rng.uniform(0, 0.4) * clearance * bore / half
        way = rng.uniform(0, TURN)
        drift = clearance * bore * spin
        peg = make.dynamic(
            "a", a.shape, mass=1.0, inertia=[0.3 * a.size**2] * 3,
            axis_angle={"axis": [float(np.cos(way)), float(np.sin(way)), 0.0], "angle": float(lean)},
            velocity=[*map(float, drift * rng.normal(size=2)), 0.0],
            angular_velocity=[*map(float, rng.normal(size=3) * [*[0.3 * drift / half] * 2, spin])],
        )  # fmt: skip
        bodies, solids, pairs = [make.fixed("b", b.shape), peg], {"a": a, "b": b}, [("a", "b")]
        gravity = [0.0, 0.0, 0.0]
    else:
        ring = torus(size, size * rng.uniform(0.1, 0.4)) if rng.random() < 0.5 else tube(
            size * 1.3, size * rng.uniform(0.4, 0.9), size * rng.uniform(0.2, 0.6)
        )  # fmt: skip
        post = tube(ring.extra["hole"] * (1 - clearance), 0.0, 6 * size)
        drift = clearance * size * spin
        loose = make.dynamic(
            "a", ring.shape, mass=1.0, inertia=[0.3 * ring.size**2] * 3,
            velocity=[*map(float, drift * rng.normal(size=2)), 0.0],
            angular_velocity=[*map(float, rng.normal(size=3) * [*[0.3 * drift / size] * 2, spin])],
        )  # fmt: skip
        bodies, solids, pairs = [make.fixed("b", post.shape), loose], {"a": ring, "b": post}, [("a", "b")]
        gravity = [0.0, 0.0, 0.0]
    scene = make.scene(
        f"seed_{seed}", bodies, gravity=gravity,
        contact=[{"between": list(pair), **contact} for pair in pairs],
        run={"until": 3.0 / spin, "accuracy": str(rng.choice(["fast", "balanced", "tight"]))},
    )  # fmt: skip
    return Drawn(scene, solids, kind, clearance)


def _fitting(seed: int, size: float) -> Solid:
    """A random solid that fits into a ball of this radius."""
    first = random_solid(np.random.default_rng(seed + 10**6), 1.0)
    again = random_solid(np.random.default_rng(seed + 10**6), size / first.size)
    return again if again.size <= size * (1 + 1e-9) else ellipsoid(size, size * 0.7, size * 0.5)


def depth(points_of: Solid, other: Solid, p: Array, R: Array) -> float:
    """Deepest penetration of points of one solid, at (p, R) in the axes of the other, m; negative: apart."""
    deepest = -np.inf
    n = 48

    def of(x: Array) -> Array:
        return -other.distance(p + x @ R.T)

    for face in points_of.faces:
        u, v = (g.ravel() for g in np.meshgrid(*[(np.arange(n) + 0.5) / n] * 2, indexing="ij"))
        deep = of(face(u, v))
        best = np.argsort(deep)[-12:]
        u, v, step, deep = u[best], v[best], np.full(len(best), 1 / n), deep[best]
        offsets = np.stack(np.meshgrid([-1, 0, 1], [-1, 0, 1], indexing="ij"), -1).reshape(-1, 2)
        for _ in range(40):
            tries = of(face(np.clip(u[:, None] + step[:, None] * offsets[:, 0], 0, 1),
                            v[:, None] + step[:, None] * offsets[:, 1]))  # fmt: skip
            which = tries.argmax(axis=1)
            u = np.clip(u + step * offsets[which, 0], 0, 1)
            v = v + step * offsets[which, 1]
            step = np.where(which == 4, step / 2, step)
        deepest = max(deepest, float(of(face(u, v)).max()))
    for edge in points_of.edges:
        t = np.linspace(0, 1, 241)
        deep = of(edge(t))
        best = np.argsort(deep)[-6:]
        t, step = t[best], np.full(len(best), 1 / 240)
        for _ in range(40):
            tries = of(edge(np.clip(t[:, None] + step[:, None] * np.array([-1, 0, 1]), 0, 1)))
            which = tries.argmax(axis=1)
            t = np.clip(t + step * (which - 1), 0, 1)
            step = np.where(which == 1, step / 2, step)
        deepest = max(deepest, float(of(edge(t)).max()))
    return deepest


def penetration(drawn: Drawn, path: Trajectory) -> tuple[float, float]:
    """Deepest penetration over the samples of all pairs (m), and its time."""
    names = path.body_names
    rotations = {
        name: [rotation_of(tuple(map(float, q))) for q in path.quaternion[:, names.index(name)]]
        for name in names
    }
    worst = (-np.inf, 0.0)
    for pair in drawn.scene.contacts:
        first, second = (each[0] for each in pair.between)
        for points, other in ((first, second), (second, first)):
            solid, into = drawn.solids[points], drawn.solids[other]
            for k, t in enumerate(path.t):
                Ro, Rp = rotations[other][k], rotations[points][k]
                p = Ro.T @ (path.p[k, names.index(points)] - path.p[k, names.index(other)])
                if np.linalg.norm(p) > solid.size + into.size and into.size and not into.cavity:
                    continue
                found = depth(solid, into, p, Ro.T @ Rp)
                if found > worst[0]:
                    worst = (found, float(t))
    return worst


@dataclass(frozen=True)
class Verdict:
    """What became of a seed."""

    seed: int
    kind: str
    clearance: float
    outcome: str
    doubts: tuple[str, ...]
    deepest: float  # of the characteristic length
    at: float  # s
    told: float  # of the characteristic length: what the run says of itself
    cost: float  # s
    steps: int

    @property
    def fails(self) -> bool:
        return self.outcome == "DONE" and not self.doubts and not self.deepest <= TOLERANCE

    def __str__(self) -> str:
        state = "FAILS" if self.fails else "trusted" if self.outcome == "DONE" and not self.doubts else "told"
        return (
            f"{state} {self.seed} {self.kind} clearance {self.clearance:.0e} {self.outcome} "
            f"deepest {self.deepest:.1e} at {self.at:.4g} s, told {self.told:.1e}, {self.steps} steps, "
            f"{self.cost:.1f} s {'; '.join(self.doubts)}"
        )


def judge(seed: int, samples: int = 40) -> Verdict:
    """Runs and judges one seed."""
    drawn = draw(seed)
    begun = time.process_time()
    try:
        library = library_of(drawn.scene)
        length = library.manifest.instance["scales"]["length"]
        path = simulate(library, samples=samples, estimate=False)
    except ModelgenError as refused:
        return Verdict(seed, drawn.kind, drawn.clearance, "REFUSED", (str(refused),), 0, 0, 0, 0, 0)
    cost = time.process_time() - begun
    deepest, at = penetration(drawn, path)
    return Verdict(
        seed, drawn.kind, drawn.clearance, path.outcome.name, path.doubts, deepest / length, at,
        path.penetration_max / length, cost, path.steps,
    )  # fmt: skip


def main() -> None:
    """Judges the seeds."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--all", action="store_true", help="a line for each seed")
    given = parser.parse_args()
    verdicts = []
    for seed in range(given.first, given.first + given.count):
        verdict = judge(seed)
        verdicts.append(verdict)
        if given.all or verdict.fails or verdict.outcome != "DONE" or verdict.doubts:
            print(verdict, flush=True)
    failed = [each.seed for each in verdicts if each.fails]
    trusted = sum(each.outcome == Outcome.DONE.name and not each.doubts for each in verdicts)
    print(f"{len(verdicts)} scenes, {trusted} trusted, {len(failed)} of them penetrate: {failed}")
    sys.exit(bool(failed))


if __name__ == "__main__":
    main()
