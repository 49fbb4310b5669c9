"""Derivatives of runs of all shipped scenes by many numbers, at three times, beside differences of runs.

Run with `python -m tests.benchmarks.derivative_pairs [--scenes a,b] [--cap SECONDS] [--accuracy tight]
[--out FILE]`. A pair is a number (a component of a start, or a factor of a number of the scene) and a time.
Differences bear the derivative out (`agrees`), or it is `off` by more than AGREES and than they resolve, or
`wrong` by more than WRONG; or they do not resolve WRONG, mostly because changed runs have other events. None
that is called differentiable may be wrong. Where a scene with another number starts with a gap or with bodies
in each other (start held), the run as a function of the number has no derivative there, and the differences
are those of a start that is put back on the contact. Pairs are written to FILE number by number; those that
are there already are not run again.
"""

from __future__ import annotations

import argparse
import json
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from modelgen.errors import ModelgenError
from modelgen.runtime.sensitivity_directions import QUANTITIES, directions_of
from tests.running import NAMES
from tests.sensitivity.pairs import Pair, Pairs, library_with_factors, opened, scales_of, shown

PARTS = (0.1, 0.35, 0.9)  # of the run
ZERO = 1e-6  # of a scene's scales: sizes of derivatives up to which no relative error is told
FACTORS, BODIES = 8, 3  # numbers of a scene, and bodies whose starts are changed

Entry = dict[str, Any]


def study(name: str, cap: float, accuracy: str = "tight", known: Sequence[Entry] = ()) -> Iterator[Entry]:
    """The pairs of a scene, of runs that take at most `cap` s of time, but for those of the numbers that are
    known."""
    library, meanings = library_with_factors(name, FACTORS)
    instance = library.manifest.instance
    by = [*meanings] + [each["name"] for each in instance["inputs"]]
    for body in [body for body in instance["bodies"] if body["motion"] in ("free", "point")][:BODIES]:
        quantities = QUANTITIES if body["motion"] == "free" else ("position", "velocity")
        by += [f"{body['name']}.{quantity}" for quantity in quantities]
    times = sorted({each["t"] for each in known})
    if not times:
        until = affordable(library, float(instance["run"].get("until") or 1.0), cap)
        times = [part * until for part in PARTS]
    done = {each["by"] for each in known}
    pairs = Pairs(library, times, accuracy)
    for direction in directions_of(library.manifest.instance, by):
        meaning = meanings.get(direction.name, direction.name)
        if meaning not in done:
            yield from [entry_of(name, pair, meaning) for pair in pairs.of(direction)]


def affordable(library: Any, until: float, cap: float) -> float:
    """The end of the scene, earlier where its run takes too long."""
    while until > 1e-3:
        begun = time.process_time()
        shown(opened(library), [until], *scales_of(library))
        if time.process_time() - begun <= cap:
            break
        until /= 2
    return until


def entry_of(name: str, pair: Pair, by: str) -> Entry:
    return {
        "scene": name, "by": by, "t": pair.t, "kind": pair.verdict.kind, "reason": pair.verdict.reason,
        "reason_t": pair.verdict.t, "contact": pair.verdict.contact, "outcome": pair.outcome,
        "error": pair.error, "size": pair.size, "noise": pair.noise, "is_held": pair.is_held,
    }  # fmt: skip


def print_scene(name: str, entries: Sequence[Entry]) -> None:
    certain = [each for each in entries if each["kind"] == "differentiable"]
    counts = Counter(each["outcome"] for each in certain)
    others = Counter((each["reason"], each["outcome"]) for each in entries if each not in certain)
    worst = max(
        (
            each["error"] / each["size"]
            for each in certain
            if each["outcome"] != "unresolved" and each["size"] > ZERO
        ),
        default=0,
    )
    print(
        f"{name:22} {len(entries):4} pairs, differentiable {len(certain)}: {dict(counts)} worst {worst:.1e}"
    )
    for (reason, outcome), count in sorted(others.items()):
        print(f"    undecided {count:3} {outcome:10} {reason}")
    for each in certain:
        if each["outcome"] in ("off", "wrong"):
            print(
                f"    {each['outcome']}: {each['by']} t = {each['t']:.4g}, error {each['error']:.1e}, "
                f"size {each['size']:.1e}, resolved {each['noise']:.1e}"
            )


def print_all(found: Sequence[Entry]) -> None:
    exist = [each for each in found if each["outcome"] != "unresolved" and not each["is_held"]]
    undecided = [each for each in exist if each["kind"] != "differentiable"]
    share = 100 * len(undecided) / max(len(exist), 1)
    print(f"\n{len(found)} pairs; of {len(exist)} that exist by differences {len(undecided)} ({share:.1f} %)")
    print("are undecided or one-sided")
    counts = Counter(
        (each["kind"], each["reason"], each["outcome"], "start held" if each["is_held"] else "")
        for each in found
    )
    for key, count in sorted(counts.items()):
        print(f"{count:5} {' | '.join(filter(None, key))}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--scenes", default=",".join(NAMES), help="names, separated by commas")
    parser.add_argument("--cap", type=float, default=0.1, help="processor time of a run, s")
    parser.add_argument("--accuracy", default="tight", help="of the derivatives")
    parser.add_argument("--out", type=Path, help="a file of all pairs, JSON")
    given = parser.parse_args()
    names = given.scenes.split(",")
    found: list[Entry] = []
    if given.out and given.out.exists():
        found = json.loads(given.out.read_text())
    for name in names:
        begun = time.perf_counter()
        entries = [each for each in found if each["scene"] == name]
        try:
            for entry in study(name, given.cap, given.accuracy, entries):
                entries.append(entry)
                found.append(entry)
                if given.out and not len(entries) % len(PARTS):
                    given.out.write_text(json.dumps(found, default=float))
        except ModelgenError as error:
            print(f"{name:22} {error}")
        print_scene(name, entries)
        print(f"    {time.perf_counter() - begun:.0f} s", flush=True)
    found = [each for each in found if each["scene"] in names]
    print_all(found)
    wrong = [each for each in found if each["kind"] == "differentiable" and each["outcome"] == "wrong"]
    assert not wrong, f"{len(wrong)} derivatives that are called differentiable are wrong"
    assert all(np.isfinite(each["size"]) for each in found if each["kind"] == "differentiable")


if __name__ == "__main__":
    main()
