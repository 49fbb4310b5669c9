"""Put a spinning coin down on its edge: it is let go upright.

    python -m tests.examples.put_a_coin_on_its_edge

A coin that is held leaning over a table, and spins, is moved by a force and a torque until it touches the
table with its rim, with as little force as that takes. Then it is let go, and spins on.
"""

from __future__ import annotations

import casadi as ca
import numpy as np

from modelgen import build, derive, emit, require
from modelgen.optimal_control.relaxation import RELAXATIONS
from modelgen.optimal_control.run_from_state import run_from
from modelgen.optimal_control.transcription import Transcription
from modelgen.scene.read import read_text
from tests.examples.plan_example import Array, PlanExample, upright

RADIUS, SPIN, LEAN, HEIGHT = 0.1, 9.0, 0.3, 0.05  # m, rad/s, rad, m over the table at the start
SCENE = f"""
gravity = [0.0, 0.0, -9.81]

[[input]]
name = "fx"
[[input]]
name = "fy"
[[input]]
name = "fz"
[[input]]
name = "tx"
[[input]]
name = "ty"
[[input]]
name = "tz"

[[body]]
name = "table"
motion = "fixed"
shape = {{ kind = "plane" }}

[[body]]
name = "coin"
shape = {{ kind = "circle", radius = {RADIUS} }}
mass = 0.1
inertia = [2.5e-4, 2.5e-4, 5e-4]
position = [0.0, 0.0, {RADIUS + HEIGHT}]
axis_angle = {{ axis = [1.0, 0.0, 0.0], angle = "pi/2 - {LEAN}" }}
angular_velocity = [0.0, 0.0, {SPIN}]

[[contact]]
between = ["coin", "table"]
friction = 0.5

[[force]]
body = "coin"
force = ["fx", "fy", "fz"]

[[torque]]
body = "coin"
torque = ["tx", "ty", "tz"]
"""
HORIZON, ELEMENTS = 0.4, 12
ALONE = 0.5  # s, for which it spins on after it was let go
WEIGHT = 0.1 * 9.81


def problem(elements: int = ELEMENTS, stages: int = 4) -> PlanExample:
    derivation = derive(require(read_text(SCENE, "put_a_coin_on_its_edge.toml")))
    library = build(emit(derivation), level="O1")
    model = derivation.model
    plan = Transcription(derivation, HORIZON, elements, stages=stages)
    carried = np.zeros((elements, 6))
    carried[:, 2] = WEIGHT  # the guess hovers
    guess = plan.guess(library, inputs=carried)
    plan.start_at(guess[: model.n_q], guess[model.n_q : model.n_q + model.n_u])
    end = plan.states[-1]
    vertical = ca.vertcat(*upright(end[3:7]))
    plan.demand(end[:2], -1e-5, 1e-5)
    plan.demand(end[2] - RADIUS, -1e-5, 1e-5)
    plan.demand(vertical[2], -1e-5, 1e-5)
    plan.demand(end[7:10], -1e-5, 1e-5)
    plan.demand(end[10:13] - SPIN * vertical, -1e-4, 1e-4)
    for held in plan.inputs:
        plan.minimise(ca.sumsqr(held[:3] - ca.DM([0, 0, WEIGHT])) + ca.sumsqr(held[3:] / RADIUS))

    def perturbed(random: np.random.Generator) -> Array:
        """How it moves under a random force and torque beside those that carry it."""
        scale = WEIGHT * np.array([0.2, 0.2, 0.2, 0.01, 0.01, 0.01])
        return plan.guess(library, inputs=carried + scale * random.normal(size=(elements, 6)))

    def missed(x: Array) -> float:
        """Of the place of its centre, and of its lean, some time after it was let go."""
        alone = run_from(library, x[: model.n_q + model.n_u], np.zeros(6))
        alone.step(ALONE)
        q = alone.state
        return float(np.linalg.norm(q[:3] - [0, 0, RADIUS]) + RADIUS * abs(upright(q[3:7])[2]))

    return PlanExample(plan, library, guess, perturbed, missed, (1e-1, 1e-2, *RELAXATIONS))


if __name__ == "__main__":
    problem().tell()
