"""The composed right-hand side against the equations that it solves, body by body and contact by contact."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np

from modelgen.derivation import Derivation
from modelgen.model import Model
from modelgen.notation import SETTING_SIZE
from modelgen.verification.findings import Finding, compared

Array = np.ndarray[Any, Any]
TRIES = 8  # states drawn for each that is wanted: not every one is regular


def check_rhs(function: ca.Function, derivation: Derivation, n: int, seed: int) -> list[Finding]:
    """Rows keep J u_dot + gamma = 0; without contact forces each body would move as its own kernel says."""
    random = np.random.default_rng(seed)
    gaps, pushes, units = [], [], []
    for _ in range(TRIES * n):
        state = random_state(derivation.model, random)
        out = [np.asarray(value).ravel() for value in function.call([ca.DM(x) for x in state])]
        if not all(np.isfinite(value).all() for value in out) or max(map(np.abs, [*out[1], 0.0])) > 1e6:
            continue
        gap, push = _residuals(derivation, state, *out)
        scale = 1.0 + float(np.abs(out[1]).max(initial=0.0)) + float(np.abs(out[3]).max(initial=0.0))
        gaps.append(gap / scale)
        pushes.append(push / scale)
        units.append(1.0)
        if len(units) == n:
            break
    count = len(units)
    if not count:
        return [Finding("udot", "failed", "no regular state was found")]
    return [
        _rest("udot", "J u_dot + gamma = 0 with the rates of the contacts", gaps),
        _rest("force", "M (u_dot - a) = J^T lambda with a from the motion of each body", pushes),
    ]


def _rest(name: str, route: str, residuals: list[Array]) -> Finding:
    """Residuals beside ones, so that they count relative to the scale that they were divided by."""
    residual = np.array(residuals).T.reshape(-1, len(residuals))
    one = np.ones((max(residual.shape[0], 1), len(residuals)))
    return compared(name, route, one + (residual if residual.size else 0.0), one)


def random_state(model: Model, random: np.random.Generator) -> list[Array]:
    """t, q with unit quaternions, u, eta, gravity, parameters of the scene; settings of inputs, if any."""
    q = np.array(model.initial_q) + 0.1 * model.scales.length * random.normal(size=model.n_q)
    for body in model.bodies:
        if model.body_kinds[body.kind].motion == "free":
            quaternion = random.normal(size=4)
            q[body.q + 3 : body.q + 7] = quaternion / np.linalg.norm(quaternion)
    blocks = (model.bodies, model.feature_pairs, model.loads)
    parameters = [value for block in blocks for entry in block for value in entry.parameters]
    eta = model.scales.length * random.normal(size=model.n_eta)
    u = random.normal(size=model.n_u)
    state = [np.array([0.3]), q, u, eta, np.array(model.scene.gravity), np.array(parameters)]
    return (
        [*state, random.normal(size=SETTING_SIZE * len(model.scene.inputs))] if model.scene.inputs else state
    )


def _residuals(
    derivation: Derivation, state: list[Array], qdot: Array, udot: Array, eta_dot: Array, force: Array
) -> tuple[Array, Array]:
    """J u_dot + gamma of the rows of feature pairs; M (u_dot - a) - J^T lambda of bodies without loads."""
    model, (t, q, u, eta, gravity, _, *settings) = derivation.model, state
    poses, twists, accels = _kinematics(derivation, t, q, u, udot, settings)
    left = {k: np.zeros(0) for k, _ in enumerate(model.bodies)}
    for k, body in enumerate(model.bodies):
        kind = model.body_kinds[body.kind]
        if kind.motion in ("point", "free") and not kind.loaded:
            left[k] = _pushed(derivation, k, q, u, gravity, accels[k])
    gaps, of_friction = [], iter(force[len(model.feature_pairs) :])
    for index, feature_pair in enumerate(model.feature_pairs):
        rates = derivation.function(f"mg_{model.contact_kinds[feature_pair.kind].name}_rates")
        start = model.contacts[model.pairs[feature_pair.pair].contacts[0]].eta
        own = eta[start : start + rates.numel_in("eta")]
        given = [
            poses[feature_pair.o],
            twists[feature_pair.o],
            poses[feature_pair.f],
            twists[feature_pair.f],
            own,
            np.array(feature_pair.parameters),
        ]
        cut = [ca.DM(value[: rates.numel_in(k)]) for k, value in enumerate(given)]
        found = {
            name: np.asarray(value) for name, value in zip(rates.name_out(), rates.call(cut), strict=True)
        }
        friction = model.pairs[feature_pair.pair].friction
        rows = [0, *(1 + each.row + k for each in friction for k in range(each.rows))]
        gamma, along = found["gamma"].ravel(), np.zeros(len(rows))
        forces = np.array([force[index], *(next(of_friction) for _ in rows[1:])])
        for side, name in ((feature_pair.o, "J_o"), (feature_pair.f, "J_f")):
            J = found[name].reshape(len(gamma), -1)[rows]
            along += J @ accels[side][: J.shape[1]]
            if left[side].size:
                left[side] -= J.T @ forces
        gaps += list(gamma[rows] + along)
    return np.array(gaps), np.concatenate([np.zeros(0), *left.values()])


def _kinematics(
    derivation: Derivation, t: Array, q: Array, u: Array, udot: Array, settings: list[Array]
) -> tuple[list[Array], ...]:
    """Poses, twists and accelerations of all bodies."""
    model = derivation.model
    poses: list[Array] = []
    twists: list[Array] = []
    accels: list[Array] = []
    for body in model.bodies:
        kind = model.body_kinds[body.kind]
        if kind.motion in ("fixed", "driven"):
            path = [np.array(body.parameters), np.zeros(6), np.zeros(6)]
            if kind.motion == "driven":
                given = [t, np.array(body.parameters), *(settings if kind.inputs else [])]
                function = derivation.function(f"mg_{kind.name}_path")
                out = function.call([ca.DM(value) for value in given])
                path = [np.asarray(value).ravel() for value in out]
        else:
            size = 3 if kind.motion == "point" else 6
            own, gain = u[body.u : body.u + size], udot[body.u : body.u + size]
            pose = np.concatenate([q[body.q : body.q + 3], np.eye(3).ravel()])
            if kind.motion == "free":
                pose = np.asarray(derivation.function(f"mg_{kind.name}_pose")(q[body.q : body.q + 7])).ravel()
            path = [pose, np.pad(own, (0, 6 - size)), np.pad(gain, (0, 6 - size))]
        for column, value in zip((poses, twists, accels), path, strict=True):
            column.append(value)
    return poses, twists, accels


def _pushed(derivation: Derivation, index: int, q: Array, u: Array, gravity: Array, accel: Array) -> Array:
    """M (u_dot - a) of a body, a as it would be alone."""
    body = derivation.model.bodies[index]
    motion = derivation.function(f"mg_{derivation.model.body_kinds[body.kind].name}_motion")
    size = motion.numel_out("udot")
    arguments = (q[body.q : body.q + motion.numel_in("q")], u[body.u : body.u + size], ca.DM(0, 1), gravity)
    parameters = ca.DM(list(body.parameters)) if body.parameters else ca.DM(0, 1)
    alone = np.asarray(motion.call([*(ca.DM(value) for value in arguments), parameters])[1]).ravel()
    gain = accel[:size] - alone
    push = gain[:3] / body.mass_inverse[0]
    if size == 3:
        return np.asarray(push)
    return np.concatenate([push, np.linalg.solve(np.reshape(body.mass_inverse[1:], (3, 3)), gain[3:])])
