"""Near conforming contact tangential rows lose digits as the normal one does: eps/mu, at given (q, eta)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import mpmath as mp
import numpy as np
import pytest

from modelgen.contact.form_table import ContactKind, contact_kernels
from modelgen.geometry.frames import SEAM
from modelgen.model import ShapeKind, Side
from tests.curves.test_loss import Case, concentric, crossing, focal, rim
from tests.curves.test_loss import margin as margin_of
from tests.explicit.test_loss import DECADES, LOSSES, crossed
from tests.laws.configurations import Array
from tests.laws.precise import evaluate
from tests.laws.test_loss import EPS, FORMS, SEEDS, margin, near_conforming, slope

BALL = ShapeKind("sphere", "sphere", ("radius",))


def relative_error(kind: ContactKind, at: list[Array]) -> float:
    """Of the gamma below the first, in double against 50 digits."""
    rates = contact_kernels(kind).rates
    found, wanted = np.array(rates(*at)[3])[1:, 0], mp.matrix(evaluate(rates, *at)[3][1:])
    return float(mp.norm(mp.matrix(found) - wanted) / mp.norm(wanted))


@pytest.mark.cases(3)
@pytest.mark.parametrize("form", FORMS)
def test_arithmetic_loses_eps_over_mu(form: str) -> None:
    """Down to mu = 1e-8; median of the poses of a decade."""
    margins, errors = [], []
    with mp.workdps(50):
        for fraction in 10.0 ** np.arange(-1, -8.5, -1):
            drawn = [near_conforming(float(fraction), seed, form) for seed in SEEDS]
            margins.append(float(np.median([margin(*case) for case in drawn])))
            errors.append(float(np.median([relative_error(replace(kind, rows=6), at) for kind, at in drawn])))
    assert min(margins) < 1e-8
    assert all(error * mu < 5 * EPS for mu, error in zip(margins, errors, strict=True))
    assert -1.25 < slope(margins, errors) < -0.75


def decades(make: Callable[[float, int], Case], sizes: Array) -> tuple[Array, Array]:
    """Least margins and errors, medians over the seeds."""
    margins, errors = [], []
    with mp.workdps(50):
        for size in sizes:
            cases = [make(float(size), seed) for seed in SEEDS]
            margins.append(np.median([min(mu, 0.7 * flat) for mu, flat in map(margin_of, cases)]))
            errors.append(np.median([relative_error(replace(kind, rows=6), at) for kind, at in cases]))
    return np.array(margins), np.array(errors)


@pytest.mark.cases(5)
@pytest.mark.parametrize("make", [rim, concentric, *LOSSES])
def test_curves_and_centres_lose_eps_over_mu(make: Callable[[float, int], Case]) -> None:
    margins, errors = decades(make, DECADES)
    assert margins.min() < 1e-7
    assert (errors * margins < 10 * EPS).all()


def test_touching_curves_lose_eps_over_the_squared_sine() -> None:
    sizes = 10.0 ** np.arange(-1, -6.1, -1)
    _, errors = decades(lambda sine, seed: crossing(sine, 0.0, seed), sizes)
    assert (errors * sizes**2 < 20 * EPS).all()


def test_curves_parallel_at_a_gap_and_focal_distances_lose_nothing() -> None:
    for make in (lambda sine, seed: crossing(sine, 0.4, seed), focal):
        assert decades(make, 10.0 ** np.arange(-1, -12.5, -1))[1].max() < 1e-13


def test_parallel_edges_at_a_gap_lose_eps_over_mu() -> None:
    """Unlike the normal row, which needs no levers: those of the nearest points run away."""
    margins, errors = decades(partial(crossed, d=0.4), DECADES)
    assert (errors * margins < 10 * EPS).all()


def beside(direction: Array) -> list[Array]:
    """Two balls that touch in a direction, at random velocities."""
    random = np.random.default_rng(3)
    turn = np.eye(3).ravel()
    twists = random.normal(size=(2, 6))
    return [
        np.concatenate([np.zeros(3), turn]), twists[0], np.concatenate([1.5 * direction, turn]), twists[1],
        np.zeros(0), np.array([1.0, 0.5]),
    ]  # fmt: skip


@pytest.mark.parametrize("side", [-1, 1])
@pytest.mark.parametrize("centre", [SEAM, 1.0, -1.0, 0.0])
def test_no_digit_is_lost_where_the_frame_jumps_nor_at_its_poles(centre: float, side: int) -> None:
    """The third component of N by decades on both sides of the seam, of both poles and of the equator."""
    kind = ContactKind("bounding_balls", "explicit", Side(BALL, "free"), Side(BALL, "free"), 6)
    with mp.workdps(50):
        for distance in 10.0 ** np.arange(-1, -18, -2.0):
            height = np.clip(centre + side * distance, -1, 1)
            across = np.sqrt((1 - height) * (1 + height))
            at = beside(np.array([0.6 * across, 0.8 * across, height]))
            assert relative_error(kind, at) < 20 * EPS
