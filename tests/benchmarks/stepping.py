"""Time-stepping: order and error of motions, energy drift of dampers by decades, delay of lift-off.

Run with `python -m tests.benchmarks.stepping`. Errors are against event-driven runs at tolerance 1e-12.
"""

from __future__ import annotations

import numpy as np

from modelgen import Accuracy, simulate
from modelgen.codegen.library import Library
from modelgen.runtime.accuracy import Scheme
from modelgen.runtime.trajectory import Trajectory
from tests.oracles.pieces import times
from tests.oracles.test_stepping_orders import flight
from tests.oracles.test_stepping_springs import SCHEMES, STEPS, order, pendulum
from tests.running import library_of, scene_of

DRAG = {"body": "egg", "force": ["-2*vx", "-3*vy*sqrt(vx*vx + vy*vy)", "-vz"]}
RATES = (1e0, 1e2, 1e4, 1e6, 1e8, 1e10)  # 1/s


def stepped(library: Library, until: float, step: float, scheme: Scheme) -> Trajectory:
    record = Accuracy.balanced().time_stepping(step, scheme)
    return simulate(library, until=until, samples=1, accuracy=record, estimate=False)


def orders() -> None:
    """Order over STEPS, and error at the last of them."""
    print("| motion | scheme | order of p | error of p, m | order of w | error of w, rad/s |")
    print("|---" * 6 + "|")
    for name, library, until in (
        ("flight with drag and spin", library_of(flight(force=[DRAG])), 1.0),
        ("free spin", library_of(flight(gravity=[0, 0, 0])), 1.0),
        ("linkage with dampers", library_of(pendulum(0.3, 2.0)), 0.6),
        ("double_pendulum", scene_of("double_pendulum"), 0.25),
        ("rolling_ellipsoid", scene_of("rolling_ellipsoid"), 0.5),
    ):
        exact = simulate(library, until=until, samples=1, accuracy=Accuracy.of(1e-12), estimate=False)
        for scheme in SCHEMES:
            runs = [stepped(library, until, step, scheme) for step in STEPS]
            cells = []
            for quantity in ("p", "w"):
                errors = [
                    float(np.abs(getattr(run, quantity)[-1] - getattr(exact, quantity)[-1]).max())
                    for run in runs
                ]
                cells.append(f"{order(errors):.2f} | {errors[-1]:.1e}" if max(errors) > 1e-12 else "- | 0")
            print(f"| {name} | {scheme} | {' | '.join(cells)} |")


def drifts() -> None:
    """Energy drift of a falling linkage whose dampers have the given rate."""
    print(f"\n| damper, 1/s | scheme | {' | '.join(f'drift at {step:g} s' for step in STEPS)} |")
    print("|---" * (2 + len(STEPS)) + "|")
    for rate in RATES:
        for scheme in ("stewart-trinkle", "moreau"):
            library = library_of(pendulum(0.1 * rate, 0.05 * rate))
            found = [f"{stepped(library, 0.6, step, scheme).energy_drift:.1e}" for step in STEPS]
            print(f"| {rate:.0e} | {scheme} | {' | '.join(found)} |")


def lift_offs() -> None:
    """Delay of the lift-off of `ball_leaves_sphere`, in steps."""
    library = scene_of("ball_leaves_sphere")
    exact = simulate(library, until=1.0, samples=1, accuracy=Accuracy.of(1e-12), estimate=False)
    (true,) = times(exact, "lift-off")
    print(f"\n| scheme | {' | '.join(f'late at {step:g} s, steps' for step in STEPS)} |")
    print("|---" * (1 + len(STEPS)) + "|")
    for scheme in SCHEMES:
        late = [(times(stepped(library, 1.0, step, scheme), "lift-off")[0] - true) / step for step in STEPS]
        print(f"| {scheme} | {' | '.join(f'{value:+.2f}' for value in late)} |")


if __name__ == "__main__":
    orders()
    drifts()
    lift_offs()
