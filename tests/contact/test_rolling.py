"""Bodies held by their tangential rows roll as published and closed forms say."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from modelgen.contact.form_table import contact_kernels
from modelgen.model import ContactKind, Rows, ShapeKind, Side
from tests.contact.test_reference_cases import PLANE, ROLLING, W, rolling_arguments, rolling_kind

Array = np.ndarray[Any, Any]
G = 9.81
SPHERE = ShapeKind("sphere", "sphere", ("radius",))
BOWL = ShapeKind("bowl", "sphere", ("radius",), cavity=True)
ELLIPSOID = ShapeKind("ellipsoid", "ellipsoid", ("a", "b", "c"))
CIRCLE = ShapeKind("circle", "circle", ("radius",))
REST = np.array([0.0, 0.0, 0.0, *np.eye(3).ravel()])


@dataclass(frozen=True)
class Held:
    """A free body f whose first rows are held at zero against o."""

    kind: ContactKind
    parameters: Array
    mass: float
    inertia: Array  # (3,3) body axes
    held: int = 3

    @cached_property
    def rates(self) -> ca.Function:
        return contact_kernels(self.kind).rates

    def rows(self, o: tuple[Array, Array], pose: Array, twist: Array) -> tuple[Array, ...]:
        """J_o, J_f, gamma and the tangents with N as columns (3,3)."""
        given = [entry[: self.rates.numel_in(k)] for k, entry in enumerate(o)]
        out = self.rates(*given, pose, twist, [], self.parameters)
        found = dict(zip(self.rates.name_out(), (np.array(entry)[:, 0] for entry in out), strict=True))
        n = self.kind.rows
        axes = np.column_stack([found["normal"], found["tangents"].reshape(2, 3).T])
        return found["J_o"].reshape(n, -1), found["J_f"].reshape(n, -1), found["gamma"], axes

    def motion(
        self,
        pose: Array,
        twist: Array,
        down: Array,
        o: tuple[Array, Array, Array] = (REST, REST[:6], REST[:6]),
    ) -> tuple[Array, Array]:
        """(6,) acceleration and (rows held,) forces under gravity `down`; o has a pose, twist and rate."""
        J_o, J_f, gamma, _ = self.rows(o[:2], pose, twist)
        J, k = J_f[: self.held], self.held
        w = twist[3:]
        M = np.zeros((6, 6))
        M[:3, :3], M[3:, 3:] = self.mass * np.eye(3), self.inertia
        free = np.concatenate([self.mass * down, -np.cross(w, self.inertia @ w)])
        right = -gamma[:k] - (J_o[:k] @ o[2] if J_o.size else 0)
        found = np.linalg.solve(np.block([[M, -J.T], [J, np.zeros((k, k))]]), np.concatenate([free, right]))
        return found[:6], found[6:]

    def travel(self, pose: Array, twist: Array, until: float) -> tuple[Array, Array]:
        """Pose and twist after a time, o at rest, gravity along -z."""
        turn = Rotation.from_matrix(pose[3:].reshape(3, 3, order="F")).as_quat()

        def slope(t: float, x: Array) -> Array:
            a, _ = self.motion(posed(x), x[7:], np.array([0.0, 0.0, -G]))
            vector, scalar, w = x[3:6], x[6], x[10:]
            turning = np.concatenate([scalar * w + np.cross(vector, w), [-vector @ w]]) / 2
            return np.concatenate([x[7:10], turning, a])

        start = np.concatenate([pose[:3], turn, twist])
        end = solve_ivp(slope, (0, until), start, method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
        return posed(end), end[7:]


def posed(x: Array) -> Array:
    return np.concatenate([x[:3], Rotation.from_quat(x[3:7]).as_matrix().ravel(order="F")])


def pose_of(p: Any, R: Array) -> Array:
    return np.concatenate([p, R.ravel(order="F")])


def kind(form: str, o: ShapeKind, f: ShapeKind, rows: Rows = 3, **sides: Any) -> ContactKind:
    one, two = (
        Side(o, sides.get("motion", "fixed")),
        Side(f, "free", placement=sides.get("placed", "identity")),
    )
    return ContactKind("rolling", form, one, two, rows)


def ball(form: str, o: ShapeKind, lengths: list[float], rows: Rows = 3, motion: str = "fixed") -> Held:
    """A homogeneous ball of mass 2 whose radius is the last of the lengths."""
    inertia = 0.4 * 2.0 * lengths[-1] ** 2 * np.eye(3)
    return Held(kind(form, o, SPHERE, rows, motion=motion), np.array(lengths), 2.0, inertia)


def turn_of(seed: int) -> Array:
    return Rotation.random(rng=np.random.default_rng(seed)).as_matrix()


@pytest.mark.parametrize("angle", [0.0, 0.3, 1.2])
def test_a_ball_rolls_down_an_incline_at_five_sevenths(angle: float) -> None:
    """5/7 g sin(angle), held by a friction of 2/7 of the weight along the slope."""
    held, R = ball("explicit", PLANE, [0.1]), turn_of(1)
    down = G * np.array([np.sin(angle), 0.0, -np.cos(angle)])
    v = np.array([0.7, -0.4, 0.0])
    w = np.cross([0.0, 0.0, 1.0], v) / 0.1 + [0.0, 0.0, 3.0]
    a, force = held.motion(pose_of([0.2, 0.3, 0.1], R), np.concatenate([v, R.T @ w]), down)
    np.testing.assert_allclose(a[:3], [5 / 7 * G * np.sin(angle), 0, 0], atol=1e-13)
    np.testing.assert_allclose(force[0], 2.0 * G * np.cos(angle), rtol=1e-13)
    np.testing.assert_allclose(np.hypot(*force[1:]), 2 / 7 * 2.0 * G * np.sin(angle), atol=1e-13)


def test_a_ball_on_a_turntable_circles_at_two_sevenths() -> None:
    """v_dot = 2/7 W e_z x v on a table that turns at W, with what its own acceleration adds."""
    held, R, spin, gain = ball("explicit", PLANE, [0.1], motion="driven"), turn_of(2), 1.7, 0.6
    p, v = np.array([0.5, -0.3, 0.1]), np.array([0.2, 0.9, 0.0])
    up = np.array([0.0, 0.0, 1.0])
    w = np.cross(up, v - spin * np.cross(up, p)) / 0.1 - 0.8 * up
    table = REST, np.array([0, 0, 0, 0, 0, spin]), np.array([0, 0, 0, 0, 0, gain])
    a, _ = held.motion(pose_of(p, R), np.concatenate([v, R.T @ w]), -G * up, table)
    np.testing.assert_allclose(a[:3], 2 / 7 * np.cross(up, spin * v + gain * p), atol=1e-12)


@pytest.mark.parametrize("form", ["explicit"])
def test_a_ball_in_a_bowl_is_a_pendulum_that_rolls(form: str) -> None:
    """7/5 (R - r) theta'' = -g sin(theta), and w.N of a homogeneous ball never changes."""
    reach, radius, theta, rate = 1.0, 0.2, 0.6, 1.3
    held, R = ball(form, BOWL, [reach, radius], rows=6), turn_of(3)
    out = np.array([np.sin(theta), 0.0, -np.cos(theta)])
    along = np.array([np.cos(theta), 0.0, np.sin(theta)])
    v = (reach - radius) * rate * along
    w = -np.cross(out, v) / radius + 2.5 * out
    pose, twist = pose_of((reach - radius) * out, R), np.concatenate([v, R.T @ w])
    a, _ = held.motion(pose, twist, np.array([0.0, 0.0, -G]))
    _, J, gamma, _ = held.rows((REST, REST[:0]), pose, twist)
    np.testing.assert_allclose((J @ twist)[:3], 0, atol=1e-14)
    np.testing.assert_allclose(a[:3] @ along, -5 / 7 * G * np.sin(theta), atol=1e-12)
    np.testing.assert_allclose(a[:3] @ out, -(reach - radius) * rate**2, atol=1e-12)
    np.testing.assert_allclose(J[3] @ a + gamma[3], 0, atol=1e-12)


@pytest.mark.parametrize("form", ["paper", "block", "differentiated"])
def test_montanas_rolling_sphere_neither_slips_nor_spins(form: str) -> None:
    """With the twist whose contact rates are published, rows of slip and spin vanish; rolling is |w|."""
    chart = rolling_kind(form)
    found = contact_kernels(ContactKind("montana", form, chart.o, chart.f, 6)).rates
    at = rolling_arguments()
    _, J_o, J_f, _, eta_dot, *_ = (np.array(entry)[:, 0] for entry in found(*at))
    past = J_o.reshape(6, 6) @ at[1] + J_f.reshape(6, 6) @ at[3]
    np.testing.assert_allclose(past[:4], 0, atol=1e-15)
    assert np.hypot(*past[4:]) == pytest.approx(np.hypot(*W[:2]), abs=1e-14)
    np.testing.assert_allclose(eta_dot, [ROLLING[name] for name in ("u_o", "v_o", "u_f", "v_f")], atol=1e-12)


def test_a_rolling_coin_arrives_where_published() -> None:
    """Rill and Schaeffer's coin after half a second: centre and contact within 1e-9 m, and the force."""
    r, tilt, up = 0.01, np.radians(1.0), np.array([0.0, 0.0, 1.0])
    to_x = Rotation.from_rotvec([0, np.pi / 2, 0]).as_matrix()  # the circle's axis along x
    parameters = np.concatenate([[r], np.zeros(3), to_x.ravel(order="F")])
    inertia = r * r * np.diag([0.5, 0.25, 0.25])
    coin = Held(kind("support", PLANE, CIRCLE, placed="general"), parameters, 1.0, inertia)
    R = Rotation.from_rotvec([0, tilt, 0]).as_matrix()
    p, w = r * np.array([np.sin(tilt), 0.0, np.cos(tilt)]), 10 * np.pi * up
    pose, twist = coin.travel(pose_of(p, R), np.concatenate([np.cross(w, p), R.T @ w]), 0.5)
    centre = [8.27529183556e-05, 0.00158178190055, 0.00976087384263]
    np.testing.assert_allclose(pose[:3], centre, atol=1e-9)
    place = contact_kernels(coin.kind).place
    contact = np.array(place(REST, pose, [], parameters)[6])[:, 0]
    np.testing.assert_allclose(contact, [0.00200494702065, 0.00259692310364, 0], atol=1e-9)
    _, force = coin.motion(pose, twist, -G * up)
    axes = coin.rows((REST, REST[:0]), pose, twist)[3]
    np.testing.assert_allclose(axes @ force, [-0.807813489485, -0.634913784517, 9.83551980688], atol=1e-6)


@pytest.mark.slow
def test_an_ellipsoid_that_rolls_keeps_its_energy_and_stays_in_contact() -> None:
    """0.10 x 0.07 x 0.05 m tilted by 0.3 rad at 6 rad/s about the vertical, two seconds without slip."""
    axes, tilt, up = np.array([0.05, 0.035, 0.025]), 0.3, np.array([0.0, 0.0, 1.0])
    mass = 4 / 3 * np.pi * axes.prod() * 1000
    inertia = mass / 5 * np.diag(np.sum(axes**2) - axes**2)
    egg = Held(kind("support", PLANE, ELLIPSOID), axes, mass, inertia)
    R = Rotation.from_rotvec([tilt, 0, 0]).as_matrix()
    n = R.T @ -up
    lever = R @ (axes**2 * n / np.sqrt(n @ (axes**2 * n)))
    w = 6.0 * up
    pose, twist = pose_of(-lever, R), np.concatenate([-np.cross(w, lever), R.T @ w])

    def energy(pose: Array, twist: Array) -> float:
        v, spin = twist[:3], twist[3:]
        return float(mass * (v @ v / 2 + G * pose[2]) + spin @ inertia @ spin / 2)

    before = energy(pose, twist)
    end, speed = egg.travel(pose, twist, 2.0)
    kinetic = before - mass * G * pose[2]
    assert abs(energy(end, speed) - before) < 1e-10 * kinetic
    _, J, _, _ = egg.rows((REST, REST[:0]), end, speed)
    np.testing.assert_allclose(J @ speed, 0, atol=1e-11)
    place = contact_kernels(egg.kind).place
    assert abs(float(place(REST, end, [], axes)[1])) < 1e-12
