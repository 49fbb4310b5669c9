"""What Gamma2 is worth: a table of the manual. Run with `python -m tests.benchmarks.gamma2`."""

from __future__ import annotations

from dataclasses import replace
from time import process_time

import numpy as np

from modelgen import Accuracy, simulate
from modelgen.codegen.library import Library
from modelgen.runtime.trajectory import Trajectory
from tests.running import scene_of

SCENES = ("ellipsoid_on_plane", "ellipsoid_in_cavity")
UNTIL, SAMPLES = 2.0, 40
BASE = Accuracy.of(1e-11)
FINEST = replace(
    Accuracy.tight().with_thresholds(drift_tolerance=1e-18, extremality_residual=1e-16), tolerance=1e-16
)
UNLIMITED = 1e3  # of the length: a run without Gamma2 goes on though the bodies sink into each other
VARIANTS = {
    "with Gamma2, eta corrected once a step, drift projected (default)": BASE,
    "without Gamma2, otherwise the same": replace(BASE, use_gamma=False),
    "with Gamma2, eta integrated only (the paper)": replace(BASE, newton=0, project=0),
    "without Gamma2, eta integrated only": replace(
        BASE.with_thresholds(penetration_limit=UNLIMITED), newton=0, project=0, use_gamma=False
    ),
    "with Gamma2, eta corrected once a step, no projection": replace(BASE, project=0),
    "with Gamma2, eta corrected at every stage": replace(BASE, newton=2),
}


def error(path: Trajectory, reference: Trajectory) -> float:
    """Largest distance over the samples between the moved tips of the three axes, 0.1 m long."""
    worst = 0.0
    for sample, true in zip(_tips(path), _tips(reference), strict=True):
        worst = max(worst, float(np.abs(sample - true).max()))
    return worst


def _tips(path: Trajectory) -> np.ndarray:
    w, x, y, z = np.moveaxis(path.quaternion[:, 1], -1, 0)
    columns = np.stack(
        [
            np.stack([1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)], -1),
            np.stack([2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)], -1),
            np.stack([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)], -1),
        ],
        axis=1,
    )
    return np.asarray(path.p[:, 1, None]) + 0.1 * columns


def cost(library: Library, accuracy: Accuracy) -> float:
    """Microseconds of CPU time per simulated second: the least of nine runs less the least fixed cost."""
    spent = {until: min(_cpu(library, accuracy, until) for _ in range(9)) for until in (1e-6, 20.0)}
    return (spent[20.0] - spent[1e-6]) / 20.0 * 1e6


def _cpu(library: Library, accuracy: Accuracy, until: float) -> float:
    begun = process_time()
    simulate(library, until=until, accuracy=accuracy, samples=1, estimate=False)
    return process_time() - begun


def rows(name: str) -> list[tuple[str, float, float, float]]:
    """(variant, error in m, gap in m, cost in us per simulated second) for one scene."""
    truths = [
        simulate(
            scene_of(name, form, "long double"), until=UNTIL, samples=SAMPLES, accuracy=FINEST, estimate=False
        )
        for form in ("implicit", "block")
    ]
    library = scene_of(name, "implicit")
    found = []
    for variant, accuracy in VARIANTS.items():
        path = simulate(library, until=UNTIL, samples=SAMPLES, accuracy=accuracy, estimate=False)
        gap = float(np.nanmax(np.abs(path.gap)))
        found.append((variant, error(path, truths[0]), gap, cost(library, accuracy)))
    reference = "long double, tolerance 1e-16: the reference (error: against the block form)"
    gap = float(np.nanmax(np.abs(truths[0].gap)))
    price = cost(scene_of(name, "implicit", "long double"), FINEST)
    return [*found, (reference, error(truths[1], truths[0]), gap, price)]


def main() -> None:
    for name in SCENES:
        print(f"\n| `{name}`, {UNTIL:g} s, implicit form | error (m) | gap (m) | µs per simulated s |")
        print("|---|---|---|---|")
        for variant, distance, gap, price in rows(name):
            print(f"| {variant} | {distance:.1e} | {gap:.1e} | {price:.0f} |")


if __name__ == "__main__":
    main()
