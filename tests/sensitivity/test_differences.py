"""Derivatives of runs equal differences of runs, through contacts that strike, stick, slip and change."""

from __future__ import annotations

import numpy as np
import pytest

from modelgen import sensitivity, start
from modelgen.codegen.library import Library
from modelgen.runtime.sensitivity import Sensitivity
from modelgen.scene.read import read_text
from tests.running import NAMES
from tests.sensitivity.differences import by_differences, differentiable, shipped
from tests.stories.test_parameters import NUMBERS, with_parameter

AGREE = 1e-8  # relative to the derivative; differences of runs resolve about that


def moving(library: Library) -> list[str]:
    return [
        body["name"] for body in library.manifest.instance["bodies"] if body["motion"] in ("free", "point")
    ]


def places(library: Library) -> tuple[list[str], list[int]]:
    """What is differentiated, and where it stands in the state."""
    n_q, bodies = library.manifest.instance["n_q"], library.manifest.instance["bodies"]
    entries = [body for body in bodies if body["motion"] in ("free", "point")]
    of = [f"{body['name']}.{quantity}" for quantity in ("position", "velocity") for body in entries]
    first = [body["q"] for body in entries] + [n_q + body["u"] for body in entries]
    return of, [at + k for at in first for k in range(3)]


def is_held(library: Library) -> bool:
    """Whether contacts or joints hold bodies at the start."""
    simulation = start(library)
    return bool(simulation.session.joints or np.any(simulation.session.closed))


def assert_differences(library: Library, name: str, times: list[float]) -> Sensitivity:
    """Derivatives that are called certain agree with differences."""
    of, at = places(library)
    found = sensitivity(library, times, of=of, by=[name], accuracy="tight")
    for index, t in enumerate(times):
        if not found.verdicts[index]:
            continue
        for column, difference in enumerate(by_differences(library, name, t)):
            exact = difference.value[at]
            bound = AGREE * np.max(np.abs(exact)) + 3 * difference.noise + 1e-10
            assert np.max(np.abs(found.jacobian[index, :, column] - exact)) <= bound
    return found


@pytest.mark.cases(2)
@pytest.mark.parametrize("case", [case for case in NUMBERS if case not in ("end of the run", "radius")])
def test_by_numbers_of_a_scene(case: str) -> None:
    """Masses, inertia, shapes, places, friction, restitution, springs, joints, gravity."""
    assert_differences(differentiable(read_text(with_parameter(case), "scene.toml")), "number", [0.06, 0.3])


@pytest.mark.cases(1)
@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("quantity", ["velocity", "position", "angular_velocity"])
def test_by_starts_of_a_shipped_scene(name: str, quantity: str) -> None:
    library = shipped(name)
    body = moving(library)[0]
    entry = next(each for each in library.manifest.instance["bodies"] if each["name"] == body)
    if quantity == "angular_velocity" and entry["motion"] == "point":
        pytest.skip("a point mass does not turn")
    if quantity == "position" and is_held(library):
        pytest.skip("a finite change of the place leaves the constraints")
    until = float(library.manifest.instance["run"].get("until") or 1.0)
    assert_differences(library, f"{body}.{quantity}", [0.1 * until, 0.4 * until])


@pytest.mark.cases(1)
@pytest.mark.parametrize(
    "name", ["double_pendulum", pytest.param("egg_on_spline", marks=pytest.mark.slow), "newton_cradle"]
)
def test_through_blows(name: str) -> None:
    """Joint limits, frictionless blows of an egg, a chain of balls."""
    library = shipped(name)
    found = assert_differences(library, f"{moving(library)[0]}.velocity", [0.9])
    assert found.verdict
    assert found.events


def test_steps_towards_the_end_of_slip_change_no_derivative() -> None:
    """A sample at any time before it ends, at 1.02517 s, makes the steps that lead to it others."""
    library, of = shipped("tippe_top"), ["top.position", "top.velocity", "top.angular_velocity"]
    samples = np.random.default_rng(5).uniform(1.0, 1.02517, 12)
    after = np.array(
        [
            sensitivity(library, [t, 1.1], of=of, by=["top.angular_velocity"], accuracy="tight").jacobian[-1]
            for t in samples
        ]
    )
    assert np.ptp(after, axis=0).max() < 1e-9 * np.abs(after).max()
