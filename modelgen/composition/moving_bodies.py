"""Poses, twists and accelerations without constraints of all bodies of a scene, and its loads."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import casadi as ca

from modelgen.composition.scene_symbols import Expression, SceneSymbols, SplitParameters, fitted
from modelgen.dynamics.bodies import mass_and_inertia
from modelgen.model import BodyEntry, BodyKind, Model

Functions = Mapping[str, ca.Function]
COLUMNS = {"point": 3, "free": 6}  # velocity coordinates, by motion


@dataclass(frozen=True)
class MovingBody:
    """A body as expressions.

    `accel`: of a dynamic body without constraint forces, of a driven one as prescribed.
    """

    kind: BodyKind
    entry: BodyEntry
    parameters: Expression
    pose: Expression  # (12,)
    twist: Expression  # (6,)
    qdot: Expression
    accel: Expression

    @property
    def columns(self) -> int:
        """Velocity coordinates: 6, 3 or none."""
        return COLUMNS.get(self.kind.motion, 0)


def moving_bodies(
    model: Model, symbols: SceneSymbols, parameters: SplitParameters, functions: Functions
) -> list[MovingBody]:
    """All bodies, under all loads."""
    bodies = [
        _placed(model.body_kinds[entry.kind], entry, symbols, given, functions)
        for entry, given in zip(model.bodies, parameters.bodies, strict=True)
    ]
    wrenches: list[Expression] = [ca.DM(6, 1) for _ in bodies]
    for load, given in zip(model.loads, parameters.loads, strict=True):
        function = functions[f"mg_{model.load_kinds[load.kind].name}_wrench"]
        sides = [part for index in load.bodies for part in (bodies[index].pose, bodies[index].twist)]
        sides += [ca.DM(12, 1), ca.DM(6, 1)][: 4 - len(sides)]
        settings = [symbols.inputs] if model.load_kinds[load.kind].inputs else []
        found = function.call(fitted(function, [symbols.t, *sides, given, *settings]))
        for index, wrench in zip(load.bodies, found, strict=False):
            if wrench.numel():
                wrenches[index] = wrenches[index] + wrench
    return [
        _accelerated(body, symbols, wrench, functions) for body, wrench in zip(bodies, wrenches, strict=True)
    ]


def times_inverse_body_mass(bodies: list[MovingBody], wrenches: Expression) -> Expression:
    """M^-1 times wrenches (n_u, k), body by body."""
    parts: list[Expression] = []
    at = 0
    for body in bodies:
        if not body.columns:
            continue
        mass, inertia = mass_and_inertia(body.kind, body.parameters)
        parts.append(wrenches[at : at + 3, :] / mass)
        if body.columns == 6:
            parts.append(_times_inverse_inertia(inertia, wrenches[at + 3 : at + 6, :]))
        at += body.columns
    return ca.vertcat(*parts) if parts else wrenches


def mass_matrix(bodies: list[MovingBody]) -> Expression:
    """M (n_u, n_u), spins in body axes."""
    blocks: list[Expression] = []
    for body in bodies:
        if body.columns:
            mass, inertia = mass_and_inertia(body.kind, body.parameters)
            blocks += [mass] * 3 + ([inertia] if body.columns == 6 else [])
    return ca.diagcat(*blocks) if blocks else ca.DM(0, 0)


def _times_inverse_inertia(inertia: Expression, torques: Expression) -> Expression:
    if inertia.sparsity().is_diag():
        return ca.vertcat(*(torques[k, :] / inertia[k, k] for k in range(3)))
    columns = ca.horzsplit(inertia)
    adjugate = ca.horzcat(*(ca.cross(columns[i - 2], columns[i - 1]) for i in range(3)))
    return ca.mtimes(adjugate, torques) / ca.dot(columns[0], adjugate[:, 0])


def _placed(
    kind: BodyKind, entry: BodyEntry, symbols: SceneSymbols, parameters: Expression, functions: Functions
) -> MovingBody:
    none = ca.DM(0, 1)
    if kind.motion == "fixed":
        return MovingBody(kind, entry, parameters, parameters, ca.DM(6, 1), none, ca.DM(6, 1))
    if kind.motion == "driven":
        path = functions[f"mg_{kind.name}_path"]
        settings = [symbols.inputs] if kind.inputs else []
        pose, twist, accel = path.call([symbols.t, parameters, *settings])
        return MovingBody(kind, entry, parameters, pose, twist, none, accel)
    q, u = _state(kind, entry, symbols)
    if kind.motion == "point":
        pose = ca.vertcat(q, ca.vec(ca.DM.eye(3)))
        return MovingBody(kind, entry, parameters, pose, ca.vertcat(u, ca.DM(3, 1)), none, none)
    (pose,) = functions[f"mg_{kind.name}_pose"].call([q])
    return MovingBody(kind, entry, parameters, pose, u, none, none)


def _state(kind: BodyKind, entry: BodyEntry, symbols: SceneSymbols) -> tuple[Expression, Expression]:
    n_q, n_u = (3, 3) if kind.motion == "point" else (7, 6)
    return symbols.q[entry.q : entry.q + n_q], symbols.u[entry.u : entry.u + n_u]


def _accelerated(
    body: MovingBody, symbols: SceneSymbols, wrench: Expression, functions: Functions
) -> MovingBody:
    if not body.columns:
        return body
    q, u = _state(body.kind, body.entry, symbols)
    motion = functions[f"mg_{body.kind.name}_motion"]
    arguments = fitted(motion, [q, u, wrench, symbols.gravity, body.parameters])
    qdot, accel = motion.call(arguments)
    return replace(body, qdot=qdot, accel=accel)
