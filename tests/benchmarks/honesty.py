"""What runs say of their own error, against the truth, over random cases of the shipped scenes.

Run with `python -m tests.benchmarks.honesty [--cases 10000] [--jobs 16] [--seed 1] [--scenes a,b]
[--seconds 600] [--root FOLDER]`; one case again with `--scenes A --number 7`. Each scene is built twice, then
its cases are runs of these two libraries (tests/benchmark/cases.py). What is in FOLDER, libraries and
verdicts, is not made again. A run that calls itself estimated must not underestimate its error by more than
ten times, and may overestimate it so in 5 %.
"""

from __future__ import annotations

import argparse
import json
import os
import time
from collections import Counter
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import asdict
from functools import cache
from pathlib import Path
from statistics import median
from tempfile import mkdtemp

from modelgen import build, derive, emit, require
from modelgen.codegen.library import Library
from tests.benchmark.cases import Verdict, judged, scene_named, true_form
from tests.running import NAMES

REALS = ("double", "long double")


def folder_of(root: Path, name: str, real: str) -> Path:
    return root / name / real.replace(" ", "_")


def build_both(name: str, root: Path) -> None:
    """The two libraries of a scene, each in a folder of its own."""
    scene = scene_named(name)
    for real, each in zip(REALS, (scene, true_form(scene)), strict=True):
        build(emit(derive(require(each))), real=real, folder=folder_of(root, name, real))


@cache
def library(name: str, real: str, root: Path) -> Library:
    return Library.load(folder_of(root, name, real), real)


def case(name: str, number: int, seed: int, root: Path, end: float) -> Verdict | None:
    """A verdict; None where the time is up."""
    if time.time() > end:
        return None
    ours, truth = (library(name, real, root) for real in REALS)
    return judged(name, ours, truth, seed, number)


def remembered(store: Path) -> list[Verdict]:
    if not store.exists():
        return []
    return [Verdict(**json.loads(line)) for line in store.read_text(encoding="utf-8").splitlines()]


def run(tasks: Sequence[tuple[str, int]], options: argparse.Namespace) -> list[Verdict]:
    """The verdicts of the tasks, those not known yet made and remembered."""
    store = options.root / f"verdicts_{options.seed}.jsonl"
    known = {(v.scene, v.number): v for v in remembered(store)}
    end = time.time() + options.seconds
    with ProcessPoolExecutor(options.jobs) as pool, store.open("a", encoding="utf-8") as file:
        left = [task for task in tasks if task not in known]
        runs = [pool.submit(case, *task, options.seed, options.root, end) for task in left]
        for done in as_completed(runs):
            verdict = done.result()
            if verdict is not None:
                known[verdict.scene, verdict.number] = verdict
                file.write(json.dumps(asdict(verdict)) + "\n")
                file.flush()
    return [known[task] for task in tasks if task in known]


def show(verdicts: Sequence[Verdict]) -> None:
    """A line a scene, then every case that was not honest."""
    print(f"{'scene':24}{'cases':>7}{'estimated':>11}{'low':>7}{'high':>7}  median ratio   others")
    groups = {name: [v for v in verdicts if v.scene == name] for name in sorted({v.scene for v in verdicts})}
    for name, group in (*groups.items(), ("all", list(verdicts))):
        sure = [v for v in group if v.status == "estimated"]
        counts = Counter(v.status for v in group if v.status != "estimated")
        others = ", ".join(f"{count} {status}" for status, count in counts.items())
        middle = f"{median(v.ratio for v in sure):.2f}" if sure else "-"
        low, high = sum(v.under for v in sure), sum(v.over for v in sure)
        print(f"{name:24}{len(group):7}{len(sure):11}{low:7}{high:7}{middle:>14}   {others}")
    for status in sorted({v.status for v in verdicts} - {"refused"}):
        group = [v for v in verdicts if v.status == status]
        low, high = sum(v.under for v in group), sum(v.over for v in group)
        print(f"{status}: {len(group)}, ten times too low {low}, too high {high} ({high / len(group):.1%})")
    for v in verdicts:
        if v.under or v.over:
            kind = "low" if v.under else "high"
            print(f"{kind}, {v.status}: --scenes {v.scene} --number {v.number}", end=" ")
            print(f"{v.ratio:.3g} of {v.true:.3g} ({v.settings})")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=10_000)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--scenes", default=",".join(NAMES))
    parser.add_argument("--number", type=int, help="of one case of one scene")
    parser.add_argument("--seconds", type=float, default=1e9, help="after which no further case begins")
    parser.add_argument("--root", type=Path, help="a folder that keeps libraries and verdicts")
    options = parser.parse_args()
    options.root = options.root or Path(mkdtemp(prefix="honesty-"))
    names = options.scenes.split(",")
    with ProcessPoolExecutor(options.jobs) as pool:
        list(pool.map(build_both, names, [options.root] * len(names)))
    numbers = range(options.cases) if options.number is None else [options.number]
    show(run([(names[k % len(names)], k) for k in numbers], options))


if __name__ == "__main__":
    main()
