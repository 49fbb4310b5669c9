"""Which events of two runs of one scene are the same, in which modes they differ, and which impacts have no
order.

A bounce that settles ends by a few more or fewer blows where thresholds differ, and all that hangs on it
starts and stops as often: events of one run alone, although contacts are open, closed, slide and stick at
the same times. So events other than blows count by how long the modes that they change differ.

What follows two impacts on one body differs by a finite amount if they come in the other order: a cube that
falls on an edge goes on otherwise when one corner of it is struck first. Contacts that are struck at once,
as the supports of a ball on a ring, have no order, and the next impact at one of them comes after those.
Where run and companion differ in that, it shows; but both may err to the same side.
"""

from __future__ import annotations

import re
from bisect import bisect, bisect_left
from collections import defaultdict
from collections.abc import Collection, Iterator, Mapping, Sequence
from itertools import pairwise, takewhile
from typing import Any, NamedTuple

from modelgen.runtime.trajectory import FALLBACK_EVENTS, LOAD_SWITCH, SEARCH_EVENTS, Event

BLOWS = ("impact", "touch-down")  # the last blow of a bounce that settles is a touch-down
NO_MODES = (*SEARCH_EVENTS, *FALLBACK_EVENTS, "near-singular")
TOUCH = "touch"
FEATURE = "feature"
LOAD = LOAD_SWITCH.partition("-")[0]
NUMBER = "#"  # stands before the number of a contact, of pairs that have several
ONE_SPEED = 1e-2  # relative difference up to which blows of two runs may be the same
Subject = tuple[str, str]  # what an event is about, and the name of its contact
Pairs = Sequence[tuple[Event, Event]]
TOUCHES = {  # the modes before and after
    "impact": ("open", "open"),
    "lift-off": ("closed", "open"),
    "touch-down": ("open", "closed"),
    "face-contact": ("open", "face"),
    "tipping": ("face", "edge"),
}


class Change(NamedTuple):
    """A mode that begins, and the one that ends, where an event tells it; None: not known."""

    t: float  # s
    before: str | None
    after: str | None


class Stretch(NamedTuple):
    start: float  # s
    end: float  # s
    mode: str | None


def in_pairs(mine: Sequence[Event], theirs: Sequence[Event]) -> list[tuple[Event, Event]]:
    """The events of one run that another has too, with those, by time. Without NO_MODES, whose times are
    those of steps.

    As many events of a contact are the same in order. Of others, those are the same that have one speed, from
    the first and from the last on, then those that are the nearest to each other in turn.
    """
    found: list[tuple[Event, Event]] = []
    likes = _by_subject(theirs)
    for subject, events in _by_subject(mine).items():
        like = likes.get(subject, [])
        same = len(events) == len(like)
        found += zip(events, like, strict=True) if same else _pairs_of_unequal(events, like)
    return sorted(found, key=lambda pair: pair[0].t)


def alone(mine: Sequence[Event], theirs: Sequence[Event], pairs: Pairs) -> list[Event]:
    """The events that one of two runs has and the other has not. `pairs`: of `in_pairs`."""
    paired = {id(event) for pair in pairs for event in pair}
    return [event for event in (*mine, *theirs) if event.kind not in NO_MODES and id(event) not in paired]


def modes_apart(
    mine: Sequence[Event],
    theirs: Sequence[Event],
    instance: Mapping[str, Any],
    end: float,
    unloaded: Collection[str] = (),
) -> dict[Subject, float]:
    """s: for how long up to `end` two runs are in different modes, by what the modes are of. A blow that
    leaves its contact open changes no mode. `unloaded`: contacts that begin open unless an event tells
    otherwise."""
    resting = _contacts_by_patch(instance)
    changes = [_changes(run, resting, dict.fromkeys(unloaded, True)) for run in (mine, theirs)]
    apart = {}
    for subject in changes[0].keys() | changes[1].keys():
        first = "0" if subject[0] == LOAD else None
        both = (_stretches(run.get(subject, []), first, end) for run in changes)
        apart[subject] = _time_apart(*both)
    return apart


def undecided_impacts(
    pairs: Pairs,
    instance: Mapping[str, Any],
    safe: float,
    least: float,
    end: float,
) -> list[tuple[Event, Event]]:
    """Impacts of a run that follow each other at one body, in times that differ by no more than the error.

    Args:
        pairs: of `in_pairs`, of the run and its companion.
        instance: of the manifest.
        safe: the time between two impacts errs by `safe` times what the companion has otherwise.
        least: m; impacts that move less than this until `end`, s, are left aside.
    """
    struck, found = BodiesByContact(instance), []
    blows = [(a, b) for a, b in pairs if a.kind in BLOWS and a.t <= end]
    for (a, like_a), (b, like_b) in pairwise(blows):
        if a.contact == b.contact or not struck[a.contact] & struck[b.contact]:
            continue
        if min(a.speed, b.speed) * (end - b.t) <= least:
            continue
        if _is_after(b, a) and _is_after(like_b, like_a):
            continue  # its contact did not approach at the blow at a: b comes after it in any case
        between, again = b.t - a.t, like_b.t - like_a.t
        if between > 0 and again > 0 and safe * abs(between - again) >= min(between, again):
            found.append((a, b))
    return found


def undecided(first: Event, second: Event) -> str:
    """The doubt about the order of two impacts."""
    names = f"{first.contact} and {second.contact}"
    when = f"t = {second.t:.6g} s, {second.t - first.t:.2g} s apart"
    return f"which of the impacts at {names} ({when}) comes first is within the error"


def _is_after(second: Event, first: Event) -> bool:
    """Whether a blow comes after another one however their times err."""
    return second.after_t is not None and second.after_t >= first.t


def subject_of(event: Event) -> Subject:
    """What an event changes: touch, slip, spin, roll, the features that touch, or what it is by itself."""
    what = TOUCH if event.kind in TOUCHES else event.kind.split("-")[0]
    return what, event.contact


def name_of_blow(event: Event) -> str:
    """What a blow is known by in several runs. The contacts of a pair are numbered as they appear, and so one
    of several is known by its features."""
    pair, several, _ = event.contact.partition(NUMBER)
    return pair + NUMBER + event.features if several else pair


def _by_subject(events: Sequence[Event]) -> dict[Subject, list[Event]]:
    """Events by kind and contact, in order; all blows of a contact are of one kind."""
    found: dict[Subject, list[Event]] = defaultdict(list)
    for event in events:
        if event.kind in BLOWS:
            found["blow", name_of_blow(event)].append(event)
        elif event.kind not in NO_MODES:
            found[event.kind, event.contact].append(event)
    return found


def _pairs_of_unequal(mine: Sequence[Event], theirs: Sequence[Event]) -> list[tuple[Event, Event]]:
    first = _count_of_like(mine, theirs)
    last = _count_of_like(mine[first:][::-1], theirs[first:][::-1])
    ends = [len(run) - last for run in (mine, theirs)]
    return [
        *zip(mine[:first], theirs[:first], strict=True),
        *_nearest_pairs(mine[first : ends[0]], theirs[first : ends[1]]),
        *zip(mine[ends[0] :], theirs[ends[1] :], strict=True),
    ]


def _count_of_like(mine: Sequence[Event], theirs: Sequence[Event]) -> int:
    """How many blows from the first on have one speed in both."""
    like = (
        abs(a.speed - b.speed) <= ONE_SPEED * a.speed and a.speed > 0
        for a, b in zip(mine, theirs, strict=False)
    )
    return sum(1 for _ in takewhile(bool, like))


def _nearest_pairs(mine: Sequence[Event], theirs: Sequence[Event]) -> Iterator[tuple[Event, Event]]:
    times, likes = ([event.t for event in run] for run in (mine, theirs))
    for k, t in enumerate(times):
        like = _nearest(likes, t)
        if like is not None and _nearest(times, likes[like]) == k:
            yield mine[k], theirs[like]


def _nearest(times: Sequence[float], t: float) -> int | None:
    """The index of the one of increasing times that is nearest to t, of equals the first; None of none."""
    at = bisect(times, t)
    near = range(max(at - 1, 0), min(at + 1, len(times)))
    best = min(near, key=lambda k: abs(times[k] - t), default=None)
    return None if best is None else bisect_left(times, times[best])


def _contacts_by_patch(instance: Mapping[str, Any]) -> dict[str, list[str]]:
    """The contacts at points of the faces that rest, by the name that events have of the faces."""
    by_pair: dict[int, list[str]] = defaultdict(list)
    for contact in instance["contacts"]:
        by_pair[contact["pair"]].append(contact["name"])
    found: dict[str, list[str]] = {}
    for patch in instance["patches"]:
        pairs = {patch["pair"], *(instance["feature_pairs"][k]["pair"] for k in patch["feature_pairs"])}
        found[patch["name"].rpartition(":")[0]] = [name for pair in sorted(pairs) for name in by_pair[pair]]
    return found


def _changes(
    events: Sequence[Event], resting: Mapping[str, Sequence[str]], unloaded: Mapping[str, bool]
) -> dict[Subject, list[Change]]:
    """The modes of each subject by time. Where a contact opens or closes, other modes of it begin that are
    not known; a face that rests takes the place of the contacts at its points, and ends where one of these
    opens. Features change no motion while their contact is open."""
    found: dict[Subject, list[Change]] = defaultdict(list)
    begun: dict[str, float] = {}  # s, when other modes of a contact began
    is_open = {**unloaded, **_open_at_start(events)}
    for event in events:
        if event.kind in SEARCH_EVENTS:
            is_open[event.contact] = True  # it appears or vanishes
        if event.kind in NO_MODES:
            continue
        own, (before, after) = subject_of(event), _modes(event, found)
        if own[0] == TOUCH:
            is_open[event.contact] = after == "open"
        elif own[0] == FEATURE and is_open.get(event.contact):
            continue
        if own not in found and own[0] != TOUCH and event.contact in begun:
            found[own].append(Change(begun[event.contact], None, None))
        names = [event.contact, *(resting.get(event.contact, ()) if after == "face" else ())]
        if after == "open":
            names += [face for face, points in resting.items() if event.contact in points]
        for name in names if own[0] == TOUCH else ():
            begun[name] = event.t
            for subject, changes in found.items():
                if subject[1] == name and subject != (TOUCH, event.contact):
                    changes.append(Change(event.t, None, None))
        found[own].append(Change(event.t, before, after))
    return found


def _open_at_start(events: Sequence[Event]) -> dict[str, bool]:
    """Whether contacts begin open, of those of which the first event that tells it does."""
    first: dict[str, bool] = {}
    for event in events:
        if event.kind in TOUCHES:
            first.setdefault(event.contact, TOUCHES[event.kind][0] == "open")
    return first


def _modes(event: Event, known: Mapping[Subject, Sequence[Change]]) -> tuple[str, str]:
    """The modes before and after an event."""
    if event.kind in TOUCHES:
        return TOUCHES[event.kind]
    if event.kind == LOAD_SWITCH:
        odd = len(known.get(subject_of(event), ())) % 2
        return str(odd), str(1 - odd)
    what, _, how = event.kind.partition("-")
    if how == "start":
        return "stop", "start"
    if how in ("stop", "end", "reversal"):
        return "start", "start" if how == "reversal" else "stop"
    return f"before {what}", event.features or what


def _stretches(changes: Sequence[Change], first: str | None, end: float) -> list[Stretch]:
    """The stretches of one mode up to `end`, of which the first has the mode `first`, if it is known. Where
    neither the event before a stretch nor that after it tells the mode, it is None."""
    found, t, mode = [], 0.0, first
    for change in changes:
        if change.t >= end:
            break
        found.append(Stretch(t, change.t, change.before if mode is None else mode))
        t, mode = change.t, change.after
    return [*found, Stretch(t, end, mode)]


def _time_apart(mine: Sequence[Stretch], theirs: Sequence[Stretch]) -> float:
    """s: for how long two runs are in different modes. A mode that is not known is taken for that in which
    the other run is the longest meanwhile: where it is another one, the motions differ."""
    apart = 0.0
    for run, other in ((mine, theirs), (theirs, mine)):
        for stretch in run:
            spent: dict[str | None, float] = defaultdict(float)
            for like in other[bisect(other, stretch.start, key=lambda each: each.end) :]:
                if like.start >= stretch.end:
                    break
                spent[like.mode] += min(stretch.end, like.end) - max(stretch.start, like.start)
            spent.pop(None, None)
            same = max(spent.values(), default=0.0) if stretch.mode is None else spent[stretch.mode]
            once = 1.0 if stretch.mode is None else 0.5  # two known modes are compared from both sides
            apart += once * (sum(spent.values()) - same)
    return apart


class BodiesByContact(Mapping[str, set[int]]):
    """For each contact, pair and joint limit, its bodies that forces move; also for those of pools, whose
    names are made of those of the bodies."""

    def __init__(self, instance: Mapping[str, Any]) -> None:
        free = {k for k, body in enumerate(instance["bodies"]) if body["motion"] in ("point", "free")}
        feature_pairs = [instance["feature_pairs"][pair["feature_pairs"][0]] for pair in instance["pairs"]]
        pairs = [free & {feature_pair["o"], feature_pair["f"]} for feature_pair in feature_pairs]
        self._known: dict[str, set[int]] = {
            **{contact["name"]: pairs[contact["pair"]] for contact in instance["contacts"]},
            **{pair["name"]: bodies for pair, bodies in zip(instance["pairs"], pairs, strict=True)},
            **{limit["name"]: free & {limit["o"], limit["f"]} for limit in instance["limits"]},
        }
        members = {body for each in instance.get("classes", ()) for body, _ in each}
        self._members = {instance["bodies"][body]["name"]: body for body in members}

    def __getitem__(self, name: str) -> set[int]:
        if name not in self._known:
            pair, *_ = re.split("[#:]", name, maxsplit=1)
            self._known[name] = {self._members[each] for each in pair.split("-")}
        return self._known[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._known)

    def __len__(self) -> int:
        return len(self._known)
