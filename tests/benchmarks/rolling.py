"""The ellipsoid that rolls without slip, here, in MuJoCo and in Drake: error and cost in one run.

    python -m tests.benchmarks.rolling [PICTURE.png]

prints a table and, with a path, draws it. MuJoCo (extra `peers`) and Drake (`pip install drake`) take part
where they are installed. All are judged alike, against the independent reference: distance of the centre at
2 s, root mean square of the tips' distances over the samples to 2 s, energy at 5 s over the first kinetic
energy, and CPU time. Each peer runs at its defaults and, ordered by step, at the settings that a sweep over
integrator, cone, impedance, stiffness and solver found to serve it best on this scene.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from statistics import median
from time import process_time

import numpy as np

from modelgen import Accuracy, simulate
from tests.benchmarks import rolling_drake, rolling_mujoco
from tests.benchmarks.tracks import JUDGED, TIMES, Row, Track, judged
from tests.oracles.friction.rolling_ellipsoid import reference
from tests.running import scene_of

LONG = 10  # runs of so many times the span tell the cost without what a run costs to begin


def ours(accuracy: Accuracy) -> Track:
    """The scene `rolling_ellipsoid` by the public verbs."""
    library = scene_of("rolling_ellipsoid")
    until, samples = float(TIMES[-1]), len(TIMES) - 1

    def timed(span: float) -> float:
        spent = []
        for _ in range(5):
            begun = process_time()
            simulate(library, until=span, accuracy=accuracy, samples=samples, estimate=False)
            spent.append(process_time() - begun)
        return median(spent)

    path = simulate(library, until=until, accuracy=accuracy, samples=samples, estimate=False)
    cost = (timed(LONG * until) - timed(until)) / ((LONG - 1) * until) * 1e6
    return Track.of_quaternions(path.p[:, 1], path.quaternion[:, 1], path.v[:, 1], path.w[:, 1], cost)


def runs() -> Iterator[tuple[str, Callable[[], Track]]]:
    for name in ("fast", "balanced", "tight"):
        yield f"modelgen {name}", partial(ours, getattr(Accuracy, name)())
    for peer, module in (("mujoco", rolling_mujoco), ("pydrake", rolling_drake)):
        if find_spec(peer):
            yield from module.runs()
        else:
            print(f"{peer} is not installed: left out")


def table(rows: list[Row]) -> str:
    lines = [
        ("", "centre at 2 s", "tips to 2 s", "energy at 5 s", "cost"),
        ("", "m", "m, rms", "of first kinetic", "us per s"),
        *((r.name, f"{r.centre:.1e}", f"{r.tips:.1e}", f"{r.energy:+.1e}", f"{r.cost:.0f}") for r in rows),
    ]
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    return "\n".join("  ".join(map(str.ljust, line, widths)) for line in lines)


def drawn(rows: list[Row], picture: Path) -> None:
    """Error and energy over cost."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    figure, axes = plt.subplots(1, 2, figsize=(11, 4.5), layout="constrained")
    values: dict[str, Callable[[Row], float]] = {
        "distance of the centre at 2 s, m": lambda row: row.centre,
        "|energy change| at 5 s over first kinetic energy": lambda row: abs(row.energy),
    }
    for axis, (label, value) in zip(axes, values.items(), strict=True):
        for who, mark in (("modelgen", "o"), ("MuJoCo", "s"), ("Drake", "^")):
            chosen = [row for row in rows if row.name.startswith(who)]
            axis.loglog([row.cost for row in chosen], [value(row) for row in chosen], mark, label=who)
        axis.set(xlabel="CPU time per simulated second, us", ylabel=label)
        axis.grid(alpha=0.3)
        axis.legend(loc="center right")
    figure.savefig(picture, dpi=150)


def main(picture: Path | None) -> None:
    truth = reference(TIMES)
    p, R, v, w = (np.asarray(values, float) for values in (truth.p, truth.R, truth.v, truth.w))
    exact = Track(p, R, v, w, 0.0)
    rows = [judged(name, run(), exact) for name, run in runs()]
    print(f"samples every {TIMES[1]:g} s; judged at {JUDGED:g} s and {TIMES[-1]:g} s")
    print(table(rows))
    if picture:
        drawn(rows, picture)
        print(picture)


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else None)
