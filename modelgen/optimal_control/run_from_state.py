"""A run from a given state with given inputs."""

from __future__ import annotations

from typing import Any

import numpy as np

from modelgen.codegen.library import Library
from modelgen.runtime.core_session import Session
from modelgen.runtime.settings import accuracy_of
from modelgen.runtime.stepped_simulation import Simulation

Array = np.ndarray[Any, Any]


def run_from(library: Library, start: Array | None, inputs: Array | None = None) -> Simulation:
    """A run from q and u (n_q + n_u,), None: those of the scene, with values of all inputs."""
    session = Session(library, accuracy_of(library.manifest.instance, None, {}))
    if start is not None:
        session.x[: len(start)] = start
    simulation = Simulation(session)
    if inputs is not None:
        set_inputs(simulation, inputs)
    simulation.begin()
    return simulation


def set_inputs(simulation: Simulation, values: Array) -> None:
    """Give all inputs of the scene these values."""
    names = [each["name"] for each in simulation.session.instance["inputs"]]
    simulation.inputs.update(dict(zip(names, map(float, values), strict=True)))
