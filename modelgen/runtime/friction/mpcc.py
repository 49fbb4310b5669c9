"""Complementarity as constraints of an optimisation: CasADi and IPOPT, by a homotopy of relaxations."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike, NDArray

from modelgen.runtime.compiled_lcp import CoreLibrary
from modelgen.runtime.friction.compiled_solvers import motion, residual
from modelgen.runtime.friction.problem import FrictionProblem, FrictionSolution, Motion, Outcome

RELAXATIONS = (10.0, 1.0, 1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12)  # G H <= this, one after the other
SOLVED = 1e-6  # a certificate below counts as solved: IPOPT is not asked for more
STARTS = 4  # of one problem, where IPOPT ends at a point that is no solution
_IPOPT = {"print_level": 0, "sb": "yes", "tol": 1e-11, "constr_viol_tol": 1e-11, "max_iter": 300}
_OPTIONS: dict[str, Any] = {"print_time": False, "error_on_fail": False, "ipopt": _IPOPT}


@dataclass(frozen=True)
class Conditions:
    """Complementarity conditions of an MPCC: equal = 0, and 0 <= G, 0 <= H, G H = 0 for each pair."""

    equal: list[ca.SX] = field(default_factory=list)
    pairs: list[tuple[ca.SX, ca.SX]] = field(default_factory=list)


@dataclass(frozen=True)
class MpccSolution:
    """The end of the homotopy."""

    x: NDArray[Any]
    objective: float
    complementarity: float  # largest |min(G, H)|
    violation: float  # largest of |equal| and of what is below 0 in `above`
    iterations: int  # of IPOPT, all relaxations together


def minimise(
    x: ca.SX,
    objective: ca.SX,
    conditions: Conditions,
    start: ArrayLike,
    *,
    above: Sequence[ca.SX] = (),
    relaxations: Sequence[float] = RELAXATIONS,
) -> MpccSolution:
    """min objective(x) subject to `conditions` and above >= 0: a program with complementarity constraints.

    S. Scholtes, SIAM J. Optim. 11 (2001), 918-936: G H = 0 is relaxed to G H <= tau, tau falling, each from
    the solution before. It ends at a C-stationary point, which need not be the least of all; and no
    constraint qualification holds at tau = 0, so that multipliers may grow without bound.

    Args:
        x: (n,) the unknowns, all expressions are of these.
        start: (n,).
        above: further expressions that are >= 0.
    """
    first, second = _columns([g for g, _ in conditions.pairs]), _columns([h for _, h in conditions.pairs])
    equal, other, tau = _columns(conditions.equal), _columns(above), ca.SX.sym("tau")
    constraints = ca.vertcat(equal, other, first, second, tau - first * second)
    program = {"x": x, "p": tau, "f": objective, "g": constraints}
    solver = ca.nlpsol("mpcc", "ipopt", program, _OPTIONS)
    upper = np.full(constraints.numel(), np.inf)
    upper[: equal.numel()] = 0
    at, iterations = np.asarray(start, dtype=np.float64), 0
    for relaxation in relaxations:
        answer = solver(x0=at, p=relaxation, lbg=0, ubg=upper)
        found = np.array(answer["x"]).ravel()
        if np.isfinite(found).all():
            at = found
        iterations += int(solver.stats()["iter_count"])
    measure = ca.Function("measure", [x], [objective, ca.fmin(first, second), equal, other])
    value, smaller, error, slack = (np.array(part).ravel() for part in measure(at))
    worst = max(np.abs(error).max(initial=0.0), (-slack).max(initial=0.0))
    return MpccSolution(
        at, float(value[0]), float(np.abs(smaller).max(initial=0.0)), float(worst), iterations
    )


def coulomb_conditions(problem: FrictionProblem, z: ca.SX, w: ca.SX, speed: ca.SX) -> Conditions:
    """Coulomb's law for symbolic forces z and motions w as smooth conditions, for use in an optimisation
    problem.

    0 <= N, 0 <= w_n, N w_n = 0; of each disc of forces f = z_t / mu with v = mu w_t and its `speed` g:
    N v + g f = 0, 0 <= g, 0 <= N^2 - |f|^2, g (N^2 - |f|^2) = 0. Bilateral rows: w = 0.

    Args:
        problem: which rows are contacts, and their coefficients; A and b are not used.
        z, w: (n,).
        speed: (n_disc,) one a disc in the order of `problem.discs`.
    """
    conditions, number = Conditions([w[int(row)] for row in problem.bilateral]), 0
    for contact, row in enumerate(problem.first):
        normal = z[int(row)]
        conditions.pairs.append((normal, w[int(row)]))
        taken = {int(row)}
        for _, rows, mu in problem.discs(contact):
            force = ca.vertcat(*(z[int(i)] / m for i, m in zip(rows, mu, strict=True)))
            moves = ca.vertcat(*(w[int(i)] * m for i, m in zip(rows, mu, strict=True)))
            conditions.equal.append(normal * moves + speed[number] * force)
            conditions.pairs.append((speed[number], normal**2 - ca.sumsqr(force)))
            taken |= {int(i) for i in rows}
            number += 1
        frictionless = set(range(int(row), int(row) + int(problem.rows[contact]))) - taken
        conditions.equal.extend(z[i] for i in sorted(frictionless))
    return conditions


def mpcc(problem: FrictionProblem, library: CoreLibrary, start: ArrayLike | None = None) -> FrictionSolution:
    """Coulomb's law as an MPCC, by IPOPT: an independent reference, thousands of times slower than `coulomb`.

    No approximation but what the last relaxation leaves (G H <= 1e-12 in scaled units). What it loses: of one
    start in eight the end is a point that only minimises infeasibility, so that some are tried; forces come
    to about 1e-6; it says nothing about rank or uniqueness. Contacts that open faster than they press have no
    force. Scheme: see `minimise`.
    """
    scale, S, c = _scaled(problem)
    discs = sum(len(problem.discs(contact)) for contact in range(len(problem.first)))
    y, speed = ca.SX.sym("y", problem.n), ca.SX.sym("speed", discs)
    conditions = coulomb_conditions(problem, y, ca.mtimes(ca.DM(S), y) + ca.DM(c), speed)
    random, iterations, best, value = np.random.default_rng(0), 0, np.zeros(problem.n + discs), np.inf
    for attempt in range(STARTS):
        guess = np.concatenate([np.zeros(problem.n), np.ones(discs)])
        if attempt == 0 and start is not None:
            guess[: problem.n] = np.asarray(start) / scale
        elif attempt > 0:
            guess[problem.first] = 2 * random.random(len(problem.first))
        answer = minimise(ca.vertcat(y, speed), ca.SX(0), conditions, guess)
        iterations += answer.iterations
        for x in (answer.x, _opened(problem, answer.x, S, c)):
            found = residual(problem, x[: problem.n] * scale, library)
            if found <= value:
                best, value = x, found
        if value <= SOLVED:
            break
    return _solution(problem, best, best[: problem.n] * scale, value, iterations)


def _solution(
    problem: FrictionProblem, x: NDArray[Any], z: NDArray[Any], value: float, iterations: int
) -> FrictionSolution:
    return FrictionSolution(
        z=z,
        w=motion(problem, z),
        outcome=Outcome.SOLVED if value <= SOLVED else Outcome.NOT_FOUND,
        residual=value,
        coulomb_residual=value,
        approximation="",
        iterations=iterations,
        motions=_motions(problem, x[: problem.n], x[problem.n :]),
    )


def _scaled(problem: FrictionProblem) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
    """scale, S, c such that z = scale y and S y + c is the motion divided by scale: unit diagonal of S."""
    mobility = np.sqrt(np.where(np.diag(problem.A) > 0, np.diag(problem.A), 1.0))
    for row, rows in zip(problem.first, problem.rows, strict=True):
        mobility[row + 1 : row + min(rows, 3)] = mobility[row]
    c = problem.b / mobility
    size = float(np.abs(c).max(initial=0.0)) or 1.0
    return size / mobility, problem.A / mobility[:, None] / mobility, c / size


def _opened(problem: FrictionProblem, x: NDArray[Any], S: NDArray[Any], c: NDArray[Any]) -> NDArray[Any]:
    """Without the forces of contacts that open faster than they press, which the last relaxation has left."""
    opened, w = x.copy(), S @ x[: problem.n] + c
    for row, rows in zip(problem.first, problem.rows, strict=True):
        if x[row] < w[row]:
            opened[row : row + rows] = 0
    return opened


def _motions(problem: FrictionProblem, y: NDArray[Any], speed: NDArray[Any]) -> tuple[Motion, ...]:
    motions, number, small = [], 0, np.sqrt(SOLVED)
    for contact, row in enumerate(problem.first):
        seen = Motion.PRESSES if y[row] > 0 else Motion.OPEN
        for mark, _, _ in problem.discs(contact):
            if seen and speed[number] > small:
                seen |= mark
            number += 1
        motions.append(seen)
    return tuple(motions)


def _columns(parts: Sequence[ca.SX]) -> ca.SX:
    return ca.vertcat(*parts) if parts else ca.SX(0, 1)
