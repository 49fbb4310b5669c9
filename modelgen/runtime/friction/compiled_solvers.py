"""The solvers of the compiled core (core/solve/friction/friction.h), and the certificate that all share."""

from __future__ import annotations

import ctypes
from functools import cache
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from modelgen.errors import SimulationError
from modelgen.runtime.c_arrays import C_REALS, frozen, pointer
from modelgen.runtime.compiled_lcp import CoreLibrary
from modelgen.runtime.friction.problem import FrictionProblem, FrictionSolution, Motion, Outcome
from modelgen.runtime.tables.scratch_memory import solver_scratch

Law = Literal["coulomb", "relaxed"]
LAWS: tuple[Law, ...] = ("coulomb", "relaxed")  # in the order of core/solve/friction/friction.h
_COUNTS = ("outcome", "sweeps", "newton", "starts", "rank", "active", "unique")
_UNDECIDED = -1


def coulomb(
    problem: FrictionProblem,
    library: CoreLibrary,
    start: ArrayLike | None = None,
    starts: int = 0,
    accepted: float = 0.0,
) -> FrictionSolution:
    """Solves Coulomb's law without approximation.

    Block Gauss-Seidel sweeps with exact solutions at one contact, then a semismooth Newton method on the
    natural map (P. Alart, A. Curnier, Comput. Methods Appl. Mech. Eng. 92 (1991), 353-375); where these
    fail, from interior points of convex problems whose normal rows are shifted by the slip that came out
    before (V. Acary, F. Cadoux, C. Lemarechal, J. Malick, ZAMM 91 (2011), 155-175), and along paths from
    softened matrices. What it loses: a solution may exist and not be found (NOT_FOUND), and of several it
    returns one.

    Args:
        start: (n,) a guess of the forces, such as those of the step before; none by default.
        starts: starting points at most, the guess among them; 0: all, which may take seconds for 20 contacts.
        accepted: a residual that counts as solved once Newton steps no longer halve it; 0: rounding alone.

    Raises:
        SimulationError: a record that does not fit together, or a start of another shape.
    """
    return _call(problem, library, "coulomb", start, starts, accepted)


def relaxation(
    problem: FrictionProblem, library: CoreLibrary, start: ArrayLike | None = None
) -> FrictionSolution:
    """Solves the convex relaxation: min z'Az/2 + b'z over the friction cones.

    M. Anitescu, A. Tasora, Comput. Optim. Appl. 47 (2010), 207-235. Always solved where it is feasible,
    with w unique. What it loses: w_n of a contact that slips is |mu w_t| instead of 0, so that sliding
    bodies lift off at a slope of mu (in a time-stepping scheme: a gap of about mu |v_t| times the step).
    Contacts that open more slowly than that are pushed too. Exact where all stick or open faster, or mu = 0.
    Its program can be infeasible where Coulomb's law has a solution. Arguments and errors as for `coulomb`.
    """
    return _call(problem, library, "relaxed", start)


def residual(problem: FrictionProblem, z: ArrayLike, library: CoreLibrary, law: Law = "coulomb") -> float:
    """The scaled natural map of any z: 0 for a solution of `law` (mg_friction_residual of the core).

    Dimensionless, and the same in all units and for all choices of t1, t2.
    """
    forces = np.ascontiguousarray(z, dtype=library.dtype)
    record, alive = _record(problem, library, law)
    function = library.cdll.mg_friction_residual
    function.restype = C_REALS[forces.dtype.char]
    value = float(function(ctypes.byref(record), pointer(forces)))
    del alive
    return value


def scattered_start(
    problem: FrictionProblem, z: ArrayLike, number: int, library: CoreLibrary
) -> NDArray[Any]:
    """Forces from which `coulomb` may find another solution than z (mg_scatter_friction_start of the core).

    Args:
        z: (n,) forces of a solution.
        number: 0: no forces; from 1 on: forces scattered within the cones, 0.3 to 100 times as large as z.

    Returns:
        (n,) a start, the same for the same arguments.
    """
    forces = np.array(z, dtype=library.dtype)
    record, alive = _record(problem, library, "coulomb")
    library.cdll.mg_scatter_friction_start(ctypes.byref(record), number, pointer(forces))
    del alive
    return forces


def _call(
    problem: FrictionProblem,
    library: CoreLibrary,
    law: Law,
    start: ArrayLike | None,
    starts: int = 0,
    accepted: float = 0.0,
) -> FrictionSolution:
    record, alive = _record(problem, library, law, starts, accepted)
    cdll, n, count = library.cdll, problem.n, len(problem.first)
    z = np.zeros(n, dtype=library.dtype)
    if start is not None and np.shape(start) != z.shape:
        raise SimulationError("problem with friction", f"start of shape {np.shape(start)}", f"shape ({n},)")
    if start is not None:
        z[:] = np.asarray(start)
    marks = np.zeros(count, dtype=np.intc)
    work, iwork = solver_scratch(cdll.mg_friction_work_size, cdll.mg_friction_iwork_size, z.dtype, n, count)
    report = report_structure(z.dtype)()
    cdll.mg_friction(
        ctypes.byref(record),
        pointer(z),
        pointer(marks),
        ctypes.byref(report),
        pointer(work),
        pointer(iwork),
    )
    del alive
    return FrictionSolution(
        z=frozen(z),
        w=frozen(motion(problem, z)),
        outcome=list(Outcome)[report.outcome],
        residual=float(report.residual),
        coulomb_residual=residual(problem, z, library),
        approximation="" if law == "coulomb" else "w_n of a contact that slips is |mu w_t| instead of 0",
        iterations=int(report.sweeps + report.newton),
        motions=tuple(Motion(int(mark)) for mark in marks),
        rank=int(report.rank),
        active=int(report.active),
        unique=None if report.unique == _UNDECIDED else bool(report.unique),
    )


def motion(problem: FrictionProblem, z: NDArray[Any]) -> NDArray[Any]:
    """w = A z + b."""
    with np.errstate(invalid="ignore", over="ignore"):
        return np.asarray(problem.A.astype(z.dtype) @ z + problem.b)


def _record(
    problem: FrictionProblem, library: CoreLibrary, law: Law, starts: int = 0, accepted: float = 0.0
) -> tuple[Any, tuple[Any, ...]]:
    """The record for the core, and the arrays that must live as long as it does."""
    real = library.dtype
    A, b = np.asfortranarray(problem.A, dtype=real), np.ascontiguousarray(problem.b, dtype=real)
    cone = np.ascontiguousarray(problem.cone, dtype=real)
    first, rows = (np.ascontiguousarray(x, dtype=np.intc) for x in (problem.first, problem.rows))
    kept = (first, rows, cone, A, b)
    pointers = (pointer(array) for array in kept)
    record = problem_structure(np.dtype(real))
    return record(problem.n, len(first), LAWS.index(law), 1, *pointers, starts, accepted), kept


@cache
def problem_structure(dtype: np.dtype[Any]) -> Any:
    """The mg_friction_problem of a real type."""
    fields = [
        *((name, ctypes.c_int) for name in ("n", "n_contact", "law", "wants_rank")),
        *((name, ctypes.c_void_p) for name in ("first", "rows", "cone", "A", "b")),
        ("starts", ctypes.c_int),
        ("accepted", C_REALS[dtype.char]),
        ("stop", ctypes.c_void_p),
        ("from_last", ctypes.c_int),
        ("near", C_REALS[dtype.char]),
        ("newton_max", ctypes.c_int),
    ]
    return type("FrictionProblem", (ctypes.Structure,), {"_fields_": fields})


@cache
def report_structure(dtype: np.dtype[Any]) -> Any:
    """The mg_friction_report of a real type."""
    fields = [*((name, ctypes.c_int) for name in _COUNTS), ("residual", C_REALS[dtype.char])]
    return type("FrictionReport", (ctypes.Structure,), {"_fields_": fields})
