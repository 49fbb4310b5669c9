"""What runs say of their own error, against the truth, over random cases of the shipped scenes.

Run with `python -m tests.benchmarks.honesty [--cases 10000] [--jobs 16] [--seed 1] [--scenes a,b]`; one case
again with `--scenes A --number 7`.
Each scene is built twice, then its cases are runs of these two libraries (tests/measure/cases.py). A run that
calls itself estimated must not underestimate its error by more than ten times, and may overestimate it so in
5 %.
"""

from __future__ import annotations

import argparse
import os
from collections import Counter
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import cache
from pathlib import Path
from statistics import median
from tempfile import mkdtemp

from modelgen import build, derive, emit, require
from modelgen.codegen.library import Library
from tests.measure.cases import Verdict, judged, scene_named, true_form
from tests.running import NAMES

REALS = ("double", "long double")


def build_both(name: str, root: str) -> str:
    """The two libraries of a scene, each in a folder of its own."""
    scene = scene_named(name)
    for real, each in zip(REALS, (scene, true_form(scene)), strict=True):
        build(emit(derive(require(each))), real=real, folder=Path(root) / name / real.replace(" ", "_"))
    return name


@cache
def library(name: str, real: str, root: str) -> Library:
    return Library.load(Path(root) / name / real.replace(" ", "_"), real)


def case(name: str, number: int, seed: int, root: str) -> Verdict:
    return judged(name, *(library(name, real, root) for real in REALS), seed, number)


def show(verdicts: Sequence[Verdict]) -> None:
    """A line a scene, then every case that was not honest."""
    print(f"{'scene':24}{'cases':>7}{'estimated':>11}{'under':>7}{'over':>7}  median ratio   others")
    groups = {name: [v for v in verdicts if v.scene == name] for name in sorted({v.scene for v in verdicts})}
    for name, group in (*groups.items(), ("all", list(verdicts))):
        sure = [v for v in group if v.status == "estimated"]
        counts = Counter(v.status for v in group if v.status != "estimated")
        others = ", ".join(f"{count} {status}" for status, count in counts.items())
        middle = f"{median(v.ratio for v in sure):.2f}" if sure else "-"
        under, over = sum(v.under for v in sure), sum(v.over for v in sure)
        print(f"{name:24}{len(group):7}{len(sure):11}{under:7}{over:7}{middle:>14}   {others}")
    for status in sorted({v.status for v in verdicts} - {"refused"}):
        group = [v for v in verdicts if v.status == status]
        under, over = sum(v.under for v in group), sum(v.over for v in group)
        print(f"{status}: {len(group)}, ten times too low {under}, too high {over} ({over / len(group):.1%})")
    for v in verdicts:
        if v.under or v.over:
            kind = "under" if v.under else "over"
            print(f"{kind} {v.status}: --scenes {v.scene} --number {v.number}", end=" ")
            print(f"{v.ratio:.3g} of {v.true:.3g} ({v.settings})")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=10_000)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--scenes", default=",".join(NAMES))
    parser.add_argument("--number", type=int, help="of one case of one scene")
    parser.add_argument("--root", help="a folder that keeps the libraries")
    options = parser.parse_args()
    names, root = options.scenes.split(","), options.root or mkdtemp(prefix="honesty-")
    with ProcessPoolExecutor(options.jobs) as pool:
        list(pool.map(build_both, names, [root] * len(names)))
    numbers = range(options.cases) if options.number is None else [options.number]
    with ProcessPoolExecutor(options.jobs) as pool:
        tasks = [(names[k % len(names)], k) for k in numbers]
        runs = [pool.submit(case, name, k, options.seed, root) for name, k in tasks]
        show([run.result() for run in runs])


if __name__ == "__main__":
    main()
