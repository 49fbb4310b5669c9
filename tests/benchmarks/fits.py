"""How often fits converge, and how often the truth lies in the intervals they state.

    python -m tests.benchmarks.fits [SCENE..]

prints for each scene of tests/identification/motions.py: of 20 first guesses within half of the truth, and
of 20 anywhere in the ranges of the parameters, alone and with two more, how many lead to the truth; and of
100 recordings with noise, how many have each parameter, and all of them, in its 95 % interval.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Mapping

import numpy as np

from modelgen import ModelgenError, fit
from modelgen.identification.fit import Fit
from tests.identification.motions import MOTIONS, Motion

GUESSES, TRIALS = 20, 100
NEAR = 1e-3  # relative: a fit to a recording without noise that found the truth


def fitted(motion: Motion, guess: Mapping[str, float], starts: int = 1) -> bool:
    try:
        found = fit(motion.library, motion.recording(), by=motion.by, parameters=guess, starts=starts)
    except ModelgenError:
        return False
    return bool(np.allclose(found.values, motion.true_values, rtol=NEAR))


def covered(motion: Motion, seed: int) -> list[bool]:
    found: Fit = fit(motion.library, motion.recording(seed), by=motion.by)
    ranges = [found.interval(name) for name in motion.by]
    return [low <= true <= high for (low, high), true in zip(ranges, motion.true_values, strict=True)]


def main() -> None:
    for name in sys.argv[1:] or MOTIONS:
        motion = MOTIONS[name]
        began = time.perf_counter()
        for word, guess, starts in (
            ("within half of the truth", motion.near_guess, 1),
            ("anywhere in the ranges", motion.other_guess, 1),
            ("anywhere in the ranges, with two more,", motion.other_guess, 3),
        ):
            good = sum(fitted(motion, guess(seed), starts) for seed in range(GUESSES))
            print(f"{name}: of {GUESSES} first guesses {word} {good} converge", flush=True)
        inside = np.array([covered(motion, seed) for seed in range(TRIALS)])
        each = ", ".join(f"{by} {n}" for by, n in zip(motion.by, inside.sum(axis=0), strict=True))
        took = time.perf_counter() - began
        print(
            f"{name}: of {TRIALS} trials within: {each}; all {inside.all(axis=1).sum()} ({took:.0f} s)",
            flush=True,
        )


if __name__ == "__main__":
    main()
