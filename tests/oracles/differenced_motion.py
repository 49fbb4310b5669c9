"""The eigenvalues of the compiled right-hand side about a place at rest, by differences of all of its states.

The core keeps J u_dot + gamma = 0 of what sticks there, so that whatever would leave the constraints is
carried along: it adds zeros to the eigenvalues, nothing else.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from modelgen import Accuracy
from modelgen.codegen.library import Library
from modelgen.linearisation.equilibrium_and_modes import Linearised
from modelgen.runtime.core_session import Session
from modelgen.runtime.start import begin

Array = np.ndarray[Any, np.dtype[np.float64]]

STEP = 1e-6  # of each state, in m, rad, m/s, rad/s


def exponents(found: Linearised) -> Array:
    """s of the modes exp(s t) that move, those of an oscillation both."""
    values = [mode.growth + 1j * mode.frequency for mode in found.modes if mode.growth or mode.frequency]
    return _sorted([*values, *(value.conjugate() for value in values if value.imag)])


def differenced(library: Library, found: Linearised) -> Array:
    """As many eigenvalues (1/s), the largest."""
    session = Session(library, Accuracy.tight())
    instance = library.manifest.instance
    for body in instance["bodies"]:
        if body["name"] in found.p:
            q = np.concatenate([found.p[body["name"]], found.quaternion[body["name"]]])
            size = 7 if body["motion"] == "free" else 3
            session.x[body["q"] : body["q"] + size] = q[:size]
    session.x[instance["n_q"] : instance["n_q"] + instance["n_u"]] = 0.0
    begin(session)
    n, x = len(session.x) - 1, session.x.copy()
    columns, out = [], np.zeros_like(x)
    for k in range(n):
        ends = []
        for sign in (1, -1):
            moved = x.copy()
            moved[k] += sign * STEP
            session.evaluate(0.0, moved, out)
            ends.append(out[:n].copy())
        columns.append((ends[0] - ends[1]) / (2 * STEP))
    values = np.linalg.eigvals(np.array(columns, dtype=float).T)
    return _sorted(values[np.argsort(-np.abs(values))][: len(exponents(found))])


def _sorted(values: Any) -> Array:
    given = np.asarray(values, dtype=complex)
    return given[np.lexsort((given.real.round(6), given.imag.round(6)))]
