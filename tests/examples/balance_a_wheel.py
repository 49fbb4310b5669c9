"""Bring the pole on the wheel of scenes/balancing_wheel.toml upright, at rest over another place, with least torque.

    python -m tests.examples.balance_a_wheel
"""

from __future__ import annotations

import casadi as ca
import numpy as np

from modelgen import build, derive, emit, read, require, start
from modelgen.codegen.library import Library
from modelgen.optimal_control.transcription import Transcription
from tests.examples.plan_example import Array, PlanExample
from tests.running import SCENES

HORIZON, ELEMENTS = 1.0, 12
GAINS = np.array([30.0, 6.0, 1.0, 1.5])  # of the feedback in the guess: lean, its rate, place, speed
GOAL = 0.3  # m, the axle beside its start


def problem(elements: int = ELEMENTS, stages: int = 3) -> PlanExample:
    derivation = derive(require(read(SCENES / "balancing_wheel.toml")))
    library = build(emit(derivation), level="O1")
    model = derivation.model
    n_q, n_u = model.n_q, model.n_u
    bodies = {each["name"]: each for each in library.manifest.instance["bodies"]}
    wheel, pole = bodies["wheel"]["q"], bodies["pole"]["q"]
    rates = [n_q + bodies["wheel"]["u"], n_q + bodies["pole"]["u"] + 4]  # vx of the axle, turning of the pole
    plan = Transcription(derivation, HORIZON, elements, stages=stages, impacts=False)
    guess = plan.guess(library, inputs=balancing(library, elements))
    plan.start_at(guess[:n_q], guess[n_q : n_q + n_u])
    end = plan.states[-1]
    plan.demand(end[wheel], GOAL)
    plan.demand(end[pole + 5], 0.0)  # y of the quaternion: its lean
    plan.demand(end[rates], 0.0)
    for torque in plan.inputs:
        plan.demand(torque, -20.0, 20.0)
        plan.minimise(ca.sumsqr(torque))

    def perturbed(random: np.random.Generator) -> Array:
        """How it is balanced with other gains, and pushed at random."""
        torques = balancing(library, elements, random.uniform(0.8, 1.2, 4))
        return plan.guess(library, inputs=torques + random.normal(scale=0.1, size=torques.shape))

    def missed(x: Array) -> float:
        """Of the place of the axle, and of the top of the pole."""
        return float(abs(x[wheel] - GOAL) + 0.8 * abs(2 * x[pole + 5]))

    return PlanExample(plan, library, guess, perturbed, missed)


def balancing(library: Library, elements: int, factors: Array | None = None) -> Array:
    """(elements, 1) torques of a feedback that is sampled once an element, N m."""
    run, torques = start(library), []
    gains = GAINS * (np.ones(4) if factors is None else factors)
    for k in range(elements):
        shown = run.sensors
        felt = [shown["lean"], shown["turning"][1], shown["axle"][0], shown["speed"][0]]
        torques.append(float(np.clip(gains @ np.array(felt, dtype=float), -20, 20)))
        run.inputs["torque"] = torques[-1]
        run.step((k + 1) * HORIZON / elements)
    return np.array(torques)[:, None]


if __name__ == "__main__":
    problem().tell()
