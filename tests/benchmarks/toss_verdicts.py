"""Verdicts of measured tosses of a cube, up to their last frame and until the cube rests.

    python -m tests.benchmarks.toss_verdicts [--folder FOLDER] [--count 60] [--until S]

FOLDER holds tosses in the form of `tests/oracles/data/cube_tosses`, NUMBER.csv, of which COUNT are taken that
are evenly spread; as it is, the ten that come with the project. Told are how many runs at `balanced` are
trusted, each reason of those that are not, and for how many trusted ones a run at `tight` is farther away at
a frame than the sum of both stated errors. Exits with 1 if there is one.
"""

from __future__ import annotations

import argparse
from collections import Counter
from pathlib import Path

import numpy as np

from modelgen import simulate
from modelgen.runtime.trajectory import Trajectory
from tests.benchmarks.verdicts import reason
from tests.oracles.friction.cube_toss import FOLDER, scene_of, toss
from tests.running import library_of

SAMPLES = 100


def spread(folder: Path, count: int) -> list[int]:
    """Numbers of tosses, evenly spread."""
    numbers = sorted(int(path.stem) for path in folder.glob("*.csv"))
    return [numbers[k] for k in np.unique(np.linspace(0, len(numbers) - 1, count).round().astype(int))]


def is_near(path: Trajectory, other: Trajectory) -> bool:
    """Whether two runs end within the sum of their stated errors, at all samples that both predict."""
    n = min(len(path.t), len(other.t))
    apart = np.abs(path.p[:n] - other.p[:n]).max(axis=(1, 2))
    return bool(np.all(apart <= path.position_error[:n] + other.position_error[:n] + 1e-12))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--folder", type=Path, default=FOLDER)
    parser.add_argument("--count", type=int, default=60)
    parser.add_argument("--until", type=float, help="s; as it is, the last frame")
    given = parser.parse_args()
    trusted, wrong, reasons = 0, 0, Counter[str]()
    numbers = spread(given.folder, given.count)
    for number in numbers:
        measured = toss(number, given.folder)
        library, until = library_of(scene_of(measured)), given.until or float(measured.t[-1])
        path, fine = (
            simulate(library, until=until, samples=SAMPLES, accuracy=accuracy)
            for accuracy in ("balanced", "tight")
        )
        trusted += path.is_trusted
        if path.is_trusted and not is_near(path, fine):
            wrong += 1
            print(f"{number}: trusted, and farther from `tight` than both state")
        if not path.is_trusted:
            same = "as" if is_near(path, fine) else "not as"
            print(f"{number}: {path.outcome.name} {same} at `tight`: {'; '.join(path.doubts)}", flush=True)
            reasons.update({each for doubt in path.doubts for each in reason(doubt)})
    print(f"{trusted} of {len(numbers)} trusted, {wrong} of them farther from `tight` than both state")
    for each, count in reasons.most_common():
        print(f"{count:4} {each}")
    return int(wrong > 0)


if __name__ == "__main__":
    raise SystemExit(main())
