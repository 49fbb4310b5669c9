"""A scene as complementarity system: M v_dot = f_v + J_n lambda_n + J_t lambda_t + J_j lambda_j, with the
conditions of contacts, limits and friction as pairs G, H: 0 <= G, 0 <= H, G H = 0.

The friction forces of a contact are lambda_n mu d, with a direction d, |d| <= 1. Coulomb's law, with s the
slip times mu, and g >= 0: s + g d = 0, g complementary to 1 - |d|^2. So d and g are known where the contact
is open, too: g = |s|. Where joints permit no slip along an axis, as across the plane of a planar body, its
friction cannot be told from their forces: d has no part along it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from modelgen.composition.constraint_rows import Row
from modelgen.composition.contact_mode import ContactMode, FrictionMode, contact_count, friction_of_contacts
from modelgen.composition.explicit_runge_kutta import settled_state
from modelgen.composition.moving_bodies import Functions
from modelgen.composition.right_hand_side import WrittenScene, written_scene
from modelgen.composition.scene_symbols import Expression, parameter_values
from modelgen.model import Model

Array = np.ndarray[Any, Any]
MOVED = 1e-4  # s, of a motion with speeds of about one unit; its rows leave those of its start by the square
HELD = 1e-6  # parts of rows that are zero


@dataclass(frozen=True)
class ComplementaritySystem:
    """Expressions of the symbols of a scene, of the loads of its rows and of the speeds of its friction."""

    scene: WrittenScene
    loads: (
        Expression  # symbols (rows,): forces of contacts and limits, directions of friction, forces of joints
    )
    forces: Expression  # (rows,) N, of the loads
    speeds: Expression  # (friction constraints,)
    contacts: tuple[int, ...]  # places of the contacts and limits among the rows
    gap: Expression  # of those, m
    rate: Expression  # of those, m/s
    gamma: Expression  # of those, Gamma2
    mass: Expression  # (n_u, n_u)
    load: Expression  # (n_u,) forces without constraints, f_v
    J_normal: Expression  # (n_u, contacts)
    J_tangent: Expression  # (n_u, friction rows)
    J_joint: Expression  # (n_u, joint rows)
    joint_value: Expression
    joint_gamma: Expression
    udot: Expression
    eta_error: Expression  # zero where eta gives the closest points
    first: tuple[Expression, ...]  # G
    second: tuple[Expression, ...]  # H
    equal: tuple[Expression, ...]  # zero, of friction


def complementarity_system(
    model: Model, functions: Functions, feature_pairs: tuple[int, ...], symbol: Any
) -> ComplementaritySystem:
    """The system of a scene on these feature pairs."""
    off = tuple(FrictionMode() for _ in friction_of_contacts(model))
    none = ContactMode(feature_pairs, (False,) * contact_count(model), off)
    scene = written_scene(model, functions, none, symbol)
    rows = scene.rows.rows
    loads = symbol.sym("loads", len(rows))
    forces = _forces(scene, loads)
    speeds = symbol.sym("speeds", len(off))
    listed = tuple(k for k, touch in enumerate(scene.rows.contacts) if touch)
    push = ca.DM(model.n_u, 1)
    for k, row in enumerate(rows):
        push = push + row.J.T * forces[k]
    mass = scene.mass
    first, second, equal = _conditions(scene, loads, speeds, listed, _held_by_joints(scene))
    return ComplementaritySystem(
        scene=scene,
        loads=loads,
        forces=forces,
        speeds=speeds,
        contacts=listed,
        gap=_column([touch.gap for touch in scene.rows.contacts if touch]),
        rate=_column([rows[k].rate for k in listed]),
        gamma=_column([rows[k].gamma for k in listed]),
        mass=mass,
        load=ca.mtimes(mass, scene.free),
        J_normal=_columns([rows[k] for k in listed], model.n_u),
        J_tangent=_columns([row for row in rows if row.kind == "friction"], model.n_u),
        J_joint=_columns([row for row in rows if row.kind == "joint"], model.n_u),
        joint_value=_column([row.value for row in rows if row.kind == "joint"]),
        joint_gamma=_column([row.gamma for row in rows if row.kind == "joint"]),
        udot=scene.free + scene.times_inverse_mass(push),
        eta_error=settled_state(scene, functions)[model.n_q + model.n_u :] - scene.symbols.eta,
        first=tuple(first),
        second=tuple(second),
        equal=tuple(equal),
    )


def _forces(scene: WrittenScene, loads: Expression) -> Expression:
    """The forces of all rows."""
    forces = [loads[k] for k in range(int(loads.numel()))]
    for number, (index, _) in enumerate(friction_of_contacts(scene.model)):
        for i, k in enumerate(_friction_rows(scene, number)):
            forces[k] = scene.parameters.friction[number][i] * loads[index] * loads[k]
    return ca.vertcat(*forces) if forces else loads


def _held_by_joints(scene: WrittenScene) -> set[int]:
    """Places of the friction rows along which joints permit no slip: at the start, and where a motion that
    they permit leads from there."""
    rows, model, symbols = scene.rows.rows, scene.model, scene.symbols
    places = [k for k, row in enumerate(rows) if row.kind == "friction"]
    joints = [row.J for row in rows if row.kind == "joint"]
    if not places or not joints:
        return set()
    results = [ca.vertcat(*joints), ca.vertcat(*(rows[k].J for k in places)), scene.qdot]
    function = ca.Function("jacobians", list(vars(symbols).values()), results)
    rest: list[Any] = [np.zeros(symbols.eta.shape), model.scene.gravity, parameter_values(model), 0]

    def at(q: Array, u: Array) -> list[Array]:
        return [np.array(each) for each in function.call([ca.DM(each) for each in (0, q, u, *rest)])]

    q = np.array(model.initial_q)
    u = np.random.default_rng(0).normal(size=model.n_u)
    permitted = _without(u[None], at(q, u)[0])[0]
    moved = q + MOVED * at(q, permitted)[2].ravel()
    left = [np.abs(_without(slip, J)).max(axis=1) for J, slip, _ in (at(q, permitted), at(moved, permitted))]
    return {k for k, *parts in zip(places, *left, strict=True) if max(parts) <= HELD}


def _without(rows: Array, J: Array) -> Array:
    """What of the rows (n, n_u) the rows J do not span."""
    return np.asarray(rows - rows @ np.linalg.pinv(J) @ J)


def _conditions(
    scene: WrittenScene,
    loads: Expression,
    speeds: Expression,
    listed: tuple[int, ...],
    held: set[int],
) -> tuple[list[Expression], list[Expression], list[Expression]]:
    """G, H, and what is zero."""
    rows = scene.rows.rows
    first = [loads[k] for k in listed]
    second = [touch.gap for touch in scene.rows.contacts if touch]
    equal: list[Expression] = []
    for number, (index, _) in enumerate(friction_of_contacts(scene.model)):
        own = _friction_rows(scene, number)
        if index not in listed:
            equal += [loads[k] for k in own]
            continue
        mu = scene.parameters.friction[number]
        equal += [
            loads[k] if k in held else mu[i] * rows[k].rate + speeds[number] * loads[k]
            for i, k in enumerate(own)
        ]
        first.append(speeds[number])
        second.append(1 - sum(loads[k] ** 2 for k in own))
    return first, second, equal


def _friction_rows(scene: WrittenScene, number: int) -> list[int]:
    """Places of the rows of a friction constraint."""
    return [k for k, row in enumerate(scene.rows.rows) if row.kind == "friction" and row.owner == number]


def _column(parts: list[Expression]) -> Expression:
    return ca.densify(ca.vertcat(*parts)) if parts else ca.DM(0, 1)


def _columns(rows: list[Row], n_u: int) -> Expression:
    return ca.densify(ca.horzcat(*(row.J.T for row in rows))) if rows else ca.DM(n_u, 0)
