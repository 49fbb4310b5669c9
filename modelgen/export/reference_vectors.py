"""Test vectors: states of a run of the scene at some times, with how far another machine may be off."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from modelgen.codegen.library import Library
from modelgen.runtime.accuracy import Accuracy
from modelgen.runtime.c_initialisers import array_text, values_text
from modelgen.runtime.core_session import CONTINUE, FULL, Session
from modelgen.runtime.error_statement import Estimate
from modelgen.runtime.recording import Recording
from modelgen.runtime.simulate import simulate
from modelgen.runtime.start import begin
from modelgen.runtime.tables.ctypes_structures import Array

COUNT = 10  # intervals between vectors
STEPS = 1000  # in one call of the core
MARGIN = 10.0  # tolerance over the estimate of the error, which is one of magnitude
ROUNDING = 64.0  # tolerance of numbers without an error, in roundings of the largest of their kind

HEAD = """/* States of the run of the scene as modelgen has them, and tolerances: {margin:g} times the
   estimate of the error of that run. Per vector and body that moves 18 numbers: position, rotation matrix by
   columns, velocity, angular velocity in body axes. Per vector four tolerances: m, 1, m/s, rad/s; MG_MAX: the
   run has no estimate there. */
#define VECTORS {count}
#define VECTOR_BODIES {bodies}
#define VECTOR_UNTIL ((mg_real){until}) /* s */
#define VECTOR_CODE {code} /* with which the run ends */
"""


@dataclass(frozen=True, slots=True)
class Vectors:
    """States of a run.

    Attributes:
        text: the file `vectors.h`.
        compared: vectors with a tolerance.
        count: all vectors.
        statement: the estimate of the run in words.
    """

    text: str
    compared: int
    count: int
    statement: str


def vectors_of(library: Library, accuracy: Accuracy) -> Vectors:
    """The vectors of the run of the scene file. Raises SimulationError where its start is refused."""
    instance = library.manifest.instance
    until = float(instance["run"]["until"])
    path = simulate(library, accuracy=accuracy, samples=COUNT, estimate=True)
    session = Session(library, accuracy)
    fresh = Recording(Session(library, accuracy), np.linspace(0.0, until, COUNT + 1))
    recording = Recording(session, np.linspace(0.0, until, COUNT + 1))
    begin(session)
    code = CONTINUE if not session.start_code else session.start_code
    while code in (CONTINUE, FULL):
        code = session.advance(until, STEPS, recording.record)
        session.drain_events()
    count = recording.record.count
    moving = [k for k, body in enumerate(instance["bodies"]) if body["motion"] != "fixed"]
    states = np.concatenate([recording.arrays["pose"], recording.arrays["twist"]], axis=2)[:count, moving]
    tolerances = _tolerances(path.estimate, states, float(np.finfo(library.dtype).eps))
    names = {at: f"record_{k}" for k, at in enumerate(fresh.placed)}
    head = HEAD.format(margin=MARGIN, count=count, bodies=len(moving), until=until.hex(), code=code)
    arrays = [array_text(names[at], array) for at, array in fresh.placed.items()]
    text = "\n".join(
        [
            head,
            *arrays,
            f"static mg_record record = {values_text(fresh.record, names)};",
            array_text("vector_state", states.astype(library.dtype), "static const"),
            array_text("vector_tolerance", tolerances.astype(library.dtype), "static const"),
        ]
    )
    compared = int((tolerances[:, 0] < np.finfo(library.dtype).max).sum())
    statement = path.estimate.statement if path.estimate else "no estimate"
    return Vectors(text + "\n", compared, count, statement)


def _tolerances(estimate: Estimate | None, states: Array, eps: float) -> Array:
    """(n, 4): of position, rotation, velocity, angular velocity; the largest number where there is none."""
    limit = float(np.finfo(states.dtype).max)
    found = np.full((len(states), 4), limit)
    if estimate is None or not len(states):
        return found
    groups = (slice(0, 3), slice(3, 12), slice(12, 15), slice(15, 18))
    errors = (estimate.position, estimate.rotation, estimate.velocity, estimate.spin)
    predicted = min(estimate.predicted, len(states))
    for column, (group, error) in enumerate(zip(groups, errors, strict=True)):
        size = np.nanmax(np.abs(states[:, :, group]), initial=0.0)
        told = MARGIN * np.asarray(error)[:predicted] + ROUNDING * eps * max(1.0, float(size))
        found[:predicted, column] = np.where(np.isfinite(told), told, limit)
    return found
