"""Which settings are tried: all ladders, then one turned knob after another, wherever it moves the front."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Protocol

from modelgen.benchmark.knobs import Settings, Space, Value
from modelgen.benchmark.work_precision_front import Point, front, improves, is_measured, place

ROUNDS = 3  # in which combinations of knobs are built up
IDLE = 3  # rungs without a smaller error before the end of a ladder is looked at
FALLS = 2.0  # times smaller errors are there if the rungs between are worth their time


class Evaluate(Protocol):
    def __call__(self, settings: Settings) -> Point: ...


Left = Callable[[], bool]  # whether there is time left


def sweep(space: Space, evaluate: Evaluate, left: Left) -> Iterator[Point]:
    """The points in the order in which they are measured; the caller may stop at any."""
    points: list[Point] = []
    for rungs in space.ladders():
        for point in _descend(rungs, evaluate, left):
            points.append(point)
            yield point
    for _ in range(ROUNDS):
        known = front(points)
        for name, value in space.alternatives():
            for point in _turn(space, points, name, value, evaluate, left):
                points.append(point)
                yield point
            for point in _descend(_further(space, points), evaluate, left):
                points.append(point)
                yield point
        if not left() or not any(improves(known, point) for point in front(points)):
            return


def _further(space: Space, points: Sequence[Point]) -> list[Settings]:
    """The rungs below the most accurate point, on its ladder, that were not tried."""
    known = front(points)
    seen = [dict(point.settings) for point in points]
    return [rung for rung in space.below(known[-1].settings) if rung not in seen] if known else []


def _descend(rungs: Sequence[Settings], evaluate: Evaluate, left: Left) -> Iterator[Point]:
    """Measure one ladder from coarse to fine until its error no longer falls, also at its end."""
    best, idle, whole = float("inf"), 0, False
    for settings in rungs:
        if not left() or (whole and settings is rungs[-1]):
            return
        point = evaluate(settings)
        yield point
        if is_measured(point):
            idle = 0 if place(point)[1] < best else idle + 1
            best = min(best, place(point)[1])
        if point.costs.get("too_long"):
            return
        if idle == IDLE and not whole and settings is not rungs[-1]:
            last = evaluate(rungs[-1])
            yield last
            whole = is_measured(last) and place(last)[1] < best / FALLS
            if not whole:
                return


def _turn(
    space: Space, points: Sequence[Point], name: str, value: Value, evaluate: Evaluate, left: Left
) -> Iterator[Point]:
    """Vary one knob at three points of the front, and at all points if one of them improved.

    The last place is a rung below the most accurate point: where a knob lowers the floor, it shows there.
    """
    known = front(points)
    seen = [dict(point.settings) for point in points]
    places = [point.settings for point in known]
    places += space.below(places[-1])[:1] if places else []
    turned = [space.with_value(settings, name, value) for settings in places]
    fresh = [settings for settings in turned if settings is not None and settings not in seen]
    scouts = {0, len(fresh) // 2, len(fresh) - 1}
    helped = False
    for chosen in (True, False):
        for number, settings in enumerate(fresh):
            if (number in scouts) != chosen or not left():
                continue
            point = evaluate(settings)
            helped = helped or improves(known, point)
            yield point
        if not helped:
            return
