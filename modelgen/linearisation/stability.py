"""Stability of a steady motion over a range of a parameter: eigenvalues, and where the motion is stable."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.optimize import brentq, linear_sum_assignment

from modelgen.codegen.library import Library
from modelgen.derivation import Derivation
from modelgen.errors import ModelgenError, SimulationError, expect
from modelgen.linearisation.steady_modes import LinearisedSteady, Spectrum, SteadyFamily, split
from modelgen.linearisation.touching_contact import Array
from modelgen.runtime.arguments import (
    check_function,
    check_name,
    numbers_in,
    shown,
    values_by_name,
    with_parameters,
)

HALVINGS = 24  # of the distance of two values between which stability changes
CLOSE = 1e-13  # relative, of an end of stability where growth crosses zero


@dataclass(frozen=True, slots=True)
class Stability:
    """Eigenvalues of the small motions over the values of a parameter; arrays are read-only."""

    scene: str
    parameter: str
    values: Array  # (m,)
    eigenvalues: tuple[Spectrum, ...]  # (r,) complex each, 1/s; in the order of those of the value before
    stable: tuple[tuple[float, float], ...]  # ranges of the values in which no motion grows
    refused: tuple[
        tuple[float, str], ...
    ]  # values without such a steady motion, and why; no eigenvalues there


def stability(
    derivation: Derivation,
    library: Library,
    parameter: str,
    values: Sequence[float],
    *,
    parameters: Mapping[str, float] | None = None,
    on_progress: Callable[[float], None] | None = None,
) -> Stability:
    """The eigenvalues of the steady motion near the start of a scene at each value of a parameter.

    An end of stability between two values is located to rounding where the growth of a motion crosses zero;
    where it leaves zero, as without dissipation, by halving. Values at which there is no such motion are kept
    as refused.

    Args:
        derivation: of the scene.
        library: what `build` made of it.
        parameter: the name of a `[[parameter]]` of the scene.
        values: at least two, ascending.
        parameters: values of other parameters.
        on_progress: called with the share of the values that are done.

    Raises:
        ModelgenError: as `linearise_steady`; the parameter does not take these values, or they do not ascend.
        SimulationError: as `linearise_steady`, where there is no steady motion at any value.
    """
    expect("stability", derivation, Derivation)
    expect("stability", library, Library)
    check_function("on_progress", on_progress)
    check_name(
        "stability: parameter",
        parameter,
        [each["name"] for each in library.manifest.instance.get("parameters", ())],
    )
    found = numbers_in("stability: values", values, "two or more numbers that ascend")
    if found.ndim != 1 or len(found) < 2 or not (np.diff(found) > 0).all():
        raise ModelgenError("stability: values", shown(values), "two or more numbers that ascend")
    family, others = SteadyFamily(derivation, library), dict(values_by_name("parameters", parameters))

    def at(value: float) -> LinearisedSteady:
        return family.at(others | {parameter: float(value)})

    for end in (found[0], found[-1]):
        with_parameters(library, others | {parameter: float(end)})
    motions: list[LinearisedSteady | None] = []
    refused: list[tuple[float, SimulationError]] = []
    for k, value in enumerate(found):
        try:
            motions.append(at(value))
        except SimulationError as error:
            motions.append(None)
            refused.append((float(value), error))
        if on_progress:
            on_progress((k + 1) / len(found))
    if len(refused) == len(found):
        raise refused[0][1]
    none = np.zeros(0, dtype=complex)
    return Stability(
        scene=derivation.model.scene.name,
        parameter=parameter,
        values=found,
        eigenvalues=_in_order([motion.eigenvalues if motion else none for motion in motions]),
        stable=_stable(found, motions, at),
        refused=tuple((value, str(error)) for value, error in refused),
    )


def _in_order(found: list[Spectrum]) -> tuple[Spectrum, ...]:
    """The eigenvalues of each value in the order of those before, by the least sum of distances."""
    ordered = found[:1]
    for values in found[1:]:
        last = ordered[-1]
        if len(values) == len(last):
            order = linear_sum_assignment(np.abs(last[:, None] - values[None, :]))[1]
            values = values[order]
        ordered.append(values)
    return tuple(ordered)


def _stable(
    values: Array, motions: Sequence[LinearisedSteady | None], at: Callable[[float], LinearisedSteady]
) -> tuple[tuple[float, float], ...]:
    """A range ends where growth begins, or at the last value before one without a motion."""
    ends = [float(values[0])] if _is_stable(motions[0]) else []
    for (a, at_a), (b, at_b) in pairwise(zip(values, motions, strict=True)):
        if _is_stable(at_a) == _is_stable(at_b):
            continue
        if at_a is None or at_b is None:
            ends.append(float(b if at_a is None else a))
        else:
            ends.append(_end(float(a), at_a, float(b), at_b, at))
    if len(ends) % 2:
        ends.append(float(values[-1]))
    return tuple(zip(ends[::2], ends[1::2], strict=True))


def _is_stable(motion: LinearisedSteady | None) -> bool:
    return motion is not None and motion.growth <= 0


def _end(
    a: float,
    at_a: LinearisedSteady,
    b: float,
    at_b: LinearisedSteady,
    at: Callable[[float], LinearisedSteady],
) -> float:
    """Where stability changes between a and b."""
    neutral = min(at_a.neutral, at_b.neutral)
    if at_a.growth * at_b.growth < 0:
        xtol, rtol = CLOSE * max(abs(a), abs(b)), 4 * np.finfo(float).eps
        return float(brentq(lambda value: _growth(at(value), neutral), a, b, xtol=xtol, rtol=rtol))
    for _ in range(HALVINGS):
        middle = (a + b) / 2
        if (at(middle).growth <= 0) == (at_a.growth <= 0):
            a = middle
        else:
            b = middle
    return (a + b) / 2


def _growth(motion: LinearisedSteady, neutral: int) -> float:
    """1/s, of the motion that grows fastest, without the so many that are nearest to neutral."""
    moved, _ = split(motion.matrix, neutral)
    return float(np.real(np.linalg.eigvals(moved.T @ motion.matrix @ moved)).max())
