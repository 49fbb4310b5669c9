"""Digests of runs, one line a scene: `python -m tests.memory.digests FOLDER SECONDS SCENE.toml ..`

Each scene is run for at most SECONDS of its time, in calls of a few steps, with samples, sensors, and a state
that is saved and loaded after each call. With `--derivatives` it is differentiated by its parameters, inputs
and starts, forward and backward. Processes that print the same lines have made the same runs to the last
bit. Libraries go to FOLDER; with SECONDS 0 they are only built.
"""

from __future__ import annotations

import argparse
import os
from collections.abc import Mapping
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np

from modelgen import derive, emit, read, require
from modelgen.codegen import build
from modelgen.codegen.compiler import DEBUG
from modelgen.codegen.library import Library
from modelgen.errors import ModelgenError
from modelgen.runtime.core_session import CONTINUE, FULL, Session
from modelgen.runtime.gradient import gradient
from modelgen.runtime.recording import Recording
from modelgen.runtime.sensitivity import outputs_of, sensitivity
from modelgen.runtime.settings import accuracy_of
from modelgen.runtime.tables import library_tables
from tests.conftest import compile_without_optimisation
from tests.running import LEVEL

SAMPLES, CALL, STEPS_MAX = 20, 50, 1000
TIMES = 3  # of derivatives
SCRATCH = 2**28  # bytes of a run, which the debug core fills in each call


def until_of(library: Library, seconds: float) -> float:
    """The end of a run of at most that long."""
    return min(seconds, float(library.manifest.instance["run"]["until"]))


def run_digest(library: Library, seconds: float, steps_max: int = STEPS_MAX) -> str:
    """Outcome, steps and a digest of states, samples and events of a run."""
    session = Session(library, accuracy_of(library.manifest.instance, None, {}))
    until = until_of(library, seconds)
    digest, code = sha256(), session.begin()
    recording = Recording(session, np.linspace(0.0, until, SAMPLES + 1))
    while code in (0, CONTINUE, FULL) and session.run.t < until and session.run.steps < steps_max:
        code = session.advance(until, min(CALL, steps_max - session.run.steps), recording.record)
        digest.update(repr(session.drain_events()).encode())
        state = session.save()
        session.load(state)
        for _, array in sorted(session.run_arrays.items()):
            digest.update(array.tobytes())
        if session.shared.n_sensor:
            session.sense()
            digest.update(session.sensed.tobytes())
    for name in sorted(recording.arrays):
        digest.update(recording.arrays[name][: recording.record.count].tobytes())
    return f"{code} {session.run.steps} {digest.hexdigest()[:16]}"


def numbers_of(instance: Mapping[str, Any]) -> list[str]:
    """What a scene is differentiated by: its parameters and inputs, and the starts of a body."""
    named = [each["name"] for each in (*instance["parameters"], *instance["inputs"])]
    moving = [body["name"] for body in instance["bodies"] if body["motion"] in ("point", "free")]
    return named + [f"{body}.{of}" for body in moving[:1] for of in ("position", "velocity")]


def derivative_digest(library: Library, seconds: float) -> str:
    """Verdict and digest of derivatives, forward and, where the run does not end early, backward."""
    from casadi import MX, Function, sumsqr  # of derivatives only

    instance = library.manifest.instance
    times = np.linspace(0.0, until_of(library, seconds), TIMES + 1)[1:]
    of, by = list(outputs_of(instance)), numbers_of(instance)
    forward = sensitivity(library, times, of=of, by=by, estimate=False)
    digest = sha256(np.nan_to_num(forward.jacobian, nan=-1.0).tobytes())
    digest.update(np.nan_to_num(forward.value, nan=-1.0).tobytes())
    shown = MX.sym("shown", len(times), forward.value.shape[1])
    try:
        backward = gradient(library, times, Function("loss", [shown], [sumsqr(shown)]), of=of, by=by)
        digest.update(np.nan_to_num(backward.gradient, nan=-1.0).tobytes())
    except ModelgenError:
        digest.update(b"ended early")
    return f"{forward.verdict.kind} {digest.hexdigest()[:16]}"


def digest_of(scene: Path, folder: Path, seconds: float, derivatives: bool, steps_max: int) -> str:
    """What is printed of a scene. The debug core has derivatives in any case, so that it is compiled once."""
    try:
        package = emit(derive(require(read(scene))), derivatives=derivatives or DEBUG in os.environ)
        library = build.build(package, folder=folder / scene.stem, level=LEVEL)
        if not seconds > 0:
            return "built"
        if derivatives:
            return derivative_digest(library, seconds)
        return run_digest(library, seconds, steps_max)
    except ModelgenError as error:
        return f"refused: {type(error).__name__}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--derivatives", action="store_true")
    parser.add_argument("--steps", type=int, default=STEPS_MAX, help="at most, of each run")
    parser.add_argument("folder", type=Path)
    parser.add_argument("seconds", type=float)
    parser.add_argument("scenes", type=Path, nargs="+")
    given = parser.parse_args()
    build.compile_library = compile_without_optimisation
    library_tables.memory_of_run = lambda: SCRATCH
    for scene in given.scenes:
        told = digest_of(scene, given.folder, given.seconds, given.derivatives, given.steps)
        print(scene.stem, told, flush=True)


if __name__ == "__main__":
    main()
