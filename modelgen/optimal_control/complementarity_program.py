"""Programs with complementarity constraints, and nonlinear programs with the same unknowns."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

import casadi as ca
import numpy as np

from modelgen.errors import ModelgenError

Array = np.ndarray[Any, Any]
Symbol = TypeVar("Symbol", ca.SX, ca.MX)


@dataclass(frozen=True)
class ComplementarityProgram(Generic[Symbol]):
    """min f(x, p) with lbx <= x <= ubx, lbg <= g <= ubg, 0 <= G, 0 <= H, and G_i H_j = 0 for each pair (i,
    j).

    Attributes:
        first: (n,) G.
        second: (m,) H.
        pairs: those of G and H that complement each other; None: (0, 0), (1, 1), and so on.

    Raises:
        ModelgenError: sizes do not fit.
    """

    x: Symbol
    f: Symbol
    g: Symbol
    lbx: Array
    ubx: Array
    lbg: Array
    ubg: Array
    first: Symbol
    second: Symbol
    p: Symbol | None = None
    pairs: Sequence[tuple[int, int]] | None = None

    def __post_init__(self) -> None:
        n, m = int(self.first.numel()), int(self.second.numel())
        sizes = {
            "lbx": (len(self.lbx), self.x.numel()), "ubx": (len(self.ubx), self.x.numel()),
            "lbg": (len(self.lbg), self.g.numel()), "ubg": (len(self.ubg), self.g.numel()),
        }  # fmt: skip
        for name, (given, needed) in sizes.items():
            if given != needed:
                raise ModelgenError(
                    "ComplementarityProgram", f"{given} entries in {name}", f"{needed} are needed"
                )
        if self.pairs is None and n != m:
            found = f"{n} entries in first, {m} in second"
            raise ModelgenError("ComplementarityProgram", found, "as many of both, or `pairs`")
        if any(not (0 <= i < n and 0 <= j < m) for i, j in self.pairs or ()):
            raise ModelgenError("ComplementarityProgram", "a pair beyond the entries", f"below {n} and {m}")

    @property
    def paired(self) -> Array:
        """(pairs, 2) places in G and H."""
        n = int(self.first.numel())
        listed = [(k, k) for k in range(n)] if self.pairs is None else self.pairs
        return np.array(listed, dtype=int).reshape(-1, 2)


@dataclass(frozen=True)
class Answer:
    """What IPOPT gave."""

    x: Array
    success: bool
    iterations: int
    value: float


class RelaxedProgram(Generic[Symbol]):
    """The nonlinear program with G_i H_j <= tau in place of G_i H_j = 0, and those in which entries of G
    and H are zero in place of it."""

    def __init__(self, program: ComplementarityProgram[Symbol], options: dict[str, Any]) -> None:
        self._program: ComplementarityProgram[Symbol] = program
        symbol = type(program.x)
        tau = symbol.sym("tau")
        given = program.p if program.p is not None else symbol(0, 1)
        first, second = program.paired.T.tolist()
        products = tau - program.first[first] * program.second[second] if first else symbol(0, 1)
        constraints = ca.vertcat(program.g, program.first, program.second, products)
        problem = {"x": program.x, "p": ca.vertcat(given, tau), "f": program.f, "g": constraints}
        self._solver = ca.nlpsol("relaxed", "ipopt", problem, options)
        self._lbx = without_repeated_bounds(program)
        self._sided = int(program.first.numel() + program.second.numel())
        self._pairs = len(first)
        self._measure = ca.Function(
            "measure", [program.x, given], [program.f, program.g, program.first, program.second]
        )

    def relaxed(self, at: Array, p: Sequence[float], tau: float) -> Answer:
        """Solved with this bound of the products."""
        return self._solved(at, [*p, tau], np.full(self._sided, np.inf), 0.0)

    def branch(self, at: Array, p: Sequence[float], zero: Array) -> Answer:
        """Solved with these entries of G and H, (n + m,) bool, zero, and no products."""
        return self._solved(at, [*p, 1.0], np.where(zero, 0.0, np.inf), -np.inf)

    def _solved(self, at: Array, p: Sequence[float], sided: Array, products: float) -> Answer:
        program = self._program
        lower = [program.lbg, np.zeros(self._sided), np.full(self._pairs, products)]
        upper = [program.ubg, sided, np.full(self._pairs, np.inf)]
        answer = self._solver(
            x0=at,
            p=p,
            lbx=self._lbx,
            ubx=program.ubx,
            lbg=np.concatenate(lower),
            ubg=np.concatenate(upper),
        )
        stats = self._solver.stats()
        return Answer(
            np.array(answer["x"]).ravel(),
            bool(stats["success"]),
            int(stats["iter_count"]),
            float(answer["f"]),
        )

    def measured(self, x: Array, p: Sequence[float]) -> tuple[float, float, Array]:
        """The value, the largest violation of bounds and constraints, and G and H, (n + m,)."""
        program = self._program
        value, g, first, second = (np.array(each).ravel() for each in self._measure(x, list(p)))
        sides = np.concatenate([first, second])
        apart = [program.lbg - g, g - program.ubg, program.lbx - x, x - program.ubx, -sides]
        return float(value[0]), float(max(each.max(initial=0.0) for each in apart)), sides


def without_repeated_bounds(program: ComplementarityProgram[Symbol]) -> Array:
    """lbx without the bounds 0 <= x_k of unknowns that are an entry of G or H: a row that is set to zero
    beside such a bound would leave no interior and no unique multiplier."""
    sides = ca.vertcat(program.first, program.second)
    lbx = np.array(program.lbx, dtype=float)
    if program.p is not None or not sides.numel():
        return lbx
    slope = ca.Function("sides", [program.x], [sides, ca.jacobian(sides, program.x)])
    value, jacobian = slope(0)
    curved = ca.which_depends(sides, program.x, 2, True)
    rows, columns = (np.array(each) for each in jacobian.sparsity().get_triplet())
    entries = np.array(jacobian.nonzeros())
    single = np.bincount(rows, minlength=len(curved)) == 1
    for row, column, entry in zip(rows, columns, entries, strict=True):
        if single[row] and entry == 1.0 and not curved[row] and value[int(row)] == 0.0 and lbx[column] == 0.0:
            lbx[column] = -np.inf
    return lbx
