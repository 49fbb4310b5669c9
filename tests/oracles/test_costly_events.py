"""Heaps whose contacts close and open so often that events cost more than steps: the run changes to
time-stepping, says so, and comes back when the events have died."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from itertools import combinations

import numpy as np
import pytest

from modelgen import Accuracy, build, derive, emit, require, simulate
from modelgen.codegen.library import Library
from modelgen.runtime.core_session import Session
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Scene
from tests.benchmarks.many_contacts import pyramid
from tests.running import library_of

EVALUATIONS = 20_000  # of right-hand sides; far more without a bound on what modes and rejected steps cost
TRANSITIONS = ("impact", "touch-down", "lift-off")
LEAST_EVALUATIONS = 13  # of the right-hand side in a step of order 8
BODIES = 6
SEEDS = range(4)
WORK = 2e4  # so little that small heaps change as large ones do by default


def heap(seed: int, bodies: int = BODIES, drag: float = 2.0) -> Scene:
    """Balls of several sizes fall into a bowl and come to rest in it by drag."""
    rng = np.random.default_rng(seed)
    names = [f"ball{i}" for i in range(bodies)]
    balls = [
        make.dynamic(
            name,
            make.sphere(float(rng.uniform(0.07, 0.1))),
            density=500.0,
            position=[float(0.22 * (i % 3 - 1) + rng.uniform(-0.01, 0.01)), float(0.25 * (i // 3)), 0.3],
        )
        for i, name in enumerate(names)
    ]
    pairs = [{"between": list(pair)} for pair in combinations(["bowl", *names], 2)]
    drags = [{"body": name, "force": [f"-{drag}*v{axis}" for axis in "xyz"]} for name in names]
    bowl = make.fixed("bowl", make.paraboloid(1.0, 1.0))
    return make.scene("heap", [bowl, *balls], contact=pairs, force=drags)


@cache
def library(seed: int) -> Library:
    return build(emit(derive(require(heap(seed)))))


def run(seed: int, until: float = 8.0, fallback: bool = True) -> Trajectory:
    accuracy = replace(Accuracy.balanced().with_thresholds(chatter_work=WORK), fallback=fallback)
    return simulate(library(seed), until=until, accuracy=accuracy, estimate=False)


def located(path: Trajectory) -> np.ndarray:
    """s: the times of steps that closed or opened contacts at located events."""
    times, is_stepping = [], False
    for event in path.events:
        if event.kind.startswith("fallback"):
            is_stepping = event.kind == "fallback-start"
        elif event.kind in TRANSITIONS and not is_stepping:
            times.append(event.t)
    return np.unique(times)


def excess(path: Trajectory, seed: int) -> float:
    """The most that the work of located events between any two times exceeds 4 times that of time-stepping, 5
    right-hand sides a step of 0.01 T, over `chatter_work`; one right-hand side is one evaluation of each of m
    contacts, and of n < m forces n^3/300 more, of which only a bound is known."""
    instance = library(seed).manifest.instance
    contacts, T = len(instance["contacts"]), instance["scales"]["time"]
    t = located(path)
    spent = LEAST_EVALUATIONS * contacts * np.arange(len(t))
    allowed = 4 * 5 * t / (0.01 * T) * (contacts + (2 * BODIES) ** 3 / 300)
    balance = spent - allowed
    return float((balance - np.minimum.accumulate(balance)).max()) / WORK


@pytest.mark.slow
@pytest.mark.parametrize("seed", SEEDS)
def test_located_events_cost_no_more_than_several_times_what_steps_do(seed: int) -> None:
    assert excess(run(seed), seed) <= 1
    assert excess(run(seed, fallback=False), seed) > 1  # what would be located


@pytest.mark.slow
@pytest.mark.parametrize("seed", SEEDS)
def test_the_run_comes_back_and_rests_where_that_of_all_events_does(seed: int) -> None:
    path, exact = run(seed), run(seed, fallback=False)
    changes = [event.kind for event in path.events if event.kind.startswith("fallback")]
    assert changes == ["fallback-start", "fallback-end"] * (len(changes) // 2)
    assert 0 < len(changes) <= 2 * 8  # each stay is twice as long as the one before
    np.testing.assert_allclose(path.p[-1], exact.p[-1], atol=1e-3)
    assert path.rhs_evals < exact.rhs_evals / 4
    assert path.penetration_max <= 1e-9
    assert path.energy_drift < 1e-2  # of order 1 in a step of 0.01 T


def test_the_change_is_told_with_its_error() -> None:
    accuracy = Accuracy.balanced().with_thresholds(chatter_work=WORK)
    path = simulate(library(SEEDS[0]), until=1.0, accuracy=accuracy)
    step = 0.01 * library(SEEDS[0]).manifest.instance["scales"]["time"]
    assert path.estimate is not None
    assert path.fallback_step == pytest.approx(step)
    assert any("s in all, the run went on by time-stepping" in told for told in path.estimate.uncertified)
    assert path.estimate.events is not None
    assert path.estimate.events >= step
    (told,) = [warning for warning in path.warnings if "cost several times" in warning]
    assert f"in steps of {step:.2g} s" in told
    assert path.doubts


@pytest.mark.parametrize("base", [2, 3])
def test_a_wall_of_flush_blocks_is_passed_by_steps(base: int) -> None:
    """More faces rest on each other than forces can be told apart: to choose which of them stick, and to
    follow their pressures when a ball strikes them, costs more than to step over it."""
    path = simulate(library_of(pyramid(base)), until=0.3, accuracy="balanced", samples=3, estimate=False)
    assert path.outcome.succeeded
    assert path.rhs_evals < EVALUATIONS
    assert path.penetration_max <= 1e-9
    assert any(event.kind == "fallback-start" for event in path.events)


def test_neither_calls_nor_samples_change_when_events_cost_too_much() -> None:
    scene = library_of(pyramid(2))
    accuracy = Accuracy.balanced().with_thresholds(chatter_work=10 * WORK)
    one, many = Session(scene, accuracy), Session(scene, accuracy)
    record = one.tables.Record()
    for session, steps in ((one, 10**8), (many, 1)):
        assert session.begin() == 0
        while session.advance(0.3, steps, record):
            session.events.count = 0
    assert one.run.report.chatters
    assert many.save() == one.save()
    few, dense = (
        simulate(scene, until=0.3, accuracy="balanced", samples=n, estimate=False) for n in (3, 500)
    )
    np.testing.assert_array_equal(dense.p[-1], few.p[-1])


@pytest.mark.parametrize("restitution", [0.5, 0.9, 0.97])
def test_few_contacts_keep_all_their_events(restitution: float) -> None:
    """The impacts of a ball accumulate, but all of them together cost little."""
    ball = make.dynamic("ball", make.sphere(0.1), density=500.0, position=[0.0, 0.0, 0.15])
    pair = {"between": ["ball", "floor"], "restitution": restitution}
    scene = make.scene("bounces", [make.fixed("floor", make.plane()), ball], contact=[pair])
    drop = 2 * 0.05 / 9.81
    rest = drop**0.5 * (1 + restitution) / (1 - restitution)
    path = simulate(build(emit(derive(require(scene)))), until=1.2 * rest, estimate=False)
    assert not any(event.kind.startswith("fallback") for event in path.events)
    assert sum(event.kind == "impact" for event in path.events) > 10
    assert [event.kind for event in path.events][-1] == "touch-down"
