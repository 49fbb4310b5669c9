"""Laws of the work-precision front, whatever was measured."""

from __future__ import annotations

import itertools

from hypothesis import given
from hypothesis import strategies as st

from modelgen.benchmark.work_precision_front import (
    Point,
    advantage,
    cheapest,
    compared,
    finest,
    front,
    improves,
    is_measured,
    place,
    spaced,
)

SIZES = st.floats(1e-16, 1e3)
POINTS = st.lists(
    st.builds(Point, st.just({}), st.none() | SIZES, st.none() | SIZES.map(lambda cost: 1e6 * cost))
)


@given(POINTS)
def test_along_a_front_errors_fall_as_costs_rise(points: list[Point]) -> None:
    placed = [place(point) for point in front(points)]
    assert all(a[0] < b[0] and a[1] > b[1] for a, b in itertools.pairwise(placed))


@given(POINTS)
def test_no_point_beats_one_of_the_front_and_every_other_is_beaten(points: list[Point]) -> None:
    best = front(points)
    for point in filter(is_measured, points):
        cost, error = place(point)
        beaten = any(c <= cost and e <= error for c, e in map(place, best))
        assert beaten
        assert not any(cost < c and error < e for c, e in map(place, best))


@given(POINTS)
def test_the_front_of_a_front_is_itself(points: list[Point]) -> None:
    assert front(front(points)) == front(points)


@given(POINTS, SIZES)
def test_a_pick_meets_its_demand_and_none_does_so_better(points: list[Point], demand: float) -> None:
    within = [point for point in points if is_measured(point) and place(point)[1] <= demand]
    pick = cheapest(points, demand)
    assert (pick is None) == (not within)
    if pick is not None:
        assert place(pick)[1] <= demand
        assert place(pick)[0] == min(place(point)[0] for point in within)
    afforded = [point for point in points if is_measured(point) and place(point)[0] <= demand * 1e6]
    found = finest(points, demand * 1e6)
    assert (found is None) == (not afforded)
    if found is not None:
        assert place(found)[1] == min(place(point)[1] for point in afforded)


@given(POINTS)
def test_what_a_front_holds_does_not_improve_it(points: list[Point]) -> None:
    best = front(points)
    assert not any(improves(best, point) for point in points)


@given(POINTS)
def test_rows_that_are_shown_are_of_the_front_and_apart(points: list[Point]) -> None:
    best = front(points)
    shown = spaced(best, 2.0)
    assert all(point in best for point in shown)
    assert shown[:1] == best[:1]
    assert all(place(a)[1] >= 2 * place(b)[1] for a, b in itertools.pairwise(shown))


@given(POINTS, st.integers(0, 20))
def test_a_point_that_is_cited_is_shown_and_the_others_stay(points: list[Point], k: int) -> None:
    best = front(points)
    cited = best[k : k + 2]
    shown = spaced(best, 2.0, cited)
    assert all(point in shown for point in (*cited, *spaced(best, 2.0)))
    assert len(shown) <= len(spaced(best, 2.0)) + len(cited)


@given(POINTS, POINTS, SIZES)
def test_an_advantage_is_that_of_the_points_compared(
    ours: list[Point], theirs: list[Point], budget: float
) -> None:
    points, found = compared(ours, theirs, 1e6 * budget), advantage(ours, theirs, 1e6 * budget)
    assert (points is None) == (found is None)
    if points is None or found is None:
        return
    best, equal, finer = points
    assert best in front(theirs)
    assert equal in front(ours)
    assert finer in front(ours)
    assert found["cheaper"] == place(best)[0] / place(equal)[0]
    assert place(equal)[1] <= place(best)[1] == found["error"]
    assert place(finer)[0] <= place(best)[0]
