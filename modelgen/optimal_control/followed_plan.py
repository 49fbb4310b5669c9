"""A plan followed by a run: the states that its inputs lead to."""

from __future__ import annotations

from typing import Any

import numpy as np

from modelgen.codegen.library import Library
from modelgen.optimal_control.run_from_state import run_from, set_inputs

Array = np.ndarray[Any, Any]


def followed(library: Library, t: Array, x: Array, inputs: Array) -> Array:
    """(n + 1, n_x) the states of a run from x[0] under the inputs of a plan, at the ends of its elements."""
    n = int(library.manifest.instance["n_q"]) + int(library.manifest.instance["n_u"])
    simulation = run_from(library, x[0][:n], inputs[0] if inputs.shape[1] else None)
    states = [np.array(simulation.state[:-1], dtype=float)]
    for until, held in zip(t[1:], inputs, strict=True):
        if held.size:
            set_inputs(simulation, held)
        if simulation.outcome is None:
            simulation.step(float(until))
        states.append(np.array(simulation.state[:-1], dtype=float))
    return np.array(states)
