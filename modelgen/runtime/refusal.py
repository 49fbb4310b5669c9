"""Why a start is refused: the core's codes as errors."""

from __future__ import annotations

from typing import TYPE_CHECKING

from modelgen.errors import SimulationError

if TYPE_CHECKING:
    from modelgen.runtime.session import Session

PENETRATION, NO_EXTREMUM, NO_SIDE = 10, 11, 12
REFUSED = (PENETRATION, NO_EXTREMUM, NO_SIDE)


def refusal(session: Session, code: int, contact: int, run: str = "") -> SimulationError:
    """The error of a code at the session's state; `run` says which of several runs it is."""
    where = f"{run}contact {session.contacts[contact]!r}"
    if code == NO_EXTREMUM:
        return SimulationError(
            where,
            "no pair of closest points was found at the start",
            "surfaces with one nearest pair there",
            "start the bodies nearer to each other or away from a symmetric position",
        )
    if code == NO_SIDE:
        return SimulationError(
            where,
            "two curves touch at the start, which has no side of its own",
            "a gap, or a contact that says on which side the second curve lies",
            "give the contact a normal, from the first curve to the second",
        )
    d = session.settle(contact)["d"]
    allowed = session.settings.start_gap * session.system.length
    return SimulationError(
        where,
        f"the bodies interpenetrate at the start by {-float(d):.3g} m",
        f"at most {float(allowed):.3g} m",
        "move them apart",
    )
