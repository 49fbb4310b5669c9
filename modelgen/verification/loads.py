"""The wrenches of loads against virtual power: force and torque by differentiation of what moves."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
from scipy.spatial.transform import Rotation

from modelgen.model import LoadKind
from modelgen.scene.expression import evaluate
from modelgen.scene.scene_types import ForceLoad
from modelgen.verification.extremal_motion import columns
from modelgen.verification.findings import Finding, compared
from modelgen.verification.random_input_settings import drawn_settings, with_settings

Array = np.ndarray[Any, Any]


def check_load(role: str, function: ca.Function, kind: LoadKind, n: int, seed: int) -> list[Finding]:
    """Check a spring by derivatives of length, energy and dissipation, other loads by their virtual power."""
    random = np.random.default_rng(seed)
    sides = [_side(motion, n, random) for motion in kind.motions]
    turned = [] if kind.kind != "spring" else [np.tile([[40.0], [0.7], [0.3]], n)]
    arms = [random.normal(size=(3, n)) if off else np.zeros((3, n)) for off in kind.arms or (False,)]
    numbers = np.concatenate(
        [*(a for a, off in zip(arms, kind.arms, strict=False) if off), *turned, np.zeros((0, n))]
    )
    if role == "deflection":
        routes = {"deflection": "distance of the anchors", "J": "derivative of that distance"}
        found = columns(function, sides[0][0], sides[1][0], numbers)
        wanted = columns(_length(), sides[0][0], sides[1][0], *arms, turned[0])
        return [compared(name, routes[name], f, w) for name, f, w in zip(routes, found, wanted, strict=True)]
    t = random.uniform(0.1, 1.0, (1, n))
    both = [*sides, (np.zeros((12, n)), np.zeros((6, n)))][:2]
    settings = drawn_settings(kind.inputs, n, random)
    found = columns(function, t, *both[0], *both[1], numbers, *([settings] if kind.inputs else []))
    if kind.kind == "spring":
        wanted = columns(_spring(), *sides[0], *sides[1], *arms, turned[0])
        route = "derivatives of the energy k (L - L_0)^2/2 and of the dissipation c L_dot^2/2"
        return [compared(f"wrench_{s}", route, f, w) for s, f, w in zip("ab", found, wanted, strict=True)]
    power = np.array(
        [
            _given(kind, t[0, k], both[0][0][:, k], both[0][1][:, k], arms[0][:, k], settings[:, k])
            for k in range(n)
        ]
    ).T
    return [compared("wrench_a", "virtual power of the load at its point", found[0], power)]


def _side(motion: str, n: int, random: np.random.Generator) -> tuple[Array, Array]:
    R = (
        np.tile(np.eye(3).ravel(), (n, 1))
        if motion == "point"
        else Rotation.random(n, random).as_matrix().reshape(n, 9)
    )
    twist = random.normal(size=(6, n))
    twist[3:] *= 0.0 if motion == "point" else 1.0
    twist *= 0.0 if motion == "fixed" else 1.0
    return np.concatenate([random.normal(size=(3, n)), R.T]), twist


def _length() -> ca.Function:
    """(L - L_0, its derivative by the displacements of both bodies (12))."""
    sides = [
        [ca.SX.sym(name, size) for name, size in (("pose", 12), ("arm", 3), ("move", 6))] for _ in range(2)
    ]
    k, points = ca.SX.sym("k", 3), []
    for pose, arm, move in sides:
        R = ca.reshape(pose[3:], 3, 3)
        points.append(pose[:3] + move[:3] + R @ (arm + ca.cross(move[3:], arm)))
    off, moves = ca.norm_2(points[1] - points[0]) - k[2], ca.vertcat(sides[0][2], sides[1][2])
    still = ca.substitute([off, ca.gradient(off, moves)], [moves], [ca.SX(12, 1)])
    arguments = [sides[0][0], sides[1][0], sides[0][1], sides[1][1], k]
    return ca.Function("length", arguments, [ca.densify(each) for each in still])


def _spring() -> ca.Function:
    """-dU/d(displacement) - dD/d(velocity) of both bodies: (force world, torque body)."""
    sides = [
        [ca.SX.sym(name, size) for name, size in (("pose", 12), ("twist", 6), ("arm", 3), ("move", 6))]
        for _ in range(2)
    ]
    k = ca.SX.sym("k", 3)
    points, speeds = [], []
    for pose, twist, arm, move in sides:
        R = ca.reshape(pose[3:], 3, 3)
        points.append(pose[:3] + move[:3] + R @ (arm + ca.cross(move[3:], arm)))
        speeds.append(twist[:3] + R @ ca.cross(twist[3:], arm))
    between = points[1] - points[0]
    length = ca.norm_2(between)
    rate = ca.dot(between, speeds[1] - speeds[0]) / length
    energy, loss = k[0] * (length - k[2]) ** 2 / 2, k[1] * rate**2 / 2
    wrenches = [-ca.gradient(energy, move) - ca.gradient(loss, twist) for _, twist, _, move in sides]
    still = ca.substitute(wrenches, [side[3] for side in sides], [ca.SX(6, 1)] * 2)
    arguments = [sides[0][0], sides[0][1], sides[1][0], sides[1][1], sides[0][2], sides[1][2], k]
    return ca.Function("spring", arguments, [ca.densify(wrench) for wrench in still])


def _given(kind: LoadKind, t: float, pose: Array, twist: Array, arm: Array, settings: Array) -> Array:
    """The wrench whose power on every twist is that of the force at its point, or of the torque."""
    load, R = kind.load, pose[3:].reshape(3, 3, order="F")
    assert load is not None
    turned = Rotation.from_matrix(R).as_quat()[[3, 0, 1, 2]]
    quaternion = turned if turned[0] >= 0 else -turned
    spin = R @ twist[3:]
    known = {"t": t} | {axis: pose[i] for i, axis in enumerate("xyz")}
    known |= {f"v{a}": twist[i] for i, a in enumerate("xyz")} | {
        f"w{a}": spin[i] for i, a in enumerate("xyz")
    }
    known |= {f"q{a}": quaternion[i] for i, a in enumerate("wxyz")}
    vector = np.array(
        [evaluate(with_settings(each, kind.inputs, settings), known) for each in load.components]
    )
    world = vector if load.frame == "world" else R @ vector
    unit = np.eye(6)
    if isinstance(load, ForceLoad):
        return np.array([world @ (e[:3] + R @ np.cross(e[3:], arm)) for e in unit])
    return np.array([world @ (R @ e[3:]) for e in unit])
