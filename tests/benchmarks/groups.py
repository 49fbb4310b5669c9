"""Bodies of six shapes dropped into a box, with no pair listed: what a group of contacts costs.

Run with `python -m tests.benchmarks.groups [--seeds 50 [--first 0] [--out FILE]] [--shapes torus,dome]`.
The first run takes all pairs as candidates (`[contacts]` with `between = "all"`); the second lists the
pairs that met in the first; least CPU time of some rounds that alternate. With --seeds, so many groups are
dropped instead, and the deepest penetration of any two bodies in the samples of each run is told by an
independent distance: the largest gap along a direction, by support functions in closed form (the normals
of the run are tried first: any direction proves a least gap); of tori from points of their centre circles.
Results are added to FILE, and seeds that it holds are not run again.
"""

from __future__ import annotations

import json
from argparse import ArgumentParser
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time
from typing import Any

import numpy as np
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation

from modelgen import build, derive, emit, require, simulate
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Body, Scene, Shape

UNTIL, STEP = 1.0, 1e-3  # s
BODIES, ROUNDS = 20, 3
PROVED = 1e-10  # m; any direction along which bodies penetrate less proves that they do
HALF = 0.3  # m, of the box
RING = 180  # points of a centre circle from which a distance is refined
TITLES = ("pairs", "pairs that met", "CPU s", "penetration (m)", "energy drift", "outcome")
SHAPES: Mapping[str, Callable[[], Shape]] = {
    "sphere": lambda: make.sphere(0.06),
    "ellipsoid": lambda: make.ellipsoid(0.08, 0.06, 0.05),
    "oblate": lambda: make.ellipsoid(0.08, 0.08, 0.04),
    "prolate": lambda: make.ellipsoid(0.09, 0.05, 0.05),
    "capsule": lambda: make.capsule(0.04, 0.08),
    "pill": lambda: make.capsule(0.05, 0.03),
    "superellipsoid": lambda: make.superellipsoid(0.07, 0.06, 0.05, 2.5, 2.5),
    "dome": lambda: make.dome(0.07, 0.06),
    "cylinder": lambda: make.cylinder(0.05, 0.08),
    "frustum": lambda: make.frustum(0.06, 0.04, 0.07),
    "torus": lambda: make.torus(0.055, 0.02),
    "box": lambda: make.box(0.1, 0.08, 0.06),
}
SIX = "sphere,ellipsoid,oblate,prolate,capsule,pill"


def dropped(shapes: Iterable[str], bodies: int = BODIES, seed: int = 0) -> list[Body]:
    """Bodies above the floor of a box of five planes, in layers."""
    rng, named = np.random.default_rng(seed), list(shapes)
    turned = {
        "east": [0.0, -90.0, 0.0],
        "west": [0.0, 90.0, 0.0],
        "north": [90.0, 0.0, 0.0],
        "south": [-90.0, 0.0, 0.0],
    }
    at = {
        "east": [HALF, 0.0, 0.0],
        "west": [-HALF, 0.0, 0.0],
        "north": [0.0, HALF, 0.0],
        "south": [0.0, -HALF, 0.0],
    }
    walls = [make.fixed("floor", make.plane())]
    walls += [
        make.fixed(name, make.plane(), position=at[name], rpy=[float(a) for a in np.radians(turned[name])])
        for name in at
    ]
    moving = []
    for k in range(bodies):
        layer, place = divmod(k, 9)
        x, y = 0.19 * (place % 3 - 1), 0.19 * (place // 3 - 1)
        moving.append(
            make.dynamic(
                f"body{k}",
                SHAPES[named[k % len(named)]](),
                density=500.0,
                position=[x, y, 0.12 + 0.2 * layer],
                rpy=[float(a) for a in rng.uniform(-1, 1, 3)],
            )
        )
    return [*walls, *moving]


def group(bodies: list[Body]) -> Scene:
    return make.scene("group", bodies, contacts={"between": "all", "friction": 0.3})


def listing(bodies: list[Body], pairs: list[tuple[str, str]]) -> Scene:
    return make.scene("listing", bodies, contact=[{"between": list(pair), "friction": 0.3} for pair in pairs])


@dataclass(frozen=True)
class Ran:
    path: Trajectory
    seconds: float  # CPU
    centres: Mapping[str, np.ndarray]  # of mass, m, in the axes of each body


def run(scene: Scene, folder: str | Path) -> Ran:
    library = build(emit(derive(require(scene))), folder=f"{folder}/{scene.name}")
    centres = {body["name"]: np.array(body["centre_of_mass"]) for body in library.manifest.instance["bodies"]}
    begun = process_time()
    path = simulate(library, until=UNTIL, samples=50, estimate=False, method="time-stepping", step=STEP)
    return Ran(path, process_time() - begun, centres)


def met(path: Trajectory, scene: Scene) -> list[tuple[str, str]]:
    """The pairs that carried force at an event or a sample."""
    names = {
        event.contact.partition("#")[0].partition(":")[0]
        for event in path.events
        if event.kind in ("impact", "touch-down")
    }
    pairs = [(pair.between[0][0], pair.between[1][0]) for pair in scene.contacts]
    return [pair for pair in pairs if "-".join(pair) in names or "-".join(reversed(pair)) in names]


Support = Callable[[np.ndarray], float]  # of a body at its place: the largest x.n over its points x


def support_of(shape: Shape) -> Support:
    """That of a shape of SHAPES about its own origin, of unit n, in closed form."""
    numbers: dict[str, Any] = dict(shape.parameters)
    values = np.array(list(numbers.values()))
    match shape.kind:
        case "sphere":
            return lambda n: float(values[0])
        case "ellipsoid":
            return lambda n: float(np.linalg.norm(values * n))
        case "capsule":
            return lambda n: float(numbers["radius"] + numbers["length"] / 2 * abs(n[2]))
        case "cylinder":
            return lambda n: float(
                numbers["radius"] * np.hypot(n[0], n[1]) + numbers["length"] / 2 * abs(n[2])
            )
        case "frustum":
            return lambda n: float(
                max(
                    numbers["radius_bottom"] * np.hypot(n[0], n[1]) - numbers["length"] / 2 * n[2],
                    numbers["radius_top"] * np.hypot(n[0], n[1]) + numbers["length"] / 2 * n[2],
                )
            )
        case "torus":
            return lambda n: float(numbers["major"] * np.hypot(n[0], n[1]) + numbers["minor"])
        case "box":
            return lambda n: float(np.abs(values / 2 * n).sum())
        case "dome":
            return lambda n: _dome(float(numbers["radius"]), float(numbers["length"]), n)
        case "superellipsoid":
            P, Q = values[3] / (values[3] - 1), values[4] / (values[4] - 1)
            return lambda n: float(
                (np.sum(np.abs(values[:2] * n[:2]) ** P) ** (Q / P) + abs(values[2] * n[2]) ** Q) ** (1 / Q)
            )
    raise ValueError(shape.kind)


def _dome(radius: float, length: float, n: np.ndarray) -> float:
    """Of the part of a ball above z = 0, whose centre is at length - radius."""
    centre = length - radius
    if centre + radius * n[2] >= 0:
        return float(centre * n[2] + radius)
    return float(np.sqrt(radius**2 - centre**2) * np.hypot(n[0], n[1]))


@dataclass(frozen=True)
class Placed:
    """A body at its place."""

    support: Support
    centre: np.ndarray  # of mass
    ring: Callable[[float], np.ndarray] | None  # of a torus: a point of its centre circle, by the angle
    thickness: float  # of a torus: its minor radius


def placed(body: Body, centre: np.ndarray, place: np.ndarray, turn: Rotation) -> Placed:
    (shape,) = body.shapes
    matrix, own = turn.as_matrix(), support_of(shape)
    origin = place - matrix @ centre
    numbers = dict(shape.parameters)
    if shape.kind != "torus":
        return Placed(lambda n: float(origin @ n + own(matrix.T @ n)), place, None, 0.0)
    R = float(numbers["major"])
    ring = lambda angle: origin + matrix @ np.array([R * np.cos(angle), R * np.sin(angle), 0.0])  # noqa: E731
    return Placed(lambda n: float(origin @ n + own(matrix.T @ n)), place, ring, float(numbers["minor"]))


def separation(one: Support, other: Support, guesses: Iterable[np.ndarray]) -> float:
    """The largest gap of two convex bodies along a direction, m; negative where they penetrate. The guesses
    are directions from one to the other; any direction proves a least gap."""
    units = [guess / np.linalg.norm(guess) for guess in guesses]
    guess = min(units, key=lambda n: one(n) + other(-n))
    if one(guess) + other(-guess) < PROVED:
        return -(one(guess) + other(-guess))
    normal = guess / np.linalg.norm(guess)
    tangents = np.linalg.svd(normal[None])[2][1:]

    def closeness(at: np.ndarray) -> float:
        n = normal + at @ tangents
        n /= np.linalg.norm(n)
        return one(n) + other(-n)

    at = minimize(closeness, np.zeros(2), method="BFGS", options={"gtol": 1e-10}).x
    for size in (1e-2, 1e-4, 1e-6):  # where edges touch, there is a kink
        if closeness(at) < PROVED:
            break
        simplex = at + size * np.array([[0, 0], [1, 0], [0, 1]])
        options = {"initial_simplex": simplex, "xatol": 1e-11, "fatol": 1e-14, "maxfev": 400}
        at = minimize(closeness, at, method="Nelder-Mead", options=options).x
    return -closeness(at)


def gap(one: Placed, other: Placed, guesses: Iterable[np.ndarray]) -> float:
    """The distance of two bodies; negative where they penetrate. `guesses`: normals from one to the other."""
    along = other.centre - one.centre
    if one.support(along / np.linalg.norm(along)) + other.support(-along / np.linalg.norm(along)) <= 0:
        return 0.0  # the plane between the centres parts them
    whole = separation(one.support, other.support, [along, *guesses])
    if whole > -PROVED or (one.ring is None and other.ring is None):
        return whole
    if one.ring is not None and other.ring is not None:
        return _circles(one.ring, other.ring) - one.thickness - other.thickness
    if one.ring is not None:
        return _to_circle(other, one.ring) - one.thickness
    assert other.ring is not None
    return _to_circle(one, other.ring) - other.thickness


def _to_circle(solid: Placed, circle: Callable[[float], np.ndarray]) -> float:
    return _least(lambda angle: _to_point(solid, circle(angle)))


def _to_point(solid: Placed, point: np.ndarray) -> float:
    return separation(solid.support, lambda n: float(point @ n), [point - solid.centre])


def _circles(one: Callable[[float], np.ndarray], other: Callable[[float], np.ndarray]) -> float:
    """The distance of two circles."""
    angles = np.linspace(0, 2 * np.pi, RING, endpoint=False)
    both = [np.array([ring(a) for a in angles]) for ring in (one, other)]
    apart = np.linalg.norm(both[0][:, None] - both[1][None], axis=2)
    i, k = np.unravel_index(int(apart.argmin()), apart.shape)
    least = minimize(
        lambda at: float(np.sum((one(at[0]) - other(at[1])) ** 2)),
        np.array([angles[i], angles[k]]), method="BFGS",
    )  # fmt: skip
    return float(np.sqrt(least.fun))


def _least(distance: Callable[[float], float]) -> float:
    angles = np.linspace(0, 2 * np.pi, RING // 4, endpoint=False)
    values = [distance(angle) for angle in angles]
    begin = float(angles[int(np.argmin(values))])
    width = float(angles[1])
    simplex = np.array([[begin], [begin + width / 2]])
    options = {"initial_simplex": simplex, "xatol": 1e-9, "fatol": 1e-13}
    found = minimize(lambda at: distance(float(at[0])), [begin], method="Nelder-Mead", options=options)
    return float(found.fun)


def deepest(ran: Ran, bodies: list[Body]) -> float:
    """The deepest penetration in the samples of a run, m."""
    path = ran.path
    moving = [body for body in bodies if body.motion == "dynamic"]
    at = [path.body_names.index(body.name) for body in moving]
    depth = 0.0
    bodies_of = [tuple(name.partition("#")[0].partition(":")[0].split("-")) for name in path.contact_names]
    for sample, (p, q) in enumerate(zip(path.p, path.quaternion, strict=True)):
        normals: dict[tuple[str, ...], list[np.ndarray]] = {}
        for k in np.flatnonzero(path.feature_pair[sample] >= 0):
            N = path.normals[sample, k]
            for n in (N, -N) if np.isfinite(N).all() else ():
                normals.setdefault(bodies_of[k], []).append(n)
        turns = Rotation.from_quat(q[at][:, [1, 2, 3, 0]])
        shapes = [
            placed(body, ran.centres[body.name], p[k], turn)
            for body, k, turn in zip(moving, at, turns, strict=True)
        ]
        for shape in shapes:
            walls = [
                shape.support(np.array(n)) - HALF for n in ([1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0])
            ]
            depth = max(depth, shape.support(np.array([0, 0, -1.0])), *walls)
        names = [body.name for body in moving]
        for (one, a), (other, b) in combinations(zip(shapes, names, strict=True), 2):
            guesses = [*normals.get((a, b), []), *normals.get((b, a), [])]
            depth = max(depth, -gap(one, other, guesses))
    return depth


def seeds(taken: Iterable[int], shapes: list[str], out: Path | None) -> None:
    """Penetrations of groups, with bodies turned by different seeds."""
    known: dict[int, dict[str, Any]] = {}
    if out and out.exists():
        known = {each["seed"]: each for each in map(json.loads, out.read_text().splitlines())}
    print("| seed | outcome | end (s) | penetration_max (m) | independent (m) | CPU s |\n" + "|---" * 6 + "|")
    with TemporaryDirectory() as folder:
        for seed in taken:
            each = known.get(seed)
            if each is None:
                bodies = dropped(shapes, seed=seed)
                ran = run(group(bodies), folder)
                each = {
                    "seed": seed, "outcome": ran.path.outcome.name, "end": float(ran.path.t[-1]),
                    "penetration_max": ran.path.penetration_max, "independent": deepest(ran, bodies),
                    "seconds": ran.seconds,
                }  # fmt: skip
                if out:
                    with out.open("a") as file:
                        file.write(json.dumps(each) + "\n")
            depths = f"{each['penetration_max']:.1e} | {each['independent']:.1e}"
            line = f"| {seed} | {each['outcome']} | {each['end']:.3g} | {depths} | {each['seconds']:.2f} |"
            print(line, flush=True)


def costs(shapes: list[str]) -> None:
    """The group beside its listed pairs."""
    print(f"| {' | '.join(TITLES)} |\n{'|---' * len(TITLES)}|", flush=True)
    with TemporaryDirectory() as folder:
        bodies = dropped(shapes)
        whole = group(bodies)
        pairs = met(run(whole, folder).path, whole)
        scenes = whole, listing(bodies, pairs)
        rounds = [[run(scene, folder) for scene in scenes] for _ in range(ROUNDS)]
        least = [min(each[k].seconds for each in rounds) for k in range(len(scenes))]
        for scene, seconds, ran in zip(scenes, least, rounds[0], strict=True):
            path = ran.path
            cells = (
                *(f"{len(scene.contacts)}", f"{len(pairs)}", f"{seconds:.2f}", f"{path.penetration_max:.1e}"),
                *(f"{path.energy_drift:.1e}", path.outcome.name),
            )
            print(f"| {' | '.join(cells)} |", flush=True)
        print(f"ratio {least[0] / least[1]:.2f}")


def main() -> None:
    parser = ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=0)
    parser.add_argument("--first", type=int, default=0, help="the first of the seeds")
    parser.add_argument("--out", type=Path)
    parser.add_argument("--shapes", default=SIX, help=f"of {', '.join(SHAPES)}")
    given = parser.parse_args()
    shapes = given.shapes.split(",")
    if given.seeds:
        seeds(range(given.first, given.first + given.seeds), shapes, given.out)
    else:
        costs(shapes)


if __name__ == "__main__":
    main()
