"""Whether a run can be trusted, and if not, why: its end, gaps, energy, estimate, and what certifies it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from modelgen.runtime.accuracy import Accuracy
from modelgen.runtime.error_statement import Estimate
from modelgen.runtime.trajectory import Outcome, Trajectory

DYING = ("slip-stop", "spin-stop", "roll-stop")  # events at which slip has died
UNBALANCED = (
    1e-3  # of the kinetic energy, or of m L^2 / T^2: more energy is not lost by steps, but by a fault
)


def with_trust(
    path: Trajectory, estimate: Estimate | None, accuracy: Accuracy, instance: Mapping[str, Any]
) -> Trajectory:
    """The run with its estimate and the doubts that follow."""
    return replace(path, estimate=estimate, doubts=doubts(path, estimate, accuracy, instance))


def doubts(
    path: Trajectory, estimate: Estimate | None, accuracy: Accuracy, instance: Mapping[str, Any]
) -> tuple[str, ...]:
    """Reasons why a run cannot be trusted; none if it can.

    Args:
        path, estimate: the run, and its estimate if there is one.
        accuracy: its record; `gap_error_max`, `start_joint_gap` and `energy_error_max` are the thresholds of
            the ledger.
        instance: of the manifest.

    Returns:
        The reasons in words: the run ended early; a closed contact is open; bodies penetrate; an open edge
        passed through a body; a joint is apart; energy is out of balance; the error is not predicted up to
        the end; the run is uncertified, and why.
    """
    return tuple(_doubts(path, estimate, accuracy, instance))


def _doubts(
    path: Trajectory, estimate: Estimate | None, accuracy: Accuracy, instance: Mapping[str, Any]
) -> Iterator[str]:
    if path.outcome is not Outcome.DONE:
        yield f"it ended early: {path.outcome.name.lower()}"
    gap_limit = accuracy.gap_error_max * instance["scales"]["length"]
    if not path.gap_max <= gap_limit:
        yield f"the gap of a closed contact reached {path.gap_max:.2g} m, above {gap_limit:.2g} m"
    if not path.penetration_max <= gap_limit:
        where = f"bodies penetrated by {path.penetration_max:.2g} m ({path.penetration_pair}, "
        yield f"{where}t = {path.penetration_t:.6g} s), above {gap_limit:.2g} m"
    for each in path.over_edges:
        surface, other = each.between
        yield f"an open edge of {surface}, which touches nothing, passed through {other} (t = {each.t:.6g} s)"
    joint_limit = accuracy.start_joint_gap * instance["scales"]["length"]
    if not path.joint_error_max <= joint_limit:
        yield f"a joint was apart by {path.joint_error_max:.2g} m, above {joint_limit:.2g} m"
    if not path.energy_drift <= max(accuracy.energy_error_max, path.energy_rounding):
        yield f"the energy drift {path.energy_drift:.2g} is above {accuracy.energy_error_max:g}"
    if estimate is not None and estimate.horizon is not None:
        yield f"nothing is predicted beyond {estimate.horizon:.6g} s"
    reasons = tuple(uncertified(path, accuracy, instance)) if estimate is None else estimate.uncertified
    if reasons:
        yield f"uncertified: {'; '.join(reasons)}"


def uncertified(path: Trajectory, accuracy: Accuracy, instance: Mapping[str, Any]) -> Iterator[str]:
    """Reasons why a run may have an error that its companion would share."""
    if not accuracy.use_gamma and instance["pairs"]:
        yield "Gamma2 is left out, and so the motion is another"
    if _is_unbalanced(path, instance):
        yield f"energy is off by {path.energy_drift:.2g} of the kinetic energy"
    if steps_in_time(path, accuracy):
        yield "time-stepping locates no events"
    if accuracy.method == "rk4" and any(event.kind in DYING for event in path.events):
        yield "fixed steps lose their order where slip dies"
    if path.indeterminate_load:
        yield (
            f"from t = {path.indeterminate_t:.6g} s the motion is not unique: {path.indeterminate_load} "
            "is at a jump from which it leads away"
        )
    elif path.indeterminate_t is not None:
        yield (
            "contact forces with friction were not unique, and from "
            f"t = {path.indeterminate_t:.6g} s the motion not proved to be: which contact slips first is not "
            "decided by them"
        )
    if path.unfollowed_minima:
        yield "closest points were found that no contact was free to follow"
    if path.incomplete_searches:
        yield "a search for closest points was given up before all were found"


def steps_in_time(path: Trajectory, accuracy: Accuracy) -> bool:
    """Whether a run, or a part of it, was one of time-stepping."""
    return accuracy.method == "time-stepping" or any(event.kind == "fallback-start" for event in path.events)


def _is_unbalanced(path: Trajectory, instance: Mapping[str, Any]) -> bool:
    if path.energy_drift <= UNBALANCED:  # whatever the kinetic energy
        return False
    scales, bodies = instance["scales"], instance["bodies"]
    mass = np.array([1 / b["mass_inverse"][0] if b["mass_inverse"][0] else 0.0 for b in bodies])
    v = path.v[np.isfinite(path.v).all(axis=(1, 2))].astype(float)
    kinetic = float((mass / 2 * (v**2).sum(axis=-1)).sum(axis=-1).max(initial=0.0))
    least = scales["mass"] * (scales["length"] / scales["time"]) ** 2
    return bool(path.energy_drift * kinetic > UNBALANCED * max(kinetic, least))
