"""Ratios of speed, all taken in one run. Run with `python -m tests.benchmarks.speed`.

The smooth RK4 step of the C core against the same step written by hand in C, with the instructions of both
counted by callgrind where valgrind is installed; and `simulate` against the bare loop of the core.
"""

from __future__ import annotations

import ctypes
import os
import re
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from time import perf_counter

import numpy as np

from modelgen import Accuracy, simulate
from modelgen.runtime.closest import find_closest
from modelgen.runtime.session import Session
from tests.running import scene_of

HERE = Path(__file__).parent
STEPS, STEP = 200_000, 1e-4
FLAGS = ("-O3", "-march=native", "-fno-math-errno", "-shared", "-fPIC")


def hand_written(folder: Path) -> ctypes.CDLL:
    """The hand-written step, compiled with the flags under which it is fastest."""
    compiler = shutil.which("gcc") or shutil.which("cc") or "cc"
    target = folder / "hand_written.so"
    subprocess.run([compiler, *FLAGS, str(HERE / "hand_written.c"), "-o", str(target), "-lm"], check=True)
    return ctypes.CDLL(str(target))


def started() -> Session:
    """A session of ellipsoid_on_plane at its start, ready for RK4."""
    session = Session(scene_of("ellipsoid_on_plane"), Accuracy.tight().fixed_step(STEP))
    find_closest(session)
    session.begin()
    return session


def core_steps(session: Session, n: int) -> None:
    session.library.cdll.mg_smooth(*session._head, ctypes.c_long(n), *session._scratch)


def hand_steps(library: ctypes.CDLL, state: np.ndarray, n: int) -> None:
    a, b, c, m = 0.12, 0.09, 0.07, 1.2
    body = np.array([a * a, b * b, c * c, 1 / m, 0.00312, 0.004632, 0.0054, 9.81])
    library.hand_written_steps(
        ctypes.c_void_p(body.ctypes.data),
        ctypes.c_void_p(state.ctypes.data),
        ctypes.c_double(STEP),
        ctypes.c_long(n),
    )


def state_of(session: Session) -> np.ndarray:
    """The 13 states of the body in the hand-written step's order."""
    sentence = session.sentence
    egg = next(body for body in sentence["bodies"] if body["name"] == "egg")
    q, u = egg["q"], sentence["n_q"] + egg["u"]
    return np.concatenate([session.x[q : q + 7], session.x[u : u + 6]]).copy()


def timed(call: object, repeats: int = 9) -> float:
    """Median wall time of one call per step, ns."""
    times = []
    for _ in range(repeats):
        start = perf_counter()
        call()  # type: ignore[operator]
        times.append(perf_counter() - start)
    return median(times) / STEPS * 1e9


def instructions(which: str) -> float | None:
    """Instructions of one step by callgrind: the difference of a long and a short run of this module."""
    if shutil.which("valgrind") is None:
        return None
    counts = [_callgrind(which, n) for n in (1000, 11000)]
    return (counts[1] - counts[0]) / 10000


def _callgrind(which: str, n: int) -> int:
    command = ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null", sys.executable, "-m", __spec__.name]
    environment = {**os.environ, "PYTHONHASHSEED": "0"}
    done = subprocess.run([*command, which, str(n)], capture_output=True, text=True, check=True, env=environment)
    found = re.search(r"Collected : (\d+)", done.stderr)
    assert found, done.stderr
    return int(found[1])


def one_step_each() -> None:
    with TemporaryDirectory() as folder:
        library = hand_written(Path(folder))
        session = started()
        state = state_of(session)
        core = state_of(session)
        core_steps(session, 1000)
        hand_steps(library, state, 1000)
        print(f"difference after 1000 steps: {np.abs(state - state_of(session)).max():.1e}")
        assert not np.array_equal(core, state)
        ours = timed(lambda: core_steps(session, STEPS))
        theirs = timed(lambda: hand_steps(library, state, STEPS))
    print(f"RK4 step: core {ours:.0f} ns, by hand {theirs:.0f} ns, ratio {ours / theirs:.2f}")


def loop_and_simulate() -> None:
    library = scene_of("ellipsoid_on_plane")
    accuracy = replace(Accuracy.tight().fixed_step(STEP))
    until = STEPS * STEP
    fixed = median(simulate(library, until=STEP, accuracy=accuracy, samples=1).wall_s for _ in range(9))
    whole = median(simulate(library, until=until, accuracy=accuracy, samples=200).wall_s for _ in range(5))
    bare = []
    for _ in range(5):
        session = Session(library, accuracy)
        find_closest(session)
        session.begin()
        record = session.tables.Record()
        start = perf_counter()
        session.advance(until, 10**9, record)
        bare.append(perf_counter() - start)
    print(f"fixed cost of simulate {fixed * 1e3:.1f} ms")
    print(f"simulate over {STEPS} steps {whole:.3f} s, bare loop {median(bare):.3f} s, ratio {whole / median(bare):.2f}")


def main() -> None:
    if len(sys.argv) == 3:
        return counted(sys.argv[1], int(sys.argv[2]))
    one_step_each()
    for which in ("core", "hand"):
        print(f"instructions of a step, {which}: {instructions(which)}")
    return loop_and_simulate()


def counted(which: str, n: int) -> None:
    with TemporaryDirectory() as folder:
        if which == "hand":
            hand_steps(hand_written(Path(folder)), state_of(started()), n)
        else:
            core_steps(started(), n)


if __name__ == "__main__":
    main()
