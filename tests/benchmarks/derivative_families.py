"""Derivatives of random scenes of feet, hinges, kinks, inputs and sensors of forces, beside differences.

Run with `python -m tests.benchmarks.derivative_families [--members N] [--families a,b] [--accuracy tight]`. A
pair is a number (parameter, input, or component of a start) and an output (a sensor, or a quantity of a
body). None that is called differentiable may differ from differences of both sides, or of one, by more than
1e-6 of its size, and none that is said to hold for one side from differences of that side. Exits with 1 where
one does.
"""

from __future__ import annotations

import argparse
from collections import Counter

import numpy as np

from modelgen.scene.read import read_text
from tests.sensitivity.differences import differentiable
from tests.sensitivity.families import FAMILIES
from tests.sensitivity.judge import Judged, judged
from tests.sensitivity.scenes_on_kinks import ON_KINKS

KINDS = {**FAMILIES, **ON_KINKS}
SIDES = {"both": "differentiable", "larger": "one-sided", "smaller": "one-sided"}


def pairs_of(family: str, seed: int, accuracy: str = "tight") -> list[Judged]:
    """The pairs of a member of a family."""
    drawn = KINDS[family](np.random.default_rng([seed, *family.encode()]))
    return list(judged(differentiable(read_text(drawn.text, f"{family}.toml")), drawn, accuracy))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--members", type=int, default=12)
    parser.add_argument("--families", default=",".join(KINDS))
    parser.add_argument("--accuracy", default="tight")
    given = parser.parse_args()
    total: Counter[str] = Counter()
    wrong = 0
    for family in given.families.split(","):
        counts: Counter[str] = Counter()
        for seed in range(given.members):
            for pair in pairs_of(family, seed, given.accuracy):
                counts[f"{SIDES.get(pair.side, 'doubted')}, {pair.outcome}"] += 1
                wrong += pair.outcome == "wrong"
                if pair.outcome == "wrong":
                    told = f"{pair.of} by {pair.by} ({pair.side}): {pair.found} for {pair.expected}"
                    print(f"  {family} {seed}: {told}", flush=True)
        print(f"{family:8} " + "; ".join(f"{n} {name}" for name, n in sorted(counts.items())), flush=True)
        total += counts
    print(f"{total.total()} pairs: " + "; ".join(f"{n} {name}" for name, n in sorted(total.items())))
    return int(wrong > 0)


if __name__ == "__main__":
    raise SystemExit(main())
