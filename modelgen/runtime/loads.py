"""The load for which a run is not finite, as the scene writes it."""

from __future__ import annotations

from modelgen.runtime.session import Session
from modelgen.runtime.trajectory import Outcome


def load_of(session: Session, outcome: Outcome) -> str:
    """`torque[0] on 'cart'`; empty where the outcome is another, or not for a load."""
    at = session.odd_load() if outcome is Outcome.NOT_FINITE else -1
    if at < 0:
        return ""
    sentence, kinds = session.sentence, session.library.manifest.kinds["load"]
    named = [kinds[load["kind"]]["kind"] for load in sentence["loads"]]
    kind = named[at].replace("_", " ")
    bodies = " and ".join(repr(sentence["bodies"][body]["name"]) for body in sentence["loads"][at]["bodies"])
    # loads that nobody observes may be left out, and the springs of joints are no loads of the scene
    counted = not sentence["observe"] and kind != "joint spring"
    index = f"[{named[:at].count(named[at])}]" if counted else ""
    return f"{kind}{index} on {bodies}"
