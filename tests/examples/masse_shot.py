"""Strike a ball on a table so that it slides around an obstacle, comes to roll, and is at its goal in time.

    python -m tests.examples.masse_shot

Speed and spin of the strike are sought, with least energy. The ends of the elements move to the instant at
which it begins to roll.
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

[[body]]
name = "table"
motion = "fixed"
shape = { kind = "plane" }

[[body]]
name = "ball"
shape = { kind = "sphere", radius = 0.4 }
density = 200.0
position = [0.0, 0.0, 0.4]
velocity = [1.0, 0.5, 0.0]
angular_velocity = [4.0, 0.0, 0.0]

[[contact]]
between = ["ball", "table"]
friction = 0.3
"""
HORIZON, ELEMENTS = 0.6, 12
GOAL = (0.5, 0.0)  # m
OBSTACLE, AWAY = (0.25, 0.0), 0.05  # m, its place, and how far beside it the ball passes


def problem(elements: int = ELEMENTS, stages: int = 3) -> PlanExample:
    derivation = derive(require(read_text(SCENE, "masse.toml")))
    library = build(emit(derivation), level="O1")
    model = derivation.model
    plan = Transcription(derivation, HORIZON, elements, stages=stages, free_lengths=True, impacts=False)
    guess = plan.guess(library)
    plan.start_at(guess[: model.n_q])
    start, end = plan.states[0], plan.states[-1]
    plan.demand(ca.vertcat(start[9], start[12]), 0.0)  # it is struck along the table, without spin about N
    plan.demand(end[:2], GOAL)
    beside = plan.states[elements // 2]
    plan.demand(beside[0], OBSTACLE[0])
    plan.demand(beside[1], OBSTACLE[1] + AWAY, np.inf)
    plan.minimise(ca.sumsqr(start[7:10]) + 0.4 * ca.sumsqr(0.4 * start[10:13]))

    def perturbed(random: np.random.Generator) -> Array:
        """A strike with other speeds and spins, by up to a third."""
        struck = np.array(model.initial_u) * random.uniform(0.7, 1.3, model.n_u)
        return plan.guess(library, np.concatenate([model.initial_q, struck]))

    def missed(x: Array) -> float:
        return float(np.hypot(*(x[:2] - GOAL)))

    return PlanExample(plan, library, guess, perturbed, missed)


if __name__ == "__main__":
    problem().tell()
