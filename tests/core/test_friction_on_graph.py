"""Friction problems on their graph: the solution is that of the matrix, at any number of contacts."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from modelgen.codegen.library import Library
from modelgen.runtime.c_arrays import pointer
from modelgen.runtime.friction.compiled_solvers import _record, coulomb, report_structure, residual
from modelgen.runtime.friction.problem import FrictionProblem, Outcome

Array = np.ndarray[Any, Any]
GUARD = 64  # numbers behind the scratch memory, which no call writes


class Graph(ctypes.Structure):
    """`mg_friction_graph` of core/solve/friction/friction.h."""

    _fields_ = (
        ("n_body", ctypes.c_int),
        *((name, ctypes.c_void_p) for name in ("place", "body", "J", "MJ", "yields")),
    )


@dataclass(frozen=True)
class Rows:
    """Rows by bodies: `J` and `MJ` (n, 2, 6), `body` (n, 2), -1 for ground; the problem with its matrix."""

    J: Array
    MJ: Array
    body: Array
    bodies: int
    problem: FrictionProblem

    def solve(self, library: Library, accepted: float, starts: int = 0) -> tuple[Array, Any]:
        """z (n,), and the report, from memory that holds no numbers; `starts`: at most, 0: all."""
        core, problem = library.cdll, self.problem
        n, k = problem.n, len(problem.first)
        sizes = []
        for function in (core.mg_friction_graph_work_size, core.mg_friction_graph_iwork_size):
            function.restype = ctypes.c_longlong
            sizes.append(function(n, k, self.bodies))
        real = library.dtype
        work = np.full(sizes[0] + GUARD, np.nan, dtype=real)
        iwork = np.full(sizes[1] + GUARD, -77, dtype=np.intc)
        arrays = (
            np.arange(n, dtype=np.intc), self.body.astype(np.intc),
            *(np.ascontiguousarray(array, dtype=real) for array in (self.J, self.MJ, np.zeros(n))),
        )  # fmt: skip
        graph = Graph(self.bodies, *(array.ctypes.data for array in arrays))
        record, kept = _record(problem, library, "coulomb", starts, accepted)
        z, marks, report = (
            np.zeros(n, dtype=real),
            np.zeros(k, dtype=np.intc),
            report_structure(np.dtype(real))(),
        )
        core.mg_friction_on_graph(
            ctypes.byref(record), ctypes.byref(graph), pointer(z), pointer(marks), ctypes.byref(report),
            pointer(work), pointer(iwork),
        )  # fmt: skip
        assert np.all(np.isnan(work[sizes[0] :]))
        assert np.all(iwork[sizes[1] :] == -77)
        del kept, arrays
        return z, report


def pile(seed: int, bodies: int, per_contact: int, friction: float, joints: int = 0) -> Rows:
    """A random pile of bodies on ground: each stands on earlier ones, and gravity has acted for 5 ms."""
    random = np.random.default_rng(seed)
    position = random.uniform(-0.5, 0.5, (bodies, 3)) + 0.1 * np.outer(np.arange(bodies), [0, 0, 1])
    mass, inertia = random.uniform(0.5, 2, bodies), random.uniform(0.02, 0.1, (bodies, 3))
    pairs = [(int(random.integers(-1, b)), b) for b in range(bodies) for _ in range(3)]
    J: list[list[Array]] = []
    body: list[tuple[int, int]] = []
    first: list[int] = []
    for below, above in pairs:
        normal = np.array([*random.uniform(-0.5, 0.5, 2), 1.0])
        axes = np.linalg.qr(np.column_stack([normal, random.normal(size=(3, 2))]))[0].T
        axes[0] *= np.sign(axes[0] @ normal)
        point = position[above] + random.uniform(-0.1, 0.1, 3) - [0, 0, 0.1]
        first.append(len(J))
        for row in range(per_contact):
            axis, turns = axes[row % 3], row >= 3
            halves = []
            for side, sign in ((below, -1.0), (above, 1.0)):
                arm = point - position[side]
                push = np.concatenate([np.zeros(3), axis] if turns else [axis, np.cross(arm, axis)])
                halves.append(sign * push * (side >= 0))
            J.append(halves)
            body.append((below, above))
    for _ in range(joints):
        a, b = sorted(random.choice(bodies, 2, replace=False).tolist())
        J.append([random.normal(size=6), random.normal(size=6)])
        body.append((a, b))
    rows: Array = np.array(J)
    on: Array = np.array(body)
    inverse = np.array([np.r_[np.full(3, 1 / m), 1 / i] for m, i in zip(mass, inertia, strict=True)])
    MJ = rows * np.where(on[..., None] >= 0, inverse[on], 0)
    whole, carried = (np.zeros((len(rows), 6 * bodies)) for _ in range(2))
    for r, side in np.ndindex(len(rows), 2):
        if on[r, side] >= 0:
            columns = slice(6 * on[r, side], 6 * on[r, side] + 6)
            whole[r, columns] += rows[r, side]
            carried[r, columns] += MJ[r, side]
    motion = np.tile([0, 0, -9.81 * 0.005, 0, 0, 0], bodies) + 0.01 * random.normal(size=6 * bodies)
    cone = np.tile([friction, friction, 0.01, 0.01], (len(first), 1))
    problem = FrictionProblem(
        whole @ carried.T, whole @ motion, np.array(first), np.full(len(first), per_contact), cone
    )
    return Rows(rows, MJ, on, bodies, problem)


@given(
    seed=st.integers(0, 10**6),
    bodies=st.integers(2, 12),
    per_contact=st.sampled_from([1, 3, 6]),
    friction=st.sampled_from([0.0, 0.2, 0.5]),
    joints=st.integers(0, 3),
)
def test_a_solution_on_the_graph_passes_the_certificate_of_the_matrix(
    lcp: Library, seed: int, bodies: int, per_contact: int, friction: float, joints: int
) -> None:
    rows = pile(seed, bodies, per_contact, friction, joints)
    z, report = rows.solve(lcp, 1e-8)
    told = residual(rows.problem, z, lcp)
    assert report.residual == pytest.approx(told, rel=1e-3, abs=1e-9)
    if report.outcome == 0:
        assert told <= 2e-8


@pytest.mark.parametrize("real", ["float", "double", "long double"])
@pytest.mark.parametrize("seed", range(6))
def test_bodies_move_as_by_the_matrix(lcp_in: Callable[[str], Any], seed: int, real: str) -> None:
    core, rows = lcp_in(real), pile(seed, 8, 1, 0.0)
    rounding = float(np.finfo(core.dtype).eps)
    z, report = rows.solve(core, 1e4 * rounding)
    by_matrix = coulomb(rows.problem, core)
    assert report.outcome == 0
    assert by_matrix.outcome is Outcome.SOLVED
    size = np.abs(rows.problem.b).max()
    w = (rows.problem.A @ z + rows.problem.b).astype(float)
    assert w == pytest.approx(by_matrix.w.astype(float), abs=1e6 * rounding * size)


def test_most_problems_of_forty_bodies_are_solved(lcp: Library) -> None:
    solved = sum(pile(seed, 40, 3, 0.3).solve(lcp, 1e-6)[1].outcome == 0 for seed in range(10))
    assert solved >= 8  # all ten, when this was written


@pytest.mark.parametrize(
    ("seed", "bodies", "friction"), [(39, 12, 0.8), (6, 20, 0.8), (14, 20, 0.8), (30, 30, 0.3)]
)
def test_other_starting_points_solve_what_the_first_does_not(
    lcp: Library, seed: int, bodies: int, friction: float
) -> None:
    rows = pile(seed, bodies, 3, friction)
    assert rows.solve(lcp, 1e-8, starts=1)[1].outcome == list(Outcome).index(Outcome.NOT_FOUND)
    z, report = rows.solve(lcp, 1e-8, starts=3)
    assert report.outcome == 0
    assert report.starts > 1
    assert residual(rows.problem, z, lcp) <= 2e-8
