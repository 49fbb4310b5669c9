"""Plans of a block that is pushed over rough ground, against the programs of all sequences of its modes.

With one stage of collocation an element is a step of the implicit Euler method, of a block of 1 kg:
v_k - v_{k-1} = h (push_k + f_k), x_k - x_{k-1} = h v_k. In an element the block slides ahead, slides back or
sticks, and for each sequence of these the least effort is a convex quadratic program.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import casadi as ca
import numpy as np
import pytest

from modelgen import build, derive, emit, require
from modelgen.optimal_control.transcription import Plan, Transcription
from modelgen.scene.read import read_text

SCENE = """
[[input]]
name = "push"
default = 0.0
[[body]]
name = "table"
motion = "fixed"
shape = { kind = "plane" }
[[body]]
name = "block"
shape = { kind = "point" }
mass = 1.0
inertia = [1.0, 1.0, 1.0]
[[force]]
body = "block"
force = ["push", "0", "0"]
[[contact]]
between = ["block", "table"]
friction = FRICTION
"""
AHEAD, STICKS, BACK = 0, 1, 2
STARTS = 12
CLOSE = 1e-4  # to the border of a mode, in its units: a relaxation of 1e-7 leaves a tenth of that


@dataclass(frozen=True)
class Task:
    """Move by `distance`, m, from rest to rest within `horizon`, s, with the least effort."""

    friction: float
    distance: float
    horizon: float
    n: int

    @property
    def bound(self) -> float:
        return self.friction * 9.81

    def values(self) -> dict[tuple[int, ...], float]:
        """The least value of each sequence of modes that reaches the goal."""
        n, h = self.n, self.horizon / self.n
        v, push, f = (ca.SX.sym(name, n) for name in ("v", "push", "f"))
        moved = v - ca.vertcat(0, v[:-1]) - h * (push + f)
        goal = ca.vertcat(h * ca.sum1(v) - self.distance, v[-1])
        program = {"x": ca.vertcat(v, push, f), "f": h * ca.sumsqr(push), "g": ca.vertcat(moved, goal)}
        options = {"printLevel": "none", "error_on_fail": False, "print_time": False}
        solver, found = ca.qpsol("least", "qpoases", program, options), {}
        ranges = {AHEAD: (0, np.inf, -1, -1), STICKS: (0, 0, -1, 1), BACK: (-np.inf, 0, 1, 1)}
        free = np.full(n, np.inf)
        for modes in product(ranges, repeat=n):
            low, high, least, most = (
                np.array([ranges[mode][k] for mode in modes], dtype=float) for k in range(4)
            )
            lower = np.concatenate([low, -free, self.bound * least])
            upper = np.concatenate([high, free, self.bound * most])
            answer = solver(x0=0, lbx=lower, ubx=upper, lbg=0, ubg=0)
            if solver.stats()["success"]:
                found[modes] = float(answer["f"])
        return found

    def modes_of(self, plan: Plan) -> list[set[int]]:
        """The modes in which each element of a plan may be, several on the border of two."""
        possible = []
        for v, force in zip(plan.x[1:, 7], plan.forces[:, 0], strict=True):
            f = force[1] if abs(force[1]) >= abs(force[2]) else force[2]
            f = float(np.sign(f) * np.hypot(force[1], force[2]))
            modes = {STICKS} if abs(v) < CLOSE else set()
            modes |= {AHEAD} if v > -CLOSE and abs(f + self.bound) < CLOSE * self.bound else set()
            modes |= {BACK} if v < CLOSE and abs(f - self.bound) < CLOSE * self.bound else set()
            possible.append(modes)
        return possible

    def plans(self) -> list[Plan]:
        """From as many random pushes."""
        text = SCENE.replace("FRICTION", repr(self.friction))
        derivation = derive(require(read_text(text, "push.toml")))
        library = build(emit(derivation))
        wanted = Transcription(derivation, self.horizon, self.n, stages=1, impacts=False)
        end = wanted.states[-1]
        wanted.start_at([0, 0, 0, 1, 0, 0, 0], [0] * 6)
        wanted.demand(end[0], self.distance)
        wanted.demand(end[7], 0.0)
        for h, push in zip(wanted.lengths, wanted.inputs, strict=True):
            wanted.minimise(h * push[0] ** 2)
        solver, random = wanted.solver(), np.random.default_rng(round(1000 * self.friction))
        pushes = random.uniform(-self.bound, 3 * self.bound, (STARTS, self.n, 1))
        return [wanted.solve(wanted.guess(library, inputs=each), solver=solver) for each in pushes]


TASKS = [
    Task(friction, distance, horizon, n)
    for friction, distance, horizon, n in [
        *((0.3, 0.3, 1.0, 6), (0.1, 0.3, 1.0, 5), (0.5, 0.2, 1.0, 6), (0.3, 0.5, 1.5, 6), (0.2, 0.1, 0.5, 5)),
        *(
            (0.8, 0.3, 1.0, 5),
            (0.05, 1.0, 2.0, 6),
            (0.4, 0.05, 0.4, 6),
            (0.6, 1.0, 2.0, 6),
            (0.15, 0.2, 2.0, 6),
        ),
        *((0.3, 0.3, 0.6, 6), (1.0, 0.1, 1.0, 5)),
    ]
]


@pytest.mark.cases(2)
@pytest.mark.parametrize("task", TASKS, ids=str)
def test_no_plan_succeeds_that_another_mode_beside_it_improves(task: Task) -> None:
    values, near, succeeded = task.values(), 0, 0
    least = min(values.values())
    for plan in task.plans():
        if not plan.solution.success:
            continue
        succeeded += 1
        value, beside = plan.solution.value, product(*task.modes_of(plan))
        best = min((values[modes] for modes in beside if modes in values), default=np.inf)
        assert best == pytest.approx(value, rel=1e-3), (task, plan.inputs.ravel())
        assert value > least * (1 - CLOSE)
        near += value < 1.01 * least
    print(f"{task}: {succeeded} of {STARTS} succeed, {near} within 1 % of {least:.6g}")
    assert succeeded > STARTS // 2
