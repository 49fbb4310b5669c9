"""Impacts on one body so close in time that the error of the run leaves their order open.

What follows differs by a finite amount: a cube that falls on an edge goes on otherwise when one corner of it
is struck first. Contacts that are struck at once, as the supports of a ball on a ring, have no order, and the
next impact at one of them comes after those. Where run and companion differ in that, it shows; but both may
err to the same side.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any

from modelgen.runtime.event_matching import BLOWS, in_pairs
from modelgen.runtime.trajectory import Event


def undecided_impacts(
    mine: Sequence[Event],
    theirs: Sequence[Event],
    instance: Mapping[str, Any],
    safe: float,
    least: float,
    end: float,
) -> tuple[Event, Event] | None:
    """The first two impacts of a run whose times differ by no more than the error.

    Args:
        mine, theirs: the events of the run, and of its companion.
        instance: of the manifest.
        safe: the time between two impacts errs by `safe` times what the companion has otherwise.
        least: m; impacts that move less than this until `end`, s, are left aside.
    """
    struck = _moving(instance)
    before = [_blows_before(events) for events in (mine, theirs)]
    blows = [(a, b) for a, b in in_pairs(mine, theirs) if a.kind in BLOWS and a.t <= end]
    for (a, like_a), (b, like_b) in pairwise(blows):
        if a.contact == b.contact or not struck[a.contact] & struck[b.contact]:
            continue
        if min(a.speed, b.speed) * (end - b.t) <= least:
            continue
        if before[0].get(id(b)) == a.t and before[1].get(id(like_b)) == like_a.t:
            continue  # the contact of b was struck with that of a, and so b comes after a in any case
        between, again = b.t - a.t, like_b.t - like_a.t
        if between > 0 and again > 0 and safe * abs(between - again) >= min(between, again):
            return a, b
    return None


def _blows_before(events: Sequence[Event]) -> dict[int, float]:
    """s: of each blow by its id, the time of the one before at its contact, where there is one."""
    last: dict[str, float] = {}
    found = {}
    for event in events:
        if event.kind in BLOWS:
            if event.contact in last:
                found[id(event)] = last[event.contact]
            last[event.contact] = event.t
    return found


def _moving(instance: Mapping[str, Any]) -> dict[str, set[int]]:
    """For each contact and joint limit, its bodies that forces move."""
    free = {k for k, body in enumerate(instance["bodies"]) if body["motion"] in ("point", "free")}
    feature_pairs = [instance["feature_pairs"][pair["feature_pairs"][0]] for pair in instance["pairs"]]
    pairs = [free & {feature_pair["o"], feature_pair["f"]} for feature_pair in feature_pairs]
    return {
        **{contact["name"]: pairs[contact["pair"]] for contact in instance["contacts"]},
        **{pair["name"]: bodies for pair, bodies in zip(instance["pairs"], pairs, strict=True)},
        **{limit["name"]: free & {limit["o"], limit["f"]} for limit in instance["limits"]},
    }
