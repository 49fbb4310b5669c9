"""What the sensors of a scene show, as expressions of its state."""

from __future__ import annotations

import casadi as ca

from modelgen.composition.constraint_forces import ForcesAndAccelerations
from modelgen.composition.moving_bodies import Functions, MovingBody
from modelgen.composition.right_hand_side import WrittenScene
from modelgen.composition.scene_symbols import Expression, fitted
from modelgen.dynamics.sensors import sensor_parameters


def sensors_of(scene: WrittenScene, found: ForcesAndAccelerations, functions: Functions) -> Expression:
    """The components of all sensors in order, under the forces of a mode."""
    model, symbols = scene.model, scene.symbols
    if not model.scene.sensors:
        return ca.DM(0, 1)
    function = functions["mg_sensors"]
    arguments = [
        symbols.t,
        ca.vertcat(*(body.pose for body in scene.bodies)),
        ca.vertcat(*(body.twist for body in scene.bodies)),
        ca.vertcat(*(_acceleration(body, found) for body in scene.bodies)),
        ca.vertcat(ca.DM(0, 1), *_pairs(scene, found)),
        ca.vertcat(ca.DM(0, 1), *_joints(scene, found)),
        symbols.gravity,
        ca.DM(list(sensor_parameters(model))),
        *([symbols.inputs] if model.scene.inputs else []),
    ]
    return function.call(fitted(function, arguments))[0]


def _acceleration(body: MovingBody, found: ForcesAndAccelerations) -> Expression:
    """The rate of the twist of a body, (6,)."""
    if body.kind.motion == "driven":
        return body.accel
    first, size = body.entry.u, body.columns
    return ca.vertcat(found.udot[first : first + size], ca.DM(6 - size, 1)) if size else ca.DM(6, 1)


def _pairs(scene: WrittenScene, found: ForcesAndAccelerations) -> list[Expression]:
    """Of each pair the least gap and the sum of the normal forces; NaN for the force of one of several pairs
    that rest as one patch, which the pressure between the faces decides."""
    parts: list[Expression] = []
    for number, pair in enumerate(scene.model.pairs):
        gap, force = ca.DM(ca.inf), ca.DM(0)
        for k in range(*pair.contacts):
            touch = scene.rows.contacts[k]
            if touch:
                gap = ca.fmin(gap, touch.gap) if not isinstance(gap, ca.DM) else touch.gap
                force = force + found.forces[k]
        for k, row in enumerate(scene.rows.rows):
            if row.kind != "support":
                continue
            patch = scene.model.patches[row.owner]
            if number in (share.pair for share in patch.shares):
                force = force + float("nan")
            elif patch.pair == number:
                force = force + found.forces[k]
        parts += [gap, force]
    return parts


def _joints(scene: WrittenScene, found: ForcesAndAccelerations) -> list[Expression]:
    """The wrench of each joint on its second body."""
    wrenches: list[Expression] = [ca.DM(6, 1) for _ in scene.model.joints]
    for k, row in enumerate(scene.rows.rows):
        if row.kind == "joint":
            wrenches[row.owner] = wrenches[row.owner] + found.forces[k] * row.second
    return wrenches
