"""Impacts on one body so close in time that the error of the run leaves their order open.

What follows differs by a finite amount: a cube that falls on an edge goes on otherwise when one corner of it
is struck first. Contacts that are struck at once, as the supports of a ball on a ring, have no order, and the
next impact at one of them comes after those. Where run and companion differ in that, it shows; but both may
err to the same side.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from typing import Any

from modelgen.runtime.trajectory import Event

IMPACTS = ("impact", "touch-down")
Key = tuple[str, int]  # the contact, and the number of the impact there


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
    numbered, other = (_numbered(_impacts(events, end)) for events in (mine, theirs))
    for (a, key_a), (b, key_b) in pairwise((event, key) for key, event in numbered.items()):
        if not struck[a.contact] & struck[b.contact]:
            continue
        if key_a not in other or key_b not in other or min(a.speed, b.speed) * (end - b.t) <= least:
            continue
        if all(_is_after(key_b, key_a, impacts) for impacts in (numbered, other)):
            continue
        between, again = b.t - a.t, other[key_b].t - other[key_a].t
        if between > 0 and again > 0 and safe * abs(between - again) >= min(between, again):
            return a, b
    return None


def _impacts(events: Sequence[Event], end: float) -> Iterator[Event]:
    return (event for event in events if event.kind in IMPACTS and event.t <= end)


def _numbered(impacts: Iterator[Event]) -> dict[Key, Event]:
    """The impacts in order, keyed by contact and number of the impact at that contact."""
    counts: dict[str, int] = defaultdict(int)
    numbered = {}
    for event in impacts:
        numbered[event.contact, counts[event.contact]] = event
        counts[event.contact] += 1
    return numbered


def _is_after(key: Key, first: Key, impacts: Mapping[Key, Event]) -> bool:
    """Whether an impact follows one at its own contact that was at the time of the `first`, so that it comes
    after that in any case."""
    before = impacts.get((key[0], key[1] - 1))
    return before is not None and before.t == impacts[first].t


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
