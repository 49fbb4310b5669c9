"""The record of a step with friction, and of its answer."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum, IntFlag
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from modelgen.errors import SimulationError

CONE = 4  # coefficients a contact: along t1, along t2, spinning, rolling
ROWS = (1, 3, 6)


class Outcome(Enum):
    """Outcome of a friction problem; the value is the advice to the user. The first four are those of
    friction.h."""

    SOLVED = "the answer satisfies the law that the solver solves, to its residual"
    INFEASIBLE = (
        "proved: no forces at all keep every contact from penetrating; check b and what drives the bodies"
    )
    NOT_FOUND = "no start led to a solution, and there may be none; step in velocities and impulses instead"
    NOT_FINITE = "the data hold NaN, infinity, a negative coefficient, or leave the range of the real type"


class Motion(IntFlag):
    """The state of a contact. No flag: it is open; PRESSES without SLIPS: it sticks. The bits are those of
    friction.h."""

    OPEN = 0
    PRESSES = 1
    SLIPS = 2
    SPINS = 4
    ROLLS = 8


@dataclass(frozen=True, slots=True)
class FrictionProblem:
    """A friction problem: w = A z + b, Coulomb's law at each contact, w = 0 in bilateral rows.

    Forces and accelerations, or impulses and velocities: the law is the same. Rows of a contact: N along the
    normal, then with 3 rows f along t1, t2, with 6 also the torque about the normal and about t1, t2.
    """

    A: NDArray[Any]  # (n, n) J M^-1 J'; of any rank
    b: NDArray[Any]  # (n,)
    first: NDArray[np.intc]  # (n_contact,) row of N
    rows: NDArray[np.intc]  # (n_contact,) 1, 3 or 6
    cone: NDArray[Any]  # (n_contact, 4) coefficients along t1 and t2; of spinning and rolling, m

    @classmethod
    def of(
        cls, A: ArrayLike, b: ArrayLike, friction: ArrayLike, *, first: ArrayLike | None = None, rows: int = 3
    ) -> FrictionProblem:
        """Contacts with the same number of rows, the first rows unless `first` says where.

        Args:
            A: (n, n).
            b: (n,).
            friction: (n_contact,) isotropic, (n_contact, 2) along t1 and t2, or (n_contact, 4) with the
                lengths of spinning and rolling resistance, m.
            first: (n_contact,) row of each contact's N.
            rows: 1, 3 or 6 a contact.

        Raises:
            SimulationError: shapes that do not fit, rows outside the matrix, negative coefficients.
        """
        cone = _cone(np.asarray(friction, dtype=np.float64))
        count = len(cone)
        start = np.arange(count) * rows if first is None else np.asarray(first)
        problem = cls(
            np.asarray(A, dtype=np.float64),
            np.asarray(b, dtype=np.float64),
            start.astype(np.intc),
            np.full(count, rows, dtype=np.intc),
            cone,
        )
        check(problem)
        return problem

    @property
    def n(self) -> int:
        """Rows."""
        return len(self.b)

    @property
    def bilateral(self) -> NDArray[np.intp]:
        """The rows that belong to no contact, in which w = 0."""
        free = np.ones(self.n, dtype=bool)
        for row, count in zip(self.first, self.rows, strict=True):
            free[row : row + count] = False
        return np.flatnonzero(free)

    def discs(self, contact: int) -> list[tuple[Motion, NDArray[np.intp], NDArray[Any]]]:
        """The parts of a contact's cone: mark, rows with a positive coefficient, their coefficients."""
        row, cone = int(self.first[contact]), self.cone[contact]
        parts = [(Motion.SLIPS, np.array([row + 1, row + 2]), cone[:2])] if self.rows[contact] >= 3 else []
        if self.rows[contact] >= 6:
            parts += [
                (Motion.SPINS, np.array([row + 3]), cone[2:3]),
                (Motion.ROLLS, np.array([row + 4, row + 5]), np.repeat(cone[3], 2)),
            ]
        return [(mark, where[mu > 0], mu[mu > 0]) for mark, where, mu in parts if (mu > 0).any()]


@dataclass(frozen=True, slots=True)
class FrictionSolution:
    """Answer of a solver by name; z and w mean something only if `outcome` is SOLVED."""

    z: NDArray[Any]  # (n,) forces; otherwise the best found
    w: NDArray[Any]  # (n,) A z + b
    outcome: Outcome
    residual: float  # of the law that the solver solves: what decides SOLVED
    coulomb_residual: float  # of Coulomb's law in the same scale: what the solver's approximation costs
    approximation: str  # what the solver puts in the place of Coulomb's law; empty: nothing
    iterations: int  # sweeps and Newton steps, pivots, or steps of the interior-point method
    motions: tuple[Motion, ...]  # a contact
    rank: int | None = None  # of A on the directions in which forces may grow; with `active` their number
    active: int | None = None
    unique: bool | None = None  # the forces: True proved unique, False others give the same w, None undecided


def check(problem: FrictionProblem) -> None:
    """Raises SimulationError if the record does not fit together."""
    n, count = problem.n, len(problem.first)
    if problem.b.shape != (n,) or problem.A.shape != (n, n):
        found = f"A of shape {problem.A.shape} and b of shape {problem.b.shape}"
        raise SimulationError("problem with friction", found, "A is (n, n) and b is (n,)")
    if problem.rows.shape != (count,) or problem.cone.shape != (count, CONE):
        found = f"{count} contacts, rows of shape {problem.rows.shape}, cone of shape {problem.cone.shape}"
        raise SimulationError("problem with friction", found, f"shapes ({count},) and ({count}, {CONE})")
    taken = np.zeros(n, dtype=int)
    for contact, (row, rows) in enumerate(zip(problem.first, problem.rows, strict=True)):
        if rows not in ROWS or row < 0 or row + rows > n:
            found = f"contact {contact} has {rows} rows from row {row} on, of {n}"
            raise SimulationError("problem with friction", found, "1, 3 or 6 rows within the matrix")
        taken[row : row + rows] += 1
    if (taken > 1).any():
        found = f"row {int(np.argmax(taken > 1))} belongs to two contacts"
        raise SimulationError("problem with friction", found, "each row to one contact or none")
    if not (problem.cone >= 0).all():
        contact = int(np.argwhere(~(problem.cone >= 0))[0, 0])
        found = f"contact {contact} has the coefficients {problem.cone[contact].tolist()}"
        raise SimulationError("problem with friction", found, "numbers >= 0")


def _cone(friction: NDArray[Any]) -> NDArray[Any]:
    if friction.ndim == 1:
        friction = np.repeat(friction[:, None], 2, axis=1)
    if friction.ndim != 2 or friction.shape[1] not in (2, CONE):
        found = f"friction of shape {friction.shape}"
        raise SimulationError(
            "problem with friction", found, "shape (n_contact,), (n_contact, 2) or (n_contact, 4)"
        )
    return np.hstack([friction, np.zeros((len(friction), CONE - friction.shape[1]))])
