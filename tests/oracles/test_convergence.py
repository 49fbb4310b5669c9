"""The knobs of Accuracy: orders, tolerances, and what is left when a correction is switched off."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from modelgen import Accuracy
from tests.oracles.pieces import G
from tests.running import run

TIGHT = Accuracy.tight()
LIFT = 0.40763991317884796  # of the pebble, by the second route


def error(accuracy: Accuracy, exact: np.ndarray) -> float:
    return float(np.abs(run("ellipsoid_on_plane", accuracy, until=0.5, samples=1).p[-1, 1] - exact).max())


@pytest.fixture(scope="module")
def exact() -> np.ndarray:
    return run("ellipsoid_on_plane", TIGHT, until=0.5, samples=1).p[-1, 1]


@pytest.mark.parametrize("newton", [0, 1, 2])
def test_runge_kutta_converges_with_order_four(exact: np.ndarray, newton: int) -> None:
    steps = 0.5 / np.array([50, 100, 200, 400])
    errors = [error(replace(TIGHT.fixed_step(h), newton=newton), exact) for h in steps]
    assert np.polyfit(np.log(steps), np.log(errors), 1)[0] == pytest.approx(4, abs=0.35)


def test_runge_kutta_records_dense_samples_with_order_four() -> None:
    fine = run("ellipsoid_on_plane", TIGHT, until=0.5, samples=37).p[:, 1]
    steps = 0.5 / np.array([50, 100, 200])
    errors = [
        np.abs(run("ellipsoid_on_plane", TIGHT.fixed_step(h), until=0.5, samples=37).p[:, 1] - fine).max()
        for h in steps
    ]
    assert np.polyfit(np.log(steps), np.log(errors), 1)[0] == pytest.approx(4, abs=0.35)


def test_errors_fall_with_the_tolerance() -> None:
    exact = run("ellipsoid_on_plane", TIGHT, until=1.0, samples=20).w
    tolerances = 10.0 ** -np.arange(3, 12)
    seen = [
        run("ellipsoid_on_plane", replace(TIGHT, tolerance=float(tol)), until=1.0, samples=20).w
        for tol in tolerances
    ]
    errors = np.array([np.abs(w - exact).max() for w in seen])
    assert (errors[1:] < errors[:-1]).all()
    assert np.polyfit(np.log(tolerances), np.log(errors), 1)[0] == pytest.approx(1, abs=0.15)


def test_event_times_converge_with_the_tolerance_and_with_the_step() -> None:
    def late(accuracy: Accuracy) -> float:
        path = run("ellipsoid_on_ellipsoid", accuracy)
        return abs(next(event.t for event in path.events if event.kind == "lift-off") - LIFT)

    adaptive = [late(replace(TIGHT, tolerance=tol)) for tol in (1e-5, 1e-8, 1e-11)]
    assert adaptive[0] < 1e-3
    assert adaptive[1] < 1e-6
    assert adaptive[2] < 1e-9
    steps = np.array([4e-3, 2e-3, 1e-3])
    fixed = [late(TIGHT.fixed_step(float(h))) for h in steps]
    assert np.polyfit(np.log(steps), np.log(fixed), 1)[0] == pytest.approx(4, abs=0.7)


@pytest.mark.parametrize("newton", [0, 1, 2])
def test_corrections_of_contact_points_change_nothing_in_the_limit(newton: int) -> None:
    plain = run("ellipsoid_in_cavity", TIGHT, until=1.0, samples=10)
    other = run("ellipsoid_in_cavity", replace(TIGHT, newton=newton), until=1.0, samples=10)
    assert np.abs(plain.p - other.p).max() < 1e-9
    assert np.abs(plain.force - other.force).max() < 1e-6


def test_projection_holds_the_gap_that_drifts_without_it() -> None:
    gaps = {
        n: run("ellipsoid_in_cavity", replace(Accuracy.of(1e-8), project=n), until=3.0).gap_max
        for n in (0, 1, 10)
    }
    assert gaps[1] < 1e-15
    assert gaps[1] < gaps[10] < gaps[0] < 1e-5


def test_without_gamma_the_force_of_a_turning_ball_lacks_what_bends_its_path() -> None:
    path = run("ball_in_bowl", replace(TIGHT, use_gamma=False), until=0.05, samples=10)
    cosine = -path.p[:, 1, 2] / np.linalg.norm(path.p[:, 1], axis=1)
    assert np.abs(path.force[:, 0] - G * cosine).max() < 1e-9
    whole = run("ball_in_bowl", TIGHT, until=0.05, samples=10)
    speed = np.linalg.norm(whole.v[:, 1], axis=1)
    cosine = -whole.p[:, 1, 2] / 0.02
    assert np.abs(whole.force[:, 0] - G * cosine - speed**2 / 0.02).max() < 1e-8
