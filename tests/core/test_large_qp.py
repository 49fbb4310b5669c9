"""The contact QP of many rows between bodies, by conjugate gradients, against the dense solver."""

from __future__ import annotations

import ctypes
from typing import Any

import numpy as np
import pytest

from modelgen.runtime.compiled_lcp import Outcome, solve_qp

Rows = tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]  # o (n,), f (n,), J (n, 12), M^-1 (n_body, 6)


def heap(rng: np.random.Generator, n: int, bodies: int, decades: float) -> Rows:
    """Random rows between random bodies, one in four of them on the ground, with masses over some decades."""
    f = rng.integers(0, bodies, n)
    o = (f + rng.integers(1, bodies, n)) % bodies
    o[rng.random(n) < 0.25] = -1
    J = rng.normal(size=(n, 12))
    J[o < 0, :6] = 0
    return o, f, J, np.repeat(10 ** rng.uniform(-decades / 2, decades / 2, (bodies, 1)), 6, axis=1)


def dense(rows: Rows) -> np.ndarray:
    """(n, n): J M^-1 J^T."""
    o, f, J, inverse = rows
    whole = np.zeros((len(o), inverse.size))
    for i, (a, b) in enumerate(zip(o, f, strict=True)):
        for body, part in ((a, J[i, :6]), (b, J[i, 6:])):
            if body >= 0:
                whole[i, 6 * body : 6 * body + 6] += part
    return (whole * inverse.ravel()) @ whole.T


class RowMatrix(ctypes.Structure):
    _fields_ = (
        ("n", ctypes.c_int),
        ("n_body", ctypes.c_int),
        *((name, ctypes.c_void_p) for name in ("o", "f", "J", "MJ")),
    )


class Report(ctypes.Structure):
    _fields_ = (
        *((name, ctypes.c_int) for name in ("outcome", "iterations", "rank")),
        ("residual", ctypes.c_double),
    )


def solved(
    rows: Rows, b: np.ndarray, guess: np.ndarray, lcp: Any, tolerance: float = 0.0
) -> tuple[np.ndarray, Report]:
    """z (n,) of the solver for many rows from a guess, and its report."""
    o, f, J, inverse = rows
    MJ = J * np.hstack([inverse[o], inverse[f]])
    arrays = [np.ascontiguousarray(a) for a in (o.astype(np.intc), f.astype(np.intc), J, MJ)]
    matrix = RowMatrix(len(o), len(inverse), *(a.ctypes.data for a in arrays))
    z, report = guess.copy(), Report()
    work = np.zeros(6 * len(o) + 6 * inverse.size)
    pointers = [ctypes.c_void_p(a.ctypes.data) for a in (b, z, work)]
    solve = lcp.cdll.mg_large_qp_solve
    allowed = ctypes.c_double(tolerance)
    solve(ctypes.byref(matrix), pointers[0], allowed, 20000, pointers[1], ctypes.byref(report), pointers[2])
    return z, report


@pytest.mark.parametrize(("n", "bodies"), [(40, 60), (120, 40), (200, 60)])
@pytest.mark.parametrize("decades", [0.0, 2.0])
def test_it_solves_what_the_dense_solver_solves(n: int, bodies: int, decades: float, lcp: Any) -> None:
    """The rows of the three sizes are independent: the solution is unique."""
    rng = np.random.default_rng(n)
    for _ in range(5):
        rows = heap(rng, n, bodies, decades)
        A = dense(rows)
        d = np.sqrt(np.diag(A))
        b = A @ rng.normal(size=n) - 0.3 * d**2  # feasible: b in the range of A, but for what pushes apart
        answer = solve_qp(A, b, lcp)
        assert answer.outcome is Outcome.SOLVED
        z, report = solved(rows, b, np.zeros(n), lcp)
        assert report.outcome == 0
        assert (z >= 0).all()
        scale = np.abs(b / d).max()
        residual = np.abs(np.minimum(z * d, (A @ z + b) / d)).max() / scale
        bound = 1e3 * n * np.finfo(float).eps * max(1.0, (z * d).max() / scale)
        assert residual <= 2 * min(bound, 1e-8)
        again, second = solved(rows, b, answer.z, lcp)
        assert second.iterations <= max(report.iterations // 2, 20)  # a good guess saves iterations
        np.testing.assert_allclose(A @ again / d, A @ z / d, atol=1e-6 * scale)


def test_rows_that_depend_on_each_other_have_a_solution_too(lcp: Any) -> None:
    rng = np.random.default_rng(3)
    for _ in range(10):
        o, f, J, inverse = heap(rng, 30, 4, 1.0)
        rows = np.tile(o, 3), np.tile(f, 3), np.tile(J, (3, 1)), inverse
        A = dense(rows)
        b = A @ rng.normal(size=90)
        z, report = solved(rows, b, np.zeros(90), lcp)
        d, scale = np.sqrt(np.diag(A)), np.abs(b / np.sqrt(np.diag(A))).max()
        assert report.outcome == 0
        assert np.abs(np.minimum(z * d, (A @ z + b) / d)).max() / scale <= 2e-8


@pytest.mark.parametrize("tolerance", [1e-2, 1e-4, 1e-6])
def test_a_tolerance_is_kept_and_saves_iterations(tolerance: float, lcp: Any) -> None:
    rng = np.random.default_rng(5)
    for _ in range(5):
        rows = heap(rng, 120, 40, 1.0)
        A = dense(rows)
        d = np.sqrt(np.diag(A))
        b = A @ rng.normal(size=120) - 0.3 * d**2
        z, report = solved(rows, b, np.zeros(120), lcp, tolerance)
        _, exact = solved(rows, b, np.zeros(120), lcp)
        scale = np.abs(b / d).max()
        assert report.outcome == 0
        assert np.abs(np.minimum(z * d, (A @ z + b) / d)).max() / scale <= tolerance * (1 + 1e-6)
        assert report.iterations < exact.iterations
