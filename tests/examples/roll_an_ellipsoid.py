"""Roll an ellipsoid on a plane from rest in one pose to rest in another, with least torque.

    python -m tests.examples.roll_an_ellipsoid

It rolls without slipping, so that its place and its orientation are steered together.
"""

from __future__ import annotations

import casadi as ca
import numpy as np

from modelgen import build, derive, emit, require
from modelgen.optimal_control.transcription import Transcription
from modelgen.scene.read import read_text
from tests.examples.plan_example import Array, PlanExample

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
TURNS = (0.4, 0.5)  # rad: the long axis points so far to the side, and the body is turned so far about it


def problem(elements: int = ELEMENTS, stages: int = 3) -> PlanExample:
    derivation = derive(require(read_text(SCENE, "roll.toml")))
    library = build(emit(derivation), level="O1")
    plan = Transcription(derivation, HORIZON, elements, stages=stages, impacts=False)
    guess = plan.guess(library)
    n_q, n_u = derivation.model.n_q, derivation.model.n_u
    plan.start_at(guess[:n_q], guess[n_q : n_q + n_u])
    end, goal = plan.states[-1], goal_quaternion()
    plan.demand(end[:2], GOAL)
    plan.demand(vector_of_difference(end[3:7], goal), 0.0)
    plan.demand(end[n_q : n_q + n_u], -1e-6, 1e-6)  # more than the contact leaves free
    plan.minimise(sum((ca.sumsqr(torque) for torque in plan.inputs), ca.MX(0)))

    def perturbed(random: np.random.Generator) -> Array:
        """How it rolls under small random torques."""
        return plan.guess(library, inputs=random.normal(scale=0.05, size=(elements, 3)))

    def missed(x: Array) -> float:
        """Of the place, m, and of the orientation, rad times a semi-axis."""
        turned = 2 * np.linalg.norm(np.array(vector_of_difference(x[3:7], goal)).ravel())
        return float(np.hypot(*(x[:2] - GOAL)) + 0.1 * turned)

    return PlanExample(plan, library, guess, perturbed, missed)


def goal_quaternion() -> Array:
    """(w, x, y, z) of a turn about the vertical after one about the long axis."""
    side, about = np.array(TURNS) / 2
    a, b = np.array([np.cos(side), np.sin(side)]), np.array([np.cos(about), np.sin(about)])
    return np.array([a[0] * b[0], a[0] * b[1], a[1] * b[1], a[1] * b[0]])


def vector_of_difference(q: ca.MX, goal: Array) -> ca.MX:
    """(3,) half the small turn from the goal to q, rad."""
    w, v = goal[0], ca.DM(goal[1:])
    return w * q[1:4] - q[0] * v - ca.cross(q[1:4], v)


if __name__ == "__main__":
    problem().tell()
