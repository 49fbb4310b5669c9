"""What `fast`, `balanced` and `tight` reach and cost in each shipped scene: a table of the manual.

Run with `python -m tests.benchmarks.presets [--jobs 16] [--scenes a,b] [--root FOLDER]`. Errors are those
of `modelgen measure`, over the length and up to the horizon. Below the table stands what the tolerances were
chosen by: the errors that one leaves in half, in nine tenths and in all of the scenes.
"""

from __future__ import annotations

import argparse
import os
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from tempfile import mkdtemp

import numpy as np

from modelgen import Accuracy
from modelgen.benchmark.cost import cost_of
from modelgen.benchmark.knobs import Space
from modelgen.benchmark.measurement_store import Store
from modelgen.benchmark.sampled_motion import motion_of
from modelgen.benchmark.scene_under_measurement import Subject
from modelgen.benchmark.setting_evaluation import Bench
from modelgen.runtime.cpu_time import core_time
from tests.benchmark.cases import scene_named
from tests.running import NAMES

PRESETS = (Accuracy.fast(), Accuracy.balanced(), Accuracy.tight())
TOLERANCES = (1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 2e-11, 1e-12, 1e-13, 1e-14)


@dataclass(frozen=True, slots=True)
class Reached:
    """Of one scene: error and cost (us per simulated second) of each preset, and errors by tolerance."""

    scene: str
    horizon: float | None
    errors: list[float]
    costs: list[float]
    ladder: list[float]


def reached(name: str, root: Path) -> Reached:
    scene = scene_named(name)
    subject = Subject(scene, scene.run.until, scene.run.samples, root)
    space: Space = subject.space(("tolerance",))
    bench = Bench(subject, space, Store(root / name))

    def error(accuracy: Accuracy) -> float:
        path = subject.run(bench.plain, accuracy)
        if not bench.came_as_far(path.t_end):
            return float("inf")
        return bench.judged(motion_of(path, bench.reference.bodies))[0]

    def cost(accuracy: Accuracy) -> float:
        spent = cost_of(lambda: core_time(bench.plain, accuracy, subject.until), bench.yard)
        return spent.seconds / subject.until * 1e6

    return Reached(
        scene=name,
        horizon=bench.reference.horizon,
        errors=[error(preset) for preset in PRESETS],
        costs=[cost(preset) for preset in PRESETS],
        ladder=[error(Accuracy.of(tolerance)) for tolerance in TOLERANCES],
    )


def show(rows: Sequence[Reached]) -> None:
    print("| scene | " + " | ".join(f"{preset.name} | cost" for preset in PRESETS) + " |")
    print("| --- |" + " --- | --- |" * len(PRESETS))
    for row in rows:
        name = f"`{row.scene}`" + ("" if row.horizon is None else f" (to {row.horizon:.3g} s)")
        pairs = zip(row.errors, row.costs, strict=True)
        print(f"| {name} | " + " | ".join(f"{error:.1e} | {cost:.3g} us" for error, cost in pairs) + " |")
    print("\ntolerance: error in half, in nine tenths, in all of the scenes")
    for k, tolerance in enumerate(TOLERANCES):
        parts = np.quantile([row.ladder[k] for row in rows], [0.5, 0.9, 1.0], method="higher")
        print(f"{tolerance:.0e}: " + "  ".join(f"{part:.1e}" for part in parts))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--scenes", default=",".join(NAMES))
    parser.add_argument("--root", default=mkdtemp(prefix="presets-"), help="a folder that keeps libraries")
    options = parser.parse_args()
    names = options.scenes.split(",")
    with ProcessPoolExecutor(options.jobs) as pool:
        show(list(pool.map(reached, names, [Path(options.root)] * len(names))))


if __name__ == "__main__":
    main()
