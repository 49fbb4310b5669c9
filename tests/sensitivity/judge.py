"""Pairs of a number and an output of a scene: the derivative beside differences of runs of either side.

Differences are extrapolated with halved steps, from both sides together and from each alone (Ridders), each
with its own error. A derivative that is called differentiable is wrong if differences that are resolved, of
both sides or of one, are another number; one that is said to hold for larger or smaller values, if those of
that side are.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from modelgen.codegen.library import Library
from modelgen.errors import ModelgenError
from modelgen.runtime.core_session import Session
from modelgen.runtime.finite_differences import Runs
from modelgen.runtime.sensitivity import Outputs, TangentRun, Verdict, outputs_of
from modelgen.runtime.sensitivity_directions import direction_rows, directions_of
from modelgen.runtime.settings import accuracy_of
from modelgen.runtime.tables.ctypes_structures import Array
from tests.sensitivity.families import Member

LONGEST, HALVINGS = 1e-3, 6  # change of a number, of its size; and how often it is halved
WRONG = 1e-6  # of the size of a derivative
ROUNDED = 1e-7  # derivatives, by the sizes of number and output, that are not told from zero
LEAST = 1e-3  # size of an output that is zero, of that of the scene
SAFE = 10.0  # times the error of an extrapolation


@dataclass(frozen=True)
class Judged:
    """A derivative of an output (its components) by a number."""

    by: str
    of: str
    verdict: Verdict
    side: str  # for which changes it is said to hold
    found: Array  # (n,)
    expected: Array  # (n,), of the differences that decided
    outcome: str  # "agrees", "wrong", "unresolved"; "kink": sides differ, and none is said


def judged(library: Library, member: Member, accuracy: str = "tight") -> Iterator[Judged]:
    """All pairs of a member of a family."""
    instance = library.manifest.instance
    for direction in directions_of(instance, member.by):
        rows = direction_rows(library, [direction])
        session = Session(library, accuracy_of(instance, accuracy, {}))
        run = TangentRun(session, rows.arrays, 1, rows.kinks).go_on(member.t)
        names = list(outputs_of(instance))
        runs = Runs(library, np.array([member.t]), names, accuracy="tight")
        size = runs.size(direction)
        values = [
            _shown(runs, direction, sign * size * LONGEST / 2**k) for k in range(HALVINGS) for sign in (1, -1)
        ]
        plain, at = runs.shown(None, 0.0)[0], 0
        for name in names:
            of_one = Outputs(session, [name])
            _, jacobian, sides, verdict = run.shown(of_one)
            part = slice(at, at + len(of_one.names))
            at = part.stop
            side = common_side(sides[:, 0])
            yield _judged(
                direction.name,
                name,
                verdict,
                side,
                jacobian[:, 0] * size,
                plain[part],
                [v[part] for v in values],
                LEAST * member.size,
            )


def common_side(sides: Array) -> str:
    """The side for which all components hold."""
    found = {str(each) for each in sides} - {"both"}
    return found.pop() if len(found) == 1 else "neither" if found else "both"


def _shown(runs: Runs, direction: object, change: float) -> Array:
    try:
        return np.asarray(runs.shown(direction, change)[0])  # type: ignore[arg-type]
    except ModelgenError:
        return np.full(len(runs.shown(None, 0.0)[0]), np.nan)


def _judged(
    by: str,
    of: str,
    verdict: Verdict,
    side: str,
    found: Array,
    plain: Array,
    values: list[Array],
    least: float,
) -> Judged:
    """`values`: after changes by LONGEST, -LONGEST, LONGEST/2, .. of the size of the number."""
    steps = [LONGEST / 2**k for k in range(HALVINGS)]
    above, below = values[::2], values[1::2]
    scale = least + float(np.max(np.abs(plain))) + float(np.nanmax(np.abs(found), initial=0.0))
    rough = 1e-13 * scale / steps[-1]
    central = extrapolated(
        [(u - d) / (2 * h) for u, d, h in zip(above, below, steps, strict=True)], 4.0, rough
    )
    sides = [
        extrapolated([(v - plain) / h for v, h in zip(side, steps, strict=True)], 2.0, rough)
        for side, steps in ((above, steps), (below, [-h for h in steps]))
    ]
    judges = {"larger": sides[:1], "smaller": sides[1:]}.get(side, (central, *sides))
    resolved = [
        (value, error)
        for value, error in judges
        if np.all(SAFE * error <= WRONG / 2 * np.max(np.abs(value)) + ROUNDED * scale)
    ]
    outcome, expected = "unresolved", central[0]
    for value, error in resolved:
        apart = np.abs(found - value) > WRONG * np.max(np.abs(value)) + SAFE * error + ROUNDED * scale
        outcome = "agrees" if outcome == "unresolved" else outcome
        if np.any(apart) or not np.all(np.isfinite(found)):
            outcome, expected = ("kink" if side in ("neither", "unknown") else "wrong"), value
            break
    if bool(verdict) != (side == "both"):
        outcome = "wrong"  # the verdict is that of all sides together
    return Judged(by, of, verdict, side, found, expected, outcome)


def extrapolated(quotients: list[Array], base: float, rough: float) -> tuple[Array, Array]:
    """The limit of quotients with halved steps, whose error is a series of powers of `base`, and its error:
    by how much the last two steps of the extrapolation change it, and rounding."""
    table, last = quotients, quotients[-1]
    errors = [np.full_like(last, np.inf)]
    for order in range(1, min(len(quotients), 5)):
        factor = base**order
        table = [(factor * b - a) / (factor - 1) for a, b in pairwise(table)]
        errors.append(np.maximum(np.abs(table[-1] - last), np.abs(table[-1] - table[-2])))
        last = table[-1]
    return last, errors[-1] + rough
