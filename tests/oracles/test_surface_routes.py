"""Shipped scenes with charts, caps and cells against routes that know neither."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from modelgen import Accuracy, read
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene.free_form_values import Net
from modelgen.scene.scene_types import Shape
from tests.oracles.pieces import G, rotations
from tests.oracles.stationary_route import Gap, StationaryRoute
from tests.oracles.surface_routes import ellipsoid_on_patch, pebble_on_plane
from tests.running import SCENES, run, scene_of

UNTIL = 2.0


def body_of(name: str) -> dict[str, Any]:
    """The instance of a scene's second body."""
    body: dict[str, Any] = scene_of(name).manifest.instance["bodies"][1]
    return body


def shapes_of(name: str) -> list[Shape]:
    """The shapes of the two bodies."""
    return [body.shapes[0] for body in read(SCENES / f"{name}.toml").bodies]


def compared(name: str, gap: Gap, guess: list[float]) -> tuple[float, float, int]:
    """Largest differences of position and rotation matrix from the second route; the number of walks."""
    path = run(name, Accuracy.tight(), until=UNTIL, samples=40)
    inverse = body_of(name)["mass_inverse"]
    route = StationaryRoute(gap, 1 / inverse[0], np.linalg.inv(np.reshape(inverse[1:], (3, 3))))
    turned = rotations(path, 1)
    spin = turned[0].T @ path.w[0, 1]
    found = route.run(path.p[0, 1], path.quaternion[0, 1], path.v[0, 1], spin, np.array(guess), path.t).y
    position = np.abs(path.p[:, 1] - found[:3].T).max()
    e = path.quaternion[:, 1]
    away = np.minimum(np.abs(e - found[3:7].T).max(axis=1), np.abs(e + found[3:7].T).max(axis=1)).max()
    return float(position), float(away), walks(path)


def walks(path: Trajectory) -> int:
    return sum(event.kind == "feature-change" for event in path.events)


@pytest.mark.slow
def test_a_pebble_that_passes_its_poles_follows_a_second_route() -> None:
    _, pebble = shapes_of("bean_with_poles")
    centre = np.array(body_of("bean_with_poles")["centre_of_mass"])
    gap = pebble_on_plane(dict(pebble.parameters), centre)
    position, rotation, changes = compared("bean_with_poles", gap, [-1.5, 0.0])
    assert changes >= 2
    assert position < 1e-11
    assert rotation < 1e-9


@pytest.mark.slow
def test_an_egg_that_crosses_knots_follows_a_second_route() -> None:
    bowl, egg = shapes_of("egg_on_spline")
    assert isinstance(bowl.spline, Net)
    gap = ellipsoid_on_patch(np.array([axis for _, axis in egg.parameters]), bowl.spline)
    position, rotation, changes = compared("egg_on_spline", gap, [3.5, 3.0])
    assert changes >= 5
    assert position < 1e-10
    assert rotation < 1e-9


@pytest.mark.parametrize("form", ["centre_surface", "implicit", "mixed"])
def test_a_ball_in_a_torus_is_a_particle_on_a_torus(form: str) -> None:
    """rho psi'' = -(r phi'^2 sin psi + g cos psi) with r = major + rho cos psi, and h = r^2 phi' is kept."""
    path = run("ball_in_torus", Accuracy.tight(), form, until=UNTIL, samples=40)
    major, rho = 0.3, 0.06
    h = (major + rho) * 0.8

    def motion(_: float, x: np.ndarray) -> list[float]:
        psi, rate, _ = x
        r = major + rho * np.cos(psi)
        return [rate, -(h**2 / r**3) * np.sin(psi) / rho - G / rho * np.cos(psi), h / r**2]

    start = [0.0, 3.5 / rho, 0.0]
    psi, _, phi = solve_ivp(motion, (0, UNTIL), start, "DOP853", path.t, rtol=1e-13, atol=1e-13).y
    r = major + rho * np.cos(psi)
    exact = np.stack([r * np.cos(phi), r * np.sin(phi), rho * np.sin(psi)], axis=-1)
    assert np.abs(path.p[:, 1] - exact).max() < 1e-9
