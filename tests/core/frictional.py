"""Random problems with friction: bodies of unequal mass that touch each other and the ground."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from modelgen.runtime.friction import FrictionProblem

CONTACTS = 20
DECADES = (0, 2, 4, 6)  # of mass
FRICTION = (0.0, 0.1, 0.3, 0.5, 1.0, 2.0)


def natural_map(problem: FrictionProblem, forces: NDArray[Any], relaxed: bool = False) -> float:
    """The certificate of friction problems, written again from its definition, in long double."""
    A, b, z = (x.astype(np.longdouble) for x in (problem.A, problem.b, forces))
    w, errors, sizes = A @ z + b, [np.longdouble(0)], [np.longdouble(0)]
    for contact, row in enumerate(problem.first):
        d, slack = np.sqrt(A[row, row]), w[row]
        for _, rows, mu in problem.discs(contact):
            f, v = z[rows] / mu, mu * w[rows]
            a = np.mean(mu**2 * np.diag(A)[rows])
            q = f - v / a
            q = q * min(1.0, max(z[row], 0) / np.linalg.norm(q)) if np.linalg.norm(q) > 0 else q
            errors.append(np.linalg.norm(f - q) * np.sqrt(a))
            sizes.append(np.linalg.norm(mu * b[rows]) / np.sqrt(a))
            slack -= np.linalg.norm(v) if relaxed else 0
        errors.append(abs(min(z[row] * d, slack / d)))
        sizes.append(abs(b[row]) / d)
    for row in problem.bilateral:
        errors.append(abs(w[row]) / np.sqrt(A[row, row]))
        sizes.append(abs(b[row]) / np.sqrt(A[row, row]))
    return float(max(errors) / (max(sizes) or 1))


def feasible(seed: int, most: int = CONTACTS) -> FrictionProblem:
    """1 to `most` contacts, A of full rank or not, friction 0 to 2, masses over 0 to 6 decades; two kinds.

    A solution was put in: forces and motions that obey the law are drawn, b = w - A z. Or there is a
    velocity at which every contact opens faster than mu times its slip, and b = J v is in the range of A:
    then a solution exists (Acary, Cadoux, Lemarechal, Malick, ZAMM 91 (2011), theorem 1).
    """
    rng = np.random.default_rng(seed)
    return drawn(rng, int(rng.integers(1, most + 1)), deficient=bool(rng.random() < 0.5))


def drawn(rng: np.random.Generator, contacts: int, deficient: bool) -> FrictionProblem:
    """One of them; deficient: few bodies, with more rows than ways to move from some contacts on."""
    few, many = (1, max(2, contacts // 3 + 1)), (max(1, (contacts + 1) // 2), contacts + 2)
    bodies = int(rng.integers(*(few if deficient else many)))
    mobility = _mobility(rng, bodies, int(rng.choice(DECADES)))
    mu = rng.uniform(0, 2, contacts) if rng.random() < 0.5 else np.full(contacts, rng.choice(FRICTION))
    if rng.random() < 0.5:
        J = _rows(rng, bodies, mu, rng.normal(size=6 * bodies))
        A = _symmetric(J @ mobility @ J.T)
        return FrictionProblem.of(A, _solved(rng, A, mu), mu)
    opening = rng.normal(size=6 * bodies)
    J = _rows(rng, bodies, mu, opening, apart=True)
    b = J @ (rng.normal(size=6 * bodies) - rng.uniform(0, 2) * opening)
    return FrictionProblem.of(_symmetric(J @ mobility @ J.T), b, mu)


def impossible(seed: int) -> FrictionProblem:
    """A feasible problem with one contact more: the first from behind, normal motions summing to < 0."""
    problem = feasible(seed, CONTACTS - 1)
    rng = np.random.default_rng(seed)
    turn = np.vstack([np.eye(problem.n), np.zeros((3, problem.n))])
    turn[-3:, :3] = np.diag([-1.0, 1.0, -1.0])
    b = turn @ problem.b
    b[-3] -= rng.uniform(0.1, 1) * np.abs(problem.b).max()
    mu = np.append(problem.cone[:, 0], problem.cone[0, 0])
    return FrictionProblem.of(turn @ problem.A @ turn.T, b, mu)


def mild(seed: int) -> FrictionProblem:
    """1 to 4 contacts, well-conditioned, friction so weak that each b has one answer; any units."""
    rng = np.random.default_rng(seed)
    n = 3 * int(rng.integers(1, 5))
    J = np.hstack([np.eye(n), 0.2 * rng.normal(size=(n, n)) / np.sqrt(n)]) * 10 ** rng.uniform(-2, 2)
    return FrictionProblem.of(J @ J.T, J @ rng.normal(size=2 * n), rng.uniform(0.01, 0.3, n // 3))


def stack(boxes: int, mu: float, ratio: float = 1.0) -> FrictionProblem:
    """Cubes of edge 1 on their corners, from the ground up, after 1 s of gravity 1; masses 1 to `ratio`."""
    mass = ratio ** (np.arange(boxes) / max(1, boxes - 1))
    J = np.zeros((12 * boxes, 6 * boxes))
    for box in range(boxes):
        for foot, (x, y) in enumerate(([0.5, 0.5], [-0.5, 0.5], [-0.5, -0.5], [0.5, -0.5])):
            rows = 12 * box + 3 * foot
            for body, z, sign in ((box, -0.5, 1), (box - 1, 0.5, -1)):
                if body >= 0:
                    J[rows : rows + 3, 6 * body : 6 * body + 6] = (
                        sign * _moves(np.array([x, y, z]))[[2, 0, 1]]
                    )
    mobility = np.diag(np.repeat(1 / mass, 6) * np.tile([1, 1, 1, 6, 6, 6], boxes))
    fall = np.tile([0, 0, -1.0, 0, 0, 0], boxes)
    return FrictionProblem.of(_symmetric(J @ mobility @ J.T), J @ fall, np.full(4 * boxes, mu))


def with_bilateral(problem: FrictionProblem, rng: np.random.Generator, count: int) -> FrictionProblem:
    """Its contacts with a little more mobility, and `count` bilateral rows after them, at which b is 0."""
    n, size = problem.n, np.sqrt(np.trace(problem.A) / problem.n)
    root = np.linalg.cholesky(problem.A + 1e-3 * size**2 * np.eye(n))
    J = np.vstack([np.hstack([root, np.zeros((n, count))]), rng.normal(size=(count, n + count)) * size])
    return replace(problem, A=_symmetric(J @ J.T), b=np.append(problem.b, np.zeros(count)))


def _symmetric(A: NDArray[Any]) -> NDArray[Any]:
    return np.asarray((A + A.T) / 2)


def _mobility(rng: np.random.Generator, bodies: int, decades: int) -> NDArray[Any]:
    """M^-1 of bodies with masses from 1 to 10^decades, both ends met where there are two."""
    mass = 10 ** rng.uniform(0, decades, bodies)
    if bodies > 1:
        mass[rng.permutation(bodies)[:2]] = (1, 10**decades)
    inverse = np.zeros((6 * bodies, 6 * bodies))
    for body, m in enumerate(mass):
        axes = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        at = 6 * body
        inverse[at : at + 3, at : at + 3] = np.eye(3) / m
        inverse[at + 3 : at + 6, at + 3 : at + 6] = (
            axes @ np.diag(1 / (m * rng.uniform(0.05, 0.6, 3))) @ axes.T
        )
    return inverse


def _rows(
    rng: np.random.Generator, bodies: int, mu: NDArray[Any], velocity: NDArray[Any], apart: bool = False
) -> NDArray[Any]:
    """J, 3 rows a contact; apart: `velocity` opens every contact within its dual cone."""
    J = []
    for coefficient in mu:
        moves = _relative(rng, bodies)
        normal = rng.normal(size=3)
        if apart:
            along = moves @ velocity / np.linalg.norm(moves @ velocity)
            across = np.cross(along, normal) / np.linalg.norm(np.cross(along, normal))
            lean = np.arctan2(1, coefficient) * rng.uniform(0, 0.9)
            normal = np.cos(lean) * along + np.sin(lean) * across
        J.append(_frame(normal, rng) @ moves)
    return np.vstack(J)


def _relative(rng: np.random.Generator, bodies: int) -> NDArray[Any]:
    """The relative velocity of a point of one body and a point of another, or of the ground."""
    f, o = int(rng.integers(bodies)), int(rng.integers(-1, bodies))
    moves = np.zeros((3, 6 * bodies))
    for body, sign in ((f, 1), (o, -1)) if o not in (f, -1) else ((f, 1),):
        moves[:, 6 * body : 6 * body + 6] += sign * _moves(rng.normal(size=3))
    return moves


def _moves(point: NDArray[Any]) -> NDArray[Any]:
    """Velocity of a point of a body from its velocity and angular velocity."""
    x, y, z = point
    return np.hstack([np.eye(3), [[0, z, -y], [-z, 0, x], [y, -x, 0]]])


def _frame(normal: NDArray[Any], rng: np.random.Generator) -> NDArray[Any]:
    n = normal / np.linalg.norm(normal)
    t = np.cross(n, rng.normal(size=3))
    t /= np.linalg.norm(t)
    return np.array([n, t, np.cross(n, t)])


def _solved(rng: np.random.Generator, A: NDArray[Any], mu: NDArray[Any]) -> NDArray[Any]:
    """b of a problem with a solution in which contacts open, stick and slip at random."""
    z, w = np.zeros(len(A)), np.zeros(len(A))
    for contact, coefficient in enumerate(mu):
        row, angle = 3 * contact, rng.uniform(0, 2 * np.pi)
        d, along = np.sqrt(A[row, row]), np.array([np.cos(angle), np.sin(angle)])
        match rng.choice(["opens", "sticks", "slips"]):
            case "opens":
                w[row], w[row + 1 : row + 3] = rng.uniform(0, 1) * d, rng.normal(size=2) * d
            case "sticks":
                z[row] = rng.uniform(0.1, 1) / d
                z[row + 1 : row + 3] = coefficient * z[row] * along * rng.uniform(0, 1)
            case "slips":
                z[row] = rng.uniform(0.1, 1) / d
                z[row + 1 : row + 3] = coefficient * z[row] * along
                w[row + 1 : row + 3] = -along * rng.uniform(0, 1) * d
    return np.asarray(w - A @ z)
