"""The function of time that made a run non-finite, as the scene names it."""

from __future__ import annotations

from modelgen.runtime.core_session import Session
from modelgen.runtime.trajectory import Outcome


def unbounded(session: Session, outcome: Outcome) -> str:
    """`torque[0] on 'cart'`, `path of 'table'` or `motion of joint 'crank'`; empty where the outcome is
    another, or not for a function of time."""
    at = session.unbounded() if outcome is Outcome.NOT_FINITE else -1
    if at < 0:
        return ""
    loads, bodies = session.instance["loads"], session.instance["bodies"]
    if at < len(loads):
        return _load(session, at)
    at -= len(loads)
    if at < len(bodies):
        return f"path of {bodies[at]['name']!r}"
    return f"motion of joint {session.joints[at - len(bodies)]!r}"


def _load(session: Session, at: int) -> str:
    instance, kinds = session.instance, session.library.manifest.kinds["load"]
    named = [kinds[load["kind"]]["kind"] for load in instance["loads"]]
    kind = named[at].replace("_", " ")
    bodies = " and ".join(repr(instance["bodies"][body]["name"]) for body in instance["loads"][at]["bodies"])
    # loads that nobody observes may be left out, and the springs of joints are no loads of the scene
    counted = not instance["observe"] and kind != "joint spring"
    index = f"[{named[:at].count(named[at])}]" if counted else ""
    return f"{kind}{index} on {bodies}"
