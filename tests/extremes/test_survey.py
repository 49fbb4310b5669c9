"""At the ends of double precision: right within the law of loss, or refused in so many words."""

from __future__ import annotations

from typing import Any

import pytest

from modelgen.benchmark.extreme_trials import Extreme, Found, Trial, tried
from modelgen.benchmark.extremes_survey import EXTREMES, survey
from modelgen.benchmark.extremes_table import _ranges
from modelgen.benchmark.libraries_by_kinds import LibrariesByKinds
from modelgen.errors import ModelgenError
from modelgen.runtime.core_session import Session
from tests.running import folder

NAMES = [extreme.name for extreme in EXTREMES]
LONG = {  # each builds libraries of its own
    *("conforming ball", "conforming ellipsoid", "flat on flat", "parallel tangents", "pole of a chart"),
    *("heavy above light", "free spin", "spin in contact", "friction", "restitution", "redundant feet"),
}


LIBRARIES = LibrariesByKinds(folder() / "extremes")


def failures(name: str, quick: bool) -> list[dict[str, object]]:
    found: list[Found] = []
    tried([each for each in EXTREMES if each.name == name], LIBRARIES, quick, lambda text: None, found)
    assert found
    return [each.as_json() for each in found if not each.holds]


@pytest.mark.cases(4)
@pytest.mark.parametrize("name", sorted(set(NAMES) - LONG))
def test_a_few_decades_keep_their_law(name: str) -> None:
    assert not failures(name, quick=True)


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_all_decades_keep_their_law(name: str) -> None:
    assert not failures(name, quick=False)


def test_what_is_tried_quickly_is_a_part_of_all() -> None:
    for extreme in EXTREMES:
        assert set(extreme.quick) <= set(extreme.values)
        assert len(NAMES) == len(set(NAMES))


def extreme(**keys: object) -> Extreme:
    def attempt(value: float, libraries: LibrariesByKinds) -> Trial:
        return Trial(value)

    what: dict[str, object] = {"warned": 1e-2, "refused": 1e-4, "allowed": lambda x: 1.0} | keys
    return Extreme("e", "x", (1e-1, 1e-5), (), "law", measured="m", attempt=attempt, **what)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("value", "trial", "holds"),
    [
        (1e-1, Trial(0.5), True),
        (1e-1, Trial(1.5), False),  # beyond its law
        (1e-1, Trial(float("nan")), False),
        (1e-1, Trial(0.5, ("so",), "warned"), False),  # sooner than was said
        (1e-3, Trial(0.5), False),  # without a word
        (1e-3, Trial(0.5, ("so",), "warned"), True),
        (1e-5, Trial(None, ("no",), "refused"), True),
        (1e-5, Trial(None, (), "refused"), False),
    ],
)
def test_a_value_holds_by_its_law_and_by_what_is_told(value: float, trial: Trial, holds: bool) -> None:
    assert Found(extreme(), value, trial).holds is holds


def test_where_another_model_takes_over_it_is_safe_again() -> None:
    assert extreme(switched=1e-4).expected(1e-5) == "safe"
    assert extreme(switched=1e-4).expected(1e-3) == "warned"


@pytest.mark.parametrize(
    ("name", "nth"), [("unit of mass", 1), ("unit of mass", 2), ("far from the origin", 2)]
)
@pytest.mark.parametrize("late", [False, True])
def test_ctrl_c_in_any_run_ends_the_survey(
    name: str, nth: int, late: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In the run itself, and in what it is compared with, before it or after; or as that comes to its end."""
    runs: list[float] = []
    advance = Session.advance

    def stopping(self: Session, end: float, steps: int, record: Any) -> int:
        runs.append(end)
        if len(runs) == nth and not late:
            raise KeyboardInterrupt
        code = advance(self, end, 10**9, record)
        if len(runs) == nth:
            raise KeyboardInterrupt
        return code

    monkeypatch.setattr(Session, "advance", stopping)
    found: list[Found] = []
    with pytest.raises(KeyboardInterrupt):
        tried([each for each in EXTREMES if each.name == name], LIBRARIES, True, lambda text: None, found)
    assert not found


def test_the_table_has_the_values_of_a_verdict_as_runs_by_size() -> None:
    verdicts = [(1e-2, "safe"), (1e2, "safe"), (1e-1, "warned"), (10.0, "warned"), (1e3, "safe")]
    found = [Found(extreme(), value, Trial(0.5, (), verdict)) for value, verdict in verdicts]  # type: ignore[arg-type]
    assert _ranges(found, "safe") == "0.01, 100 .. 1000"
    assert _ranges(found, "warned") == "0.1 .. 10"
    assert _ranges(found, "refused") == "-"


def test_an_unknown_extreme_is_refused_by_name() -> None:
    with pytest.raises(ModelgenError, match="needle"):
        survey(["needel"])
