"""The reference says how far it can be trusted, and where prediction ends."""

from __future__ import annotations

import pytest

from modelgen import measure, read, tune
from modelgen.benchmark.reference_solution import APART, PREDICTABLE, ROUNDING, SENSITIVE, reference_of
from modelgen.benchmark.scene_under_measurement import Subject
from modelgen.errors import ModelgenError
from modelgen.scene.read import read_text
from modelgen.scene.run_choices import COMPILED_SOLVERS
from tests.running import SCENES, folder

BILLIARD = """
[run]
until = 20.0
samples = 200

[[body]]
name = "ball"
density = 100.0
shape = { kind = "sphere", radius = 0.1 }
position = [0.5, 0.1, 0.3]
velocity = [-1.0, 0.7, 0.2]

[[body]]
name = "room"
motion = "fixed"
shape = { kind = "sphere", radius = 1.0, cavity = true }

[[body]]
name = "post"
motion = "fixed"
shape = { kind = "sphere", radius = 0.3 }
position = [0.0, 0.1, -0.2]

[[contact]]
between = ["ball", "room"]
restitution = 1.0

[[contact]]
between = ["ball", "post"]
restitution = 1.0
"""

pytestmark = pytest.mark.usefixtures("hasty")


def subject(name: str, until: float, samples: int = 20) -> Subject:
    return Subject(read(SCENES / f"{name}.toml"), until, samples, folder())


def test_two_forms_agree_to_the_rounding_that_motions_are_compared_in() -> None:
    egg = subject("ellipsoid_on_plane", 0.5)
    reference = reference_of(egg, egg.space())
    assert reference.made_by[0].startswith("support, long double")
    assert reference.made_by[1].startswith("implicit, long double")
    assert ROUNDING <= reference.error < 1e-14
    assert reference.horizon is None
    assert 1 < reference.growth < 1e4


def test_a_scene_that_ends_early_is_measured_up_to_there() -> None:
    sliding = subject("user_surface", 0.05, 5)
    reference = reference_of(sliding, sliding.space())
    assert reference.end == pytest.approx(0.05)
    assert reference.ending == ""


@pytest.mark.slow
def test_a_billiard_is_predicted_up_to_a_horizon_and_judged_by_distributions_beyond() -> None:
    found = measure(read_text(BILLIARD, "billiard.toml"), knobs=["tolerance"], root=folder())
    horizon, until = found.reference["horizon"], found.subject.until
    assert 0.3 * until < horizon < until
    assert found.reference["reason"] in (SENSITIVE, APART)
    assert found.reference["growth"] * ROUNDING <= PREDICTABLE
    best = found.front[-1]
    assert best.error is not None
    assert best.error < 1e-2
    assert set(best.errors["beyond"]) == {"positions", "speeds", "momentum"}
    assert best.errors["energy"] < 1e-9


@pytest.mark.slow
def test_an_error_is_promised_up_to_the_horizon_only() -> None:
    scene = read_text(BILLIARD, "billiard.toml")
    with pytest.raises(ModelgenError, match="an error can be promised up to") as refused:
        tune(scene, error=1e-3, knobs=["tolerance"], root=folder())
    assert "--until" in refused.value.remedy
    early = tune(scene, error=1e-6, until=3.0, knobs=["tolerance"], root=folder())
    assert early.point.error is not None
    assert early.point.error <= 1e-6
    assert early.run.tolerance == early.point.settings["tolerance"]


@pytest.mark.parametrize("name", ["sphere_slide_to_roll", "bouncing_ball"])
def test_a_subject_has_an_accuracy_with_every_solver_that_is_tried(name: str) -> None:
    solvers = COMPILED_SOLVERS if name == "sphere_slide_to_roll" else COMPILED_SOLVERS[:1]
    for solver in solvers:
        settings = {"method": "time-stepping", "step": 0.01, "scheme": "moreau", "solver": solver}
        assert subject(name, 0.1).accuracy(settings).solver == solver
