"""Which of the impacts that follow each other within the error of a run have an order that a third run tells.

The time between two impacts in a run and that in its companion may differ as much as they are, because
bounces end sooner in the run, at its threshold of rest. A companion of the companion then shows whether the
time between them has settled.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from modelgen.runtime.event_matching import Pairs, in_pairs
from modelgen.runtime.trajectory import Event, Trajectory

Tie = tuple[Event, Event]
Finer = Callable[
    [float], Trajectory | None
]  # the companion's companion up to a time, s; None: it does not start


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
