"""Blows on one body so close in time that a run's error leaves open which comes first.

What follows differs by a finite amount: a cube that falls on an edge goes on otherwise when one corner of it
is struck first. Where run and companion differ in that, it shows; but both may err to the same side.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from typing import Any

from modelgen.runtime.trajectory import Event

BLOWS = ("impact", "touch-down")


def undecided_blows(
    mine: Sequence[Event],
    theirs: Sequence[Event],
    instance: Mapping[str, Any],
    safe: float,
    least: float,
    end: float,
) -> tuple[Event, Event] | None:
    """The first two blows of a run that come in the same order in its companion by no more than the error.

    Args:
        mine, theirs: the events of the run, and of its companion.
        instance: of the manifest.
        safe: the time between two blows errs by `safe` times what the companion has otherwise.
        least: m; blows that move less than this until `end`, s, are left aside.
    """
    own, struck = _blows(mine, end), _moving(instance)
    other = _numbered(_blows(theirs, end))
    for (a, key_a), (b, key_b) in pairwise((event, key) for key, event in _numbered(own).items()):
        if a.contact == b.contact or not struck[a.contact] & struck[b.contact]:
            continue
        if key_a not in other or key_b not in other or min(a.speed, b.speed) * (end - b.t) <= least:
            continue
        between, again = b.t - a.t, other[key_b].t - other[key_a].t
        if between > 0 and again > 0 and safe * abs(between - again) >= min(between, again):
            return a, b
    return None


def _blows(events: Sequence[Event], end: float) -> Iterator[Event]:
    return (event for event in events if event.kind in BLOWS and event.t <= end)


def _numbered(blows: Iterator[Event]) -> dict[tuple[str, int], Event]:
    """Blows in order, by their contact and which of its blows each is."""
    counts: dict[str, int] = defaultdict(int)
    numbered = {}
    for event in blows:
        numbered[event.contact, counts[event.contact]] = event
        counts[event.contact] += 1
    return numbered


def _moving(instance: Mapping[str, Any]) -> dict[str, set[int]]:
    """By contact, pair of bodies, or limit of a joint: its bodies that are not fixed nor driven."""
    free = {k for k, body in enumerate(instance["bodies"]) if body["motion"] in ("point", "free")}
    feature_pairs = [instance["feature_pairs"][pair["feature_pairs"][0]] for pair in instance["pairs"]]
    pairs = [free & {feature_pair["o"], feature_pair["f"]} for feature_pair in feature_pairs]
    return {
        **{contact["name"]: pairs[contact["pair"]] for contact in instance["contacts"]},
        **{pair["name"]: bodies for pair, bodies in zip(instance["pairs"], pairs, strict=True)},
        **{limit["name"]: free & {limit["o"], limit["f"]} for limit in instance["limits"]},
    }
