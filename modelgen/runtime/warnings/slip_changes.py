"""Contacts that change between sticking and slipping again and again, each change of which ends a step."""

from __future__ import annotations

from collections.abc import Sequence

from modelgen.runtime.trajectory import Event

CHANGES = ("slip-start", "slip-stop")
MANY = 20  # changes of one contact in a characteristic time, above which a run says so


def slip_change_warnings(events: Sequence[Event], period: float) -> list[str]:
    """One warning for each contact that changed more than MANY times in a characteristic time `period`, s."""
    times: dict[str, list[float]] = {}
    for event in events:
        if event.kind in CHANGES:
            times.setdefault(event.contact, []).append(event.t)
    told = []
    for contact, at in times.items():
        dense = [t for t, later in zip(at, at[MANY:], strict=False) if later - t < period]
        if dense:
            told.append(
                f"{contact} changed between sticking and slipping {len(at)} times, from t = {dense[0]:.4g} s "
                f"on more than {MANY} times in a characteristic time of {period:.3g} s, as where friction or "
                "rolling resistance stops a slow motion again and again: each change ends a step and is "
                'located, at any accuracy; method = "time-stepping" bounds the number of steps'
            )
    return told
