"""Warnings about impacts, and about forces that rigid-body equations leave indeterminate."""

from __future__ import annotations

from modelgen.runtime.accuracy import Accuracy
from modelgen.runtime.core_session import Session
from modelgen.runtime.trust import gain_text, paradox_text


def impact_warnings(session: Session, accuracy: Accuracy) -> list[str]:
    """Warnings: energy gained in impacts, impact laws that were replaced, simultaneous impacts, Painleve's
    paradox."""
    return [*_gains(session, accuracy), *_laws(session), *_chains(session), *_paradox(session)]


def _gains(session: Session, accuracy: Accuracy) -> list[str]:
    report = session.run.report
    if report.impact_gain_contact < 0 or float(report.impact_gain_max) <= accuracy.tolerance * float(
        report.kinetic_max
    ):
        return []
    contact = session.contacts[report.impact_gain_contact]
    return [gain_text(session.instance, contact, float(report.impact_gain_t), float(report.impact_gain_max))]


def _laws(session: Session) -> list[str]:
    """Warns that time-stepping replaced another law by Newton's."""
    others = [p["name"] for p in session.instance["pairs"] if p.get("law", "newton") != "newton"]
    if not others or not (session.accuracy.method == "time-stepping" or session.run.report.fallbacks):
        return []
    return [f"time-stepping follows Newton's law of impact; another is asked for at {', '.join(others)}"]


def _chains(session: Session) -> list[str]:
    report = session.run.report
    if report.chain_impact_contact < 0:
        return []
    return [
        f"an impact at t = {float(report.chain_impact_t):.6g} s reached "
        f"{session.contacts[report.chain_impact_contact]}, "
        'whose bodies touched at rest: all contacts were struck at once; impacts = "sequential" passes '
        "impacts on one by one, after which bodies may separate otherwise"
    ]


def _paradox(session: Session) -> list[str]:
    report = session.run.report
    if report.painleve_contact < 0:
        return []
    return [paradox_text(session.contacts[report.painleve_contact], float(report.painleve_t))]
