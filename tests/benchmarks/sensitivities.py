"""What derivatives of runs cost, in units of the plain run, and what memory they take.

Run with `python -m tests.benchmarks.sensitivities [--scenes a,b] [--accuracy tight] [--part 0.3]`. Columns:
the plain run; a run with derivatives along no direction, which takes each step again; along 1, 4 and 12
directions; what one direction more costs (12 less 4, by 8); a gradient, forward with its check and back, for
any number of directions, and the part of it that goes back; the memory of 12 directions, and of the tape of a
gradient for a step. Times are the least of several of processor time, taken in turn.
"""

from __future__ import annotations

import argparse
import ctypes
import time

import numpy as np

from modelgen import build, derive, emit, read, require
from modelgen.codegen.library import Library
from modelgen.runtime.core_session import CONTINUE, FULL, Session
from modelgen.runtime.gradient import MARKS, SLOPES, TapedRun
from modelgen.runtime.sensitivity import Outputs, TangentRun
from modelgen.runtime.sensitivity_directions import QUANTITIES, direction_arrays, directions_of
from modelgen.runtime.settings import accuracy_of
from modelgen.runtime.start import begin
from tests.running import SCENES

NAMES = (
    *("bouncing_ellipsoid", "ellipsoid_on_plane", "double_pendulum", "rolling_ellipsoid", "egg_on_spline"),
    *("coin", "four_bar", "newton_cradle", "wheel_on_rail", "balancing_wheel"),
)
REPEATS = 7


class Measured:
    """Runs of one scene up to a part of its time."""

    def __init__(self, library: Library, accuracy: str, part: float) -> None:
        self.library, self._accuracy = library, accuracy
        instance = library.manifest.instance
        self._until = part * float(instance["run"].get("until") or 1.0)
        moving = [body for body in instance["bodies"] if body["motion"] in ("free", "point")]
        names = [
            f"{body['name']}.{quantity}"
            for body in moving
            for quantity in (QUANTITIES if body["motion"] == "free" else ("position", "velocity"))
        ]
        self._of = [f"{body['name']}.position" for body in moving]
        self._directions = (4 * directions_of(library.manifest.instance, names))[:12]

    def session(self) -> Session:
        return Session(self.library, accuracy_of(self.library.manifest.instance, self._accuracy, {}))

    def plain(self) -> float:
        session = self.session()
        begin(session)
        record, begun = session.tables.Record(), time.process_time()
        while session.advance(self._until, 1_000_000, record) in (CONTINUE, FULL):
            session.drain_events()
        return time.process_time() - begun

    def along(self, n: int) -> float:
        """Derivatives along n directions."""
        arrays = direction_arrays(self.library, self._directions[:n])
        run = TangentRun(self.session(), arrays, n)
        begun = time.process_time()
        run.go_on(self._until)
        return time.process_time() - begun

    def gradient(self) -> tuple[float, float]:
        """A gradient by all directions, and the part of it that goes back."""
        rows = direction_arrays(self.library, self._directions)
        combined = {
            name: np.ascontiguousarray(array[:1] if name in MARKS else np.sum(array, axis=0)[None])
            for name, array in rows.items()
        }
        run = TapedRun(self.session(), combined)
        outputs = Outputs(run.session, self._of)
        begun = time.process_time()
        run.go_on(self._until)
        turned = time.process_time()
        run.cotangents(outputs, [run.steps], np.ones((1, len(outputs.names))))
        ended = time.process_time()
        return ended - begun, ended - turned

    def memory(self) -> tuple[float, float]:
        """kB of 12 directions, and of the tape for a step."""
        session = self.session()
        size = session.library.cdll.mg_sensitivity_size
        size.restype = ctypes.c_long
        reals = size(ctypes.byref(session.system), 12)
        real = np.dtype(session.tables.dtype).itemsize
        return reals * real / 1e3, (session.shared.checkpoint_size + SLOPES * session.n_x * real) / 1e3


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--scenes", default=",".join(NAMES), help="names, separated by commas")
    parser.add_argument("--accuracy", default="tight")
    parser.add_argument("--part", type=float, default=0.3, help="of the time of the scene")
    given = parser.parse_args()
    columns = ("none", "1", "4", "12", "each", "gradient", "back")
    headings = " ".join(f"{heading:>6}" for heading in columns)
    print(f"{'scene':20} {'run':>8} {headings} {'memory':>9} {'a step':>8}")
    for name in given.scenes.split(","):
        library = build(emit(derive(require(read(SCENES / f"{name}.toml"))), derivatives=True))
        measured = Measured(library, given.accuracy, given.part)
        plain, *times = least_of(measured)
        ratios = [each / plain for each in times]
        ratios.insert(4, (ratios[3] - ratios[2]) / 8)
        memory, step = measured.memory()
        shown = " ".join(f"{ratio:{max(6, len(key))}.2f}" for key, ratio in zip(columns, ratios, strict=True))
        print(f"{name:20} {plain * 1e3:5.1f} ms {shown} {memory:6.0f} kB {step:5.1f} kB", flush=True)


def least_of(measured: Measured) -> list[float]:
    """The least times of several rounds: of the plain run, along 0, 1, 4 and 12 directions, of a gradient,
    and of going back."""
    rounds = [
        [measured.plain(), *(measured.along(n) for n in (0, 1, 4, 12)), *measured.gradient()]
        for _ in range(REPEATS)
    ]
    return [min(times) for times in zip(*rounds, strict=True)]


if __name__ == "__main__":
    main()
