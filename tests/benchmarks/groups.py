"""Bodies of six shapes dropped into a box, with no pair listed: what a group of contacts costs.

Run with `python -m tests.benchmarks.groups`. The first run takes all pairs as candidates (`[contacts]` with
`between = "all"`); the second lists the pairs that met in the first.
"""

from __future__ import annotations

from tempfile import TemporaryDirectory
from time import process_time

import numpy as np

from modelgen import build, derive, emit, require, simulate
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Body, Scene

UNTIL, STEP = 1.0, 1e-3  # s
BODIES = 20
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


def main() -> None:
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
