"""A simulated run as a guess of a plan, and a plan followed by a run."""

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
from modelgen.runtime.core_session import Session
from modelgen.runtime.settings import accuracy_of
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


def run_from(library: Library, start: Array | None, inputs: Array | None = None) -> Simulation:
    """A run from q and u (n_q + n_u,), None: those of the scene, with values of all inputs."""
    session = Session(library, accuracy_of(library.manifest.instance, None, {}))
    if start is not None:
        session.x[: len(start)] = start
    simulation = Simulation(session)
    if inputs is not None:
        _set_inputs(simulation, inputs)
    simulation.begin()
    return simulation


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
            _set_inputs(simulation, inputs[k])
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


def followed(library: Library, t: Array, x: Array, inputs: Array) -> Array:
    """(n + 1, n_x) the states of a run from x[0] under the inputs of a plan, at the ends of its elements."""
    n = int(library.manifest.instance["n_q"]) + int(library.manifest.instance["n_u"])
    simulation = run_from(library, x[0][:n], inputs[0] if inputs.shape[1] else None)
    states = [np.array(simulation.state[:-1], dtype=float)]
    for until, held in zip(t[1:], inputs, strict=True):
        if held.size:
            _set_inputs(simulation, held)
        if simulation.outcome is None:
            simulation.step(float(until))
        states.append(np.array(simulation.state[:-1], dtype=float))
    return np.array(states)


def _set_inputs(simulation: Simulation, values: Array) -> None:
    names = [each["name"] for each in simulation.session.instance["inputs"]]
    simulation.inputs.update(dict(zip(names, map(float, values), strict=True)))
