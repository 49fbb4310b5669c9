"""The reference of the rolling ellipsoid: what it conserves, and a second formulation."""

from __future__ import annotations

import numpy as np
import pytest

from tests.oracles.friction.lagrange_route import LagrangeRoute, ellipsoid_support
from tests.oracles.friction.rolling_ellipsoid import SEMI_AXES, Rolled, body, reference

TIMES = np.linspace(0, 5, 11)


@pytest.fixture(scope="module")
def rolled() -> Rolled:
    return reference(TIMES)


@pytest.mark.slow
def test_energy_is_kept_and_the_contact_neither_slips_nor_opens(rolled: Rolled) -> None:
    assert np.abs((rolled.energy - rolled.energy[0]) / rolled.kinetic[0]).max() < 1e-14
    lever = np.array([R.T[:, 2] for R in rolled.R])
    axes = np.array(SEMI_AXES)
    point = -(axes**2 * lever) / np.linalg.norm((axes * lever).astype(float), axis=1)[:, None]
    arm = np.einsum("nij,nj->ni", rolled.R, point)
    assert np.abs(rolled.v + np.cross(rolled.w, arm)).max() < 1e-14
    assert np.abs(rolled.p[:, 2] + arm[:, 2]).max() < 1e-14
    assert (rolled.force[:, 2] > 0).all()
    # so far inside the cone that it never slips with mu = 1
    assert (np.hypot(rolled.force[:, 0], rolled.force[:, 1]) / rolled.force[:, 2]).max() < 0.5


def test_the_start_is_the_scene() -> None:
    begin = reference([0.0])
    assert begin.w[0] == pytest.approx([0, 0, 6], abs=1e-18)
    # the height is the support of the ellipsoid, the speed that of a lever about the point at rest
    assert float(begin.p[0, 2]) == pytest.approx(np.hypot(0.05 * np.cos(0.3), 0.07 * np.sin(0.3)), rel=1e-15)
    lever = (0.07**2 - 0.05**2) * np.sin(0.3) * np.cos(0.3) / begin.p[0, 2]
    assert np.linalg.norm(begin.v[0].astype(float)) == pytest.approx(6 * float(lever), rel=1e-14)
    assert float(begin.kinetic[0]) == pytest.approx(0.08200542090368218, rel=1e-12)


@pytest.mark.slow
def test_lagranges_equations_roll_the_same_way(rolled: Rolled) -> None:
    ellipsoid = body()
    route = LagrangeRoute(ellipsoid_support(SEMI_AXES), float(ellipsoid.mass), ellipsoid.inertia)
    p, R, w, _ = route.run(*route.start(rolled.R[0], rolled.w[0]), TIMES[:5])
    assert np.abs(p - rolled.p[:5]).max() < 1e-12
    assert np.abs(R - rolled.R[:5]).max() < 1e-10
    assert np.abs(w - rolled.w[:5]).max() < 1e-9


@pytest.mark.slow
def test_the_reference_has_converged(rolled: Rolled) -> None:
    coarse = reference(TIMES[:5], tolerance=1e-14)
    assert np.abs(coarse.p - rolled.p[:5]).max() < 1e-13
