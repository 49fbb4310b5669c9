"""Ratios of speed, all taken in one run. Run with `python -m tests.benchmarks.speed`.

The smooth RK4 step, of a general library and of one whose numbers are folded into its code (`fold`), and the
step that `simulate` takes, with its search for events, against the same step written by hand in C, with the
instructions counted by callgrind where valgrind is installed; `simulate` against the bare loop of the core;
and the Python of a call of `simulate`.
"""

from __future__ import annotations

import ctypes
import shutil
import subprocess
from collections.abc import Callable
from functools import partial
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from time import perf_counter

import numpy as np

from modelgen import Accuracy, build, derive, emit, require, simulate
from modelgen.codegen.compiler import find_compiler
from modelgen.codegen.library import Library
from modelgen.runtime.core_session import Session
from modelgen.runtime.recording import Recording
from modelgen.scene.read import read_text
from tests.benchmarks.counted import STEP, core_steps, hand_steps, start, state_of
from tests.benchmarks.counting import COUNTED_CPU, callgrind, countable
from tests.benchmarks.step_cost import SCENES, library_of

HERE = Path(__file__).parent
STEPS = 200_000
SHORT = 2000  # steps of one of many runs
COUNTED = 100_000  # steps under callgrind
FLAGS = ("-O3", "-fno-math-errno", "-shared", "-fPIC")


def hand_written(folder: Path, cpu: str) -> Path:
    """The hand-written step, compiled with the flags under which it is fastest."""
    target = folder / "hand_written.so"
    command = [*find_compiler().command, *FLAGS, cpu, str(HERE / "hand_written.c"), "-o", str(target), "-lm"]
    subprocess.run(command, check=True)
    return target


def folded(folder: Path) -> Library:
    """ellipsoid_on_plane with its numbers as constants of the code."""
    scene = read_text("fold = true\n" + (SCENES / "ellipsoid_on_plane.toml").read_text(), "folded.toml")
    return build(emit(derive(require(scene))), folder=folder / "build")


def least_ns(*calls: Callable[[], object], repeats: int = 300) -> list[float]:
    """Wall time of a step of each call, ns: the least of many short runs in turn, which is undisturbed."""
    times = []
    for _ in range(repeats):
        marks = [perf_counter()]
        for call in calls:
            call()
            marks.append(perf_counter())
        times.append(np.diff(marks))
    return [float(least) for least in np.min(times, axis=0) / SHORT * 1e9]


def one_step_each() -> None:
    with TemporaryDirectory() as folder:
        library = ctypes.CDLL(str(hand_written(Path(folder), "-march=native")))
        sessions = [start(library_of("ellipsoid_on_plane")), start(folded(Path(folder)))]
        state = state_of(sessions[0])
        hand_steps(library, state, 1000)
        for session in sessions:
            core_steps(session, 1000)
            print(f"difference after 1000 steps: {np.abs(state - state_of(session)).max():.1e}")
        *ours, theirs = least_ns(
            *(partial(core_steps, session, SHORT) for session in sessions),
            lambda: hand_steps(library, state, SHORT),
        )
    for name, time in zip(("general", "folded"), ours, strict=True):
        print(f"RK4 step, {name}: {time:.0f} ns, by hand {theirs:.0f} ns, ratio {time / theirs:.2f}")


def instructions() -> None:
    """Instructions of one step by callgrind: the difference of a long and a short run."""
    if shutil.which("valgrind") is None:
        print("instructions: valgrind is not installed")
        return
    with TemporaryDirectory() as name:
        general, fold = Path(name) / "general", Path(name) / "folded"
        for folder, library in ((general, library_of("ellipsoid_on_plane")), (fold, folded(Path(name)))):
            folder.mkdir()
            countable(library, folder)
        hand_written(general, COUNTED_CPU)
        for label, which, folder in (
            ("general", "core", general), ("folded", "core", fold), ("by hand", "hand", general)
        ):  # fmt: skip
            few, many = (
                callgrind("tests.benchmarks.counted", which, folder, n) for n in (1000, 1000 + COUNTED)
            )
            print(f"instructions of an RK4 step, {label}: {(many - few) / COUNTED:.0f}")


def advanced(library: Library, until: float) -> float:
    """Wall time of the core alone, from a settled start, s."""
    session = start(library)
    record = session.tables.Record()
    begun = perf_counter()
    session.advance(until, 10**9, record)
    return perf_counter() - begun


def step_of_simulate() -> None:
    """The step with search for events, projection and diagnostics beside the hand-written one."""
    library = library_of("ellipsoid_on_plane")
    with TemporaryDirectory() as folder:
        hand = ctypes.CDLL(str(hand_written(Path(folder), "-march=native")))
        state = state_of(start(library))
        (theirs,) = least_ns(lambda: hand_steps(hand, state, SHORT))
    ours = min(advanced(library, SHORT * STEP) for _ in range(100)) / SHORT * 1e9
    print(f"RK4 step of simulate: {ours:.0f} ns, by hand {theirs:.0f} ns, ratio {ours / theirs:.1f}")


def python_of_a_call() -> None:
    """A call of `simulate` without what the core takes of it, the least of each."""
    library = library_of("ellipsoid_on_plane")
    accuracy = Accuracy.tight().fixed_step(STEP)
    whole, core = [], []
    for _ in range(500):
        begun = perf_counter()
        simulate(library, until=STEP, accuracy=accuracy, samples=1, estimate=False)
        whole.append(perf_counter() - begun)
        session = Session(library, accuracy)
        recording = Recording(session, np.array([0.0, STEP]))
        begun = perf_counter()
        session.begin()
        session.advance(STEP, 100, recording.record)
        core.append(perf_counter() - begun)
    print(f"a call of simulate: {1e6 * min(whole):.0f} us, of which the core {1e6 * min(core):.0f} us")


def loop_and_simulate() -> None:
    library = library_of("ellipsoid_on_plane")
    accuracy = Accuracy.tight().fixed_step(STEP)
    until = STEPS * STEP
    whole = median(
        simulate(library, until=until, accuracy=accuracy, samples=200, estimate=False).wall_s
        for _ in range(5)
    )
    bare = [advanced(library, until) for _ in range(5)]
    ratio = whole / median(bare)
    print(f"simulate over {STEPS} steps: {whole:.3f} s, bare loop {median(bare):.3f} s, ratio {ratio:.2f}")


def main() -> None:
    one_step_each()
    instructions()
    step_of_simulate()
    loop_and_simulate()
    python_of_a_call()


if __name__ == "__main__":
    main()
