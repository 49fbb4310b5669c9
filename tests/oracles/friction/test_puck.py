"""Faces that slide and spin, stick and tip, against motions in coordinates of their own and closed forms."""

from __future__ import annotations

from math import cos, pi, sin

import numpy as np
import pytest

from modelgen import Accuracy
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Body, Shape
from tests.oracles.friction.puck import G, Puck, disc_with_height, rectangle_with_height, uniform_ring
from tests.oracles.pieces import TABLE, imbalance, ran, times
from tests.running import run

ON_TABLE = ("body", "table")


def flat_ring(outer: float, bore: float, mass: float, inertia: float, **keys: object) -> Body:
    """With its centre of mass in its face."""
    sizes = {"radius": outer, "bore": bore} if bore else {"radius": outer}
    shape = make.shape("tube" if bore else "cylinder", length=0.02, position=[0, 0, 0.01], **sizes)
    return make.dynamic("body", shape, mass=mass, inertia=[inertia, inertia, inertia], **keys)


def test_a_sliding_puck_follows_its_reference() -> None:
    path = run("sliding_puck", Accuracy.tight())
    mass = 1200 * pi * 0.04**2 * 0.02
    puck = Puck(mass, mass * 0.04**2 / 2, disc_with_height(0.04, 0.3, 0.01))
    velocity = np.array([1.0, 0.0, 30.0])
    end, rest = puck.ends(velocity)
    assert times(path, "slip-stop") == [pytest.approx(end, abs=1e-8)]
    slides = path.t < end - 0.01
    wanted = puck.motion(velocity, path.t[slides])
    assert path.p[slides, 1, :2] == pytest.approx(wanted[:, :2], abs=1e-11)
    assert path.w[slides, 1, 2] == pytest.approx(wanted[:, 5], abs=1e-9)
    assert path.p[-1, 1, :2] == pytest.approx(rest[:2], abs=1e-10)
    shift = path.patch_point[:, 0, :2] - path.p[:, 1, :2]
    assert shift[slides] == pytest.approx(-0.01 * path.patch_friction[slides, 0, :2] / (mass * G), abs=1e-13)
    assert imbalance(path) < 1e-11


@pytest.mark.cases(1)
@pytest.mark.parametrize("bore", [0.0, 0.02])
@pytest.mark.parametrize(("speed", "spin"), [(1.0, 30.0), (0.3, 60.0), (1.0, 2.0)])
def test_slip_and_spin_of_a_ring_die_together(bore: float, speed: float, spin: float) -> None:
    inertia = 0.3 * (0.04**2 + bore**2) / 2
    puck = Puck(0.3, inertia, uniform_ring(0.04, bore, 0.25))
    velocity = np.array([speed, 0.0, spin])
    end, rest = puck.ends(velocity)
    body = flat_ring(0.04, bore, 0.3, inertia, velocity=[speed, 0, 0], angular_velocity=[0, 0, spin])
    contact = [{"between": ON_TABLE, "friction": 0.25}]
    path = ran([body, TABLE], end + 0.1, contact, Accuracy.balanced(), samples=20)
    assert [event.kind for event in path.events] == ["face-contact", "slip-stop"]
    assert times(path, "slip-stop") == [pytest.approx(end, abs=1e-8)]
    assert path.p[-1, 0, :2] == pytest.approx(rest[:2], abs=1e-9)
    slides = path.t < end
    wanted = puck.motion(velocity, path.t[slides])
    assert path.v[slides, 0, :2] == pytest.approx(wanted[:, 3:5], abs=1e-8)


def test_slip_and_spin_of_a_disc_end_at_the_known_ratio() -> None:
    """v / (R w) tends to 0.653 for a uniform disc: Farkas and others, Phys. Rev. Lett. 90 (2003), 248302."""
    puck = Puck(0.3, 0.3 * 0.04**2 / 2, uniform_ring(0.04, 0.0, 0.25))
    for velocity in ([1.0, 0.0, 30.0], [0.3, 0.0, 60.0]):
        end, _ = puck.ends(np.array(velocity))
        body = flat_ring(
            0.04, 0.0, 0.3, puck.inertia, velocity=[velocity[0], 0, 0], angular_velocity=[0, 0, velocity[2]]
        )
        path = ran([body, TABLE], end - 1e-6, [{"between": ON_TABLE, "friction": 0.25}], samples=1)
        assert path.v[-1, 0, 0] / (0.04 * path.w[-1, 0, 2]) == pytest.approx(0.653, abs=5e-3)


@pytest.mark.slow
def test_a_box_slides_and_spins_as_by_direct_quadrature() -> None:
    a, b, h, mu, mass = 0.1, 0.06, 0.015, 0.4, 1.3
    inertia = mass * (4 * a * a + 4 * b * b) / 12
    puck = Puck(mass, inertia, rectangle_with_height(a, b, mu, h, 600))
    velocity = np.array([0.7, 0.4, 6.0])
    shape = make.box(2 * a, 2 * b, 2 * h)
    body = make.dynamic(
        "body", shape, mass=mass, inertia=[mass * (b * b + h * h) / 3, mass * (a * a + h * h) / 3, inertia],
        position=[0, 0, h], velocity=[0.7, 0.4, 0], angular_velocity=[0, 0, 6.0],
    )  # fmt: skip
    end, rest = puck.ends(velocity)
    path = ran(
        [body, TABLE], end + 0.05, [{"between": ON_TABLE, "friction": mu}], Accuracy.tight(), samples=10
    )
    slides = path.t < end - 0.01
    wanted = puck.motion(velocity, path.t[slides])
    assert path.p[slides, 0, :2] == pytest.approx(wanted[:, :2], abs=1e-10)
    assert path.w[slides, 0, 2] == pytest.approx(wanted[:, 5], abs=1e-9)
    assert times(path, "slip-stop") == [pytest.approx(end, abs=1e-8)]
    assert path.p[-1, 0, :2] == pytest.approx(rest[:2], abs=1e-9)


@pytest.mark.parametrize("tall", [0.2, 0.5, 0.9, 0.999, 1.001, 1.3])
def test_a_block_on_an_incline_slides_until_its_pressure_reaches_its_edge(tall: float) -> None:
    """mu h / w: the centre of pressure is so far ahead of the middle by the half width."""
    mu, angle, w = 0.5, 0.6, 0.05
    h = tall * w / mu
    block = make.dynamic("body", make.box(2 * w, 0.08, 2 * h), density=800.0, position=[0, 0, h])
    gravity = [G * sin(angle), 0, -G * cos(angle)]
    path = ran([block, TABLE], 0.3, [{"between": ON_TABLE, "friction": mu}], gravity=gravity, samples=5)
    if tall > 1:
        assert path.events[0].kind == "lift-off"
        assert path.w[2, 0, 1] > 0.01
        return
    assert [event.kind for event in path.events] == ["face-contact"]
    assert path.p[:, 0, 0] == pytest.approx(G * (sin(angle) - mu * cos(angle)) * path.t**2 / 2, abs=1e-12)
    assert path.patch_point[:, 0, 0] - path.p[:, 0, 0] == pytest.approx(tall * w, rel=1e-9)
    assert np.linalg.norm(path.patch_friction[-1, 0]) == pytest.approx(
        mu * path.patch_force[-1, 0], rel=1e-12
    )
    assert imbalance(path) < 1e-12


def test_a_block_at_rest_on_an_incline_sticks() -> None:
    block = make.dynamic("body", make.box(0.1, 0.08, 0.06), density=800.0, position=[0, 0, 0.03])
    gravity = [G * sin(0.4), 0, -G * cos(0.4)]
    path = ran([block, TABLE], 1.0, [{"between": ON_TABLE, "friction": 0.5}], gravity=gravity, samples=2)
    weight = 800 * 0.1 * 0.08 * 0.06 * G
    assert [event.kind for event in path.events] == ["face-contact"]
    assert np.abs(path.v).max() < 1e-13
    assert path.patch_friction[-1, 0] == pytest.approx([-weight * sin(0.4), 0, 0], abs=1e-12)
    assert path.patch_point[-1, 0, 0] - path.p[-1, 0, 0] == pytest.approx(0.03 * np.tan(0.4), rel=1e-12)


def test_a_twisted_disc_gives_way_at_two_thirds_of_its_radius() -> None:
    """Torque mu N 2 R / 3 (pure spin), and again when it stands: the bound is the same."""
    body = flat_ring(0.06, 0.0, 2.0, 0.01)
    bound = 0.3 * 2.0 * G * 0.06 * 2 / 3
    torque = [{"body": "body", "torque": [0.0, 0.0, f"{2 * bound}*t"]}]
    path = ran([body, TABLE], 1.0, [{"between": ON_TABLE, "friction": 0.3}], torque=torque, samples=4)
    assert times(path, "slip-start") == [pytest.approx(0.5, abs=1e-10)]
    assert path.w[-1, 0, 2] == pytest.approx(bound * 0.25 / 0.01, rel=1e-9)
    assert path.patch_torque[-1, 0] == pytest.approx(-bound * np.sign(path.patch_spin[-1, 0]), rel=1e-9)


def test_a_disc_on_a_belt_is_carried_along() -> None:
    belt = make.driven("table", make.plane(), path={"position": ["0.8*t", 0.0, 0.0]})
    body = flat_ring(0.06, 0.0, 2.0, 0.01, angular_velocity=[0, 0, 5.0])
    path = ran([belt, body], 1.0, [{"between": ON_TABLE, "friction": 0.3}], samples=4)
    assert [event.kind for event in path.events] == ["face-contact", "slip-stop"]
    assert path.v[-1, 1] == pytest.approx([0.8, 0, 0], abs=1e-12)
    assert path.patch_slip[-1, 0] == pytest.approx([0, 0, 0], abs=1e-12)
    assert imbalance(path) < 1e-9


@pytest.mark.cases(1)
@pytest.mark.parametrize("shape", [make.cylinder(0.03, 0.12), make.box(0.06, 0.06, 0.12)])
def test_a_body_pulled_at_its_top_tips_when_its_pressure_reaches_its_edge(shape: Shape) -> None:
    body = make.dynamic("body", shape, mass=1.0, inertia=[0.01, 0.01, 0.01], position=[0, 0, 0.06])
    force = [{"body": "body", "force": ["3*t", 0.0, 0.0], "point": [0.0, 0.0, 0.06]}]
    path = ran([body, TABLE], 0.9, [{"between": ON_TABLE, "friction": 0.9}], force=force, samples=9)
    tips = G * 0.03 / (3 * 0.12)
    assert [event.kind for event in path.events][:2] == ["face-contact", "tipping"]
    assert times(path, "tipping")[0] == pytest.approx(tips, abs=1e-8)
    assert imbalance(path) < 1e-9
