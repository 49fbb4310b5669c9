"""The formulas of bodies against rotations of SciPy, systems of point masses, and balances of momentum."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
from scipy.spatial.transform import Rotation

from modelgen.dynamics.bodies import body_kernels, mass_and_inertia
from modelgen.model import BodyKind
from modelgen.scene.expression import evaluate
from modelgen.verification.extremal_motion import columns, repeated
from modelgen.verification.findings import Finding, compared
from modelgen.verification.random_input_settings import drawn_settings, with_settings

Array = np.ndarray[Any, Any]
GRAVITY = (0.3, -0.5, -9.0)  # m/s^2, off every axis
BALANCE = "rates of momentum and angular momentum by differentiation, against force and torque"


def check_body(role: str, function: ca.Function, kind: BodyKind, n: int, seed: int) -> list[Finding]:
    """The findings for the formula of one role of a body kind."""
    random = np.random.default_rng(seed)
    checks = {"pose": _pose, "motion": _motion, "energy": _energy, "path": _path}
    return checks[role](function, kind, n, random)


def states(kind: BodyKind, n: int, random: np.random.Generator) -> tuple[Array, Array, Array]:
    """q with unit quaternions, u and parameters, one column each."""
    turns = kind.motion == "free"
    q, u = random.normal(size=(7 if turns else 3, n)), random.normal(size=(6 if turns else 3, n))
    q[3:] /= np.linalg.norm(q[3:], axis=0) if turns else 1.0
    numbers = [1.7]
    if turns:
        full = (1.3, 1.1, 0.9, 0.1, -0.05, 0.15)
        numbers += full[: {"isotropic": 1, "diagonal": 3, "full": 6, "none": 0}[kind.inertia]]
    return q, u, repeated(np.array(numbers if kind.folded is None else []), n)


def _rotations(q: Array) -> Array:
    """(n,3,3)."""
    return np.asarray(Rotation.from_quat(q[3:].T[:, [1, 2, 3, 0]]).as_matrix())


def _pose(function: ca.Function, kind: BodyKind, n: int, random: np.random.Generator) -> list[Finding]:
    q = states(kind, n, random)[0]
    wanted = np.concatenate([q[:3], _rotations(q).transpose(0, 2, 1).reshape(n, 9).T])
    return [compared("pose", "SciPy's rotation of the quaternion", columns(function, q)[0], wanted)]


def _motion(function: ca.Function, kind: BodyKind, n: int, random: np.random.Generator) -> list[Finding]:
    q, u, numbers = states(kind, n, random)
    wrench, gravity = random.normal(size=(function.size1_in(2), n)), repeated(np.array(GRAVITY), n)
    qdot, udot = columns(function, q, u, wrench, gravity, numbers)
    energy = body_kernels(kind)[-1]
    rates = columns(_along(energy, kind), q, u, gravity, numbers, qdot, udot)
    force = (wrench[:3] if wrench.size else 0.0) + _mass(kind, numbers) * gravity
    torque = np.cross(q[:3], force, axis=0)
    if kind.motion == "free":
        R = _rotations(q)
        torque += np.einsum("nij,jn->in", R, wrench[3:]) if wrench.size else 0.0
        turning = np.einsum("nij,nj->ni", R, u[3:].T)
        turned = [np.cross(turning, R[:, :, k]) for k in range(3)]
        pose_dot = np.concatenate([u[:3], *(each.T for each in turned)])
        found = columns(_along(body_kernels(kind)[0], kind), q, u, gravity, numbers, qdot, udot)[0]
    else:
        pose_dot, found = u, qdot
    balance = np.concatenate([rates[2], rates[3]])
    return [
        compared("qdot", "p_dot = v, R_dot = w x R", found, pose_dot),
        compared("udot", BALANCE, balance, np.concatenate([force, torque])),
    ]


def _mass(kind: BodyKind, numbers: Array) -> Any:
    return numbers[0] if kind.folded is None else kind.folded[0]


def _along(function: ca.Function, kind: BodyKind) -> ca.Function:
    """Rates of the outputs of a kernel of (q, ...) along qdot, udot."""
    given = {name: ca.SX.sym(name, function.size1_in(name)) for name in function.name_in()}
    q = given["q"]
    u = given.get("u", ca.SX.sym("u", 6 if kind.motion == "free" else 3))
    qdot, udot = ca.SX.sym("qdot", q.numel()), ca.SX.sym("udot", u.numel())
    values = function.call([given[name] for name in function.name_in()])
    rates = [ca.jtimes(value, q, qdot) + ca.jtimes(value, u, udot) for value in values]
    gravity = given.get("gravity", ca.SX.sym("gravity", 3))
    numbers = given.get("parameters", ca.SX.sym("parameters", body_kernels(kind)[-1].size1_in("parameters")))
    return ca.Function("along", [q, u, gravity, numbers, qdot, udot], [ca.densify(rate) for rate in rates])


def _energy(function: ca.Function, kind: BodyKind, n: int, random: np.random.Generator) -> list[Finding]:
    """Six point masses on the axes of inertia, of the body's mass and inertia, summed one by one."""
    q, u, numbers = states(kind, n, random)
    gravity = repeated(np.array(GRAVITY), n)
    found = columns(function, q, u, gravity, numbers)
    wanted = np.array([_summed(kind, q[:, k], u[:, k], numbers[:, k]) for k in range(n)]).T
    route = "sum over point masses of the same mass and inertia"
    rows = (slice(0, 1), slice(1, 2), slice(2, 5), slice(5, 8))
    return [
        compared(name, route, value, wanted[row])
        for name, value, row in zip(function.name_out(), found, rows, strict=True)
    ]


def _summed(kind: BodyKind, q: Array, u: Array, numbers: Array) -> Array:
    """Kinetic and potential energy, momentum and angular momentum."""
    mass, inertia = (np.array(ca.DM(x)) for x in map(ca.evalf, mass_and_inertia(kind, ca.SX(ca.DM(numbers)))))
    m, turns = float(mass.squeeze()), kind.motion == "free"
    second = np.trace(inertia) / 2 * np.eye(3) - inertia
    sizes, axes = np.linalg.eigh(second)
    arms = [sign * np.sqrt(3 * size / m) * axes[:, k] for k, size in enumerate(sizes) for sign in (1, -1)]
    R = Rotation.from_quat(q[[4, 5, 6, 3]]).as_matrix() if turns else np.eye(3)
    w = u[3:] if turns else np.zeros(3)
    total = np.zeros(8)
    for arm in arms if turns else [np.zeros(3)] * 6:
        r, v = q[:3] + R @ arm, u[:3] + R @ np.cross(w, arm)
        total += m / 6 * np.concatenate([[v @ v / 2, -np.dot(GRAVITY, r)], v, np.cross(r, v)])
    return total


def _path(function: ca.Function, kind: BodyKind, n: int, random: np.random.Generator) -> list[Finding]:
    times = random.uniform(0.1, 1.0, (1, n))
    start = np.concatenate(
        [random.normal(size=(3, n)), Rotation.random(n, random).as_matrix().reshape(n, 9).T]
    )
    settings = drawn_settings(kind.inputs, n, random)
    given = (times, start, settings)[: function.n_in()]
    symbols = function.sx_in()
    values = function.call(symbols)
    rates = ca.Function("rates", symbols, [ca.jacobian(value, symbols[0]) for value in values[:2]])
    pose, twist, accel = columns(function, *given)
    pose_dot, twist_dot = columns(rates, *given)
    R, turning = (x[3:].T.reshape(n, 3, 3).transpose(0, 2, 1) for x in (pose, pose_dot))
    spin = np.einsum("nji,njk->nik", R, turning)
    velocity = np.stack([*pose_dot[:3], spin[:, 2, 1], spin[:, 0, 2], spin[:, 1, 0]])
    wanted = np.array([_posed(kind, float(times[0, k]), start[:, k], settings[:, k]) for k in range(n)]).T
    return [
        compared("pose", "SciPy's rotation of the rotation vector", pose, wanted),
        compared("twist", "time derivative of the pose", twist, velocity),
        compared("accel", "time derivative of the twist", accel, twist_dot),
    ]


def _posed(kind: BodyKind, t: float, start: Array, settings: Array) -> Array:
    shift, vector = np.zeros(3), np.zeros(3)
    if kind.path is not None:
        shift, vector = (
            np.array([evaluate(with_settings(each, kind.inputs, settings), {"t": t}) for each in components])
            for components in (kind.path.position, kind.path.rotation_vector)
        )
    turned = Rotation.from_rotvec(vector).as_matrix() @ start[3:].reshape(3, 3, order="F")
    return np.concatenate([shift + start[:3], turned.T.ravel()])
