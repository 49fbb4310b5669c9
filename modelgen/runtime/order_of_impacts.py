"""Which of the impacts that follow each other within the error of a run have an order that a third run tells,
and where the other order leads.

The time between two impacts in a run and that in its companion may differ as much as they are, because
bounces end sooner in the run, at its threshold of rest. A companion of the companion then shows whether the
time between them has settled. Where it has not, the run is made once more with the two impacts in the other
order: from just before them, where the bodies that they strike are moved by as much as one of them is late.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import islice
from typing import Any

import numpy as np

from modelgen.runtime.core_session import CONTINUE, FULL, Session
from modelgen.runtime.event_matching import BodiesByContact, Pairs, in_pairs, name_of_blow, undecided
from modelgen.runtime.run_distance import APART, apart_of
from modelgen.runtime.tables.ctypes_structures import Array
from modelgen.runtime.trajectory import Event, Trajectory

Tie = tuple[Event, Event]
Finer = Callable[[float], Trajectory | None]  # the companion's companion up to a time, s; None: not to be had
Place = tuple[str, int]  # what a blow is known by, and its number among those
Change = tuple[float, Array]  # s, when a run is changed, and by what its coordinates q are
OtherOrder = Callable[[Tie], Trajectory | None]  # the run with two impacts in the other order, or None
MOST = 3  # ties of a run that are looked at
LEAD = 4.0  # times the time between two impacts: how long before them the run is changed
SPAN = 4  # least moves by which the order is tried to be reversed, and of `LEAD` how long both are looked for
STEPS = 200  # of a trial
PART = 1e-2  # of the move by which one impact is late: by what the gradient is taken
SAME = 1e-2  # relative; a run that is made again has the time between two impacts so nearly


def ties_left(common: Pairs, twin: Trajectory, ties: Sequence[Tie], finer: Finer, safe: float) -> list[Tie]:
    """The impacts of which a third run does not tell the order either.

    Args:
        common: the events that the run and its companion have, of `in_pairs`.
        twin: the companion.
        ties: impacts of the run, which both have in the same order.
        finer: makes the third run.
        safe: the time between two impacts errs by `safe` times what the third run has otherwise.
    """
    third = finer(ties[-1][1].t)
    if third is None:
        return list(ties)
    likes = {id(event): like for event, like in common}
    finest = {id(event): like for event, like in in_pairs(twin.events, third.events)}

    def is_open(tie: Tie) -> bool:
        of_twin = [likes.get(id(event)) for event in tie]
        of_third = [finest.get(id(event)) for event in of_twin]
        times = [event.t for event in (*of_twin, *of_third) if event is not None]
        if len(times) < 4:
            return True
        between, again = times[1] - times[0], times[3] - times[2]
        return safe * abs(between - again) >= min(between, again)

    return [tie for tie in ties if is_open(tie)]


def led_elsewhere(
    path: Trajectory,
    ties: Sequence[Tie],
    errors: Array,
    other_order: OtherOrder,
    instance: Mapping[str, Any],
    may: float,
) -> tuple[list[str], Array]:
    """The doubt about the first of some ties of a run of which both orders do not lead to the same motion, if
    there is one, and how far the others lead from the run.

    Args:
        path: the run.
        errors: its stated errors in each of APART at those samples up to which it predicts, (4, n).
        other_order: makes the run with the other order.
        instance: of the manifest.
        may: rad, or in L: motions nearer than that to the run are as good.

    Returns:
        One doubt in words or none, and an array (4, n).
    """
    n, least = errors.shape[1], may * np.array([[instance["scales"]["length"]], [1.0]])
    found = np.zeros((len(APART), n))
    for tie in ties[:MOST]:
        other = other_order(tie)
        if other is None or len(other.t) < n or not np.array_equal(other.t[:n], path.t[:n]):
            return [undecided(*tie)], found
        apart = apart_of(path, other, n, instance)[: len(APART)]
        if np.all(apart[:2] <= np.maximum(errors[:2], least)):
            found = np.maximum(found, apart)
            continue
        where = f"{apart[0].max():.2g} m and {apart[1].max():.2g} rad elsewhere"
        return [f"{undecided(*tie)}; in the other order bodies come {where}"], found
    return [undecided(*ties[MOST])] if len(ties) > MOST else [], found


def is_reversed(path: Trajectory, other: Trajectory, tie: Tie) -> bool:
    """Whether two impacts of a run come in the other order in another one."""
    first, second = (_nth_blow(other.events, *_place(path.events, event)) for event in tie)
    return first is not None and second is not None and second.t < first.t


def reversing_change(session: Session, path: Trajectory, tie: Tie) -> Change | None:
    """When and what to add to the coordinates q of a run so that two of its impacts come in the other order:
    the least move of the bodies that they strike, along the gradient of the time between them.

    Args:
        session: the run at `LEAD` times the time between the impacts before the first of them.
        path: the run, up to its end.
    """
    first, second = tie
    between, state, moment = second.t - first.t, session.save(), float(session.run.t)
    later = [event for event in path.events if event.t > moment]
    places, size = [_place(later, event) for event in tie], PART * between * max(first.speed, second.speed)

    def late(change: Array) -> float:
        session.load(state)
        session.x[: len(change)] += change
        return _between(session, places, second.t + LEAD * SPAN * between)

    moves = [*_moves(session, tie)]
    if not abs(late(0 * moves[0]) - between) <= SAME * between:
        return None
    slopes = np.array([(late(size * move) - late(-size * move)) / (2 * size) for move in moves])
    if not np.all(np.isfinite(slopes)) or not slopes.any():
        return None
    least = sum(slope * move for slope, move in zip(slopes, moves, strict=True)) / (slopes @ slopes)
    for times in range(1, SPAN):
        change = -(1 + times) * between * least
        if late(change) < 0:
            return moment, change
    return None


def _moves(session: Session, tie: Tie) -> Iterator[Array]:
    """Moves of the bodies that either impact strikes along each axis and about it, by some 1 m, as changes of
    q."""
    instance = session.instance
    struck = BodiesByContact(instance)
    for body in sorted(struck[tie[0].contact] | struck[tie[1].contact]):
        entry = instance["bodies"][body]
        for k in range({"free": 6, "point": 3}.get(entry["motion"], 0)):
            change = np.zeros(instance["n_q"])
            if k < 3:
                change[entry["q"] + k] = 1.0
            else:
                e = session.x[entry["q"] + 3 : entry["q"] + 7].astype(float)
                turn = np.eye(3)[k - 3] / instance["scales"]["length"]
                change[entry["q"] + 3 : entry["q"] + 7] = (
                    np.array([-e[1:] @ turn, *(e[0] * turn + np.cross(turn, e[1:]))]) / 2
                )
            yield change


def _between(session: Session, places: Sequence[Place], until: float) -> float:
    """s: the time from the first to the second of two impacts in a run that goes on; NaN if it misses one."""
    record, events = session.tables.Record(), list[Event]()
    found: list[Event | None] = [None, None]
    code, steps = CONTINUE, 0
    while code in (CONTINUE, FULL) and None in found and steps < STEPS:
        code, steps = session.advance(until, 1, record), steps + 1
        events += session.drain_events()
        found = [_nth_blow(events, *place) for place in places]
    first, second = found
    return np.nan if first is None or second is None else second.t - first.t


def _place(events: Sequence[Event], blow: Event) -> Place:
    """What a blow is known by, and how many such blows there are up to it."""
    name = name_of_blow(blow)
    return name, sum(each.speed > 0 and each.t <= blow.t and name_of_blow(each) == name for each in events)


def _nth_blow(events: Sequence[Event], name: str, n: int) -> Event | None:
    """The n-th blow that is known by a name, or None."""
    alike = (each for each in events if each.speed > 0 and name_of_blow(each) == name)
    return next(islice(alike, n - 1, None), None)
