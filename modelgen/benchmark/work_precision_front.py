"""The work-precision front: of the settings that were measured, those that no other beats in both."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass, field
from math import inf, log10
from typing import Any

from modelgen.benchmark.knobs import Settings

USELESS = 1.0  # an error of the body's own size: the run says nothing
CLEARLY = 0.95  # a setting improves a front if it costs, or errs, at most so much of what is there


@dataclass(frozen=True, slots=True)
class Point:
    """One measured setting.

    `error` is the largest distance of body points from the reference up to the horizon, over the
    characteristic length, never below the reference's own; None where the run failed or was left out.
    `cost_ns_per_s` is CPU time per simulated second; `noise` the spread of its repeats, relative.
    """

    settings: Settings
    error: float | None
    cost_ns_per_s: float | None
    errors: dict[str, Any] = field(default_factory=dict)
    costs: dict[str, Any] = field(default_factory=dict)
    remark: str = ""  # why there is no error

    def as_json(self) -> dict[str, Any]:
        return asdict(self) | {"settings": dict(self.settings)}


def is_measured(point: Point) -> bool:
    """Whether there are a cost and an error, the latter below USELESS."""
    return point.cost_ns_per_s is not None and point.error is not None and point.error < USELESS


def place(point: Point) -> tuple[float, float]:
    """(cost, error) of a point that was measured."""
    assert point.cost_ns_per_s is not None
    assert point.error is not None
    return point.cost_ns_per_s, point.error


def front(points: Iterable[Point]) -> list[Point]:
    """The points that none beats, by rising cost; their errors fall strictly."""
    best: list[Point] = []
    for point in sorted(filter(is_measured, points), key=place):
        if not best or place(point)[1] < place(best[-1])[1]:
            best.append(point)
    return best


def spaced(points: Sequence[Point], factor: float, cited: Sequence[Point] = ()) -> list[Point]:
    """Points of a front to show: the cheapest, then each whose error is smaller than that of the last by a
    factor; and those that are cited elsewhere."""
    shown: list[Point] = []
    last = inf
    for point in points:
        error = place(point)[1]
        if error * factor <= last:
            last = error
            shown.append(point)
        elif point in cited:
            shown.append(point)
    return shown


def improves(known: Sequence[Point], point: Point) -> bool:
    """Whether a point is clearly beyond a front: cheaper at no more error, or finer at no more cost."""
    if not is_measured(point):
        return False
    cost, error = place(point)
    cheap = min((c for c, e in map(place, known) if e <= error), default=float("inf"))
    fine = min((e for c, e in map(place, known) if c <= cost), default=float("inf"))
    return cost < CLEARLY * cheap and (error < CLEARLY * fine or cheap < float("inf"))


def cheapest(points: Iterable[Point], error: float) -> Point | None:
    """The cheapest point that errs at most so much."""
    fitting = [point for point in front(points) if place(point)[1] <= error]
    return min(fitting, key=place, default=None)


def finest(points: Iterable[Point], budget: float) -> Point | None:
    """The most accurate point within a budget, ns per simulated second."""
    fitting = [point for point in front(points) if place(point)[0] <= budget]
    return max(fitting, key=place, default=None)


def compared(
    ours: Sequence[Point], theirs: Sequence[Point], budget: float
) -> tuple[Point, Point, Point] | None:
    """Their most accurate point within a budget, ns per simulated second; our cheapest that errs no more; our
    most accurate that costs no more. None where either has no point for it."""
    best = finest(theirs, budget)
    if best is None:
        return None
    cost, error = place(best)
    equal, finer = cheapest(ours, error), finest(ours, cost)
    return None if equal is None or finer is None else (best, equal, finer)


def advantage(ours: Sequence[Point], theirs: Sequence[Point], budget: float) -> dict[str, float] | None:
    """Our front against theirs, at the best error that they reach within a budget, ns per simulated second.

    `cheaper`: their cost there over ours at no more error; `digits`: the decimals by which we err less at no
    more than their cost. None where either has no point for it.
    """
    points = compared(ours, theirs, budget)
    if points is None:
        return None
    (cost, error), (equal, _), (_, finer) = map(place, points)
    return {
        "error": error,
        "their_cost_ns_per_s": cost,
        "our_cost_ns_per_s": equal,
        "cheaper": cost / equal,
        "digits": log10(error / finer),
    }
