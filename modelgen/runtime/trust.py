"""Whether a run can be trusted, and if not, why: its end, gaps, energy, estimate, and what certifies it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from math import inf
from typing import Any

import numpy as np

from modelgen.runtime.accuracy import Accuracy
from modelgen.runtime.error_statement import Estimate
from modelgen.runtime.trajectory import Outcome, Trajectory


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
        accuracy: its record; `gap_error_max`, `start_joint_gap`, `energy_error_max` and
            `complementarity_error_max` of its thresholds are the bounds, which the core applies (mg_doubts).
        instance: of the manifest.

    Returns:
        The reasons in words: the run ended early; a closed contact is open; bodies penetrate; a joint is
        apart; energy is out of balance, or an impact added some; forces pull; an open edge passed through a
        body; the error is not predicted up to the end; the run is uncertified, and why.
    """
    return tuple(_doubts(path, estimate, accuracy, instance))


def _doubts(
    path: Trajectory, estimate: Estimate | None, accuracy: Accuracy, instance: Mapping[str, Any]
) -> Iterator[str]:
    if path.outcome is not Outcome.DONE:
        yield f"it ended early: {path.outcome.name.lower()}"
    told = _figures(path, accuracy, instance)
    for kind in FIGURES:
        if kind in path.doubt_kinds and not _is_explained(kind, path, estimate, instance):
            yield told[kind]
    for each in path.over_edges:
        surface, other = each.between
        found = f"passed through {other} (t = {each.t:.6g} s)"
        yield f"an open edge or end of {surface}, which touches nothing, {found}"
    if estimate is not None and estimate.horizon is not None:
        yield f"nothing is predicted beyond {estimate.horizon:.6g} s"
    reasons = tuple(uncertified(path)) if estimate is None else estimate.uncertified
    if reasons:
        yield f"uncertified: {'; '.join(reasons)}"


def _is_explained(
    kind: str, path: Trajectory, estimate: Estimate | None, instance: Mapping[str, Any]
) -> bool:
    """Whether one of FIGURES is no larger than the stated error of a run allows."""
    if estimate is None or estimate.horizon is not None or estimate.uncertified:
        return False
    if not np.isfinite(estimate.position[-1]):
        return False
    if kind == "penetration":
        before = max(int(np.searchsorted(path.t, path.penetration_t, side="right")) - 1, 0)
        return bool(path.penetration_max <= estimate.position[before])
    return kind == "energy" and _is_drift_explained(path, estimate, instance)


def _is_drift_explained(path: Trajectory, estimate: Estimate, instance: Mapping[str, Any]) -> bool:
    """Whether the stated errors of velocities and spins make the drift of the energy.

    The largest kinetic energy is taken as twice the sum of those of each body at its fastest sample, with its
    largest moment of inertia, and any body may have lost all of the drift.
    """
    largest, may = 0.0, inf
    for k, body in enumerate(instance["bodies"]):
        if body["motion"] not in ("point", "free"):
            continue
        mass, speed = 1 / body["mass_inverse"][0], float(np.linalg.norm(path.v[:, k], axis=1).max())
        largest, changed = largest + mass * speed**2, mass * speed * float(estimate.velocity[-1])
        if body["motion"] == "free":
            inertia = 1 / np.linalg.eigvalsh(np.reshape(body["mass_inverse"][1:], (3, 3)))
            spin = float(np.linalg.norm(path.w[:, k], axis=1).max())
            largest += inertia.max() * spin**2
            changed += inertia.min() * spin * float(estimate.spin[-1])
        may = min(may, changed)
    return bool(0 < (path.energy_drift + path.correction_energy) * largest <= may < inf)


def _figures(path: Trajectory, accuracy: Accuracy, instance: Mapping[str, Any]) -> Mapping[str, str]:
    """The doubts FIGURES of a run in words, with the figure and its bound."""
    length = instance["scales"]["length"]
    bounds = accuracy.thresholds
    gap, joint = bounds.gap_error_max * length, bounds.start_joint_gap * length
    energy = max(bounds.energy_error_max, path.energy_rounding)
    drift, corrected = path.energy_drift + path.correction_energy, path.correction_energy
    by_corrections = f", {corrected:.2g} of it by corrections of positions," if corrected > energy / 2 else ""
    return {
        "gap": f"the gap of a closed contact reached {path.gap_max:.2g} m, above {gap:.2g} m",
        "penetration": f"bodies penetrated by {path.penetration_max:.2g} m ({path.penetration_pair}, "
        f"t = {path.penetration_t:.6g} s), above {gap:.2g} m",
        "joint": f"a joint was apart by {path.joint_error_max:.2g} m, above {joint:.2g} m",
        "energy": f"the energy drift {drift:.2g}{by_corrections} is above {energy:.2g}",
        "complementarity": "a contact force pulled, or acted across a gap, by "
        f"{path.complementarity_max:.2g} (complementarity), above {bounds.complementarity_error_max:g}",
        "impact-gain": gain_text(instance, path.impact_gain_contact, path.impact_gain_t, path.impact_gain)
        + f", above {bounds.energy_error_max:g} of the largest kinetic energy",
        "stand-in": "contacts are with shapes that stand for other surfaces: "
        + "; ".join(f"{name} for {what}" for name, what in instance.get("stand_ins", ())),
    }


FIGURES = (
    "gap",
    "penetration",
    "joint",
    "energy",
    "complementarity",
    "impact-gain",
    "stand-in",
)  # of DOUBT_KINDS


def uncertified(path: Trajectory, brief: float = 0.0) -> Iterator[str]:
    """Reasons why a run may have an error that its companion would share. Fallbacks that last no longer than
    `brief`, s, tell modes late by no more than that; what else they change shows in the companion, unless no
    accelerations were admissible."""
    told = {
        "no-gamma": "Gamma2 is left out, and so the motion is another; use_gamma = true has it",
        "time-stepping": _time_stepping(path),
        "slip-stop": "the fixed steps of rk4 lose their order where slip dies; adaptive ones (dop853) end "
        "there",
        "indeterminate": _indeterminate(path),
        "flush": f"at t = {path.flush_t:.6g} s a blow at {path.flush_contact} struck an edge that lies in "
        "the plane of a face of each body: rounding decides whether they meet; make one face of the two, or "
        "let one lie lower by more than rounding",
        "unfollowed": f"at t = {path.unfollowed_t:.6g} s closest points of {path.unfollowed_pair} were found "
        "that no contact was free to follow: the pair may penetrate there; `points` of its [[contact]] "
        "allows more",
        "incomplete": f"at t = {path.incomplete_t:.6g} s a search for closest points of "
        f"{path.incomplete_pair} was given up before all were found: a touch there may be missed",
        "capacity": "a capacity of the core was exceeded: the warning says which, and what that did",
    }
    if 0 < _longest_fallback(path) <= brief and not path.jams:
        del told["time-stepping"]
    yield from (reason for kind, reason in told.items() if kind in path.doubt_kinds)


def _time_stepping(path: Trajectory) -> str:
    """How time-stepping, or a fallback on it, tells events."""
    starts = [event.t for event in path.events if event.kind == "fallback-start"]
    if not starts:
        return "time-stepping tells events to a step only; event-driven methods locate them"
    span = f", for {path.fallback_time:.2g} s in all," if path.fallback_time > 0 else ""
    return (
        f"from t = {starts[0]:.6g} s{span} the run went on by time-stepping, which tells events to a step of "
        f"{path.fallback_step:.2g} s only; a warning says why"
    )


def _longest_fallback(path: Trajectory) -> float:
    """s; 0 of a run that did not fall back, infinite of one that ended meanwhile."""
    longest, start = 0.0, None
    for event in path.events:
        if event.kind == "fallback-start":
            start = event.t
        elif event.kind == "fallback-end" and start is not None:
            longest, start = max(longest, event.t - start), None
    return longest if start is None else inf


def _indeterminate(path: Trajectory) -> str:
    """Why the motion is one of several, or may be."""
    if path.indeterminate_t is None:
        return ""
    if path.paradox_contact and not path.indeterminate_load:
        return paradox_text(path.paradox_contact, path.indeterminate_t)
    start = f"from t = {path.indeterminate_t:.6g} s the motion"
    if path.indeterminate_load:
        return f"{start} is not unique: {path.indeterminate_load} is at a jump from which it leads away"
    if not path.indeterminate_contact:
        return (
            f"contact forces with friction are not unique, and {start} may not be: beside a planar contact "
            "this is not tested; let fewer contacts stick, or springs share the load"
        )
    return (
        f"contact forces with friction are not unique, and {start} is not either: others that obey Coulomb's "
        f"law as well change the acceleration at {path.indeterminate_contact} by "
        f"{path.indeterminate_part:.2g} of that without forces; let fewer contacts share the load, or springs"
    )


LAW_NAMES = {"newton": "Newton's", "poisson": "Poisson's", "stronge": "Stronge's"}


def gain_text(instance: Mapping[str, Any], contact: str, t: float, gain: float) -> str:
    """Of an impact that gained energy, J, as Newton's and Poisson's laws may with friction; limits of joints
    follow Newton's."""
    pairs = {each["name"]: instance["pairs"][each["pair"]] for each in instance["contacts"]}
    law = LAW_NAMES[pairs.get(contact, {}).get("law", "newton")]
    return (
        f"an impact at t = {t:.6g} s made {gain:.2e} J at the contact {contact}: {law} restitution with "
        'friction does not exclude it; law = "stronge" does'
    )


def paradox_text(contact: str, t: float) -> str:
    """Of a contact at which Coulomb's law has two solutions."""
    return (
        f"from t = {t:.6g} s the motion is one of several: {contact} could as well slip on, pressed by its "
        "own friction, as part (Painleve)"
    )


def steps_in_time(path: Trajectory) -> bool:
    """Whether a run, or a part of it, was one of time-stepping."""
    return "time-stepping" in path.doubt_kinds
