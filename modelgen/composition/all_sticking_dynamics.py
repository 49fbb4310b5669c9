"""The right-hand side of a small scene as one expression, with all contacts held closed and sticking, or of
bodies on one joint.

M a = f + J^T lambda and J a + gamma = 0 give (J M^-1 J^T) lambda = -(J a_free + gamma) and
a = a_free + M^-1 J^T lambda (Section 3). It serves proofs and instruction counts, and the stages of steps.
"""

from __future__ import annotations

import casadi as ca

from modelgen.composition.contact_mode import (
    ContactMode,
    friction_of_contacts,
    held_mode,
    lone_feature_pairs,
)
from modelgen.composition.moving_bodies import Functions
from modelgen.composition.right_hand_side import WrittenScene, in_mode, slip_speeds, written_scene
from modelgen.composition.shared_reciprocals import with_shared_reciprocals
from modelgen.dynamics.bodies import kernel
from modelgen.model import Model

MAX_CONTACTS = 4


def why_not_closed(model: Model) -> str:
    """Reasons why a scene has no right-hand side as one expression; empty if it has one."""
    if model.joints:
        return _why_not_closed_with_joints(model)
    if model.scene.pools:
        return "pairs of many equal bodies, which are not listed"
    if len(model.pairs) > MAX_CONTACTS:
        return f"{len(model.pairs)} contacts"
    for pair in model.pairs:
        n = len(lone_feature_pairs(model, pair))
        if n != 1:
            return f"contact {pair.name!r} goes over {n} pairs of faces, edges, vertices, pieces or caps"
        if pair.friction and len(model.pairs) > 1:
            return f"friction at contact {pair.name!r}, which is not the only one"
        if any(constraint.body >= 0 for constraint in pair.friction):
            return f"friction with a direction at contact {pair.name!r}"
    return ""


def _why_not_closed_with_joints(model: Model) -> str:
    """The same of a scene with joints: their rows must be independent of all others."""
    first = model.joints[0]
    kind = model.joint_kinds[first.kind]
    if len(model.joints) + len(model.pairs) + len(model.limits) > 1:
        return f"joint {first.name!r}, which is not the only constraint"
    if kind.motion is not None or kind.armature:
        return f"joint {first.name!r} has a prescribed motion or an armature"
    return ""


def closed_right_hand_side(model: Model, functions: Functions) -> ca.Function:
    """`mg_rhs`: (t, q, u, eta, gravity, parameters) -> (qdot, udot, eta_dot, force N or N m).

    Of a pair that more than one contact follows, the first is closed, and sticks; the eta of the others
    stay. `force`: normal forces by pair, then those of the friction rows of these contacts, or those of
    the rows of the joint. `parameters` are without coefficients of friction.
    """
    solved = in_mode(model, functions, held_mode(model), slip_speeds(model), ca.SX)
    scene, found = solved.scene, solved.found
    force = ca.vertcat(ca.SX(0, 1), *(found.forces[k] for k in _held_rows(scene)))
    outputs = {"qdot": scene.qdot, "udot": found.udot, "eta_dot": scene.eta_dot, "force": force}
    return with_shared_reciprocals(kernel("mg_rhs", _arguments(scene), outputs))


def equations_of_forces(model: Model, functions: Functions) -> ca.Function:
    """(t, q, u, eta, gravity, parameters, force, accel) -> (qdot, udot, eta_dot, residual, J, response): what
    `mg_rhs` solves. `udot` under given forces along its rows, N or N m; `residual` J a + gamma at given
    accelerations; J (rows, n_u) and `response` M^-1 J^T."""
    scene = written_scene(model, functions, held_mode(model), ca.SX)
    rows = [scene.rows.rows[k] for k in _held_rows(scene)]
    J = ca.vertcat(ca.SX(0, model.n_u), *(row.J for row in rows))
    force, accel = ca.SX.sym("force", len(rows)), ca.SX.sym("accel", model.n_u)
    outputs = {
        "qdot": scene.qdot,
        "udot": scene.free + scene.times_inverse_mass(ca.mtimes(J.T, force)),
        "eta_dot": scene.eta_dot,
        "residual": ca.mtimes(J, accel) + ca.vertcat(ca.SX(0, 1), *(row.gamma for row in rows)),
        "J": J,
        "response": scene.times_inverse_mass(J.T),
    }
    return kernel("equations_of_forces", {**_arguments(scene), "force": force, "accel": accel}, outputs)


def _held_rows(scene: WrittenScene) -> list[int]:
    """The normal row of the first contact of each pair, the friction rows of these contacts, joint rows."""
    friction = friction_of_contacts(scene.model)
    firsts = [pair.contacts[0] for pair in scene.model.pairs]
    rows = list(enumerate(scene.rows.rows))
    below = [k for k, row in rows if row.kind == "friction" and friction[row.owner][0] in firsts]
    return firsts + below + [k for k, row in rows if row.kind == "joint"]


def _arguments(scene: WrittenScene) -> dict[str, ca.SX]:
    """Those of a scene, `parameters` without coefficients of friction."""
    arguments = scene.symbols.arguments
    used = int(arguments["parameters"].numel()) - 2 * len(friction_of_contacts(scene.model))
    return arguments | {"parameters": arguments["parameters"][:used]}


def pushed(model: Model, functions: Functions, mode: ContactMode) -> ca.Function:
    """(t, q, u, eta, gravity, parameters, inputs, force) -> (qdot, udot, eta_dot, joint_value, joint_J,
    rate, gamma, mass) under given forces along all rows of all contacts, contact by contact, and then of
    joints, N or N m; what the rows of the joints hold at zero, m or rad, and their J (k, n_u); of all rows
    J u and gamma; the mass matrix (n_u, n_u)."""
    scene = written_scene(model, functions, mode, ca.SX)
    joints = [row for row in scene.rows.rows if row.kind == "joint"]
    rows = [*(row for touch in scene.rows.contacts if touch for row in touch.rows), *joints]
    force = ca.SX.sym("force", len(rows))
    push = sum((row.J.T * force[k] for k, row in enumerate(rows)), ca.SX(model.n_u, 1))
    udot = scene.free + scene.times_inverse_mass(push)
    outputs = {
        "qdot": scene.qdot,
        "udot": udot,
        "eta_dot": scene.eta_dot,
        "joint_value": ca.vertcat(ca.SX(0, 1), *(row.value for row in joints)),
        "joint_J": ca.vertcat(ca.SX(0, model.n_u), *(row.J for row in joints)),
        "rate": ca.vertcat(ca.SX(0, 1), *(row.rate for row in rows)),
        "gamma": ca.vertcat(ca.SX(0, 1), *(row.gamma for row in rows)),
        "mass": ca.densify(scene.mass),
    }
    return kernel("pushed", {**scene.symbols.arguments, "force": force}, outputs)
