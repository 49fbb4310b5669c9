"""How often fits converge, and how often the truth lies in the intervals they state.

    python -m tests.benchmarks.fits [--out FILE] [SCENE..]

prints for each scene of tests/identification/motions.py: of 100 recordings with noise, how many have each
parameter, and all of them, in its 95 % interval; and of 20 first guesses within half of the truth, and of 20
anywhere in the ranges of the parameters, alone and with two more, how many lead to the truth. Results are
appended to FILE one by one; those that are there already are not computed again.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from modelgen import ModelgenError, fit
from modelgen.identification.fit import Fit
from tests.identification.motions import MOTIONS, Motion

GUESSES, TRIALS = 20, 100
NEAR = 1e-3  # relative: a fit to a recording without noise that found the truth


def fitted(motion: Motion, guess: Callable[[int], Mapping[str, float]], seed: int, starts: int) -> bool:
    recording, first = motion.recording(), guess(seed)
    try:
        found = fit(motion.library, recording, by=motion.by, parameters=first, starts=starts)
    except ModelgenError:
        return False
    return bool(np.allclose(found.values, motion.true_values, rtol=NEAR))


def covered(motion: Motion, seed: int) -> list[bool]:
    found: Fit = fit(motion.library, motion.recording(seed), by=motion.by)
    ranges = [found.interval(name) for name in motion.by]
    return [bool(low <= true <= high) for (low, high), true in zip(ranges, motion.true_values, strict=True)]


class Results:
    """Results by scene, kind and seed, in a file where one is given."""

    def __init__(self, path: Path | None) -> None:
        self._path = path
        self._known: dict[tuple[Any, ...], Any] = {}
        for line in path.read_text().splitlines() if path and path.exists() else ():
            *key, result = json.loads(line)
            self._known[tuple(key)] = result

    def of(self, key: tuple[str, str, int], function: Callable[[], Any]) -> Any:
        if key not in self._known:
            self._known[key] = function()
            if self._path:
                with self._path.open("a") as file:
                    file.write(json.dumps([*key, self._known[key]]) + "\n")
        return self._known[key]


def study(name: str, motion: Motion, results: Results) -> None:
    inside = np.array(
        [results.of((name, "covered", seed), partial(covered, motion, seed)) for seed in range(TRIALS)]
    )
    each = ", ".join(f"{by} {n}" for by, n in zip(motion.by, inside.sum(axis=0), strict=True))
    print(f"{name}: of {TRIALS} trials within: {each}; all {inside.all(axis=1).sum()}", flush=True)
    for word, guess, starts in (
        ("within half of the truth", motion.near_guess, 1),
        ("anywhere in the ranges", motion.other_guess, 1),
        ("anywhere in the ranges, with two more,", motion.other_guess, 3),
    ):
        good = sum(
            results.of((name, word, seed), partial(fitted, motion, guess, seed, starts))
            for seed in range(GUESSES)
        )
        print(f"{name}: of {GUESSES} first guesses {word} {good} converge", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("scenes", nargs="*", help=f"of {', '.join(MOTIONS)}; all unless given")
    parser.add_argument("--out", type=Path, help="a file of all results, a line of JSON each")
    given = parser.parse_args()
    results = Results(given.out)
    for name in given.scenes or MOTIONS:
        study(name, MOTIONS[name], results)


if __name__ == "__main__":
    main()
