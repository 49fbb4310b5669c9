"""Whether a point of a program with complementarity constraints has a first-order descent.

A point is B-stationary if no direction that keeps the linearised constraints lowers the value (H. Scheel, S.
Scholtes, Math. Oper. Res. 25 (2000), 1-22). Where both entries of a pair are zero, a direction may raise one,
not both. The best direction solves a linear program with one binary unknown for each such entry, whose
bound proves that there is none better.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Generic, cast

import casadi as ca
import numpy as np
from scipy.optimize import Bounds, LinearConstraint, milp
from scipy.sparse import csr_array, diags_array, hstack, vstack

from modelgen.optimal_control.complementarity_program import Array, ComplementarityProgram, Symbol

ZERO = 1e-6  # an entry of a pair up to which it counts as zero
STEP = (
    1e-3  # of an unknown, over the larger of its size and 1: within it constraints that are not active count
)
LIMIT = 20.0  # s, of one test


@dataclass(frozen=True)
class Descent:
    """The best first-order change of a point.

    Attributes:
        rate: bound of the decrease of the value for a change of each unknown by its own size, or by 1 if it
            is smaller; infinite where it was not found in time.
        x: (n_x,) the point after a STEP along the best change.
        zero: (n + m,) the entries of G and H that stay zero along the best change.
    """

    rate: float
    x: Array
    zero: Array


class StationarityTest(Generic[Symbol]):
    """The test of one program, for any number of points and numbers p."""

    def __init__(self, program: ComplementarityProgram[Symbol]) -> None:
        self._program: ComplementarityProgram[Symbol] = program
        x, g, given = (cast(Any, each) for each in (program.x, program.g, program.p))
        sides = ca.vertcat(cast(Any, program.first), cast(Any, program.second))
        listed = [ca.gradient(cast(Any, program.f), x), ca.densify(g), ca.jacobian(g, x)]
        listed += [ca.densify(sides), ca.jacobian(sides, x)]
        given = type(x)(0, 1) if given is None else given
        self._linearised = ca.Function("linearised", [x, given], listed)
        self._pairs = program.paired + np.array([0, int(program.first.numel())])  # places among both sides

    def descent(self, x: Array, p: Sequence[float] = ()) -> Descent:
        """The best first-order change of x (n_x,)."""
        program = self._program
        slope, at_g, of_g, sides, of_sides = self._linearised(x, list(p))
        scale = np.maximum(1.0, np.abs(x))
        rows_g, rows_sides = (_rows(each, scale) for each in (of_g, of_sides))
        values, g = np.array(sides).ravel(), np.array(at_g).ravel()
        held, free = self._split(values)
        reach = np.abs(rows_sides).sum(axis=1)
        n, m = len(x), len(free)
        choice = csr_array((-reach[free], (np.arange(m), np.arange(m))), shape=(m, m))
        number = {int(entry): k for k, entry in enumerate(free)}
        either = [(number[i], number[j]) for i, j in self._pairs.tolist() if i in number and j in number]
        one_of = np.zeros((len(either), m))
        for row, (i, j) in enumerate(either):
            one_of[row, i] = one_of[row, j] = 1.0
        blocks = (
            (rows_g, None, _below(program.lbg - g), _above(program.ubg - g)),
            (rows_sides, None, np.where(held, 0.0, _below(-values)), np.where(held, 0.0, np.inf)),
            (rows_sides[free], choice, np.full(m, -np.inf), np.zeros(m)),
            (
                csr_array((len(either), n)),
                csr_array(one_of),
                np.full(len(either), -np.inf),
                np.ones(len(either)),
            ),
        )
        matrix = vstack(
            [
                hstack([left, csr_array((left.shape[0], m)) if right is None else right])
                for left, right, *_ in blocks
            ]
        )
        lower, upper = (np.concatenate([block[k] for block in blocks]) for k in (2, 3))
        least, most = _below((program.lbx - x) / scale), _above((program.ubx - x) / scale)
        found = milp(
            np.concatenate([np.array(slope).ravel() * scale, np.zeros(m)]),
            integrality=np.concatenate([np.zeros(n), np.ones(m)]),
            bounds=Bounds(
                np.append(np.maximum(least, -1.0), np.zeros(m)), np.append(np.minimum(most, 1.0), np.ones(m))
            ),
            constraints=LinearConstraint(matrix, lower, upper),
            options={"time_limit": LIMIT},
        )
        zero = held.copy()
        if found.x is None:
            zero[free] = True
            return Descent(np.inf, x, zero)
        zero[free] = found.x[n:] < 0.5
        bound = found.mip_dual_bound if m else found.fun
        return Descent(float(max(-bound, 0.0)), x + STEP * scale * found.x[:n], zero)

    def _split(self, values: Array) -> tuple[Array, Array]:
        """Which entries are held at zero because a partner is not (n + m,), and the places of the others that
        are zero beside partners that are all zero."""
        held = np.zeros(len(values), dtype=bool)
        paired = np.zeros(len(values), dtype=bool)
        for i, j in self._pairs.tolist():
            paired[[i, j]] = True
            smaller, larger = (i, j) if values[i] <= values[j] else (j, i)
            held[smaller] |= bool(values[larger] > ZERO)
        return held, np.flatnonzero(paired & ~held & (values <= ZERO))


def _rows(matrix: Any, scale: Array) -> csr_array:
    """A matrix of CasADi, its columns times `scale`."""
    return csr_array(csr_array(matrix.sparse()) @ diags_array(scale))


def _below(bounds: Array) -> Array:
    """Lower bounds of a change within STEP, over STEP; none above 0, which is a change."""
    return np.minimum(bounds / STEP, 0.0)


def _above(bounds: Array) -> Array:
    return np.maximum(bounds / STEP, 0.0)
