"""What the worked examples of plans share."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from modelgen.codegen.library import Library
from modelgen.optimal_control.followed_plan import followed
from modelgen.optimal_control.relaxation import RELAXATIONS, RelaxedSolver
from modelgen.optimal_control.transcription import Plan, Transcription

Array = np.ndarray[Any, Any]


@dataclass(frozen=True)
class PlanExample:
    """A program, and starts of its solution.

    Attributes:
        guess: all unknowns, from a simulated run.
        perturbed: others, from runs with random starts or inputs.
        missed: how far a state (n_x,) at the end is from what was wanted, m.
        relaxations: of its solver.
    """

    plan: Transcription
    library: Library
    guess: Array
    perturbed: Callable[[np.random.Generator], Array]
    missed: Callable[[Array], float]
    relaxations: tuple[float, ...] = RELAXATIONS

    def solver(self) -> RelaxedSolver[ca.MX]:
        return self.plan.solver(self.relaxations)

    def simulated(self, found: Plan) -> Array:
        """(n + 1, n_x) the states of a run under the inputs of the plan."""
        return followed(self.library, found.t, found.x, found.inputs)

    def reproduced(self, found: Plan) -> tuple[float, float]:
        """Largest difference of the simulated plan, at all ends of elements: of positions, m or parts of a
        quaternion, and of velocities, m/s or rad/s."""
        model = self.plan.derivation.model
        apart = np.abs(self.simulated(found) - found.x)
        return float(apart[:, : model.n_q].max()), float(apart[:, model.n_q : model.n_q + model.n_u].max())

    def tell(self) -> None:
        """Solve it from its guess and print what came out."""
        found = self.plan.solve(self.guess, solver=self.solver())
        positions, velocities = self.reproduced(found)
        print(f"solved: {found.solution.success}, in {found.solution.iterations} iterations")
        print(f"the simulated plan misses by {self.missed(self.simulated(found)[-1]):.1e} m")
        print(f"and differs from the plan by {positions:.1e} m, {velocities:.1e} m/s at most")


def upright(q: Any) -> Any:
    """(3,) the vertical in the axes of a body with the quaternion q (w, x, y, z)."""
    w, x, y, z = q[0], q[1], q[2], q[3]
    return 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x**2 + y**2)
