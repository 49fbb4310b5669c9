"""Which starts are refused: pairs of all kinds that are apart, touch or overlap, by decades.

    python -m tests.benchmarks.starts --count 2000 [--part 0/2] [--kinds sphere frustum] [--seed K]

A pair of kinds is drawn as by `first_touches` and moved down to a height over its first touch, or below it:
by decades of the size of the smaller body, and at the first touch itself. One in five has one body at random
within the other's reach. Points of faces and edges in the other body tell how deep bodies overlap, at least.
A member fails if bodies that overlap by more than `start_gap` are not refused (missed), or if bodies that
only touch, or are apart, are refused (spurious). One line for each that fails, then how many of each, and the
median time of a start in microseconds.
"""

from __future__ import annotations

import argparse
import time
from collections import Counter
from dataclasses import dataclass, replace
from itertools import combinations_with_replacement

import numpy as np

from modelgen import ModelgenError, start
from modelgen.errors import SceneError
from modelgen.scene.scene_types import Scene
from tests.benchmarks.first_touches import (
    DOWN,
    Placed,
    _length,
    _library,
    _rotation,
    _scene,
    draw,
    specimens,
    travel,
)
from tests.benchmarks.measured_solids import depth
from tests.benchmarks.solids_by_decades import CURVES, SHEETS, VARIANTS

OVERLAPS = ("interpenetrate", "is within")
START_GAP = 1e-8  # Accuracy.start_gap
UNSURE = 4  # start_gap, about which either is right
ROUNDING = 1e-12  # of the sizes of bodies
EVERY = 5  # members, of which one is placed at random, on average


@dataclass(frozen=True)
class Start:
    moving: Placed
    fixed: Placed
    above: float  # m, height over the first touch; negative below it; nan at random
    limit: float  # m, within which it was looked for

    @property
    def scene(self) -> Scene:
        return _scene(self.moving, self.fixed)


def start_of(first: str, second: str, seed: int) -> Start | None:
    member = draw(first, second, seed)
    if member is None:
        return None
    rng = np.random.default_rng([seed, *map(ord, first + second)])
    small = min([x for x in (member.moving.radius, member.fixed.radius) if 0 < x < np.inf] or [1.0])
    if rng.integers(EVERY) == 0:
        reach = min(member.moving.radius + min(member.fixed.radius, 3 * member.moving.radius), 60.0)
        at = member.fixed.p + reach * rng.uniform(-1, 1, 3)
        return Start(replace(member.moving, p=at, R=_rotation(rng)), member.fixed, np.nan, 0.0)
    size = small * 10 ** rng.uniform(-9, -0.3)
    above = float(rng.choice([-1.0, -1.0, 1.0, 0.0])) * size
    above = min(above, member.way)
    return Start(
        replace(member.moving, p=member.moving.p + (member.way - above) * DOWN),
        member.fixed,
        above,
        member.way,
    )


def overlap(found: Start) -> float:
    """Greatest depth of points of one body in the other, m; negative: apart."""
    both = found.moving, found.fixed
    return max(
        depth(a.solid, b.solid, b.R.T @ (a.p - b.p), b.R.T @ a.R)
        for a, b in (both, both[::-1])
        if a.solid.faces or a.solid.edges
    )


def judged(found: Start) -> tuple[str, float, str, float]:
    """Outcome, depth m, what was told, s."""
    try:
        library = _library(found.scene)
    except SceneError as error:
        return "no pair", 0.0, str(error), 0.0
    begun, told = time.perf_counter(), ""
    try:
        start(library)
    except ModelgenError as error:
        told = str(error)
    seconds, deep = time.perf_counter() - begun, overlap(found)
    scale = library.manifest.instance["scales"]["length"]
    sizes = sum(x.radius for x in (found.moving, found.fixed) if x.radius < np.inf)
    unsure = UNSURE * START_GAP * scale + ROUNDING * sizes
    is_refused = any(each in told for each in OVERLAPS)
    if told and not is_refused:
        return "other refusal", deep, told, seconds
    if deep > unsure and not is_refused:
        return "missed", deep, told, seconds
    if is_refused and deep < START_GAP * scale / UNSURE and _are_apart(found, START_GAP * scale / UNSURE):
        return "spurious", deep, told, seconds
    return ("overlapping" if is_refused else "apart"), deep, "", seconds


def _are_apart(found: Start, touching: float) -> bool:
    """Whether the bodies overlap by no more than they may, as far as their construction tells."""
    if np.isnan(found.above):
        return overlap(found) < -1e-3 * _length(found.moving, found.fixed)
    if found.above < -touching:
        return False
    raised = replace(found.moving, p=found.moving.p - 2 * found.limit * DOWN)
    way = travel(raised, found.fixed, 4 * found.limit, parts=4, most=100)
    return 2 * found.limit - way < touching


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=2000)
    parser.add_argument("--kinds", nargs="*", default=[])
    parser.add_argument("--part", default="0/1", help="k/n: every n-th pair of kinds, from the k-th")
    parser.add_argument("--seed", type=int, help="one member of each pair of kinds alone")
    options = parser.parse_args()
    part, parts = map(int, options.part.split("/"))
    pairs = [
        found
        for one, two in combinations_with_replacement(VARIANTS, 2)
        if (not options.kinds or {one, two} & {*options.kinds})
        and not {one, two} <= {*CURVES, "disc"} and not {one, two} & {*SHEETS}
        and (found := specimens(one, two))
    ][part::parts]  # fmt: skip
    rounds = -(-options.count // parts // len(pairs))
    outcomes: Counter[str] = Counter()
    seconds: list[float] = []
    for seed in range(rounds) if options.seed is None else [options.seed]:
        for found in pairs:
            one, two = found[seed % len(found)]
            member = start_of(one, two, seed)
            if member is None:
                outcomes["not set up"] += 1
                continue
            outcome, deep, told, took = judged(member)
            outcomes[outcome] += 1
            seconds.append(took)
            if outcome in ("missed", "spurious", "other refusal"):
                print(
                    f"{outcome}: {one} {two} {seed}: above {member.above:.3g} depth {deep:.3g} {told}",
                    flush=True,
                )
    print(", ".join(f"{name} {n}" for name, n in outcomes.most_common()))
    print(f"median {1e6 * float(np.median(seconds)):.0f} us")


if __name__ == "__main__":
    main()
