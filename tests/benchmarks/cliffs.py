"""What scenes cost that were cliffs: steps, evaluations and CPU per simulated second.

Run with `python -m tests.benchmarks.cliffs`. The window of a scene is where its cost lies; the cost of what
comes before is taken off.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from time import process_time

import numpy as np

from modelgen import read, simulate
from modelgen.codegen.library import Library
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Scene
from tests.benchmarks.cliff_scenes import escapement, links_and_dust, scattered_balls
from tests.benchmarks.step_cost import linked_tori
from tests.running import library_of

SHIPPED = Path(__file__).parents[2] / "scenes"
ACCURACIES = ("fast", "balanced", "tight")


def rocking_can() -> Scene:
    """A can without friction that falls back from a lean of 0.05 rad to upright."""
    can = make.dynamic(
        "can",
        make.cylinder(0.03, 0.12),
        mass=0.3,
        inertia=[3.7e-4, 3.7e-4, 2.4e-4],
        position=[0.0, 0.0, "0.06*cos(0.05) + 0.03*sin(0.05)"],
        axis_angle={"axis": [0.0, 1.0, 0.0], "angle": 0.05},
    )
    return make.scene(
        "rocking", [make.fixed("table", make.plane()), can], contact=[{"between": ["can", "table"]}]
    )


def spinning_box() -> Scene:
    """A box with friction whose pressure moves to the edge of its base while it slides and spins."""
    box = make.dynamic(
        "box",
        make.box(0.08, 0.08, 0.2),
        density=500.0,
        position=[0.0, 0.0, 0.1],
        velocity=[0.0, 0.1, 0.0],
        angular_velocity=[0.0, 0.0, 20.0],
    )
    force = [{"body": "box", "force": ["2.5-5*t*0.457", "-5*t*0.889", "0.0"]}]
    touch = [{"between": ["box", "table"], "friction": 0.4}]
    return make.scene("spinning", [make.fixed("table", make.plane()), box], contact=touch, force=force)


SCENES: dict[str, tuple[Callable[[], Scene], float, float]] = {  # and the window, s
    "escapement": (lambda: escapement(0.183, 0.3, 0.02), 0.0, 0.3),
    "coin that creeps": (lambda: read(SHIPPED / "coin.toml"), 3.95, 4.2),
    "can that rocks back": (rocking_can, 0.0, 0.5),
    "face about to tip": (spinning_box, 0.2, 0.3),
    "links alone": (lambda: links_and_dust(0.0), 0.0, 1.0),
    "links and dust": (lambda: links_and_dust(1e-3), 0.0, 1.0),
    "linked tori": (linked_tori, 0.0, 5.0),
    "gears": (lambda: read(SHIPPED / "gears.toml"), 0.0, 1.0),
    "496 pairs": (lambda: scattered_balls(32), 0.0, 1.0),
}


def cost(library: Library, until: float, accuracy: str) -> tuple[np.ndarray, str]:
    """CPU time, s, steps, tried ones included, and evaluations; outcome."""
    if until == 0:
        return np.zeros(3), "DONE"
    begun = process_time()
    path = simulate(library, until=until, accuracy=accuracy, samples=2, estimate=False)
    spent = process_time() - begun
    return np.array([spent, path.steps + path.rejected, path.rhs_evals]), path.outcome.name


def main() -> None:
    """Print the table."""
    print("| scene | accuracy | outcome | steps per s | evaluations per s | CPU per s (ms) |")
    print("| --- | --- | --- | --- | --- | --- |")
    for name, (scene, begin, end) in SCENES.items():
        library = library_of(scene())
        for accuracy in ACCURACIES:
            before, _ = cost(library, begin, accuracy)
            whole, outcome = cost(library, end, accuracy)
            cpu, steps, calls = (whole - before) / (end - begin)
            print(
                f"| {name} | {accuracy} | {outcome} | {steps:.0f} | {calls:.0f} | {1e3 * cpu:.0f} |",
                flush=True,
            )


if __name__ == "__main__":
    main()
