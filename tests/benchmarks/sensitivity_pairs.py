"""Derivatives of runs beside differences of runs: pairs of a direction and a time, by verdict.

Run with `python -m tests.benchmarks.sensitivity_pairs [--only NAME,...] [--bodies 3]`. For each shipped
scene, starts of its first bodies, and for the scenes of tests/stories/test_parameters.py their number; at
three times each. A pair is `wrong` where the derivative is called differentiable and differs from the
difference by more than 1e-6 of its size and by more than the difference itself is known to; `beyond 1e-9`
likewise.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from modelgen import sensitivity
from modelgen.codegen.library import Library
from modelgen.errors import ModelgenError
from modelgen.runtime.run_differences import STEP, run_differences
from modelgen.scene.read import read_text
from tests.running import NAMES
from tests.sensitivity.differences import differentiable, shipped
from tests.sensitivity.test_differences import is_held, places
from tests.stories.test_parameters import NUMBERS, with_parameter

PARTS = (0.1, 0.4, 0.9)  # of the time of the run
WRONG, EXACT = 1e-6, 1e-9


@dataclass(frozen=True)
class Pair:
    scene: str
    by: str
    t: float
    verdict: str
    reason: str
    error: float  # relative to the derivative
    noise: float  # of the difference, likewise


def directions(library: Library, bodies: int) -> list[str]:
    """Starts of the first bodies that can be changed by a finite amount."""
    held = is_held(library)
    found = []
    moving = [b for b in library.manifest.instance["bodies"] if b["motion"] in ("free", "point")]
    for body in moving[:bodies]:
        quantities = ["velocity"] + (["position"] if not held else [])
        if body["motion"] == "free":
            quantities += ["angular_velocity"] + (["orientation"] if not held else [])
        found += [f"{body['name']}.{quantity}" for quantity in quantities]
    return found


def pairs_of(scene: str, library: Library, by: list[str], times: list[float]) -> Iterator[Pair]:
    of, _ = places(library)
    for name in by:
        found = sensitivity(library, times, of=of, by=[name], accuracy="tight")
        try:
            coarse, fine = (
                run_differences(library, times, of=of, by=[name], accuracy="tight", step=step)
                for step in (STEP, STEP / 2)
            )
        except ModelgenError as refused:
            print(f"  {scene} {name}: {refused}", file=sys.stderr)
            continue
        for k, t in enumerate(times):
            for column, direction in enumerate(found.by):
                exact = fine[k, :, column]
                size = max(float(np.max(np.abs(exact))), 1e-3)
                error = float(np.max(np.abs(found.jacobian[k, :, column] - exact))) / size
                noise = float(np.max(np.abs(exact - coarse[k, :, column]))) / size
                verdict = found.verdicts[k]
                yield Pair(scene, direction, t, verdict.kind, verdict.reason, error, noise)


def scenes(only: list[str], bodies: int) -> Iterator[Pair]:
    for name in NAMES:
        if not only or name in only:
            library = shipped(name)
            until = float(library.manifest.instance["run"].get("until") or 1.0)
            yield from pairs_of(name, library, directions(library, bodies), [part * until for part in PARTS])
    for case in NUMBERS:
        if (not only or case in only) and case != "end of the run":
            library = differentiable(read_text(with_parameter(case), "scene.toml"))
            yield from pairs_of(case, library, ["number"], [0.3 * part for part in PARTS])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", default="")
    parser.add_argument("--bodies", type=int, default=3)
    given = parser.parse_args()
    counts: Counter[str] = Counter()
    only = [name for name in given.only.split(",") if name]
    for pair in scenes(only, given.bodies):
        counts["pairs"] += 1
        counts[pair.verdict if not pair.reason else f"{pair.verdict}: {pair.reason}"] += 1
        known = 10 * pair.noise
        if pair.verdict == "differentiable":
            counts["wrong"] += pair.error > WRONG + known
            counts["beyond 1e-9"] += pair.error > EXACT + known
            counts["noise above 1e-6"] += pair.noise > WRONG
            if pair.error > EXACT + known:
                print(pair, flush=True)
        else:
            counts["undecided, yet equal"] += pair.error < WRONG + known
    for what, count in counts.items():
        print(f"{count:6d} {what}")


if __name__ == "__main__":
    main()
