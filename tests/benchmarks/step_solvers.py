"""Whole runs by time-stepping with each solver of their contact problems: cost, error, residual, failures.

    python -m tests.benchmarks.step_solvers [SCENE ..] [--step 0.002]

The error is that of positions at the end against the event-driven run at `tight`. A failure is a run that
ends early, or a step that the chosen solver did not solve: its impulses are loose, found to a larger
residual, or those of the relaxation of the core.
"""

from __future__ import annotations

import argparse
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time

import numpy as np

from modelgen import build, derive, emit, read, require, simulate
from modelgen.codegen.library import Library
from modelgen.runtime.solver_choice import solvers_of
from modelgen.runtime.trajectory import Outcome, Trajectory
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Scene
from tests.benchmarks.many_contacts import heap, stack

FOLDER = Path(__file__).parents[2] / "scenes"
UNTIL = {  # s; what a scene is for
    "sphere_slide_to_roll": (0.5, "slides, then rolls"),
    "belt": (1.0, "stick-slip"),
    "brake_shoe": (0.3, "jams"),
    "painleve_rod": (0.1, "Painleve's rod"),
    "coin": (0.2, "rolls on a rim"),
    "tumbling_box": (0.5, "impacts"),
    "stack": (0.2, "redundant"),
    "heap": (0.3, "heap of 8"),
    "bouncing_ball": (0.8, "impacts, no friction"),
    "newton_cradle": (0.5, "impacts in a row, no friction"),
    "ellipsoids_in_bowl": (0.3, "many, no friction"),
}
TITLES = ("scene", "what happens", "solver", "CPU s", "error (m)", "residual", "solves", "failures")
ALIKE = 1e-6  # m: what two references that differ in accuracy may differ by


def belt() -> Scene:
    """A block on a moving belt, held by a spring: it sticks and slips in turn."""
    face = make.shape("box", size=[0.2, 0.2, 0.05], position=[0.0, 0.0, 0.025])
    block = make.dynamic("block", face, mass=1.0, inertia=[0.01, 0.01, 0.02], velocity=[0.2, 0.0, 0.0])
    moving = make.driven("belt", make.plane(), path={"position": ["0.2*t", 0.0, 0.0]})
    return make.scene(
        "belt",
        [moving, block, make.fixed("wall")],
        contacts={"between": "all", "friction": {"static": 0.4, "kinetic": 0.3}},
        spring=[{"between": ["block", "wall"], "stiffness": 100.0}],
    )


def tumbling_box() -> Scene:
    box = make.dynamic(
        "box",
        make.box(0.1, 0.15, 0.2),
        density=500.0,
        position=[0.0, 0.0, 0.3],
        rpy=[0.5, 0.3, 0.2],
        velocity=[1.0, 0.0, 0.0],
        angular_velocity=[1.0, 4.0, 0.0],
    )
    bodies = [make.fixed("floor", make.plane()), box]
    return make.scene("tumbling_box", bodies, contacts={"between": "all", "friction": 0.3})


MADE: dict[str, Callable[[], Scene]] = {
    "belt": belt,
    "tumbling_box": tumbling_box,
    "stack": lambda: stack(3),
    "heap": lambda: heap(8),
}


def library_of(name: str, folder: str) -> Library:
    scene = MADE[name]() if name in MADE else read(FOLDER / f"{name}.toml")
    return build(emit(derive(require(scene))), folder=Path(folder) / name)


def reference(library: Library, until: float) -> np.ndarray | None:
    """(nb, 3) positions at the end by events; None where two accuracies do not lead to one end."""
    ends = []
    for accuracy in ("balanced", "tight"):
        run = simulate(library, until=until, accuracy=accuracy, samples=1, estimate=False)
        if run.outcome is not Outcome.DONE or run.fallback_step:
            return None
        ends.append(run.p[-1])
    return ends[1] if np.abs(ends[1] - ends[0]).max() < ALIKE else None


def failures(run: Trajectory) -> str:
    found = [] if run.outcome is Outcome.DONE else [f"{run.outcome.name.lower()} at {run.t_end:.3g} s"]
    steps = (re.match(r"in (\d+) steps (the impulses|no solution)", warning) for warning in run.warnings)
    found += [f"{each[1]} {'loose' if each[2] == 'the impulses' else 'relaxed'}" for each in steps if each]
    return ", ".join(found) or "none"


def rows(name: str, step: float) -> Iterator[tuple[str, ...]]:
    until, what = UNTIL[name]
    with TemporaryDirectory() as folder:
        library = library_of(name, folder)
        wanted = reference(library, until)
        for solver in solvers_of(library.manifest.instance, "time-stepping"):
            begun = process_time()
            run = simulate(
                library,
                until=until,
                method="time-stepping",
                step=step,
                solver=solver,
                samples=1,
                estimate=False,
            )
            spent = process_time() - begun
            error = "-" if wanted is None else f"{np.abs(run.p[-1] - wanted).max():.1e}"
            count = str(sum(run.solves.values()))
            yield (
                name,
                what,
                solver,
                f"{spent:.3g}",
                error,
                f"{run.solve_residual_max:.0e}",
                count,
                failures(run),
            )


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("scene", nargs="*", metavar="SCENE", help=f"of {', '.join(UNTIL)}; all by default")
    parser.add_argument("--step", type=float, default=0.002, help="s")
    given = parser.parse_args()
    print(f"| {' | '.join(TITLES)} |\n|{' --- |' * len(TITLES)}")
    for name in given.scene or UNTIL:
        for row in rows(name, given.step):
            print(f"| {' | '.join(row)} |", flush=True)


if __name__ == "__main__":
    main()
