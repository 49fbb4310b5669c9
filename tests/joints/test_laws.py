"""Laws of the rows, limits and springs of joints, for every kind on random configurations.

Values are differenced in 50 digits along exact rigid motions; nothing comes from the derivation of the rates.
"""

from __future__ import annotations

from itertools import product

import mpmath as mp
import numpy as np
import pytest

from modelgen.joint.joint_kernels import coordinates_kernel, rows_kernel
from modelgen.joint.joint_limits import is_turn, limit_kernels
from modelgen.joint.joint_springs import spring_kernel
from modelgen.model import JointKind, LimitKind, LoadKind
from tests.joints.configurations import KINDS, LENGTH, SPRUNG, Motion, motion, parameters, unit
from tests.laws.precise import evaluate

SEEDS = range(3)
TIME = 0.4
STEP = 12  # digits of the difference in time
CLOSE = 1e-10  # of the size, if that is above 1


def close(found: np.ndarray, wanted: np.ndarray) -> bool:
    return bool(np.linalg.norm(found - wanted) < CLOSE * max(1.0, float(np.linalg.norm(wanted))))


def differences(value, a: Motion, b: Motion) -> tuple[np.ndarray, np.ndarray]:
    """First and second derivatives of value(t, pose_a, pose_b) in time."""
    with mp.workdps(50):
        h = unit(STEP)
        before, now, after = (value(TIME + s * h, a.later(s * h), b.later(s * h)) for s in (-1, 0, 1))
        triples = list(zip(before, now, after, strict=True))
        first = [float((z - x) / (2 * h)) for x, _, z in triples]
        second = [float((z - 2 * y + x) / h**2) for x, y, z in triples]
    return np.array(first), np.array(second)


@pytest.mark.cases(12)
@pytest.mark.parametrize(("kind", "seed"), list(product(KINDS, SEEDS)), ids=lambda x: getattr(x, "name", x))
def test_value_dot_is_J_u_plus_bias_and_value_ddot_is_J_a_plus_gamma(kind: JointKind, seed: int) -> None:
    rng = np.random.default_rng(seed)
    a, b, given, kernel = motion(rng), motion(rng), parameters(kind.kind, rng), rows_kernel(kind)

    def value(t, pose_a, pose_b):
        return evaluate(kernel, [t], pose_a, a.twist, pose_b, b.twist, given)[0]

    first, second = differences(value, a, b)
    _, J, gamma, bias = (x.full().ravel() for x in kernel(TIME, a.pose, a.twist, b.pose, b.twist, given))
    J = J.reshape(-1, 12)
    u, u_dot = np.concatenate([a.twist, b.twist]), np.concatenate([a.accel, b.accel])
    assert len(first) == len(gamma) == len(J) > 0
    assert close(J @ u + bias, first)
    assert close(J @ u_dot + gamma, second)
    assert bool(np.any(bias)) == (kind.motion is not None)


def coordinate_rates(kind: str, a: Motion, b: Motion, given: np.ndarray) -> tuple[float, float, float]:
    """The first coordinate and its derivatives."""
    kernel = coordinates_kernel(JointKind(kind, kind))
    first, second = differences(lambda _, p, q: evaluate(kernel, p, q, given)[0], a, b)
    return float(kernel(a.pose, b.pose, given)[0]), first[0], second[0]


@pytest.mark.cases(14)
@pytest.mark.parametrize(("kind", "upper", "seed"), list(product(SPRUNG, (False, True), SEEDS)))
def test_a_limit_is_a_contact_whose_gap_follows_the_coordinate(kind: str, upper: bool, seed: int) -> None:
    rng = np.random.default_rng(seed)
    a, b, joint = motion(rng), motion(rng), parameters(kind, rng)
    value, rate, second = coordinate_rates(kind, a, b, joint)
    rates, place = limit_kernels(LimitKind("limit", kind, upper))
    turn, bound = is_turn(kind), 0.3
    eta = [value + 2 * np.pi] if turn else []
    lever = (-1.0 if upper else 1.0) * (LENGTH if turn else 1.0)
    given = [*joint, bound]
    d, J_o, J_f, gamma, eta_dot, _ = (
        x.full().ravel() for x in rates(a.pose, a.twist, b.pose, b.twist, eta, given)
    )
    assert np.isclose(d[0], lever * ((eta[0] if turn else value) - bound), rtol=1e-13)
    assert close(np.array([J_o @ a.twist + J_f @ b.twist]), np.array([lever * rate]))
    assert close(J_o @ a.accel + J_f @ b.accel + gamma, np.array([lever * second]))
    assert not turn or close(eta_dot, np.array([rate]))
    started = [eta[0] + 2.9] if turn else []
    assert not turn or np.isclose(float(place(a.pose, b.pose, started, given)[0]), eta[0], rtol=1e-13)


@pytest.mark.parametrize(("kind", "seed"), list(product(SPRUNG, SEEDS)))
def test_the_power_of_a_spring_is_what_its_energy_loses_and_its_damper_takes(kind: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    a, b, joint = motion(rng), motion(rng), parameters(kind, rng)
    value, rate, _ = coordinate_rates(kind, a, b, joint)
    stiffness, damping, rest = 5.0, 0.7, value - 0.2
    kernel = spring_kernel(LoadKind("spring", "joint_spring", (), joint=kind))
    on_a, on_b = kernel(TIME, a.pose, a.twist, b.pose, b.twist, [*joint, stiffness, damping, rest])
    power = on_a.full().ravel() @ a.twist + on_b.full().ravel() @ b.twist
    assert np.isclose(power, -(stiffness * 0.2 + damping * rate) * rate, rtol=1e-9)
