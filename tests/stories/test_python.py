"""The pipeline from Python: what is given in the wrong place is named, with the call that makes it right."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import modelgen
from modelgen import (
    Accuracy,
    ModelgenError,
    build,
    derive,
    draw,
    emit,
    load,
    read,
    record_of,
    require,
    save,
    simulate,
)
from modelgen.codegen.library import Library
from modelgen.errors import SimulationError
from modelgen.scene.scene_types import RunSettings, Scene
from tests.running import SCENES, library_of, scene_of


def ball() -> Scene:
    return read(SCENES / "bouncing_ball.toml")


@pytest.mark.parametrize(
    ("call", "given", "remedy"),
    [
        (lambda: require("ball.toml"), "str", "require(read(path))"),  # type: ignore[arg-type]
        (lambda: emit(require(ball())), "Model", "emit(derive(model))"),  # type: ignore[arg-type]
        (lambda: build(derive(require(ball()))), "Derivation", "build(emit(derivation))"),  # type: ignore[arg-type]
        (lambda: build(ball()), "Scene", "build(emit(derive(require(scene))))"),  # type: ignore[arg-type]
        (lambda: derive(ball()), "Scene", "derive(require(scene))"),  # type: ignore[arg-type]
        (lambda: derive("ball.toml"), "str", "derive(require(read(path)))"),  # type: ignore[arg-type]
        (lambda: derive(None), "NoneType", "derive(require(read(path)))"),  # type: ignore[arg-type]
        (lambda: simulate(ball()), "Scene", "simulate(build(emit(derive(require(scene)))))"),  # type: ignore[arg-type]
        (
            lambda: modelgen.simulate_batch(ball(), [], [], until=1.0),  # type: ignore[arg-type]
            "Scene",
            "simulate_batch(build(emit(derive(require(scene)))), ...)",
        ),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_a_value_of_another_station_is_refused(call: Callable[[], Any], given: str, remedy: str) -> None:
    with pytest.raises(ModelgenError) as refused:
        call()
    assert given in refused.value.found
    assert refused.value.remedy == f"write {remedy}"


def test_a_folder_may_be_given_as_text(tmp_path: Path) -> None:
    library = build(emit(derive(require(ball()))), folder=str(tmp_path / "made"))
    assert library.path.parent == tmp_path / "made"


def test_an_accuracy_may_be_given_by_its_name() -> None:
    library = scene_of("bouncing_ball")
    assert simulate(library, until=0.1, accuracy="tight").accuracy == Accuracy.tight().name


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"accuracy": "tigt"}, "accuracy: 'tigt'; coarse, fast, balanced, tight; did you mean 'tight'?"),
        (
            {"accuracy": 1e-8},
            "accuracy: 1e-08; an Accuracy, or one of coarse, fast, balanced, tight; write Accuracy.of",
        ),
        ({"until": "soon"}, "until: 'soon'; a positive time in s"),
        ({"until": -1.0}, "until: -1.0; a positive time in s"),
        ({"samples": 1.5}, "samples: 1.5; a whole number, at least 1"),
        ({"samples": float("inf")}, "samples: inf; a whole number, at least 1"),
        ({"unti": 0.1}, "simulate: unknown keyword 'unti'; allowed are until, accuracy, samples, estimate,"),
        ({"unti": 0.1}, "did you mean 'until'?"),
        ({"acuracy": "fast"}, "did you mean 'accuracy'?"),
        ({"tolerance": 1e-3}, "write accuracy=Accuracy.of(...) for a tolerance"),
        ({"tolerence": 1e-3}, "write accuracy=Accuracy.of(...) for a tolerance"),
        ({"fall_back": None}, "did you mean 'fallback'?"),
    ],
    ids=lambda value: str(value) if isinstance(value, dict) else "",
)
def test_settings_of_a_run_are_checked(options: dict[str, Any], words: str) -> None:
    with pytest.raises(SimulationError) as refused:
        simulate(scene_of("bouncing_ball"), **options)
    assert words in str(refused.value)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: read(3), "read: the argument is of type int; it takes a path, as str or Path"),  # type: ignore[arg-type]
        (lambda: Library.load(3), "Library.load: the argument is of type int"),  # type: ignore[arg-type]
        (lambda: load(3), "load: the argument is of type int"),  # type: ignore[arg-type]
        (
            lambda: save(simulate(scene_of("bouncing_ball"), until=0.1), "run.npz"),  # type: ignore[arg-type]
            "save: the argument is of type Trajectory; it takes a Record; "
            "write save(record_of(trajectory, library), ...)",
        ),
        (lambda: draw(3, "run.svg"), "draw: the argument is of type int; it takes a Record"),  # type: ignore[arg-type]
    ],
    ids=["read", "library", "load", "save", "draw"],
)
def test_what_is_no_path_or_no_record_is_refused(call: Callable[[], Any], words: str) -> None:
    with pytest.raises(ModelgenError) as refused:
        call()
    assert str(refused.value).startswith(words)


def test_a_library_is_loaded_from_a_folder_given_as_text() -> None:
    library = scene_of("bouncing_ball")
    assert Library.load(str(library.path.parent)).path == library.path


def test_a_tolerance_is_checked() -> None:
    with pytest.raises(SimulationError, match="tolerance: 'fine'; a number from 1e-18 to 1e-2"):
        Accuracy.of("fine")  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("run", "key"),
    [
        (RunSettings(tolerance=7.0), "tolerance"),
        (RunSettings(accuracy="tigt"), "accuracy"),
        (RunSettings(until=-1.0), "until"),
        (RunSettings(samples=0), "samples"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_a_setting_of_the_scene_is_named_by_file_and_key(run: RunSettings, key: str) -> None:
    with pytest.raises(SimulationError) as refused:
        simulate(library_of(replace(ball(), run=run)))
    assert refused.value.where == f"bouncing_ball.toml: run.{key}"


def test_a_run_is_saved_loaded_and_drawn(tmp_path: Path) -> None:
    library = scene_of("bouncing_ball")
    run = record_of(simulate(library, until=0.1, samples=5), library)
    save(run, str(tmp_path / "run.npz"))
    again = load(str(tmp_path / "run.npz"))
    assert again.summary == run.summary
    draw(again, str(tmp_path / "run.svg"))
    assert (tmp_path / "run.svg").read_text().lstrip().startswith("<?xml")


def test_runs_are_represented_without_their_arrays() -> None:
    library = scene_of("bouncing_ball")
    path = simulate(library, until=0.5, samples=4)
    what = "bouncing_ball: done at t = 0.5 s; samples: 5"
    assert repr(path) == f"<Trajectory {what}, events: {len(path.events)}>"
    assert repr(record_of(path, library)) == f"<Record {what}>"
