"""Derivatives of runs of all shipped scenes by many numbers, at three times, beside differences of runs.

Run with `python -m tests.benchmarks.derivative_pairs [--scenes a,b] [--cap SECONDS] [--accuracy tight]
[--out FILE]`. A pair is a number (a component of a start, or a factor of a number of the scene) and a time.
Differences bear the derivative out (`agrees`), or it is `off` by more than AGREES and than they resolve, or
`wrong` by more than WRONG; or they do not resolve WRONG, mostly because changed runs have other events. None
that is called differentiable may be wrong. Pairs are written to FILE scene by scene; scenes that are there
already are not run again.
"""

from __future__ import annotations

import argparse
import json
import time
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from modelgen.errors import ModelgenError
from modelgen.runtime.directions import QUANTITIES, directions_of
from tests.running import NAMES
from tests.sensitivity.pairs import Pair, Pairs, library_with_factors, opened, scales_of, shown

PARTS = (0.1, 0.35, 0.9)  # of the run
FACTORS = 6  # numbers of a scene


def study(name: str, cap: float, accuracy: str = "tight") -> list[dict[str, Any]]:
    """The pairs of a scene, of runs that take at most `cap` s of time."""
    library, meanings = library_with_factors(name, FACTORS)
    instance = library.manifest.instance
    moving = [body for body in instance["bodies"] if body["motion"] in ("free", "point")]
    body = moving[0]
    quantities = QUANTITIES if body["motion"] == "free" else ("position", "velocity")
    by = [*meanings] + [each["name"] for each in instance["inputs"]]
    by += [f"{body['name']}.{quantity}" for quantity in quantities]
    until = affordable(library, float(instance["run"].get("until") or 1.0), cap)
    pairs = Pairs(library, [part * until for part in PARTS], accuracy)
    return [
        entry_of(name, pair, meanings.get(pair.by, pair.by))
        for direction in directions_of(library, by)
        for pair in pairs.of(direction)
    ]


def affordable(library: Any, until: float, cap: float) -> float:
    """The end of the scene, earlier where its run takes too long."""
    while until > 1e-3:
        begun = time.process_time()
        shown(opened(library), [until], *scales_of(library))
        if time.process_time() - begun <= cap:
            break
        until /= 2
    return until


def entry_of(name: str, pair: Pair, by: str) -> dict[str, Any]:
    return {
        "scene": name, "by": by, "t": pair.t, "kind": pair.verdict.kind, "reason": pair.verdict.reason,
        "reason_t": pair.verdict.t, "contact": pair.verdict.contact, "outcome": pair.outcome,
        "error": pair.error, "size": pair.size, "noise": pair.noise,
    }  # fmt: skip


def print_scene(name: str, entries: Sequence[dict[str, Any]]) -> None:
    certain = [each for each in entries if each["kind"] == "differentiable"]
    counts = Counter(each["outcome"] for each in certain)
    others = Counter((each["reason"], each["outcome"]) for each in entries if each not in certain)
    worst = max(
        (each["error"] / (each["size"] or 1) for each in certain if each["outcome"] != "unresolved"),
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


def print_all(found: Sequence[dict[str, Any]]) -> None:
    undecided = [each for each in found if each["kind"] != "differentiable"]
    agree = sum(each["outcome"] == "agrees" for each in undecided)
    share = 100 * len(undecided) / max(len(found), 1)
    print(f"\n{len(found)} pairs, {len(undecided)} undecided ({share:.0f} %), of which {agree} agree")
    for key, count in sorted(
        Counter((each["kind"], each["reason"], each["outcome"]) for each in found).items()
    ):
        print(f"{count:5} {' | '.join(filter(None, key))}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--scenes", default=",".join(NAMES), help="names, separated by commas")
    parser.add_argument("--cap", type=float, default=0.1, help="processor time of a run, s")
    parser.add_argument("--accuracy", default="tight", help="of the derivatives")
    parser.add_argument("--out", type=Path, help="a file of all pairs, JSON")
    given = parser.parse_args()
    names = given.scenes.split(",")
    found: list[dict[str, Any]] = []
    if given.out and given.out.exists():
        found = json.loads(given.out.read_text())
    done = {each["scene"] for each in found}
    for name in names:
        if name in done:
            print_scene(name, [each for each in found if each["scene"] == name])
            continue
        begun = time.perf_counter()
        try:
            entries = study(name, given.cap, given.accuracy)
        except ModelgenError as error:
            print(f"{name:22} {error}")
            continue
        found += entries
        print_scene(name, entries)
        print(f"    {time.perf_counter() - begun:.0f} s", flush=True)
        if given.out:
            given.out.write_text(json.dumps(found, default=float))
    found = [each for each in found if each["scene"] in names]
    print_all(found)
    wrong = [each for each in found if each["kind"] == "differentiable" and each["outcome"] == "wrong"]
    assert not wrong, f"{len(wrong)} derivatives that are called differentiable are wrong"
    assert all(np.isfinite(each["size"]) for each in found if each["kind"] == "differentiable")


if __name__ == "__main__":
    main()
