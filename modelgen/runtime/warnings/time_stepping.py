"""Warnings about time-stepping."""

from __future__ import annotations

from modelgen.runtime.session import Session
from modelgen.runtime.trajectory import OUTCOME_OF_CODE, Outcome

CAUSES = {
    Outcome.COMPLEMENTARITY: "no contact forces keep the bodies apart",
    Outcome.NO_FRICTION: "no contact forces obey Coulomb's law: inconsistent (Painleve), or jammed",
    Outcome.TOO_MANY_EVENTS: "events accumulate at one time",
    Outcome.STEP_TOO_SMALL: "its steps shrink without getting on",
}


def stepping_warnings(session: Session) -> list[str]:
    """Warnings: falls back on time-stepping, and steps in which the exact friction law was replaced."""
    run, found = session.run, []
    if run.fallbacks:
        more = f" ({run.fallbacks} times in all)" if run.fallbacks > 1 else ""
        found.append(
            f"at t = {float(run.fallback_first):.6g} s the event-driven run could not go on: "
            f"{CAUSES[OUTCOME_OF_CODE[run.fallback_cause]]}; it went on by time-stepping{more}, for "
            f"{float(run.fallback_time):.3g} s, which is of order 1: fallback = false forbids that"
        )
    if run.loose_solutions:
        found.append(
            f"in {run.loose_solutions} steps the impulses were found to a residual of up to "
            f"{float(run.lcp_residual_max):.1e} only: so much of the largest velocity may be wrong in them"
        )
    if run.relaxed_solutions:
        found.append(
            f"in {run.relaxed_solutions} steps no solution of Coulomb's law was found and its convex "
            "relaxation was taken, with which sliding contacts move off"
        )
    return found
