"""Warnings about impacts, and about forces that rigid-body equations leave indeterminate."""

from __future__ import annotations

from modelgen.runtime.accuracy import Accuracy
from modelgen.runtime.core_session import Session

LAW_NAMES = {"newton": "Newton's", "poisson": "Poisson's", "stronge": "Stronge's"}


def impact_warnings(session: Session, accuracy: Accuracy) -> list[str]:
    """Warnings: energy gained in impacts, impact laws that were replaced, simultaneous impacts, Painleve's
    paradox."""
    return [*_gains(session, accuracy), *_laws(session), *_chains(session), *_paradox(session)]


def _law_of(session: Session, contact: str) -> str:
    """Of a contact of shapes, or of a limit of a joint, which follows Newton's law."""
    pairs = {each["name"]: session.instance["pairs"][each["pair"]] for each in session.instance["contacts"]}
    return str(pairs.get(contact, {}).get("law", "newton"))


def _gains(session: Session, accuracy: Accuracy) -> list[str]:
    """Warns of an impact that gained energy, as Newton's and Poisson's laws may with friction."""
    run = session.run
    if run.impact_gain_contact < 0 or float(run.impact_gain_max) <= accuracy.tolerance * float(
        run.kinetic_max
    ):
        return []
    contact = session.contacts[run.impact_gain_contact]
    return [
        f"an impact at t = {float(run.impact_gain_t):.6g} s made {float(run.impact_gain_max):.2e} J "
        f"at the contact {contact}: {LAW_NAMES[_law_of(session, contact)]} restitution with friction "
        "does not exclude it"
    ]


def _laws(session: Session) -> list[str]:
    """Warns that time-stepping replaced another law by Newton's."""
    others = [p["name"] for p in session.instance["pairs"] if p.get("law", "newton") != "newton"]
    if not others or not (session.accuracy.method == "time-stepping" or session.run.fallbacks):
        return []
    return [f"time-stepping follows Newton's law of impact; another is asked for at {', '.join(others)}"]


def _chains(session: Session) -> list[str]:
    run = session.run
    if run.chain_impact_contact < 0:
        return []
    return [
        f"an impact at t = {float(run.chain_impact_t):.6g} s reached "
        f"{session.contacts[run.chain_impact_contact]}, "
        'whose bodies touched at rest: all contacts were struck at once; impacts = "sequential" passes '
        "impacts on one by one, after which bodies may separate otherwise"
    ]


def _paradox(session: Session) -> list[str]:
    run = session.run
    if run.painleve_contact < 0:
        return []
    return [
        f"at t = {float(run.painleve_t):.6g} s the contact {session.contacts[run.painleve_contact]} could as "
        "well slip on, pressed by its own friction, as part (Painleve): the motion from there is one of "
        "several"
    ]
