"""Ratios of speed, all taken in one run. Run with `python -m tests.benchmarks.speed`.

The smooth RK4 step of the C core against the same step written by hand in C, with the instructions of both
counted by callgrind where valgrind is installed; and `simulate` against the bare loop of the core.
"""

from __future__ import annotations

import ctypes
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from time import perf_counter

import numpy as np

from modelgen import Accuracy, simulate
from modelgen.codegen.compiler import find_compiler
from tests.benchmarks.counted import STEP, core_steps, hand_steps, start, state_of
from tests.benchmarks.counting import COUNTED_CPU, callgrind, countable
from tests.running import scene_of

HERE = Path(__file__).parent
STEPS = 200_000
FLAGS = ("-O3", "-fno-math-errno", "-shared", "-fPIC")


def hand_written(folder: Path, cpu: str) -> Path:
    """The hand-written step, compiled with the flags under which it is fastest."""
    target = folder / "hand_written.so"
    command = [*find_compiler().command, *FLAGS, cpu, str(HERE / "hand_written.c"), "-o", str(target), "-lm"]
    subprocess.run(command, check=True)
    return target


def median_ns(call: Callable[[], None], repeats: int = 9) -> float:
    """Median wall time of one call per step, ns."""
    times = []
    for _ in range(repeats):
        begun = perf_counter()
        call()
        times.append(perf_counter() - begun)
    return median(times) / STEPS * 1e9


def one_step_each() -> None:
    with TemporaryDirectory() as folder:
        library = ctypes.CDLL(str(hand_written(Path(folder), "-march=native")))
        session = start(scene_of("ellipsoid_on_plane"))
        state = state_of(session)
        core_steps(session, 1000)
        hand_steps(library, state, 1000)
        print(f"difference after 1000 steps: {np.abs(state - state_of(session)).max():.1e}")
        ours = median_ns(lambda: core_steps(session, STEPS))
        theirs = median_ns(lambda: hand_steps(library, state, STEPS))
    print(f"RK4 step: core {ours:.0f} ns, by hand {theirs:.0f} ns, ratio {ours / theirs:.2f}")


def instructions() -> None:
    """Instructions of one step by callgrind: the difference of a long and a short run."""
    if shutil.which("valgrind") is None:
        print("instructions: valgrind is not installed")
        return
    library = scene_of("ellipsoid_on_plane")
    with TemporaryDirectory() as name:
        folder = Path(name)
        hand_written(folder, COUNTED_CPU)
        countable(library, folder)
        for which in ("core", "hand"):
            few, many = (callgrind("tests.benchmarks.counted", which, folder, n) for n in (1000, 1001000))
            print(f"instructions of an RK4 step, {which}: {(many - few) / 1000000:.0f}")


def loop_and_simulate() -> None:
    library = scene_of("ellipsoid_on_plane")
    accuracy = Accuracy.tight().fixed_step(STEP)
    until = STEPS * STEP
    fixed = median(
        simulate(library, until=STEP, accuracy=accuracy, samples=1, estimate=False).wall_s for _ in range(9)
    )
    whole = median(
        simulate(library, until=until, accuracy=accuracy, samples=200, estimate=False).wall_s
        for _ in range(5)
    )
    bare = []
    for _ in range(5):
        session = start(library)
        record = session.tables.Record()
        begun = perf_counter()
        session.advance(until, 10**9, record)
        bare.append(perf_counter() - begun)
    print(f"fixed cost of simulate: {fixed * 1e3:.1f} ms")
    ratio = whole / median(bare)
    print(f"simulate over {STEPS} steps: {whole:.3f} s, bare loop {median(bare):.3f} s, ratio {ratio:.2f}")


def main() -> None:
    one_step_each()
    instructions()
    loop_and_simulate()


if __name__ == "__main__":
    main()
