"""`--to browser`: the page runs the scene as `simulate` does, and obeys its sliders."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from modelgen import derive, require, simulate
from modelgen.cli.command_group import app
from modelgen.codegen.library import Library
from modelgen.errors import ModelgenError
from modelgen.export import browser_page
from modelgen.export.export_formats import Choices, export
from modelgen.export.numbers_by_parameters import arrays_of, numbers_of, sliders_of
from modelgen.runtime.accuracy import Accuracy
from modelgen.runtime.arguments import with_parameters
from modelgen.runtime.core_session import Session
from modelgen.scene.read import read_text
from tests.export.folders import needs_zig
from tests.running import SCENES, library_of
from tests.view.browser import Browser, browser, needs_browser

LIFTED = """
[run]
until = 1.5

[[parameter]]
name = "radius"
value = 0.1
minimum = 0.08
maximum = 0.2
unit = "m"

[[input]]
name = "height"
hold = "linear"
minimum = -0.1
maximum = 0.1

[[body]]
name = "lift"
motion = "driven"
shape = { kind = "plane" }
path = { position = ["0.0", "0.0", "height"] }

[[body]]
name = "egg"
shape = { kind = "ellipsoid", semi_axes = ["radius", "0.8*radius", 0.07] }
density = 1000.0
position = [0.0, 0.0, 0.25]
angular_velocity = [1.0, 2.0, 0.0]

[[contact]]
between = ["egg", "lift"]
restitution = 0.3
friction = 0.3
"""


@pytest.fixture(scope="module")
def lifted() -> Library:
    return library_of(read_text(LIFTED, "lifted.toml"))


def test_numbers_are_those_of_a_scene_with_these_values(lifted: Library) -> None:
    accuracy = Accuracy.balanced()
    (slider,) = sliders_of({"radius": (0.1, 0.08, 0.2)})
    assert 0.1 in slider.values
    assert slider.values[0] == 0.08
    assert slider.values[-1] == 0.2
    seen: list[float] = []
    numbers = numbers_of(lifted, accuracy, [slider], lambda _, given: seen.append(given["radius"]))
    assert seen == list(slider.values)
    for row, value in list(zip(numbers.table, slider.values, strict=True))[::8]:
        tables, of_run = arrays_of(Session(with_parameters(lifted, {"radius": value}), accuracy))
        arrays = [*tables, *(each.start for each in of_run)]
        found = [arrays[k].ravel()[i] for k, i in numbers.entries.tolist()]
        assert np.array_equal(found, row)
    assert len({tuple(row) for row in numbers.table.tolist()}) == len(slider.values)


def test_sliders_that_cannot_be_are_refused(lifted: Library) -> None:
    with pytest.raises(ModelgenError, match="--set NAME=VALUE"):
        sliders_of({f"p{k}": (0.0, -1.0, 1.0) for k in range(5)})
    with pytest.raises(ModelgenError, match=r"slider at radius = 0\.3.*minimum"):
        numbers_of(lifted, Accuracy.balanced(), sliders_of({"radius": (0.1, 0.3, 0.4)}), lambda *_: None)


def test_what_a_page_needs_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(browser_page.importlib.util, "find_spec", lambda name: None)
    scene = str(SCENES / "bouncing_ball.toml")
    done = CliRunner().invoke(app, ["export", scene, "--to", "browser", "--out", "ball.html"])
    assert done.exit_code == 2
    assert "modelgen-contact[compiler]" in re.sub(r"\s", "", done.output)
    for out in ("ball.png", "nowhere/ball.html"):
        assert CliRunner().invoke(app, ["export", scene, "--to", "browser", "--out", out]).exit_code == 2


def run_to_its_end(driven: Browser) -> tuple[np.ndarray, np.ndarray]:
    """Times and positions (n, bodies, 3) of the run of the page."""
    driven.until("run !== null && times.length > 0")
    driven.value("(() => { while (run.goesOn()) run.goTo(1e9); })()")
    t = np.array(driven.value("Array.from(run.column.t.subarray(0, times.length))"))
    poses = driven.value("Array.from(run.column.pose.subarray(0, 12 * data.bodies.length * times.length))")
    return t, np.array(poses).reshape(len(t), -1, 12)[..., :3]


def move(driven: Browser, name: str, value: float) -> None:
    """Set a slider of the page as a hand does."""
    driven.value(
        f"(() => {{ const box = document.querySelector('[data-name={name}]');"
        f" box.value = {value!r}; box.dispatchEvent(new Event('input')); }})()"
    )


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("page")
    derivation = derive(require(read_text(LIFTED, "lifted.toml")))
    export(derivation, "browser", folder / "lifted.html", folder / "built", Choices())
    return folder / "lifted.html"


@pytest.fixture
def driven(tmp_path: Path) -> Iterator[Browser]:
    with browser(tmp_path) as opened:
        yield opened


@needs_zig
@needs_browser
@pytest.mark.slow
def test_the_page_runs_the_scene_as_simulate_does(page: Path, lifted: Library, driven: Browser) -> None:
    driven.open(f"file://{page}")
    t, places = run_to_its_end(driven)
    alone = simulate(lifted, samples=len(t) - 1)
    assert np.array_equal(t, alone.t)
    assert np.array_equal(places, alone.p)
    events = driven.value("data.events.map(each => [each.t, each.kind, each.contact])")
    assert [tuple(each) for each in events] == [(each.t, each.kind, each.contact) for each in alone.events]
    move(driven, "radius", 30.0)
    value = driven.value("data.run.parameters[0].values[30]")
    t, places = run_to_its_end(driven)
    alone = simulate(lifted, samples=len(t) - 1, parameters={"radius": value})
    assert np.array_equal(places, alone.p)
    assert not driven.serious
    assert {request.split(":")[0] for request in driven.requests} <= {"file", "about"}


@needs_zig
@needs_browser
@pytest.mark.slow
def test_a_hand_steers_the_run_of_the_page(page: Path, driven: Browser) -> None:
    driven.open(f"file://{page}#t=0.02")
    driven.until("run !== null && times.length > 0 && asked === null && !playing")
    assert driven.value("run.goesOn()")
    driven.settle()
    before = driven.shot()[90:640, 20:880]
    assert np.ptp(before, axis=(0, 1)).min() > 100  # more than the background
    move(driven, "height", 0.08)
    driven.until("!run.goesOn()")
    driven.settle()
    after = driven.shot()[90:640, 20:880]
    assert (np.abs(before - after).max(axis=2) > 40).mean() > 0.01
    assert driven.value("run.core.page_input(0)") == pytest.approx(0.08, abs=1e-12)
    lift = driven.value("run.column.pose[12 * data.bodies.length * (times.length - 1) + 2]")
    assert lift == pytest.approx(0.08, abs=1e-12)
    driven.value("document.getElementById('reset').click()")
    assert driven.value("run.reached()") < 1.5
    assert not driven.serious
