"""The rows of all constraints of a scene: contacts, limits, friction, joints, points that hold faces.

A row has J and gamma, with acceleration J u_dot + gamma; columns of J are the velocity coordinates of all
dynamic bodies. What prescribed motion adds is in gamma.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import casadi as ca

from modelgen.composition.contact_mode import (
    PATCH_FRICTION_ROWS,
    ContactMode,
    PatchMode,
    friction_of_contacts,
)
from modelgen.composition.moving_bodies import Functions, MovingBody
from modelgen.composition.scene_symbols import Expression, SceneSymbols, SplitParameters, fitted
from modelgen.errors import ModelgenError
from modelgen.model import ContactEntry, FrictionConstraint, LimitEntry, Model

Kind = Literal["normal", "friction", "joint", "support", "patch_friction"]
FRICTION_NAMES = {"slip": ("slip_1", "slip_2"), "spin": ("spin",), "roll": ("roll_1", "roll_2")}


@dataclass(frozen=True)
class Row:
    """One row; `owner` is the index of its contact, friction constraint, joint or patch."""

    kind: Kind
    owner: int
    name: str
    J: Expression  # (1, n_u)
    gamma: Expression
    rate: Expression  # of what it holds at zero: J u, with what prescribed motion adds
    value: Expression = None  # of a joint: what it holds at zero
    second: Expression = None  # of a joint: its row of J (6,) on the second body


@dataclass(frozen=True)
class TouchingContact:
    """A contact or limit on a feature pair."""

    gap: Expression
    eta_dot: Expression
    normal: Expression
    tangents: Expression  # (6,), or none
    rows: tuple[Row, ...]  # N, t1, t2, spin, roll, roll, as far as its kind has them
    sides: tuple[int, int]  # bodies o, f
    parameters: Expression
    place: str  # name of the function that corrects eta


@dataclass(frozen=True)
class SceneRows:
    """All rows in the order of the results."""

    contacts: tuple[TouchingContact | None, ...]  # contacts with shapes, then limits
    rows: tuple[Row, ...]
    along: tuple[tuple[Expression, Expression] | None, ...]  # per friction constraint: its tangents t1, t2
    armature: tuple[Row, ...] = ()  # of joints, no rows of constraints: J^T J is part of the mass matrix


def row_names(model: Model, mode: ContactMode, joint_rows: Sequence[int]) -> tuple[str, ...]:
    """The names of the rows: `egg-table`, `egg-table:slip_1`, `hinge:0`, `box-table:bottom:support_0`."""
    owners = [*(each.name for each in model.contacts), *(each.name for each in model.limits)]
    names = list(owners)
    for index, constraint in friction_of_contacts(model):
        names += [f"{owners[index]}:{name}" for name in FRICTION_NAMES[constraint.kind]]
    for joint, count in zip(model.joints, joint_rows, strict=True):
        names += [f"{joint.name}:{k}" for k in range(count)]
    for each in mode.patches:
        names += [f"{model.patches[each.patch].name}:support_{k}" for k in range(3)]
    for each in mode.patches:
        if each.sticks:
            names += [f"{model.patches[each.patch].name}:{name}" for name in ("slip_1", "slip_2", "spin")]
    return tuple(names)


class RowBuilder:
    """Calls the kernels of contacts and joints on the bodies of a scene."""

    def __init__(
        self,
        model: Model,
        symbols: SceneSymbols,
        parameters: SplitParameters,
        bodies: list[MovingBody],
        functions: Functions,
    ) -> None:
        """Raises ModelgenError where pairs of the model are in pools, and not all listed."""
        if model.scene.pools:
            raise ModelgenError(
                model.scene.source,
                "contacts as equations, of a scene that does not list all pairs of its many equal bodies",
                "scenes whose pairs are all listed",
                "write near_per_body = 0 in [contacts]",
            )
        self._model, self._symbols, self._parameters = model, symbols, parameters
        self._bodies, self._functions = bodies, functions

    def scene_rows(self, mode: ContactMode) -> SceneRows:
        """The rows of a scene whose contacts are on the feature pairs of a mode."""
        model = self._model
        contacts = [self._contact(k, entry, mode) for k, entry in enumerate(model.contacts)]
        contacts += [self._limit(k, entry) for k, entry in enumerate(model.limits)]
        normals = [touch.rows[0] if touch else self._no_row("normal", k) for k, touch in enumerate(contacts)]
        friction, along = [], []
        for number, (index, constraint) in enumerate(friction_of_contacts(model)):
            found, frame = self._friction(number, constraint, contacts[index])
            friction += found
            along.append(frame)
        of_joints = [self._joint(number) for number, _ in enumerate(model.joints)]
        joints = [row for held, _ in of_joints for row in held]
        armature = tuple(row for _, inertial in of_joints for row in inertial)
        patches = [self._patch(each) for each in mode.patches]
        supports = [row for rows, _ in patches for row in rows]
        rubbing = [row for _, rows in patches for row in rows]
        rows = (*normals, *friction, *joints, *supports, *rubbing)
        return SceneRows(tuple(contacts), tuple(rows), tuple(along), armature)

    def _contact(self, index: int, entry: ContactEntry, mode: ContactMode) -> TouchingContact | None:
        number = mode.feature_pairs[index]
        if number < 0:
            return None
        pair = self._model.feature_pairs[number]
        name = self._model.contact_kinds[pair.kind].name
        return self._touch(
            "normal", index, name, (pair.o, pair.f), entry, self._parameters.feature_pairs[number]
        )

    def _limit(self, index: int, entry: LimitEntry) -> TouchingContact:
        name = self._model.limit_kinds[entry.kind].name
        owner = len(self._model.contacts) + index
        return self._touch("normal", owner, name, (entry.a, entry.b), entry, self._parameters.limits[index])

    def _touch(
        self,
        kind: Kind,
        owner: int,
        name: str,
        sides: tuple[int, int],
        entry: ContactEntry | LimitEntry | None,
        parameters: Expression,
    ) -> TouchingContact:
        rates = self._functions[f"mg_{name}_rates"]
        o, f = (self._bodies[index] for index in sides)
        eta = self._symbols.eta[entry.eta : entry.eta + rates.numel_in("eta")] if entry else ca.DM(0, 1)
        found = rates.call(fitted(rates, [o.pose, o.twist, f.pose, f.twist, eta, parameters]))
        results = dict(zip(rates.name_out(), found, strict=True))
        gamma = results["gamma"]
        rows = []
        for k in range(int(gamma.numel())):
            parts = {}
            for side, block in zip(sides, (results["J_o"], results["J_f"]), strict=True):
                size = int(block.numel()) // int(gamma.numel())
                parts[side] = block[k * size : (k + 1) * size]
            rows.append(self._row(kind, owner, entry.name if entry else "", parts, gamma[k]))
        tangents = results.get("tangents", ca.DM(0, 1))
        return TouchingContact(
            results["d"], results["eta_dot"], results["normal"], tangents, tuple(rows), sides, parameters,
            f"mg_{name}_place",
        )  # fmt: skip

    def _row(
        self,
        kind: Kind,
        owner: int,
        name: str,
        parts: dict[int, Expression],
        gamma: Expression,
        bias: Expression = 0,
    ) -> Row:
        """`parts`: columns of J by body; those of bodies that are not dynamic go into gamma and rate."""
        cells: list[Expression] = []
        rate = bias
        for index, body in enumerate(self._bodies):
            part = parts.get(index)
            if part is not None and body.kind.motion == "driven" and part.numel():
                gamma = gamma + ca.dot(part, body.accel)
                rate = rate + ca.dot(part, body.twist)
            if not body.columns:
                continue
            given = part is not None and part.numel()
            cells.append(part[: body.columns].T if part is not None and given else ca.DM(1, body.columns))
        J = ca.horzcat(*cells) if cells else ca.DM(1, 0)
        return Row(kind, owner, name, J, gamma, rate + ca.mtimes(J, self._symbols.u))

    def _no_row(self, kind: Kind, owner: int) -> Row:
        return Row(kind, owner, "", ca.DM(1, self._model.n_u), ca.DM(0), ca.DM(0))

    def _friction(
        self, number: int, constraint: FrictionConstraint, touch: TouchingContact | None
    ) -> tuple[list[Row], tuple[Expression, Expression] | None]:
        """The rows of a constraint, turned to its principal axes, and the tangents that they are along."""
        if touch is None:
            return [self._no_row("friction", number)] * constraint.rows, None
        first = 1 + constraint.row
        rows = [self._renamed(row, number) for row in touch.rows[first : first + constraint.rows]]
        along = (touch.tangents[0:3], touch.tangents[3:6])
        if constraint.body < 0:
            return rows, along
        rotation = ca.reshape(self._bodies[constraint.body].pose[3:12], 3, 3)
        axis = ca.mtimes(rotation, ca.DM(list(constraint.direction)))
        x, y = (ca.dot(t, axis) for t in along)
        flat = x * x + y * y
        size = ca.sqrt(flat + (flat <= 0))
        x, y = ca.if_else(flat > 0, x / size, 1), y / size
        turned = [self._combined(x, rows[0], y, rows[1]), self._combined(-y, rows[0], x, rows[1])]
        return turned, (x * along[0] + y * along[1], x * along[1] - y * along[0])

    def _renamed(self, row: Row, number: int) -> Row:
        return Row("friction", number, row.name, row.J, row.gamma, row.rate)

    def _combined(self, x: Expression, a: Row, y: Expression, b: Row) -> Row:
        return Row(
            a.kind, a.owner, a.name, x * a.J + y * b.J, x * a.gamma + y * b.gamma, x * a.rate + y * b.rate
        )

    def _joint(self, number: int) -> tuple[list[Row], list[Row]]:
        """The rows that a joint holds, and those of its armature."""
        entry = self._model.joints[number]
        kind = self._model.joint_kinds[entry.kind]
        if not entry.rows + entry.inertial_rows:
            return [], []
        function = self._functions[f"mg_{kind.name}_rows"]
        a, b = self._bodies[entry.a], self._bodies[entry.b]
        settings = [self._symbols.inputs] if kind.inputs else []
        arguments = [self._symbols.t, a.pose, a.twist, b.pose, b.twist, self._parameters.joints[number]]
        value, J, gamma, bias = function.call(fitted(function, [*arguments, *settings]))
        rows = []
        for k in range(entry.rows + entry.inertial_rows):
            row_a, row_b = J[12 * k : 12 * k + 6], J[12 * k + 6 : 12 * k + 12]
            made = self._row("joint", number, entry.name, {entry.a: row_a, entry.b: row_b}, gamma[k], bias[k])
            rows.append(Row(made.kind, made.owner, made.name, made.J, made.gamma, made.rate, value[k], row_b))
        return rows[: entry.rows], rows[entry.rows :]

    def _patch(self, each: PatchMode) -> tuple[list[Row], list[Row]]:
        """The rows of the three points of a patch, and those of its friction if it sticks."""
        patch = self._model.patches[each.patch]
        sides = tuple(self._model.faces[face].body for face in patch.faces)
        supports: list[Row] = []
        rubbing: list[Row] = []
        for k, point in enumerate(each.points):
            kind = patch.friction_kind if k == 0 and patch.friction_kind >= 0 else patch.kind
            given = ca.DM([*patch.parameters[k][:-3], *point])
            touch = self._touch(
                "support", each.patch, self._model.contact_kinds[kind].name, (sides[0], sides[1]), None, given
            )
            supports.append(touch.rows[0])
            if k == 0 and each.sticks:
                rubbing = [
                    Row("patch_friction", each.patch, "", row.J, row.gamma, row.rate)
                    for row in touch.rows[1 : 1 + PATCH_FRICTION_ROWS]
                ]
        return supports, rubbing
