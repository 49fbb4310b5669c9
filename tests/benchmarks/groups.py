"""Bodies of six shapes dropped into a box, with no pair listed: what a group of contacts costs.

Run with `python -m tests.benchmarks.groups [--seeds 50]`. The first run takes all pairs as candidates
(`[contacts]` with `between = "all"`); the second lists the pairs that met in the first. With --seeds, so many
groups are dropped instead, and the deepest penetration of any two bodies in the samples of each run is told
by an independent distance: the largest gap along a direction, by support functions in closed form.
"""

from __future__ import annotations

from argparse import ArgumentParser
from collections.abc import Callable
from itertools import combinations
from tempfile import TemporaryDirectory
from time import process_time

import numpy as np
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation

from modelgen import build, derive, emit, require, simulate
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Body, Scene

UNTIL, STEP = 1.0, 1e-3  # s
BODIES = 20
PROVED = 1e-10  # m; any direction along which bodies penetrate less proves that they do
HALF = 0.3  # m, of the box
TITLES = ("pairs", "pairs that met", "CPU s", "penetration (m)", "energy drift", "outcome")
SHAPES = (
    lambda: make.sphere(0.06),
    lambda: make.ellipsoid(0.08, 0.06, 0.05),
    lambda: make.ellipsoid(0.08, 0.08, 0.04),
    lambda: make.ellipsoid(0.09, 0.05, 0.05),
    lambda: make.capsule(0.04, 0.08),
    lambda: make.capsule(0.05, 0.03),
)


def dropped(bodies: int = BODIES, seed: int = 0) -> list[Body]:
    """Bodies above the floor of a box of five planes, in layers."""
    rng = np.random.default_rng(seed)
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
                SHAPES[k % len(SHAPES)](),
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


def met(path: Trajectory, scene: Scene) -> list[tuple[str, str]]:
    """The pairs that carried force at an event or a sample."""
    names = {
        event.contact.partition("#")[0].partition(":")[0]
        for event in path.events
        if event.kind in ("impact", "touch-down")
    }
    pairs = [(pair.between[0][0], pair.between[1][0]) for pair in scene.contacts]
    return [pair for pair in pairs if "-".join(pair) in names or "-".join(reversed(pair)) in names]


def run(scene: Scene, folder: str) -> tuple[Trajectory, float]:
    library = build(emit(derive(require(scene))), folder=f"{folder}/{scene.name}")
    begun = process_time()
    path = simulate(library, until=UNTIL, samples=50, estimate=False, method="time-stepping", step=STEP)
    return path, process_time() - begun


Support = Callable[[np.ndarray], float]  # of a body at its place: the largest x.n over its points x


def support(body: Body, place: np.ndarray, turn: Rotation) -> Support:
    """That of a shape of SHAPES, in closed form."""
    (shape,) = body.shapes
    numbers = dict(shape.parameters)
    if shape.kind == "capsule":
        axis = turn.apply([0.0, 0.0, numbers["length"] / 2])
        return lambda n: float(place @ n + abs(axis @ n) + numbers["radius"])
    sizes = np.array([numbers["radius"]] * 3 if shape.kind == "sphere" else list(numbers.values()))
    matrix = (turn.as_matrix() * sizes) @ turn.as_matrix().T
    return lambda n: float(place @ n + np.linalg.norm(matrix @ n))


def separation(one: Support, other: Support, guess: np.ndarray) -> float:
    """The largest gap of two convex bodies along a direction, m; negative where they penetrate."""
    normal = guess / np.linalg.norm(guess)
    tangents = np.linalg.svd(normal[None])[2][1:]

    def closeness(at: np.ndarray) -> float:
        n = normal + at @ tangents
        n /= np.linalg.norm(n)
        return one(n) + other(-n)

    at = minimize(closeness, np.zeros(2), method="BFGS", options={"gtol": 1e-10}).x
    for size in (1e-2, 1e-4, 1e-6):  # two capsules that lie across each other have a kink there
        if closeness(at) < PROVED:
            break
        simplex = at + size * np.array([[0, 0], [1, 0], [0, 1]])
        options = {"initial_simplex": simplex, "xatol": 1e-11, "fatol": 1e-14, "maxfev": 400}
        at = minimize(closeness, at, method="Nelder-Mead", options=options).x
    return -closeness(at)


def deepest(path: Trajectory, bodies: list[Body]) -> float:
    """The deepest penetration in the samples of a run, m."""
    moving = [body for body in bodies if body.motion == "dynamic"]
    at = [path.body_names.index(body.name) for body in moving]
    depth = 0.0
    for p, q in zip(path.p, path.quaternion, strict=True):
        turns = Rotation.from_quat(q[at][:, [1, 2, 3, 0]])
        shapes = [support(body, p[k], turn) for body, k, turn in zip(moving, at, turns, strict=True)]
        for shape in shapes:
            walls = [shape(np.array(n)) - HALF for n in ([1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0])]
            depth = max(depth, shape(np.array([0, 0, -1.0])), *walls)
        for (one, a), (other, b) in combinations(zip(shapes, at, strict=True), 2):
            along = p[b] - p[a]
            if one(along) + other(-along) > 0:  # else the plane between the centres parts them
                depth = max(depth, -separation(one, other, along))
    return depth


def seeds(count: int) -> None:
    """Penetrations of groups, with bodies turned by different seeds."""
    print(
        "| seed | outcome | penetration_max (m) | independent (m) | CPU s |\n|---|---|---|---|---|",
        flush=True,
    )
    with TemporaryDirectory() as folder:
        for seed in range(count):
            bodies = dropped(seed=seed)
            path, spent = run(group(bodies), folder)
            cells = f"{path.penetration_max:.1e} | {deepest(path, bodies):.1e} | {spent:.2f}"
            print(f"| {seed} | {path.outcome.name} | {cells} |", flush=True)


def main() -> None:
    parser = ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=0)
    count = parser.parse_args().seeds
    if count:
        seeds(count)
        return
    print(f"| {' | '.join(TITLES)} |\n{'|---' * len(TITLES)}|", flush=True)
    with TemporaryDirectory() as folder:
        bodies = dropped()
        whole = group(bodies)
        path, spent = run(whole, folder)
        pairs = met(path, whole)
        for scene in (whole, listing(bodies, pairs)):
            if scene is not whole:
                path, spent = run(scene, folder)
            cells = (
                *(f"{len(scene.contacts)}", f"{len(pairs)}", f"{spent:.2f}", f"{path.penetration_max:.1e}"),
                *(f"{path.energy_drift:.1e}", path.outcome.name),
            )
            print(f"| {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main()
