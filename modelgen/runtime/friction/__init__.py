"""Solvers of one step with Coulomb friction, by name, with one record and one certificate.

What each approximates and loses stands in its docstring.

    coulomb      the law as it stands, in the core
    relaxation   the convex program over the friction cones, in the core
    polyhedral   cones with flat sides, by Lemke's method
    mpcc         the law as constraints of an optimisation, by IPOPT: slow, independent
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

from modelgen.errors import SimulationError
from modelgen.runtime.compiled_lcp import CoreLibrary
from modelgen.runtime.friction.compiled_solvers import (
    coulomb,
    relaxation,
    residual,
    scattered_start,
)
from modelgen.runtime.friction.painleve import Paradox, SlidingAnswer, sliding
from modelgen.runtime.friction.polyhedral import polyhedral
from modelgen.runtime.friction.problem import FrictionProblem, FrictionSolution, Motion, Outcome

Solver = Callable[[FrictionProblem, CoreLibrary], FrictionSolution]
Name = Literal["coulomb", "relaxation", "polyhedral", "mpcc"]


def solver(name: Name) -> Solver:
    """The solver of that name; `mpcc` and CasADi are imported only when it is asked for.

    Raises SimulationError for another name.
    """
    if name == "mpcc":
        from modelgen.runtime.friction.mpcc import mpcc

        return mpcc
    known: dict[str, Solver] = {"coulomb": coulomb, "relaxation": relaxation, "polyhedral": polyhedral}
    if name not in known:
        raise SimulationError("solver", f"{name!r}", f"one of {', '.join((*known, 'mpcc'))}")
    return known[name]


__all__ = [
    "FrictionProblem",
    "FrictionSolution",
    "Motion",
    "Name",
    "Outcome",
    "Paradox",
    "SlidingAnswer",
    "Solver",
    "coulomb",
    "polyhedral",
    "relaxation",
    "residual",
    "scattered_start",
    "sliding",
    "solver",
]
