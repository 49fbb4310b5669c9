"""The method of a run: what a scene says, what a caller says of its own, and what does not go together."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from modelgen import Accuracy
from modelgen.errors import SimulationError
from modelgen.runtime.settings import accuracy_of
from modelgen.scene.scene_types import RunSettings

PLAIN = {**RunSettings().said(), "accuracy": "fast"}
TIME = 0.02  # s, characteristic
STEPPED = {**PLAIN, "method": "time-stepping", "step": 1e-3, "scheme": "moreau"}


def chosen(run: dict[str, Any], accuracy: Accuracy | str | None = None, **own: Any) -> Accuracy:
    pairs = [{"friction": [{"kind": "slip"}]}]
    instance = {"run": run, "source": "s.toml", "scales": {"time": TIME}, "pairs": pairs}
    return accuracy_of(instance, accuracy, own)


def test_a_scene_that_says_nothing_is_run_event_driven_and_may_fall_back() -> None:
    assert chosen(PLAIN) == Accuracy.fast()
    assert chosen(PLAIN).fallback


def test_the_method_of_the_scene_goes_with_any_named_accuracy_but_not_with_a_record() -> None:
    assert chosen(STEPPED) == Accuracy.fast().time_stepping(1e-3, "moreau")
    assert chosen(STEPPED, "tight") == Accuracy.tight().time_stepping(1e-3, "moreau")
    assert chosen(STEPPED, Accuracy.tight()) == Accuracy.tight()


def test_the_caller_has_the_last_word() -> None:
    assert chosen(STEPPED, method="dop853") == Accuracy.fast()
    assert chosen(STEPPED, method="rk4", step=0.1) == Accuracy.fast().fixed_step(0.1)
    assert chosen(STEPPED, solver="relaxation").solver == "relaxation"
    assert not chosen(PLAIN, fallback=False).fallback


def test_coarse_is_time_stepping_in_its_own_steps_or_those_given() -> None:
    own = Accuracy.coarse().time_stepping(Accuracy.coarse().thresholds.stepping_step * TIME)
    for each in (
        chosen(PLAIN, "coarse"),
        chosen(PLAIN | {"accuracy": "coarse"}),
        chosen(PLAIN, Accuracy.coarse()),
    ):
        assert replace(each, name="") == replace(own, name="")
    assert chosen(PLAIN, "coarse", step=1e-3).step == 1e-3
    assert chosen(PLAIN | {"accuracy": "coarse", "step": 1e-3}).step == 1e-3
    assert chosen(STEPPED, "coarse") == replace(
        Accuracy.coarse().time_stepping(1e-3, "moreau"), name="coarse, moreau 0.001 s"
    )
    assert (
        chosen(PLAIN | {"method": "rk4", "step": 1e-4}, "coarse").step == own.step
    )  # that of the other method
    assert chosen(PLAIN, "coarse", method="dop853").method == "dop853"
    assert chosen(PLAIN | {"accuracy": "coarse", "method": "rk4", "step": 1e-4}).method == "rk4"
    with pytest.raises(SimulationError, match=r"^s\.toml: run\.tolerance: .*coarse"):
        chosen(PLAIN | {"accuracy": "coarse", "tolerance": 1e-6})


@pytest.mark.parametrize("step", [-1, 0, 0.0, float("nan"), float("inf"), "1 ms", None])
def test_a_fixed_step_is_a_positive_time(step: Any) -> None:
    for record in (Accuracy.fast().fixed_step, Accuracy.tight().time_stepping):
        with pytest.raises(SimulationError, match=r"^step: .*; a positive time in s; give the step$"):
            record(step)
    if step is not None:
        with pytest.raises(SimulationError, match=r"^step: "):
            replace(Accuracy.balanced(), method="rk4", step=step)


def test_names_of_time_stepping_are_checked() -> None:
    with pytest.raises(SimulationError, match="did you mean 'moreau'"):
        Accuracy.fast().time_stepping(1e-3, "moro")  # type: ignore[arg-type]
    with pytest.raises(SimulationError, match=r"^solver: "):
        Accuracy.fast().time_stepping(1e-3, solver="newton")  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("own", "where"),
    [
        ({"method": "time-stepping"}, "method"),
        ({"method": "euler"}, "method"),
        ({"step": 0.1}, "step"),
        ({"scheme": "moreau"}, "scheme"),
        ({"method": "rk4", "step": -1.0}, "step"),
        ({"fallback": "no"}, "fallback"),
    ],
)
def test_what_does_not_go_together_is_refused_where_it_stands(own: dict[str, Any], where: str) -> None:
    with pytest.raises(SimulationError) as refused:
        chosen(PLAIN, **own)
    assert refused.value.where == where


def test_thresholds_are_changed_by_name_and_checked() -> None:
    record = Accuracy.fast().with_thresholds(event_tolerance=1e-8)
    assert record.thresholds == replace(Accuracy.fast().thresholds, event_tolerance=1e-8)
    assert replace(record, thresholds=Accuracy.fast().thresholds) == Accuracy.fast()
    for changes, words in (
        ({"event_tolerence": 1e-8}, "did you mean 'event_tolerance'"),
        ({"event_tolerance": -1.0}, "^event_tolerance: -1.0; a number from 0 on"),
        ({"event_tolerance": "fine"}, "^event_tolerance: 'fine'; a number from 0 on"),
    ):
        with pytest.raises(SimulationError, match=words):
            record.with_thresholds(**changes)  # type: ignore[arg-type]
    with pytest.raises(SimulationError, match=r"^thresholds: 1e-08; a Thresholds"):
        replace(record, thresholds=1e-8)  # type: ignore[arg-type]


def test_a_companion_has_finer_thresholds_of_events_and_shorter_steps() -> None:
    own = Accuracy.balanced().thresholds
    finer = Accuracy.balanced().companion(2.0**-52).thresholds
    assert finer.event_tolerance == own.event_tolerance / 10
    assert finer.chatter_step < own.chatter_step
    assert finer.gap_error_max == own.gap_error_max


def test_keys_that_go_with_a_coarse_scene_are_left_out_at_another_accuracy() -> None:
    run = PLAIN | {"accuracy": "coarse", "scheme": "moreau", "solver": "relaxation"}
    assert chosen(run).scheme == "moreau"
    assert chosen(run, "tight") == Accuracy.tight()


def test_the_name_of_a_record_tells_its_solver_once() -> None:
    assert chosen(STEPPED, solver="relaxation").name.count("relaxation") == 1
    assert chosen(PLAIN | {"accuracy": "coarse"}, solver="relaxation").name.count("relaxation") == 1
    own = Accuracy.tight().time_stepping(1e-3)
    assert own.solved_by("relaxation").solved_by("polyhedral").solved_by("coulomb") == own
