"""Balance the pole on the wheel of `scenes/balancing_wheel.toml`: from leaning to upright and at rest.

    python -m tests.examples.balance_the_wheel

The torque of the motor is sought with which the pole stands upright and at rest, over the place where it
began, after a second. The guess is a run under feedback.
"""

from __future__ import annotations

import casadi as ca
import numpy as np

from modelgen import build, derive, emit, read, require
from modelgen.optimal_control.run_from_state import run_from
from modelgen.optimal_control.transcription import Transcription
from tests.examples.plan_example import Array, PlanExample
from tests.running import SCENES

HORIZON, ELEMENTS = 1.0, 20
GAINS = (20.0, 4.0, 1.0, 1.5)  # of lean, its rate, place and speed of the axle
MOST = 20.0  # N m


def problem(elements: int = ELEMENTS, stages: int = 4) -> PlanExample:
    derivation = derive(require(read(SCENES / "balancing_wheel.toml")))
    library = build(emit(derivation), level="O1")
    model = derivation.model
    plan = Transcription(derivation, HORIZON, elements, stages=stages, impacts=False)
    wheel, pole = (
        next(each for each in library.manifest.instance["bodies"] if each["name"] == name)
        for name in ("wheel", "pole")
    )
    places = (wheel["q"], pole["q"] + 5)  # of the axle along x, and of the lean in the quaternion
    rates = (model.n_q + wheel["u"], model.n_q + pole["u"] + 4)

    def held_by(gains: Array) -> Array:
        """(elements, 1) torques of a run under feedback that is sampled once an element."""
        run, held = run_from(library, None, np.zeros(1)), []
        for k in range(elements):
            shown = run.sensors
            state = (shown["lean"], shown["turning"][1], shown["axle"][0], shown["speed"][0])  # type: ignore[index]
            held.append(float(np.clip(np.dot(gains, state), -MOST, MOST)))
            run.inputs.update({"torque": held[-1]})
            run.step(until=(k + 1) * HORIZON / elements)
        return np.array(held)[:, None]

    guess = plan.guess(library, inputs=held_by(np.array(GAINS)))
    plan.start_at(guess[: model.n_q], guess[model.n_q : model.n_q + model.n_u])
    end = plan.states[-1]
    plan.demand(ca.vertcat(*(end[k] for k in places)), -1e-6, 1e-6)
    plan.demand(ca.vertcat(*(end[k] for k in rates)), -1e-5, 1e-5)
    for held in plan.inputs:
        plan.demand(held, -MOST, MOST)
        plan.minimise(ca.sumsqr(held) * HORIZON / elements)

    def perturbed(random: np.random.Generator) -> Array:
        """A run under feedback with other gains, by up to a third."""
        return plan.guess(library, inputs=held_by(np.array(GAINS) * random.uniform(0.7, 1.3, len(GAINS))))

    def missed(x: Array) -> float:
        """Place of the axle, and how far the pole's centre of mass is beside it."""
        offset = np.abs(x[pole["q"] : pole["q"] + 2] - x[wheel["q"] : wheel["q"] + 2]).max()
        return float(abs(x[wheel["q"]]) + offset)

    return PlanExample(plan, library, guess, perturbed, missed)


if __name__ == "__main__":
    problem().tell()
