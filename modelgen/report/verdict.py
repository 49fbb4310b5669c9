"""The verdict on a run, as every output states it: from the facts of `simulate --json`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any


def verdict_line(summary: Mapping[str, Any]) -> str:
    """`trusted`, or `not trusted` with all reasons, and that the error was not estimated where it was not."""
    doubts, unknown = summary["doubts"], "" if summary["estimate"] else "; its error was not estimated"
    return (f"not trusted: {'; '.join(doubts)}" if doubts else "trusted") + unknown


def verdict_title(summary: Mapping[str, Any]) -> str:
    """For a heading: `not trusted` without an error, or `trusted` with it where it was estimated."""
    if summary["doubts"]:
        return "not trusted"
    estimate = summary["estimate"]
    return f"trusted, error {estimate['position']:.1g} m" if estimate else "trusted, error not estimated"


def horizon_of(summary: Mapping[str, Any]) -> float | None:
    """The time beyond which nothing is predicted, s; None where all is, or nothing is estimated."""
    estimate = summary["estimate"]
    return estimate["horizon"] if estimate else None
