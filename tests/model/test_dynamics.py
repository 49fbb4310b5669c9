"""Newton-Euler as theorems: power, momentum, spin, kinematics; each at random states."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from modelgen import derive, require
from modelgen.derivation import Derivation
from modelgen.dynamics.bodies import body_kernels
from modelgen.dynamics.symbolic_rotations import SERIES_BELOW, exponential, quaternion
from modelgen.model import BodyKind
from modelgen.scene.expression import evaluate, parse_expression
from modelgen.scene.scene_types import Path
from tests.model.scenes import WIDE

Array = np.ndarray[Any, Any]
SEEDS = st.integers(0, 2**32 - 1)
PARAMETERS = {
    "isotropic": [2.0, 0.3],
    "diagonal": [2.0, 0.3, 0.4, 0.5],
    "full": [2.0, 0.3, 0.4, 0.5, 0.02, -0.03, 0.01],
}
FREE = [BodyKind("b", "free", inertia, loaded=True) for inertia in PARAMETERS]  # type: ignore[arg-type]


def state(seed: int) -> tuple[Array, Array, Array, Array]:
    """q with a unit quaternion, u, wrench, gravity."""
    random = np.random.default_rng(seed)
    q = random.normal(size=7)
    q[3:] /= np.linalg.norm(q[3:])
    return q, random.normal(size=6), random.normal(size=6), random.normal(size=3)


def skew(w: Array) -> Array:
    """The matrix of w x."""
    return np.cross(np.eye(3), w)


def call(function: ca.Function, *arguments: Any) -> list[Array]:
    return [np.array(value).ravel() for value in function.call([ca.DM(a) for a in arguments])]


def along(
    function: ca.Function, q: Array, u: Array, rest: tuple[Any, ...], qdot: Array, udot: Array
) -> list[Array]:
    """Rates of all outputs of a function of (q, u, ...) when q and u change at these rates."""
    s = ca.SX.sym("s")
    outputs = function.call([ca.DM(q) + s * ca.DM(qdot), ca.DM(u) + s * ca.DM(udot), *map(ca.DM, rest)])
    rates = ca.Function("rates", [s], [ca.jacobian(value, s) for value in outputs])
    return [np.array(value).ravel() for value in rates.call([ca.DM(0)])]


@pytest.mark.parametrize("kind", FREE, ids=lambda kind: kind.inertia)
@given(seed=SEEDS)
@settings(max_examples=20, deadline=None)
def test_energy_momentum_and_spin_change_by_what_acts(kind: BodyKind, seed: int) -> None:
    _, motion, energy = body_kernels(kind)
    q, u, wrench, gravity = state(seed)
    parameters = PARAMETERS[kind.inertia]
    qdot, udot = call(motion, q, u, wrench, gravity, parameters)
    kinetic, potential, momentum, spin = along(energy, q, u, (gravity, parameters), qdot, udot)
    R = Rotation.from_quat(q[3:], scalar_first=True).as_matrix()
    force = wrench[:3] + parameters[0] * gravity
    np.testing.assert_allclose(kinetic + potential, wrench @ u, rtol=1e-11, atol=1e-11)
    np.testing.assert_allclose(momentum, force, rtol=1e-11, atol=1e-11)
    np.testing.assert_allclose(spin, np.cross(q[:3], force) + R @ wrench[3:], rtol=1e-10, atol=1e-10)


@given(seed=SEEDS)
@settings(max_examples=20, deadline=None)
def test_pose_turns_with_the_spin_and_the_quaternion_keeps_its_length(seed: int) -> None:
    pose, motion, _ = body_kernels(FREE[0])
    q, u, wrench, gravity = state(seed)
    qdot, udot = call(motion, q, u, wrench, gravity, PARAMETERS["isotropic"])
    wrapped = ca.Function("wrapped", [x := ca.SX.sym("q", 7), ca.SX.sym("u", 6)], pose.call([x]))
    (rate,) = along(wrapped, q, u, (), qdot, udot)
    R = Rotation.from_quat(q[3:], scalar_first=True).as_matrix()
    np.testing.assert_allclose(call(pose, q)[0], np.r_[q[:3], R.ravel(order="F")], atol=1e-14)
    np.testing.assert_allclose(rate[:3], u[:3], atol=1e-14)
    np.testing.assert_allclose(R.T @ rate[3:].reshape(3, 3, order="F"), skew(u[3:]), atol=1e-13)
    assert abs(q[3:] @ qdot[3:]) < 1e-14


@given(seed=SEEDS)
@settings(max_examples=20, deadline=None)
def test_inertia_of_each_structure_moves_alike_where_it_coincides(seed: int) -> None:
    q, u, wrench, gravity = state(seed)
    same = {"isotropic": [2.0, 0.3], "diagonal": [2.0, 0.3, 0.3, 0.3], "full": [2.0, 0.3, 0.3, 0.3, 0, 0, 0]}
    rates = [call(body_kernels(kind)[1], q, u, wrench, gravity, same[kind.inertia])[1] for kind in FREE]
    np.testing.assert_allclose(rates[1:], [rates[0]] * 2, atol=1e-12)


def test_folded_numbers_and_left_out_loads_change_nothing() -> None:
    q, u, wrench, gravity = state(1)
    for kind in FREE:
        numbers = PARAMETERS[kind.inertia]
        reference = call(body_kernels(kind)[1], q, u, 0 * wrench, gravity, numbers)
        folded = call(body_kernels(replace(kind, folded=tuple(numbers)))[1], q, u, 0 * wrench, gravity, [])
        unloaded = call(body_kernels(replace(kind, loaded=False))[1], q, u, [], gravity, numbers)
        np.testing.assert_allclose(folded[1], reference[1], atol=1e-14)
        np.testing.assert_allclose(unloaded[1], reference[1], atol=1e-14)


AXES = [("0", "0", "0"), ("0", "0", "t"), ("0.3*t", "t**2", "0.1"), ("1e-3*t", "0", "1e-3*t**2")]


@pytest.mark.parametrize("rotation", AXES, ids=lambda axes: ",".join(axes))
@pytest.mark.parametrize("t", [0.0, 0.7])
def test_a_driven_path_has_the_twist_and_acceleration_of_its_pose(
    rotation: tuple[str, ...], t: float
) -> None:
    position, turn = (tuple(parse_expression(text, ["t"]) for text in texts)
                      for texts in (("sin(t)", "t**2", "1"), rotation))  # fmt: skip
    (path,) = body_kernels(BodyKind("b", "driven", path=Path(position, turn)))  # type: ignore[arg-type]
    start = Rotation.from_rotvec([0.1, 0.2, 0.3])
    parameters = np.r_[1.0, 2.0, 3.0, start.as_matrix().ravel(order="F")]
    pose, twist, accel = call(path, t, parameters)
    h = 1e-5
    (later, twist_later, _), (sooner, twist_sooner, _) = (call(path, t + s, parameters) for s in (h, -h))
    R, R_dot = (x.reshape(3, 3, order="F") for x in (pose[3:], (later - sooner)[3:] / (2 * h)))
    vector = [eval_at(text, t) for text in rotation]
    np.testing.assert_allclose(R, (Rotation.from_rotvec(vector) * start).as_matrix(), atol=1e-14)
    np.testing.assert_allclose(twist[:3], (later - sooner)[:3] / (2 * h), atol=1e-9)
    np.testing.assert_allclose(R.T @ R_dot, skew(twist[3:]), atol=1e-9)
    np.testing.assert_allclose(accel, (twist_later - twist_sooner) / (2 * h), atol=1e-9)


def eval_at(text: str, t: float) -> float:
    return evaluate(parse_expression(text, ["t"]), {"t": t})


@pytest.mark.parametrize("size", [1e-9, 1e-3, *(SERIES_BELOW**0.5 * (1 + s) for s in (-1e-9, 1e-9)), 3.0])
def test_exponential_is_a_rotation_on_both_sides_of_its_series(size: float) -> None:
    vector = size * np.array([2.0, -3.0, 6.0]) / 7
    x = ca.SX.sym("x", 3)
    (R,) = ca.Function("R", [x], [exponential(x)]).call([ca.DM(vector)])
    np.testing.assert_allclose(R, Rotation.from_rotvec(vector).as_matrix(), rtol=0, atol=3e-16)


@given(seed=SEEDS, thin=st.floats(-12, 0))
@settings(max_examples=50, deadline=None)
def test_the_quaternion_of_a_rotation_is_found_near_half_turns_too(seed: int, thin: float) -> None:
    q = np.random.default_rng(seed).normal(size=4) * [10**thin, 1, 1, 1]
    q /= np.linalg.norm(q) * (np.sign(q[0]) or 1)
    R = ca.SX.sym("R", 3, 3)
    (found,) = call(
        ca.Function("q", [R], [quaternion(R)]), Rotation.from_quat(q, scalar_first=True).as_matrix()
    )
    np.testing.assert_allclose(np.sign(found @ q) * found, q, atol=1e-14)
    assert found[0] >= 0


DERIVATION: Derivation = derive(require(WIDE))


def pose_twist(random: np.random.Generator) -> tuple[Array, Array]:
    R = Rotation.random(rng=random).as_matrix()
    return np.r_[random.normal(size=3), R.ravel(order="F")], random.normal(size=6)


@given(seed=SEEDS)
@settings(max_examples=20, deadline=None)
def test_a_spring_pulls_both_ends_alike_and_its_power_is_the_loss_of_its_energy(seed: int) -> None:
    random = np.random.default_rng(seed)
    (a, twist_a), (b, twist_b) = pose_twist(random), pose_twist(random)
    anchors, stiffness, rest = random.normal(size=(2, 3)), 3.0, 0.4
    spring = DERIVATION.function("mg_spring_2_wrench")
    arms = [anchors[0], anchors[1]]
    wrench_a, wrench_b = call(spring, 0, a, twist_a, b, twist_b, np.r_[anchors.ravel(), stiffness, 0.0, rest])
    ends, speeds = [], []
    for (pose, twist), arm in zip(((a, twist_a), (b, twist_b)), arms, strict=True):
        R = pose[3:].reshape(3, 3, order="F")
        ends.append(pose[:3] + R @ arm)
        speeds.append(twist[:3] + R @ np.cross(twist[3:], arm))
    between, rate = ends[1] - ends[0], speeds[1] - speeds[0]
    length = np.linalg.norm(between)
    loss = -stiffness * (length - rest) * (between @ rate) / length
    np.testing.assert_allclose(wrench_a[:3], -wrench_b[:3], rtol=1e-12)
    np.testing.assert_allclose(
        wrench_a[:3], stiffness * (length - rest) * between / length, rtol=1e-11, atol=1e-12
    )
    np.testing.assert_allclose(wrench_a @ twist_a + wrench_b @ twist_b, loss, rtol=1e-9, atol=1e-10)


def test_a_spring_of_length_zero_exerts_no_force() -> None:
    spring = DERIVATION.function("mg_spring_wrench")
    pose, twist = np.r_[0, 0, 1.0, np.eye(3).ravel()], np.ones(6)
    wall = np.r_[0, 0, 0.0, np.eye(3).ravel()]
    wrench_a, _ = call(spring, 0, pose, twist, wall, [], np.r_[0, 0, 1.0, 5.0, 1.0, 0.2])
    np.testing.assert_array_equal(wrench_a, np.zeros(6))


@given(seed=SEEDS)
@settings(max_examples=20, deadline=None)
def test_a_force_of_expressions_acts_at_its_point_in_body_axes(seed: int) -> None:
    random = np.random.default_rng(seed)
    pose, twist = pose_twist(random)
    arm, t = random.normal(size=3), random.normal()
    R = pose[3:].reshape(3, 3, order="F")
    q = Rotation.from_matrix(R).as_quat(canonical=True, scalar_first=True)
    force = np.array([np.sin(t), -twist[0], 2 * q[1]])
    wrench, _ = call(DERIVATION.function("mg_force_wrench"), t, pose, twist, [], [], arm)
    np.testing.assert_allclose(wrench, np.r_[R @ force, np.cross(arm, force)], atol=1e-12)


@given(seed=SEEDS)
@settings(max_examples=20, deadline=None)
def test_a_world_torque_turns_in_body_axes(seed: int) -> None:
    random = np.random.default_rng(seed)
    pose, twist = pose_twist(random)
    R = pose[3:].reshape(3, 3, order="F")
    wrench, _ = call(DERIVATION.function("mg_torque_wrench"), 0, pose, twist, [], [], [])
    np.testing.assert_allclose(wrench, np.r_[0, 0, 0, R.T @ [0, (R @ twist[3:])[0], 0.1]], atol=1e-13)
