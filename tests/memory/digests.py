"""Digests of runs, one line a scene: `python -m tests.memory.digests FOLDER SECONDS SCENE.toml ..`

Each scene is run for at most SECONDS of its time, in calls of a few steps, with samples, sensors, and a state
that is saved and loaded after each call. Processes that print the same lines have made the same runs to the
last bit. Libraries go to FOLDER; with SECONDS 0 they are only built.
"""

from __future__ import annotations

import sys
from hashlib import sha256
from pathlib import Path

import numpy as np

from modelgen import derive, emit, read, require
from modelgen.codegen import build
from modelgen.codegen.library import Library
from modelgen.errors import ModelgenError
from modelgen.runtime.core_session import CONTINUE, FULL, Session
from modelgen.runtime.recording import Recording
from modelgen.runtime.settings import accuracy_of
from tests.conftest import compile_without_optimisation
from tests.running import LEVEL

SAMPLES, CALL, STEPS_MAX = 20, 50, 1000


def run_digest(library: Library, seconds: float) -> str:
    """Outcome, steps and a digest of states, samples and events of a run."""
    session = Session(library, accuracy_of(library.manifest.instance, None, {}))
    until = min(seconds, float(library.manifest.instance["run"]["until"]))
    digest, code = sha256(), session.begin()
    recording = Recording(session, np.linspace(0.0, until, SAMPLES + 1))
    while code in (0, CONTINUE, FULL) and session.run.t < until and session.run.steps < STEPS_MAX:
        code = session.advance(until, CALL, recording.record)
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


def main(folder: str, seconds: str, *scenes: str) -> None:
    build.compile_library = compile_without_optimisation
    for scene in scenes:
        name = Path(scene).stem
        try:
            package = emit(derive(require(read(Path(scene)))))
            library = build.build(package, folder=Path(folder) / name, level=LEVEL)
            told = run_digest(library, float(seconds)) if float(seconds) > 0 else "built"
        except ModelgenError as error:
            told = f"refused: {type(error).__name__}"
        print(name, told, flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
