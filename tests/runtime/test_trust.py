"""A run is trusted if nothing speaks against it, and each thing that does is named."""

from __future__ import annotations

import ctypes
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from modelgen import simulate
from modelgen.runtime.accuracy import Accuracy
from modelgen.runtime.core_session import Session
from modelgen.runtime.trajectory import DOUBT_KINDS, Outcome, Trajectory
from modelgen.runtime.trust import doubts
from modelgen.scene import python_scenes as make
from tests.running import library_of

BALL = make.dynamic("ball", make.sphere(0.1), density=1000.0, position=[0, 0, 0.3])
SCENE = make.scene(
    "ball", [make.fixed("table", make.plane()), BALL], contact=[{"between": ["ball", "table"]}]
)


@cache
def path() -> Trajectory:
    return simulate(library_of(SCENE), until=0.3, accuracy="balanced")


@cache
def instance() -> Any:
    return library_of(SCENE).manifest.instance


def doubted(run: Trajectory, accuracy: Accuracy | None = None) -> tuple[str, ...]:
    return doubts(run, run.estimate, accuracy or Accuracy.balanced(), instance())


def test_a_certified_run_is_trusted_with_and_without_its_estimate() -> None:
    assert path().is_trusted
    assert not doubted(path())
    assert not doubted(replace(path(), estimate=None))


BOUNDS = {
    "gap": ("gap_max", "gap_error_max"),
    "penetration": ("penetration_max", "gap_error_max"),
    "joint": ("joint_error_max", "start_joint_gap"),
    "complementarity": ("complementarity_max", "complementarity_error_max"),
    "energy": ("energy_error_max", "energy_error_max"),
    "impact-gain": ("impact_gain_max", "energy_error_max"),
}
COUNTS = {
    "unfollowed": "unfollowed_minima",
    "incomplete": "incomplete_searches",
    "time-stepping": "fallbacks",
    "indeterminate": "indeterminate",
}


@settings(max_examples=50, deadline=None)
@given(
    parts=st.dictionaries(st.sampled_from(sorted(BOUNDS)), st.floats(0, 2) | st.just(float("nan"))),
    counts=st.sets(st.sampled_from(sorted(COUNTS))),
    record=st.sampled_from(["fast", "balanced", "tight"]),
)
def test_the_core_doubts_each_figure_beyond_its_bound(
    parts: dict[str, float], counts: set[str], record: str
) -> None:
    """`parts`: each figure of a run over its bound, as the manual states it."""
    accuracy = Accuracy.named(record)
    session = Session(library_of(SCENE), accuracy)
    assert session.begin() == 0
    report, scales = session.run.report, instance()["scales"]
    report.kinetic_max, report.energy_0 = 3 * scales["mass"] * (scales["length"] / scales["time"]) ** 2, 0.0
    for kind, part in parts.items():
        figure, bound = BOUNDS[kind]
        size = {"energy": report.kinetic_max, "impact-gain": report.kinetic_max, "complementarity": 1.0}
        setattr(report, figure, part * getattr(accuracy.thresholds, bound) * size.get(kind, scales["length"]))
    for kind in counts:
        setattr(report, COUNTS[kind], 1)
    beyond = {kind for kind, part in parts.items() if not part <= 1} | counts
    doubted = session.doubts(session.run, 0)
    assert {kind for bit, kind in enumerate(DOUBT_KINDS) if doubted >> bit & 1} == beyond


def test_each_doubt_has_words_of_its_own_in_both_languages() -> None:
    cdll = library_of(SCENE).cdll
    cdll.mg_doubt_text.restype = ctypes.c_char_p
    texts = [cdll.mg_doubt_text(1 << bit).decode() for bit in range(len(DOUBT_KINDS))]
    assert all(texts)
    assert len({*texts}) == len(texts)
    assert not cdll.mg_doubt_text(1 << len(DOUBT_KINDS))
    said = [
        doubted(replace(path(), estimate=None, doubt_kinds=(kind,), indeterminate_t=0.1))
        for kind in DOUBT_KINDS[1:]
    ]
    assert all(len(reasons) == 1 for reasons in said)
    assert len({*said}) == len(said)


@pytest.mark.parametrize("estimated", [True, False])
@pytest.mark.parametrize(
    ("changes", "word"),
    [
        ({"outcome": Outcome.STEP_TOO_SMALL}, "it ended early: step_too_small"),
        ({"doubt_kinds": ("gap",), "gap_max": 1.5e-9}, "1.5e-09 m"),
        ({"doubt_kinds": ("joint",), "joint_error_max": 1.5e-6}, "a joint was apart by 1.5e-06"),
        ({"doubt_kinds": ("energy",), "energy_drift": 1.5e-6}, "energy drift 1.5e-06 is above 1e-06"),
        ({"doubt_kinds": ("complementarity",), "complementarity_max": 0.056}, "0.056"),
    ],
)
def test_a_doubt_names_its_figure(changes: dict[str, Any], word: str, estimated: bool) -> None:
    run = replace(path(), **changes)
    (reason,) = doubted(run if estimated else replace(run, estimate=None))
    assert word in reason


def test_an_uncertified_run_is_doubted_by_the_estimate_or_by_its_own_reasons() -> None:
    seen = {"unfollowed_pair": "ball-table", "unfollowed_t": 0.125}
    (told,) = doubted(replace(path(), estimate=None, doubt_kinds=("unfollowed",), **seen))
    assert told.startswith("uncertified: at t = 0.125 s closest points of ball-table were found")
    estimate = path().estimate
    assert estimate is not None
    horizon = replace(path(), estimate=replace(estimate, horizon=0.2))
    assert doubted(horizon) == ("nothing is predicted beyond 0.2 s",)
    shared = replace(path(), estimate=replace(estimate, uncertified=("something",)))
    assert doubted(shared) == ("uncertified: something",)


@pytest.mark.parametrize("height", [0.0, 1.0, 100.0])
def test_energy_within_rounding_is_trusted(height: float) -> None:
    """A belt drags a box with a friction of 1e-6: its motion is lost in the rounding of its height."""
    belt = make.driven("belt", make.plane(), path={"position": ["0.5*t", "0.0", str(height)]})
    box = make.dynamic("box", make.box(0.1, 0.1, 0.1), density=1000.0, position=[0, 0, height + 0.05])
    contact = [{"between": ["box", "belt"], "friction": 1e-6}]
    run = simulate(library_of(make.scene("belt", [belt, box], contact=contact)), until=1.0, samples=3)
    assert run.is_trusted, run.doubts
    assert run.energy_drift > 1e-7
    assert path().energy_rounding < 1e-12


def stated(position: float, velocity: float) -> Trajectory:
    """The run with other stated errors, the same at all samples."""
    estimate = path().estimate
    assert estimate is not None
    n = len(path().t)
    changed = replace(estimate, position=np.full(n, position), velocity=np.full(n, velocity))
    return replace(path(), estimate=changed)


@given(size=st.floats(-12, -3), part=st.sampled_from([0.5, 2.0]))
def test_a_penetration_that_the_stated_error_allows_is_no_doubt(size: float, part: float) -> None:
    deep = 10.0**size
    run = replace(
        stated(deep / part, 1.0), penetration_max=deep, penetration_t=0.2, doubt_kinds=("penetration",)
    )
    assert bool(doubted(run)) == (part > 1)


def moved(v: float, w: float, stated_v: float, stated_w: float, drift: float) -> Trajectory:
    """The run of a ball that always has the speed v and the spin w, with other stated errors and a drift."""
    run, n = path(), len(path().t)
    assert run.estimate is not None
    estimate = replace(run.estimate, velocity=np.full(n, stated_v), spin=np.full(n, stated_w))
    speeds, spins = np.zeros_like(run.v), np.zeros_like(run.w)
    speeds[:, 1, 0], spins[:, 1, 1] = v, w
    return replace(run, v=speeds, w=spins, estimate=estimate, energy_drift=drift, doubt_kinds=("energy",))


@given(size=st.floats(-9, -2), v=st.floats(0.01, 10), w=st.floats(0.1, 100), part=st.sampled_from([0.4, 3.0]))
def test_a_drift_of_the_energy_that_the_stated_errors_allow_is_no_doubt(
    size: float, v: float, w: float, part: float
) -> None:
    """With errors of both that are the same part of speed and spin, the energy may err by twice that part of
    it; half of this is told apart."""
    drift = 10.0**size
    run = moved(v, w, drift * v / part, drift * w / part, drift)
    assert bool(doubted(run)) == (part > 1)


def test_a_drift_of_the_energy_is_not_explained_by_errors_of_what_does_not_move() -> None:
    assert doubted(moved(0.0, 100.0, 1e-3, 0.0, 1e-3))
    assert doubted(moved(1e-3, 100.0, 1e-6, 0.0, 1e-3))
    assert doubted(moved(0.0, 0.0, 1.0, 1.0, 1e-3))


def test_a_run_that_is_doubted_otherwise_tells_them_all() -> None:
    run = stated(1.0, 1.0)
    assert run.estimate is not None
    run = replace(
        run, estimate=replace(run.estimate, uncertified=("x",)), doubt_kinds=("energy", "penetration")
    )
    assert len(doubted(run)) == 3
