"""The worked examples of plans from perturbed starts.

    python -m tests.benchmarks.plans [--starts 20] [--only roll_an_ellipsoid ..] [--out FILE]

Each example of `tests/examples` is solved from guesses that are simulated runs with random starts or inputs.
Told are: how many are solved and, simulated, miss their goal by at most 1e-3 m; iterations of IPOPT; the
largest difference of positions between plan and run. Each solution is written to FILE as a line of JSON;
those that it holds are not solved again.
"""

from __future__ import annotations

import argparse
import json
import tempfile
import time
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from modelgen.errors import ModelgenError
from tests.examples.plan_example import PlanExample

NAMES = ("roll_an_ellipsoid", "masse_shot", "put_a_coin_on_its_edge", "balance_the_wheel")
NEAR = 1e-3  # m


def solved(example: PlanExample, solver: Any, seed: int) -> dict[str, Any]:
    """What came of one perturbed start."""
    began = time.process_time()
    found = example.plan.solve(example.perturbed(np.random.default_rng(seed)), solver=solver)
    row = {"iterations": found.solution.iterations, "value": found.solution.value}
    row |= {"seconds": time.process_time() - began, "missed": np.inf, "positions": np.inf}
    if not found.solution.success:
        return row
    try:
        missed = example.missed(example.simulated(found)[-1])
        return row | {"missed": missed, "positions": example.reproduced(found)[0]}
    except ModelgenError:  # the plan is none that the scene permits
        return row


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--starts", type=int, default=20)
    parser.add_argument("--only", nargs="+", default=NAMES)
    parser.add_argument("--out", type=Path, default=Path(tempfile.gettempdir()) / "plans.jsonl")
    given = parser.parse_args()
    known: dict[tuple[str, int], dict[str, Any]] = {}
    if given.out.exists():
        found = map(json.loads, given.out.read_text().splitlines())
        known = {(row["example"], row["seed"]): row for row in found}
    for name in given.only:
        example = import_module(f"tests.examples.{name}").problem()
        solver = example.solver()
        rows: list[dict[str, Any]] = []
        for seed in range(given.starts):
            if (name, seed) not in known:
                known[name, seed] = {"example": name, "seed": seed} | solved(example, solver, seed)
                with open(given.out, "a", encoding="utf-8") as out:
                    out.write(json.dumps(known[name, seed]) + "\n")
            rows.append(known[name, seed])
        print(told(name, rows), flush=True)


def told(name: str, rows: list[dict[str, Any]]) -> str:
    good = [row for row in rows if row["missed"] < NEAR]
    if not good:
        return f"{name}: none of {len(rows)}"
    iterations, missed, apart = ([row[key] for row in good] for key in ("iterations", "missed", "positions"))
    return (
        f"{name:24s} {len(good)} of {len(rows)}, iterations {int(np.median(iterations))}, "
        f"missed {np.median(missed):.1e} m (most {max(missed):.1e}), "
        f"apart {np.median(apart):.1e} (most {max(apart):.1e}), "
        f"{np.median([row['seconds'] for row in good]):.1f} s"
    )


if __name__ == "__main__":
    main()
