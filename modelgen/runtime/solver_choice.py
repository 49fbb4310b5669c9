"""The solver of a run's complementarity problems: the core's own, or one of Python in its place."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping
from typing import Any

from modelgen.errors import SimulationError
from modelgen.runtime.accuracy import Accuracy

OUTER = {"lcp": 0, "polyhedral": 1, "mpcc": 2}  # called by the core; their numbers in saved states
FRICTIONLESS = ("qp", "lcp", "mpcc")  # by time-stepping; the first is that of the core
FRICTIONAL = ("coulomb", "relaxation", "polyhedral", "mpcc")
OF_EVENTS = (
    "qp",
    "coulomb",
    "lcp",
)  # their forces are right to rounding, by which contacts lift off and slip
DEFAULT = "coulomb"  # without friction what is left of the law: the program of `qp`


def has_friction(instance: Mapping[str, Any]) -> bool:
    """Whether any contact of a manifest's instance has friction or resistance."""
    return any(pair.get("friction") for pair in instance["pairs"])


def solvers_of(instance: Mapping[str, Any], method: str) -> tuple[str, ...]:
    """The solvers between which a run of a scene can choose, its default first."""
    known = FRICTIONAL if has_friction(instance) else FRICTIONLESS
    if method != "time-stepping":
        return tuple(each for each in known if each in OF_EVENTS)
    return tuple(each for each in known if each != "mpcc") if _has_resistance(instance) else known


def _has_resistance(instance: Mapping[str, Any]) -> bool:
    """Whether any contact resists spinning or rolling, whose lengths IPOPT finds no scale for."""
    kinds = (each["kind"] for pair in instance["pairs"] for each in pair.get("friction", ()))
    return any(kind != "slip" for kind in kinds)


def solver_of(accuracy: Accuracy, instance: Mapping[str, Any]) -> str:
    """The solver that a run of a scene has: without friction and choice `qp`."""
    return solvers_of(instance, accuracy.method)[0] if accuracy.solver == DEFAULT else accuracy.solver


def solves_of(report: Any, accuracy: Accuracy) -> dict[str, int]:
    """How many problems each solver was given in the run that an mg_run_report is of."""
    counts = {accuracy.solver: report.outer_solves} if accuracy.solver in OUTER else {}
    counts |= {"coulomb": report.friction_solves, "relaxation": report.relaxed_solves, "qp": report.qp_solves}
    return {name: int(count) for name, count in counts.items() if count}


def check_solver(solver: str, method: str, instance: Mapping[str, Any], place: str = "solver") -> None:
    """Raises SimulationError, about `place`, where runs of the scene by this method have no such solver."""
    if solver == DEFAULT or solver in (known := solvers_of(instance, method)):
        return
    kind = "with friction" if has_friction(instance) else "without friction"
    way = "by time-stepping" if method == "time-stepping" else "with events"
    remedy = "leave it out, or choose one of these"
    if method != "time-stepping" and solver in solvers_of(instance, "time-stepping"):
        remedy = 'take steps in time as well: method = "time-stepping", step = 0.001'
    raise SimulationError(place, repr(solver), f"{', '.join(known)} ({kind}, {way})", remedy)


def with_solver(settings: Any, accuracy: Accuracy, library: Any) -> Any:
    """The mg_settings of an Accuracy with its solver; the same ones where that is the core's.

    `library`: that of the run, which the solver calls.

    Raises SimulationError where runs of its scene have no such solver.
    """
    check_solver(accuracy.solver, accuracy.method, library.manifest.instance)
    if accuracy.solver not in OUTER:
        return settings
    if library.real == "long double":
        allowed = f"{DEFAULT}, which the core has, over long double"
        raise SimulationError("solver", repr(accuracy.solver), allowed, "build over double, or leave it out")
    from modelgen.runtime.friction.outer_solver import OuterSolver

    own = type(settings).from_buffer_copy(settings)
    own.chosen = OuterSolver(accuracy.solver, OUTER[accuracy.solver], library)  # lives as long as `own` does
    own.outer_solver = ctypes.addressof(own.chosen.structure)
    return own


def raise_failure(settings: Any) -> None:
    """After a call of the core: raises the exception of a solver called with these settings, once."""
    chosen = getattr(settings, "chosen", None)
    if chosen is not None and chosen.failure is not None:
        failure, chosen.failure = chosen.failure, None
        raise failure
