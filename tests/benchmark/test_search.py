"""The sweep on made-up programs whose best settings are known."""

from __future__ import annotations

from collections.abc import Callable

from modelgen.benchmark.front_search import sweep
from modelgen.benchmark.knobs import KNOBS, Facts, Settings, Space
from modelgen.benchmark.work_precision_front import Point, front, place

FACTS = Facts(until=2.0, time=0.1, forms={"auto": 3, "block": 4}, contacts=True, joints=False)
SPACE = Space(KNOBS, FACTS)


def always() -> bool:
    return True


def swept(evaluate: Callable[[Settings], Point], space: Space = SPACE) -> list[Point]:
    return list(sweep(space, evaluate, always))


def slow_but_exact(settings: Settings) -> Point:
    """O3 halves the cost, the block form a quarter off; fixed steps are hopeless, Gamma2 is needed."""
    cost = 1.0 if settings["method"] == "dop853" else 10.0
    effort = float(settings.get("tolerance", settings.get("step", 1.0)))
    cost *= effort**-0.125 * (0.5 if settings["level"] == "O3" else 1.0)
    cost *= 0.75 if settings["form"] == "block" else 1.0
    error = effort if settings.get("use_gamma", True) else 0.9
    return Point(settings, max(error, 1e-14), cost * 1e3)


def test_knobs_that_help_together_are_found_together() -> None:
    best = front(swept(slow_but_exact))
    assert {point.settings["level"] for point in best} == {"O3"}
    assert {point.settings["form"] for point in best} == {"block"}
    assert {point.settings["method"] for point in best} == {"dop853"}
    assert all(point.settings["use_gamma"] for point in best)
    assert len(best) >= 12


def test_no_setting_is_tried_twice_and_each_is_settled() -> None:
    tried = [dict(point.settings) for point in swept(slow_but_exact)]
    assert all(tried.count(settings) == 1 for settings in tried)
    assert all(SPACE.settled(settings) == settings for settings in tried)


def test_knobs_that_do_not_help_are_scouted_only() -> None:
    points = swept(slow_but_exact)
    dropped = [point for point in points if not point.settings.get("use_gamma", True)]
    assert 0 < len(dropped) < len(points) / 4


def test_a_ladder_goes_on_where_a_knob_lowered_its_floor() -> None:
    def floored(settings: Settings) -> Point:
        floor = 1e-17 if settings["real"] == "long double" else 1e-9
        effort = float(settings.get("tolerance", 1e-1))
        cost = effort**-0.125 * (5.0 if settings["real"] == "long double" else 1.0)
        return Point(settings, max(effort, floor), cost)

    finest = front(swept(floored))[-1]
    assert place(finest)[1] == 1e-17
    assert finest.settings["real"] == "long double"


def test_a_ladder_goes_on_below_errors_that_stay_a_while() -> None:
    """As where all but the last rungs end a clatter at the same bounce."""

    def stays(settings: Settings) -> Point:
        effort = float(settings.get("tolerance", 1.0))
        error = 1.0 if settings["method"] != "dop853" else 3e-10 if effort > 5e-10 else effort
        return Point(settings, error, effort**-0.125)

    points = swept(stays, Space(KNOBS, FACTS, ("tolerance",)))
    tried = [dict(point.settings) for point in points]
    assert place(front(points)[-1])[1] < 1e-13
    assert all(tried.count(settings) == 1 for settings in tried)


def test_a_ladder_ends_where_runs_take_too_long() -> None:
    def slow(settings: Settings) -> Point:
        return Point(settings, 1e-3, 1.0, costs={"too_long": True})

    methods = [point.settings["method"] for point in swept(slow, Space(KNOBS, FACTS, ("method",)))]
    assert methods == ["dop853", "rk4", "time-stepping"]


def test_the_time_that_is_left_is_kept_to() -> None:
    tried: list[Settings] = []

    def evaluate(settings: Settings) -> Point:
        tried.append(settings)
        return slow_but_exact(settings)

    assert len(list(sweep(SPACE, evaluate, lambda: len(tried) < 5))) == 5


def test_only_knobs_that_can_differ_are_turned() -> None:
    plain = Space(KNOBS, Facts(until=1.0, time=1.0, forms={"auto": 0}, contacts=False, joints=False))
    assert set(plain.settled({})) == {"method", "tolerance", "real", "level"}
    without_eta = Space(KNOBS, Facts(1.0, 1.0, {"auto": 0, "implicit": 3}, contacts=True, joints=False))
    assert "newton" not in without_eta.settled({})
    assert "newton" in without_eta.settled({"form": "implicit"})
    assert "step" in without_eta.settled({"method": "rk4"})
    assert "scheme" not in without_eta.settled({"method": "rk4"})
    assert "use_gamma" not in without_eta.settled({"method": "time-stepping"})
    assert "solver" not in without_eta.settled({"method": "time-stepping", "scheme": "moreau"})


def test_what_is_not_turned_stays_as_the_scene_has_it() -> None:
    own = {"method": "rk4", "step": 1e-3, "project": 10, "level": "O3", "scheme": "moreau"}
    space = Space(KNOBS, FACTS, ("form",), own)
    kept = space.settled({})
    assert kept == {"method": "rk4", "step": 0.01, "form": "auto", "project": 10, "level": "O3"}
    assert all(rung == kept | {"step": rung["step"]} for ladder in space.ladders() for rung in ladder)
    assert space.with_value(kept, "form", "block") == kept | {"form": "block"}
    assert list(space.alternatives()) == [("form", "block")]
    assert Space(KNOBS, FACTS, None, own).settled({}) == SPACE.settled({})


def test_between_two_rungs_lies_their_geometric_mean() -> None:
    coarse, fine = (SPACE.settled({"tolerance": tolerance}) for tolerance in (1e-4, 1e-6))
    assert SPACE.between(coarse, fine) == SPACE.settled({"tolerance": 1e-5})
    assert SPACE.between(coarse, fine | {"level": "O3"}) is None
    assert SPACE.between(fine, fine) is None
