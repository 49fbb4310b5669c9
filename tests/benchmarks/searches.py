"""Runs that searches without derivatives need for tasks of the worked examples, beside the ways of modelgen.

    python -m tests.benchmarks.searches [--starts 5] [--task masse_shot]

Two tasks, from perturbed starts:

- throw_a_cube: velocity and spin of a cube, so that it ends on a face at a place; by Gauss and Newton's
  method with derivatives of runs, with differences of runs, and by CMA-ES (package `cma`, extra `searches`);
- masse_shot: speed and spin of a ball, so that it passes beside an obstacle and is at its goal to 1e-3 m; by
  the plan with complementarity constraints (a run for the guess and one that checks), by sequential quadratic
  programs with differences of runs, and by CMA-ES.

Told are the starts that reach the goal, and the median of the runs that each of these took.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.optimize import minimize

from modelgen.optimal_control.run_from_state import run_from
from tests.examples import masse_shot, throw_a_cube
from tests.examples.plan_example import Array, PlanExample

NEAR = 1e-3  # m
PENALTY = 1e4  # of a miss, beside the energy of a strike
FREE = [7, 8, 10, 11]  # entries of the start of a strike that are sought: vx, vy, wx, wy
SAMPLES = 60
MOST = 3000  # runs of a search


def by_cma(cost: Callable[[Array], float], done: Callable[[], bool], start: Array, spread: Array) -> None:
    """CMA-ES from a start, with deviations, until `done`."""
    try:
        import cma
    except ModuleNotFoundError as error:
        raise SystemExit('no package cma: run pip install "modelgen-contact[searches]"') from error

    search = cma.CMAEvolutionStrategy(
        np.zeros(len(start)), 1.0, {"verbose": -9, "seed": 1, "maxfevals": MOST}
    )
    while not search.stop() and not done():
        tried = search.ask()
        search.tell(tried, [cost(start + spread * each) for each in tried])


class Shot:
    """What a strike misses, with a count of runs."""

    def __init__(self, example: PlanExample) -> None:
        self._example, self.runs, self.best = example, 0, np.inf

    def start(self, strike: Array) -> Array:
        """q and u of a strike (4,)."""
        model = self._example.plan.derivation.model
        start = np.concatenate([model.initial_q, np.zeros(model.n_u)])
        start[FREE] = strike
        return start

    def missed(self, strike: Array) -> Array:
        """(3,) of the goal, m, and how far it passes on the wrong side of the obstacle."""
        self.runs += 1
        run = run_from(self._example.library, self.start(strike))
        path = [np.array(run.state[:2])]
        for k in range(1, SAMPLES + 1):
            run.step(k * masse_shot.HORIZON / SAMPLES)
            path.append(np.array(run.state[:2]))
        x, y = np.array(path).T
        beside = np.interp(masse_shot.OBSTACLE[0], x, y) - masse_shot.OBSTACLE[1] - masse_shot.AWAY
        found = np.array([*(path[-1] - masse_shot.GOAL), beside])
        self.best = min(self.best, float(np.abs([*found[:2], min(found[2], 0.0)]).max()))
        return found

    def energy(self, strike: Array) -> float:
        return float(strike[0] ** 2 + strike[1] ** 2 + 0.4 * 0.16 * (strike[2] ** 2 + strike[3] ** 2))

    def cost(self, strike: Array) -> float:
        found = self.missed(strike)
        return self.energy(strike) + PENALTY * float(np.sum(found[:2] ** 2) + min(found[2], 0.0) ** 2)


def throws(starts: int) -> None:
    throw = throw_a_cube.problem()
    found: dict[str, Array] = {}

    def by_differences(start: Array) -> Array:
        return throw_a_cube.searched(throw, start, "2-point")

    def by_search(start: Array) -> Array:
        best: list[Any] = [np.inf, start]

        def cost(tried: Array) -> float:
            value = float(np.sum(throw.residual(tried) ** 2))
            if value < best[0]:
                best[:] = value, tried.copy()
            return value

        by_cma(cost, lambda: best[0] < 1e-8, start, throw_a_cube.SPREAD)
        return np.asarray(best[1])

    ways: dict[str, Callable[[Array], Array]] = {
        "derivatives": lambda start: throw_a_cube.by_derivatives(throw, start),
        "differences": by_differences,
        "CMA-ES": by_search,
    }
    for name, way in ways.items():
        runs = []
        for seed in range(starts):
            throw.runs = 0
            found[name] = way(throw_a_cube.perturbed(np.random.default_rng(seed)))
            needed = throw.runs
            if throw.reached(found[name]):
                runs.append(needed)
        tell("throw_a_cube", name, runs, starts)


def shots(starts: int) -> None:
    example = masse_shot.problem()
    solver = example.solver()
    runs: dict[str, list[int]] = {"plan": [], "differences": [], "CMA-ES": []}
    model = example.plan.derivation.model
    for seed in range(starts):
        random = np.random.default_rng(seed)
        plan = example.plan.solve(example.perturbed(random), solver=solver)
        if plan.solution.success and example.missed(example.simulated(plan)[-1]) < NEAR:
            runs["plan"].append(2)
        factors = np.random.default_rng(seed).uniform(0.7, 1.3, model.n_u)  # those of `perturbed`
        start = (np.array(model.initial_u) * factors)[[0, 1, 3, 4]]
        for name, way in (("differences", strike_by_differences), ("CMA-ES", strike_by_cma)):
            needed = way(Shot(example), start)
            if needed is not None:
                runs[name].append(needed)
    for name, each in runs.items():
        tell("masse_shot", name, each, starts)


def strike_by_differences(shot: Shot, start: Array) -> int | None:
    """The runs until sequential quadratic programs end; None where that is not at the goal."""
    goal = {"type": "eq", "fun": lambda strike: shot.missed(strike)[:2]}
    beside = {"type": "ineq", "fun": lambda strike: shot.missed(strike)[2:]}
    answer = minimize(shot.energy, start, method="SLSQP", constraints=[goal, beside], options={"ftol": 1e-8})
    needed = shot.runs
    return needed if np.abs(shot.missed(answer.x)[:2]).max() < NEAR else None


def strike_by_cma(shot: Shot, start: Array) -> int | None:
    """The runs until CMA-ES is at the goal; None where it does not get there."""
    by_cma(shot.cost, lambda: shot.best < NEAR, start, np.array([0.3, 0.3, 1.0, 1.0]))
    return shot.runs if shot.best < NEAR else None


def tell(task: str, way: str, runs: list[int], starts: int) -> None:
    middle = f"{int(np.median(runs))} runs (most {max(runs)})" if runs else ""
    print(f"{task:14s} {way:12s} {len(runs)} of {starts}  {middle}", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--starts", type=int, default=5)
    parser.add_argument("--task", choices=["throw_a_cube", "masse_shot"])
    given = parser.parse_args()
    if given.task != "masse_shot":
        throws(given.starts)
    if given.task != "throw_a_cube":
        shots(given.starts)


if __name__ == "__main__":
    main()
