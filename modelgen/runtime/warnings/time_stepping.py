"""Warnings about time-stepping, and advice on its step."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from modelgen.runtime.accuracy import Accuracy
from modelgen.runtime.core_session import Session
from modelgen.runtime.trajectory import OUTCOME_OF_CODE, Outcome

CAUSES = {
    Outcome.COMPLEMENTARITY: "no contact forces keep the bodies apart",
    Outcome.NO_FRICTION: "no contact forces obey Coulomb's law: inconsistent (Painleve), or jammed",
    Outcome.TOO_MANY_EVENTS: "events accumulate at one time",
    Outcome.STEP_TOO_SMALL: "its steps shrink without getting on",
    Outcome.PENETRATED: "a contact was found too late, when bodies penetrated there",
    Outcome.MARGIN: "a contact came too near to a singularity of its closest points",
}


APPROXIMATE = {
    "polyhedral": "friction acts in cones of eight sides (solver polyhedral): weaker by up to 8 %, and "
    "turned by up to pi/8, which no estimate of the error tells",
    "relaxation": "contacts that slip at v separate at mu v (solver relaxation), which no estimate of the "
    "error tells",
}

SLOW = 1.0  # step times rate up to which the motion of springs and dampers is right to a tenth
TURN = 0.3  # rad in a step up to which a turn is right to a hundredth


def stepping_warnings(session: Session) -> list[str]:
    """Warnings: falls back on time-stepping, and steps in which the exact friction law was replaced."""
    report, found = session.run.report, []
    if report.fallbacks:
        more = f" ({report.fallbacks} times in all)" if report.fallbacks > 1 else ""
        found.append(
            f"at t = {float(report.fallback_first):.6g} s the event-driven run could not go on: "
            f"{CAUSES[OUTCOME_OF_CODE[report.fallback_cause]]}; it went on by time-stepping{more}, for "
            f"{float(report.fallback_time):.3g} s, which is of order 1: fallback = false forbids that"
        )
    if report.chatters:
        more = f" ({report.chatters} times in all)" if report.chatters > 1 else ""
        step = fallback_step(report, session.accuracy, session.instance)
        found.append(
            f"from t = {float(report.chatter_first):.6g} s on contacts closed and opened so often that their "
            f"events cost several times what time-stepping does; the run went on by it{more}, for "
            f"{float(report.chatter_time):.3g} s in steps of {step:.2g} s: its error is of order 1 in the "
            "step, and events are told to one step; fallback = false locates every event"
        )
    if report.outer_solves + report.relaxed_solves and session.accuracy.solver in APPROXIMATE:
        found.append(APPROXIMATE[session.accuracy.solver])
    if report.loose_solutions:
        found.append(
            f"in {report.loose_solutions} steps the impulses were found to a residual of up to "
            f"{float(report.lcp_residual_max):.1e} only: so much of the largest velocity may be wrong in them"
        )
    if report.relaxed_solutions:
        found.append(
            f"in {report.relaxed_solutions} steps no solution of Coulomb's law was found and its convex "
            "relaxation was taken, with which sliding contacts move off"
        )
    return [*found, *_advice(session)]


def fallback_step(report: Any, accuracy: Accuracy, instance: Mapping[str, Any]) -> float:
    """s: the longest step of time-stepping by which an event-driven mg_run went on; 0 where it did not."""
    steps = accuracy.thresholds
    parts = (steps.chatter_step * (report.chatters > 0), steps.fallback_step * (report.fallbacks > 0))
    return float(max(parts) * instance["scales"]["time"])


def _advice(session: Session) -> Iterator[str]:
    """Advice on a step that is long for springs, dampers and spins, from the steps that were taken."""
    report, bodies = session.run.report, session.instance["bodies"]
    step, rate, spin = (
        float(session.settings.step),
        float(report.spring_rate_max),
        float(report.spin_max),
    )
    if session.accuracy.method != "time-stepping":
        return
    if step * rate > SLOW:
        load = session.instance["loads"][report.spring_rate_load]
        between = " and ".join(bodies[body]["name"] for body in load["bodies"])
        yield (
            f"the step is {step * rate:.2g} times as long as the time of the fastest spring or damper, "
            f"1/{rate:.2g} s, between {between} (rate c a + sqrt(k a), a = J M^-1 J^T of its two bodies "
            f"alone): its motion is damped or slowed, not followed; a step below {SLOW / rate:.1g} s "
            "follows it"
        )
    if step * spin > TURN:
        yield (
            f"{bodies[report.spin_body]['name']} turns by up to {step * spin:.2g} rad in a step (largest "
            f"angular speed at the starts of steps); a step below {TURN / spin:.1g} s follows its spin"
        )
