"""Fits find the numbers with which a motion was made, and say how well they are known."""

from __future__ import annotations

import numpy as np
import pytest

from modelgen import fit, sensitivity
from modelgen.errors import SimulationError
from modelgen.identification.compared_columns import comparison_of
from modelgen.identification.least_squares import Problem
from modelgen.identification.measurement_noise import noise_of
from modelgen.identification.recording_residuals import RecordedRun, RecordedRuns
from modelgen.identification.recording_starts import start_of
from modelgen.identification.recordings import recording_of
from modelgen.identification.unknowns import unknowns_of
from modelgen.runtime.accuracy import Accuracy
from tests.identification.motions import BOUNCE, MOTIONS, RATIO, Motion, library_of_text

HEIGHT = """
[[parameter]]
name = "height"
value = 0.35
minimum = 0.0
maximum = 1.0

"""
STARTS = ["ball.position", "ball.orientation", "ball.velocity", "ball.angular_velocity"]


@pytest.mark.cases(1)
@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("name", MOTIONS)
def test_a_fit_from_another_guess_finds_the_truth(name: str, seed: int) -> None:
    motion = MOTIONS[name]
    found = fit(motion.library, motion.recording(), by=motion.by, parameters=motion.near_guess(seed))
    assert found.converged
    assert found.values == pytest.approx(motion.true_values, rel=1e-4)


def test_friction_is_found_from_where_every_contact_sticks() -> None:
    motion = MOTIONS["bounce"]
    found = fit(motion.library, motion.recording(), by=motion.by, parameters={"friction": 0.49})
    assert found.values == pytest.approx(motion.true_values, rel=1e-4)


@pytest.mark.cases(1)
@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("name", MOTIONS)
def test_the_truth_lies_within_twice_the_interval(name: str, seed: int) -> None:
    """Which has less than 1e-4 of normal deviations outside: a failure is no chance."""
    motion = MOTIONS[name]
    found = fit(motion.library, motion.recording(seed), by=motion.by)
    apart = np.abs(found.values - motion.true_values)
    assert np.all(apart < 2 * found.confidence.half_width)
    for group, size in motion.noise.items():
        assert found.noise[group] == pytest.approx(size, rel=5 / np.sqrt(2 * motion.rows))


def problem_of(motion: Motion, by: list[str]) -> tuple[RecordedRuns, Problem]:
    recording = recording_of(motion.recording(), "recording")
    unknowns = unknowns_of(motion.library.manifest.instance, by, 1, {})
    begin, own = start_of(motion.library, recording, [u for u in unknowns if u.recording == 0], [])
    common = [u for u in unknowns if u.recording < 0]
    parts = tuple(range(len(common), len(common) + len(own)))
    comparison = comparison_of(motion.library.manifest.instance, recording)
    run = RecordedRun(recording, comparison, begin, parts)
    runs = RecordedRuns(motion.library, Accuracy.tight(), [run], [*common, *own], {})
    return runs, Problem(runs, noise_of([run], None))


def test_derivatives_are_those_of_the_deviations() -> None:
    """Against differences of runs: parameters, and all numbers of a start away from the first guess."""
    both = ("ball.position", "ball.orientation")
    motion = Motion(BOUNCE, both, {}, ("friction", "restitution"), 0.6)
    runs, problem = problem_of(motion, [*motion.by, *STARTS])
    x = np.array([each.first for each in runs.unknowns])
    turns = [k for k, each in enumerate(runs.unknowns) if each.direction.quantity == "orientation"]
    x[turns] = 0.3, -0.2, 0.4
    exact = problem.jacobian(x)
    step = 1e-6
    for k in range(len(x)):
        moved = [x + sign * step * np.eye(len(x))[k] for sign in (1, -1)]
        difference = (problem.residual(moved[0]) - problem.residual(moved[1])) / (2 * step)
        assert exact[:, k] == pytest.approx(difference, abs=1e-4 * max(1.0, np.abs(difference).max()))


def test_starts_of_several_recordings_are_fitted_each() -> None:
    motion = MOTIONS["bounce"]
    recordings = []
    speeds = (0.8, 1.4)
    for speed in speeds:
        text = motion.text.replace("velocity = [1.0, 0.2, 0.0]", f"velocity = [{speed}, 0.2, 0.0]")
        found = sensitivity(library_of_text(text), motion.t, of=["ball.position"], by=["friction"])
        noise = 1e-3 * np.random.default_rng(int(10 * speed)).normal(size=found.value.shape)
        recordings.append({"t": motion.t, "ball.position": found.value + noise})
    found_fit = fit(motion.library, recordings, by=["restitution", "ball.velocity_x", "ball.velocity_y"])
    for k, speed in enumerate(speeds):
        name = f"ball.velocity_x of recording {k + 1}"
        low, high = found_fit.interval(name)
        assert abs(found_fit[name] - speed) < high - low
        assert found_fit.starts[k]["ball.velocity"][0] == found_fit[name]
    assert found_fit["restitution"] == pytest.approx(0.7, abs=0.01)


def test_a_start_is_taken_from_the_first_rows_or_as_given() -> None:
    motion = MOTIONS["bounce"]
    text = motion.text.replace("velocity = [1.0, 0.2, 0.0]", "velocity = [0.3, -0.5, 1.0]")
    other = library_of_text(text)
    columns = motion.recording()
    shown = fit(other, columns, by=["restitution"], start=["ball"])
    assert shown.starts[0]["ball.velocity"] == pytest.approx([1.0, 0.2, 0.0], abs=1e-6)
    given = fit(other, {**columns, "start": {"ball.velocity": [1.0, 0.2, 0.0]}}, by=["restitution"])
    assert given["restitution"] == pytest.approx(0.7, abs=1e-6)


def test_only_the_ratio_of_mass_and_stiffness_is_seen() -> None:
    motion = Motion(RATIO, ("block.position",), {"block.position": 1e-3}, ("mass", "stiffness"), 1.0)
    found = fit(motion.library, motion.recording(1), by=motion.by, parameters={"stiffness": 80.0})
    assert found.unseen == ("only the ratio of mass and stiffness is seen",)
    assert np.all(np.isinf(found.confidence.deviation))
    assert found["stiffness"] / found["mass"] == pytest.approx(25.0, rel=0.01)


@pytest.mark.cases(1)
@pytest.mark.parametrize("loss", ["huber", "soft_l1", "cauchy"])
def test_outliers_count_less_with_a_robust_loss(loss: str) -> None:
    motion = MOTIONS["bounce"]
    columns = motion.recording(3)
    columns["ball.position_z"][10:60:10] += 0.3
    plain, robust = (fit(motion.library, columns, by=["restitution"], loss=each) for each in ("linear", loss))
    assert abs(robust["restitution"] - 0.7) < 2 * robust.confidence.half_width[0]
    assert abs(robust["restitution"] - 0.7) < abs(plain["restitution"] - 0.7) / 4


def test_given_noise_that_deviations_exceed_widens_the_intervals() -> None:
    motion = MOTIONS["bounce"]
    columns, by = motion.recording(5), ["restitution"]
    estimated = fit(motion.library, columns, by=by)
    size = {name: 0.05 * each for name, each in motion.noise.items()}
    said = fit(motion.library, columns, by=by, noise=size)
    assert said.confidence.reduced == pytest.approx(400, rel=0.3)
    assert any("times the noise" in note for note in said.notes)
    assert said.confidence.half_width == pytest.approx(estimated.confidence.half_width, rel=0.2)
    more = fit(motion.library, columns, by=by, noise={name: 20 * each for name, each in motion.noise.items()})
    assert more.confidence.half_width[0] == pytest.approx(20 * estimated.confidence.half_width[0], rel=0.3)


def test_other_first_guesses_are_tried_where_one_has_no_run() -> None:
    """A ball whose start is in the floor for every height below its radius."""
    text = BOUNCE.replace("position = [0.0, 0.0, 0.35]", 'position = [0.0, 0.0, "height"]')
    text = text.replace("[[body]]", HEIGHT + "[[body]]", 1)
    motion = Motion(text, ("ball.position",), {"ball.position": 1e-3}, ("height",), 0.5, 20)
    bad = {"height": 0.01}
    with pytest.raises(SimulationError, match="interpenetrate"):
        fit(motion.library, motion.recording(), by=motion.by, parameters=bad)
    found = fit(motion.library, motion.recording(), by=motion.by, parameters=bad, starts=4, seed=1)
    assert len(found.attempts) == 4
    assert np.isinf(found.attempts[0].cost)
    assert all(0 <= each.first[0] <= 1 for each in found.attempts)
    assert found["height"] == pytest.approx(0.35, rel=1e-5)


def test_inputs_are_fitted() -> None:
    text = BOUNCE + '\n[[input]]\nname = "wind"\nminimum = -5\nmaximum = 5\n'
    text += '\n[[force]]\nbody = "ball"\nforce = ["wind", "0.0", "0.0"]\n'
    library = library_of_text(text)
    t = np.linspace(0, 0.6, 30)
    shown = sensitivity(library, t, of=["ball.position"], by=["wind"], inputs={"wind": 0.7})
    found = fit(library, {"t": t, "ball.position": shown.value}, by=["wind", "friction"])
    assert found.inputs["wind"] == pytest.approx(0.7, rel=1e-5)
    assert found.parameters["friction"] == pytest.approx(0.1, rel=1e-4)


def test_uncertain_derivatives_are_counted_and_told() -> None:
    """A ball that strikes a wall and the floor at one time: the verdict is undecided from then on."""
    wall = '[[body]]\nname = "wall"\nmotion = "fixed"\nrpy = [0.0, "pi/2", 0.0]\nshape = { kind = "plane" }\n'
    text = BOUNCE.replace("position = [0.0,", "position = [0.35,").replace(
        "[1.0, 0.2, 0.0]", "[-1.0, 0.2, -1.0]"
    )
    text = "gravity = [0.0, 0.0, 0.0]\n" + text + wall + '[[contact]]\nbetween = ["ball", "wall"]\n'
    text += 'restitution = "restitution"\n'
    motion = Motion(text, ("ball.position",), {"ball.position": 1e-3}, ("restitution",), 0.6)
    found = fit(motion.library, motion.recording(1), by=motion.by, parameters={"restitution": 0.6})
    here = found.counts_at_solution
    assert here.certain + here.confirmed + here.differences + here.kept == motion.rows
    assert here.certain < motion.rows
    assert any("derivatives are not certain" in note for note in found.notes)
    assert found["restitution"] == pytest.approx(0.7, abs=1e-2)
