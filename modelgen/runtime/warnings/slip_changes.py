"""Contacts that change between sticking and slipping again and again, each change of which ends a step."""

from __future__ import annotations

from collections.abc import Sequence

from modelgen.runtime.trajectory import Event

CHANGES = ("slip-start", "slip-stop")
TOLD = 3  # contacts
MANY = 20  # changes of one contact in a characteristic time, above which a run says so


def slip_change_warnings(events: Sequence[Event], period: float) -> list[str]:
    """A warning of each contact that changed more than MANY times in a characteristic time `period`, s, at
    most TOLD: of those that changed most often, with the number of the others."""
    times: dict[str, list[float]] = {}
    for event in events:
        if event.kind in CHANGES:
            times.setdefault(event.contact, []).append(event.t)
    found: list[tuple[str, int, float]] = []  # contact, changes, when they began to be dense
    for contact, at in times.items():
        dense = [t for t, later in zip(at, at[MANY:], strict=False) if later - t < period]
        if dense:
            found.append((contact, len(at), dense[0]))
    most = sorted(found, key=lambda each: -each[1])[:TOLD]
    others = f"; {len(found) - TOLD} other contacts as well" if len(found) > TOLD else ""
    return [
        f"{contact} changed between sticking and slipping {count} times, from t = {begun:.4g} s "
        f"on more than {MANY} times in a characteristic time of {period:.3g} s, as where friction or "
        "rolling resistance stops a slow motion again and again: each change ends a step and is "
        f'located, at any accuracy; method = "time-stepping" bounds the number of steps{others}'
        for contact, count, begun in most
    ]
