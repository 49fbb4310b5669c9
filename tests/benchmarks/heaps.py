"""Ellipsoids that fall into a bowl and come to rest in a heap by drag: what a contact costs.

Run with `python -m tests.benchmarks.heaps` for 10 to 640 bodies, or with their numbers as arguments. All
pairs are contacts. The cost is the CPU time of the whole run, start included, over the mean number of
contacts that carry force and the simulated time. It is printed over that of 40 bodies; the exit code is 1
where more bodies cost more than BOUND times as much.
"""

from __future__ import annotations

import sys
from itertools import combinations
from tempfile import TemporaryDirectory
from time import process_time

import numpy as np

from modelgen import build, derive, emit, require, simulate
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Scene

UNTIL = 2.0  # s
SAMPLES = 20
DRAG = 2.0  # N s/m, and of rotation N m s
SPIN_DRAG = 0.01
FROM, BOUND = 40, 3.0  # bodies from which on the cost of a contact is to stay within this factor
APART = 0.21  # m, distance of the centres at the start
TITLES = (
    *(
        "bodies",
        "pairs",
        "pairs to model (CPU s)",
        "contacts with force",
        "event-driven (s)",
        "time-stepping (s)",
    ),
    *("CPU s per simulated s", "ms per contact and simulated s", "penetration (m)", "energy drift"),
    *("v^2 at the end over the largest", f"cost over that of {FROM} bodies"),
)


def heap(bodies: int, seed: int = 0) -> Scene:
    """Ellipsoids of random axes and orientations in layers above a bowl."""
    rng = np.random.default_rng(seed)
    names = [f"stone{i}" for i in range(bodies)]
    side = max(3, round((bodies / 2) ** (1 / 3)))
    stones = []
    for i, name in enumerate(names):
        layer, place = divmod(i, side * side)
        x, y = (APART * (at - (side - 1) / 2) for at in (place % side, place // side))
        stones.append(
            make.dynamic(
                name,
                make.ellipsoid(*(float(a) for a in rng.uniform(0.06, 0.1, 3))),
                density=500.0,
                position=[x, y, (x * x + y * y) / 2 + 0.13 + APART * layer],
                rpy=[float(a) for a in rng.uniform(-0.6, 0.6, 3)],
            )
        )
    bowl = make.fixed("bowl", make.paraboloid(1.0, 1.0))
    pairs = [{"between": list(pair)} for pair in combinations(["bowl", *names], 2)]
    forces = [{"body": name, "force": [f"-{DRAG}*v{axis}" for axis in "xyz"]} for name in names]
    torques = [{"body": name, "torque": [f"-{SPIN_DRAG}*w{axis}" for axis in "xyz"]} for name in names]
    return make.scene(f"heap_of_{bodies}", [bowl, *stones], contact=pairs, force=forces, torque=torques)


def motion_left(path: Trajectory) -> float:
    """Sum of the squares of the velocities of the centres of mass, at the last sample over its largest."""
    speeds = (path.v**2).sum(axis=(1, 2))
    return float(speeds[-1] / speeds.max())


def row(bodies: int, folder: str, costs: dict[int, float]) -> str:
    """A row of the table; adds the cost of a contact, ms per simulated second, to `costs`."""
    scene = heap(bodies)
    begun = process_time()
    model = require(scene)
    assembled = process_time() - begun
    library = build(emit(derive(model)), folder=f"{folder}/{bodies}")
    begun = process_time()
    path = simulate(library, until=UNTIL, samples=SAMPLES, estimate=False)
    spent = process_time() - begun
    contacts = float((path.force > 0).sum(axis=1).mean())
    stepping, costs[bodies] = path.fallback_time, 1e3 * spent / path.t_end / contacts
    ratio = f"{costs[bodies] / costs[FROM]:.2f}" if bodies >= FROM in costs else ""
    cells = (
        *(f"{bodies}", f"{len(model.pairs)}", f"{assembled:.2f}", f"{contacts:.0f}"),
        *(f"{path.t_end - stepping:.2f}", f"{stepping:.2f}", f"{spent / path.t_end:.2f}"),
        *(f"{costs[bodies]:.1f}", f"{path.penetration_max:.1e}"),
        *(f"{path.energy_drift:.1e}", f"{motion_left(path):.1e}", ratio),
    )
    return f"| {' | '.join(cells)} |" + ("" if path.outcome.succeeded else f" {path.outcome.name}")


def main() -> None:
    print(f"| {' | '.join(TITLES)} |")
    print("|---" * len(TITLES) + "|", flush=True)
    costs: dict[int, float] = {}
    with TemporaryDirectory() as folder:
        for bodies in [int(text) for text in sys.argv[1:]] or (10, 40, 160, 640):
            print(row(bodies, folder, costs), flush=True)
    if any(cost > BOUND * costs[FROM] for bodies, cost in costs.items() if bodies >= FROM in costs):
        sys.exit(f"a contact costs more than {BOUND:g} times as much as with {FROM} bodies")


if __name__ == "__main__":
    main()
