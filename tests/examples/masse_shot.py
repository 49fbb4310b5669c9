"""Strike a ball on a table so that it slides around an obstacle, comes to roll, and is at its goal in time.

    python masse_shot.py

Speed and spin of the strike are sought, with least energy. Prints how far the simulated ball misses its goal.
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


def problem() -> tuple[Transcription, Any, np.ndarray[Any, Any]]:
    """The program, the library of its scene, and a guess: the strike that the scene says."""
    derivation = derive(require(read_text(SCENE, "masse.toml")))
    library = build(emit(derivation), level="O1")
    plan = Transcription(derivation, HORIZON, ELEMENTS, free_lengths=True, impacts=False)
    guess = plan.guess(library)
    plan.start_at(guess[: derivation.model.n_q])
    start, end = plan.states[0], plan.states[-1]
    plan.demand(ca.vertcat(start[9], start[12]), 0.0)  # it is struck along the table, without spin about N
    plan.demand(end[:2], GOAL)
    beside = plan.states[ELEMENTS // 2]
    plan.demand(beside[0], OBSTACLE[0])
    plan.demand(beside[1], OBSTACLE[1] + AWAY, np.inf)
    plan.minimise(ca.sumsqr(start[7:10]) + 0.4 * ca.sumsqr(0.4 * start[10:13]))
    return plan, library, guess


def perturbed(plan: Transcription, library: Any, random: np.random.Generator) -> np.ndarray[Any, Any]:
    """Another guess: a strike with other speeds and spins, by up to a third."""
    model = plan.derivation.model
    start = np.concatenate([model.initial_q, np.array(model.initial_u) * random.uniform(0.7, 1.3, model.n_u)])
    return plan.guess(library, start)


def missed(library: Any, found: Plan) -> float:
    """m, from the goal to where the simulated ball is at the end."""
    end = followed(library, found.t, found.x, found.inputs)[-1]
    return float(np.hypot(*(end[:2] - GOAL)))


if __name__ == "__main__":
    plan, library, guess = problem()
    found = plan.solve(guess)
    print(f"solved: {found.solution.success}; the simulated ball misses by {missed(library, found):.1e} m")
