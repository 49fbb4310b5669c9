"""Roll an ellipsoid on a plane from rest to rest at another place, with least torque.

    python roll_an_ellipsoid.py

Prints how far the simulated plan ends from its goal.
"""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np

from modelgen import build, derive, emit, require
from modelgen.optimal_control.motion_guess import followed
from modelgen.optimal_control.transcription import Plan, Transcription
from modelgen.scene.read import read_text

SCENE = """
gravity = [0.0, 0.0, -9.81]

[[input]]
name = "tx"
default = 0.0

[[input]]
name = "ty"
default = 0.0

[[input]]
name = "tz"
default = 0.0

[[body]]
name = "table"
motion = "fixed"
shape = { kind = "plane" }

[[body]]
name = "egg"
shape = { kind = "ellipsoid", semi_axes = [0.12, 0.1, 0.1] }
density = 1000.0
position = [0.0, 0.0, 0.1]

[[contact]]
between = ["egg", "table"]
friction = 2.0

[[torque]]
body = "egg"
torque = ["tx", "ty", "tz"]
"""
HORIZON, ELEMENTS = 1.2, 10
GOAL = (0.15, 0.1)  # m, beside the start


def problem() -> tuple[Transcription, Any, np.ndarray[Any, Any]]:
    """The program, the library of its scene, and a guess: the ellipsoid at rest."""
    derivation = derive(require(read_text(SCENE, "roll.toml")))
    library = build(emit(derivation), level="O1")
    plan = Transcription(derivation, HORIZON, ELEMENTS, impacts=False)
    guess = plan.guess(library)
    n_q, n_u = derivation.model.n_q, derivation.model.n_u
    plan.start_at(guess[:n_q], guess[n_q : n_q + n_u])
    end = plan.states[-1]
    plan.demand(end[:2], GOAL)
    plan.demand(end[n_q : n_q + n_u], -1e-6, 1e-6)
    plan.minimise(sum((ca.sumsqr(torque) for torque in plan.inputs), ca.MX(0)))
    return plan, library, guess


def perturbed(plan: Transcription, library: Any, random: np.random.Generator) -> np.ndarray[Any, Any]:
    """Another guess: how it rolls under small random torques."""
    return plan.guess(library, inputs=random.normal(scale=0.05, size=(ELEMENTS, 3)))


def missed(library: Any, found: Plan) -> float:
    """m, from the goal to where the simulated plan ends."""
    end = followed(library, found.t, found.x, found.inputs)[-1]
    return float(np.hypot(*(end[:2] - GOAL)))


if __name__ == "__main__":
    plan, library, guess = problem()
    found = plan.solve(guess)
    print(f"solved: {found.solution.success}; the simulated plan misses by {missed(library, found):.1e} m")
