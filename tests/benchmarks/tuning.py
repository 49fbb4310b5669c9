"""Which errors `tune` can promise in each shipped scene, and whether it keeps them and its budgets.

Run with `python -m tests.benchmarks.tuning [--jobs 16] [--scenes a,b]`: a line a scene, with what the
registry says is reachable. `pytest -m slow tests/benchmark/test_promises.py` holds the two to each other.
"""

from __future__ import annotations

import argparse
import os
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from tempfile import mkdtemp

from tests.benchmark.promises import Promises, promises
from tests.registry import REGISTRY
from tests.running import NAMES


def show(found: Promises) -> None:
    kept = " ".join(f"{error:.1e}" for error in found.kept.values())
    listed, horizon = REGISTRY[found.scene].reachable, found.horizon or "-"
    over = max(found.over_budget.values(), default=0.0)
    print(
        f"{found.scene:24} reachable {found.reachable:2} (registry {listed:2}), best {found.best:.1e}, "
        f"reference {found.reference_error:.1e}, horizon {horizon}, budget {over:.2f}: {kept}",
        flush=True,
    )
    for word in (*found.broken, *dict.fromkeys(found.refused.values())):
        print(f"    {word}", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--scenes", default=",".join(NAMES))
    parser.add_argument("--root", default=mkdtemp(prefix="tuning-"), help="a folder that keeps measurements")
    options = parser.parse_args()
    with ProcessPoolExecutor(options.jobs) as pool:
        for run in [pool.submit(promises, name, Path(options.root)) for name in options.scenes.split(",")]:
            show(run.result())


if __name__ == "__main__":
    main()
