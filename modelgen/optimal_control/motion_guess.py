"""A simulated run as a guess of a plan: its states, contact forces and rates at given times."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from modelgen.casadi_functions.as_casadi import mode_of, rhs_arguments
from modelgen.codegen.library import Library
from modelgen.composition.contact_mode import ContactMode
from modelgen.derivation import Derivation
from modelgen.errors import ModelgenError
from modelgen.optimal_control.run_from_state import run_from, set_inputs
from modelgen.runtime.stepped_simulation import Simulation

Array = np.ndarray[Any, Any]


@dataclass(frozen=True)
class MotionGuess:
    """A run at some times: start (n_x,), x (times, n_x), inputs (times, inputs), forces (times, rows) N, and
    rates (times, rows) m/s, slip among them."""

    start: Array
    x: Array
    inputs: Array
    forces: Array
    rates: Array


def guessed_motion(
    derivation: Derivation,
    library: Library,
    times: Sequence[float],
    start: Array | None,
    inputs: Array | None,
) -> MotionGuess:
    """A run at these times; `inputs` (times, inputs) are held up to each. A run that ends stays where it is,
    and its forces are zero."""
    simulation = run_from(library, start, None if inputs is None else inputs[0])
    first = np.array(simulation.state[:-1], dtype=float)
    states, held, loads = [], [], []
    functions: dict[ContactMode, ca.Function] = {}
    for k, t in enumerate(times):
        if inputs is not None:
            set_inputs(simulation, inputs[k])
        if simulation.outcome is None:
            simulation.step(float(t))
        states.append(np.array(simulation.state[:-1], dtype=float))
        held.append(np.array(simulation.session.input[:-1:3], dtype=float))
        loads.append(_forces_and_rates(derivation, simulation, functions))
    rows = max((each.shape[1] for each in loads), default=0)
    filled = np.array([each if each.shape[1] == rows else np.zeros((2, rows)) for each in loads])
    shown = np.array(held).reshape(len(times), -1)
    return MotionGuess(first, np.array(states), shown, filled[:, 0], filled[:, 1])


def _forces_and_rates(
    derivation: Derivation, simulation: Simulation, functions: dict[ContactMode, ca.Function]
) -> Array:
    """(2, rows) at the present state; none where its mode has no equations of rows."""
    try:
        mode = mode_of(derivation, simulation)
    except ModelgenError:
        return np.zeros((2, 0))
    if mode not in functions:
        solved = derivation.solved(mode)
        rates = ca.vertcat(ca.DM(0, 1), *(row.rate for row in solved.scene.rows.rows))
        functions[mode] = solved.function("loads", {"both": ca.horzcat(solved.found.forces, rates)})
    given = [ca.DM(each) for each in rhs_arguments(derivation.model, simulation)]
    return np.array(functions[mode].call(given)[0]).T
