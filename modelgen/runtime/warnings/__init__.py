"""Warnings about a valid scene or a finished run: indeterminate forces, order of impacts, and the like."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from modelgen.runtime.accuracy import Accuracy
from modelgen.runtime.core_session import Session
from modelgen.runtime.joint_results import joint_warnings
from modelgen.runtime.trajectory import Event
from modelgen.runtime.warnings.impacts import impact_warnings
from modelgen.runtime.warnings.slip_changes import slip_change_warnings
from modelgen.runtime.warnings.time_stepping import stepping_warnings

POINTS_MAX = 64  # contacts that a pair can have

STEPS_OF_A_PERIOD = 5000  # tried in a characteristic time, on average, above which a run says so
TURN = 0.1  # rad in a step, on average, above which the turning explains its length


def hints(bodies: Sequence[Mapping[str, Any]], touching: Sequence[Any]) -> tuple[str, ...]:
    """Advice for a scene without contacts and joints, and for one in which no body can move."""
    moving = [body["name"] for body in bodies if body["motion"] in ("point", "free")]
    if all(body["motion"] == "fixed" for body in bodies):
        return (
            'nothing moves: every body is fixed; one without motion = "fixed" and with a mass or a density '
            "is moved by forces",
        )
    if touching or not moving or len(bodies) < 2:
        return ()
    partner = next(body["name"] for body in bodies if body["name"] != moving[0])
    return (
        "no contact is listed, so all bodies pass through each other; "
        f'two that may touch: [[contact]] with between = ["{moving[0]}", "{partner}"]',
    )


def warnings(session: Session, accuracy: Accuracy, events: Sequence[Event]) -> tuple[str, ...]:
    """The warnings about a run with these events, and its scene."""
    report = session.run.report
    margin, redundant = float(report.margin_min), int(report.redundant_max)
    found = [
        *session.instance["warnings"],
        *hints(session.instance["bodies"], [*session.instance["contacts"], *session.joints]),
    ]
    bound = accuracy.thresholds.margin_warn
    if margin < bound:
        found.append(
            f"the margin of a closed contact fell to {margin:.1e}, below {bound:g}: "
            "its contact points lose about as many digits as the margin has zeros"
        )
    if report.singular_passages:
        found.append(
            f"closed contacts, first {session.contacts[report.passage_contact]}, passed "
            f"{int(report.singular_passages)} times where curvature vanishes or points of a pair become "
            "one: forces there are peaks whose impulses count, but that samples do not show"
        )
    if (patch := int(report.overlapping_patch)) >= 0 and _is_share_measured(session, patch):
        found.append(
            f"the faces of several pairs in the planar contact {session.shared.patch_names[patch]} overlap: "
            "the force of each pair is not unique, and its share is given in proportion to what presses on "
            "its faces; their sum is right"
        )
    if redundant:
        found.append(_redundancy(redundant, bool(session.system.n_friction)))
    if report.shared_switch >= 0:
        found.append(_shared(session))
    if report.unfollowed_minima:
        found.append(_unfollowed(session))
    if report.incomplete_searches:
        found.append(_incomplete(session))
    found += _capacities(session)
    found += _far(session, accuracy)
    found += _short_steps(session, accuracy)
    if accuracy.method != "time-stepping":  # whose steps no change ends
        found += slip_change_warnings(events, session.instance["scales"]["time"])
    found += impact_warnings(session, accuracy)
    found += stepping_warnings(session)
    return (*found, *joint_warnings(session, accuracy))


def _is_share_measured(session: Session, patch: int) -> bool:
    """Whether a sensor measures a pair of a patch of several."""
    shares = session.instance["patches"][patch]["shares"]
    return bool({share[0] for share in shares} & set(session.instance["sensors"].get("pairs", ())))


def _redundancy(redundant: int, has_friction: bool) -> str:
    if has_friction:
        return (
            f"contact forces are not unique: there were up to {redundant} more than independent rows; while "
            "all contacts hold the motion is unique, and forces within their bounds are given"
        )
    return (
        f"contact forces are not unique: {redundant} more contacts carried force than have independent "
        "rows; the motion is unique, the forces given are those of least weighted norm"
    )


def _shared(session: Session) -> str:
    """Warns that a load at a jump and contacts or joints hold the same motion."""
    load = session.switching_loads[session.run.report.shared_switch]
    return (
        f"forces are not unique: {load} rests at its jump, and contacts or joints hold it there too; the "
        "motion is the same however they share what they hold, of which the forces given are one way"
    )


def _unfollowed(session: Session) -> str:
    """Warns that a pair has more closest points within reach than contacts."""
    report = session.run.report
    slots = session.shared.slots
    first, end = session.instance["pairs"][slots.pattern_of(report.unfollowed_pair)]["contacts"]
    count = end - first
    is_shared = session.instance["contacts"][first]["feature_pair"] < 0
    remedy = f"; points = {min(2 * count, POINTS_MAX)} in its [[contact]] follows more" if is_shared else ""
    return (
        f"{slots.pair_name(report.unfollowed_pair)} has more closest points within reach than its contacts "
        f"can follow ({count}), first at t = {float(report.unfollowed_t):.6g} s: it may penetrate "
        f"there{remedy}"
    )


def _incomplete(session: Session) -> str:
    """Warns that a search for closest points was given up."""
    report = session.run.report
    name = session.shared.slots.pair_name(report.incomplete_pair)
    return (
        f"{name}: a search for closest points was given up before all were found, first at "
        f"t = {float(report.incomplete_t):.6g} s, as where surfaces conform or a chart is singular: a "
        "contact may be missed there; a small change of the shapes or the start removes a perfect fit"
    )


def _short_steps(session: Session, accuracy: Accuracy) -> list[str]:
    """Warns if adaptive steps were far shorter than the motion is long, with what that costs."""
    tried, span = int(session.run.steps + session.run.rejected), float(session.run.t)
    period = session.instance["scales"]["time"]
    if accuracy.method != "dop853" or tried * period <= STEPS_OF_A_PERIOD * max(span, period):
        return []
    name, spin = _fastest(session)
    cause = (
        f"because {name} turns at {spin:.4g} rad/s, with {2 * np.pi * tried / (spin * span):.2g} of them "
        "in a turn; a looser accuracy takes fewer"
        if spin * span > TURN * tried
        else "as where a rim rocks almost flat without friction and its contact point runs round; "
        'method = "time-stepping" bounds their number'
    )
    return [
        f"steps were short: {tried} were tried in {span:.4g} s, {tried * period / span:.0f} in a "
        f"characteristic time of {period:.3g} s, {cause}"
    ]


def _fastest(session: Session) -> tuple[str, float]:
    """The free body that turns fastest at the end, and its angular velocity in rad/s."""
    bodies, n_q = session.instance["bodies"], session.instance["n_q"]
    spins = [
        (float(np.linalg.norm(session.x[n_q + body["u"] + 3 : n_q + body["u"] + 6])), body["name"])
        for body in bodies
        if body["motion"] == "free"
    ]
    spin, name = max(spins, default=(0.0, ""))
    return name, spin


def _far(session: Session, accuracy: Accuracy) -> list[str]:
    """Warns if bodies are so far from the origin that rounding of positions exceeds the contact gap."""
    bodies = [body for body in session.instance["bodies"] if body["motion"] in ("point", "free")]
    starts = (session.instance["initial_q"], session.x)
    far = max((abs(float(q[b["q"] + k])) for q in starts for b in bodies for k in range(3)), default=0.0)
    length = session.instance["scales"]["length"]
    known = far * float(np.finfo(session.tables.dtype).eps) / length
    if not known > float(session.settings.contact_gap):
        return []
    return [
        f"bodies are {far:.1e} m from the origin, where positions are rounded to {known:.1e} of the "
        f"characteristic length {length:.3g} m: put the origin near them"
    ]


def _capacities(session: Session) -> list[str]:
    if not any(session.run.report.exceeded):
        return []
    from modelgen.runtime.warnings.capacities import capacity_warnings  # few runs need it

    return capacity_warnings(session)
