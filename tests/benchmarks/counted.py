"""One thing many times: `python -m tests.benchmarks.counted core|hand|free|loaded FOLDER N`.

core and hand take N RK4 steps of ellipsoid_on_plane; free and loaded take N of bodies in a bowl, without
forces and with every body on the bowl. FOLDER holds manifest.json, library.json, the model's library (named
in the latter) and, for hand, hand_written.so.
"""

from __future__ import annotations

import ctypes
import sys
from pathlib import Path

import numpy as np

from modelgen.codegen.library import Library
from modelgen.runtime.accuracy import Accuracy
from modelgen.runtime.core_session import Session
from modelgen.runtime.start import begin

STEP = 1e-4


def start(library: Library) -> Session:
    """A session of ellipsoid_on_plane at its start, ready for RK4; its support form needs no search."""
    session = Session(library, Accuracy.tight().fixed_step(STEP))
    begin(session)
    return session


def core_steps(session: Session, n: int) -> None:
    session.smooth(n)


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
    instance = session.instance
    egg = next(body for body in instance["bodies"] if body["name"] == "egg")
    q, u = egg["q"], instance["n_q"] + egg["u"]
    return np.concatenate([session.x[q : q + 7], session.x[u : u + 6]]).copy()


def bowl_steps(library: Library, loaded: bool, n: int) -> None:
    session = Session(library, Accuracy.balanced().fixed_step(1e-9))
    begin(session)
    session.active[: len(session.instance["bodies"]) - 1] = loaded
    session.smooth(n)


def main(which: str, folder: Path, n: int) -> None:
    if which in ("free", "loaded"):
        bowl_steps(Library.load(folder), which == "loaded", n)
        return
    session = start(Library.load(folder))
    if which == "core":
        core_steps(session, n)
    else:
        hand_steps(ctypes.CDLL(str(folder / "hand_written.so")), state_of(session), n)


if __name__ == "__main__":
    main(sys.argv[1], Path(sys.argv[2]), int(sys.argv[3]))
