"""Forces of the rows that hold, and the accelerations under them, in a fixed mode and in all modes.

With G the wrenches of the rows per unit force, the friction of what slips included,
  (J M^-1 G) f = -(J a + gamma),    u_dot = a + M^-1 G f
(sections 3 and 2.6 of Anitescu, Cremer and Potra, 1995; friction of slip opposite to it, as componentwise
N mu^2 s / |mu s|). Where rows are dependent, forces are those of least norm in the scale of the rows.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import casadi as ca

from modelgen.composition.constraint_rows import Row, SceneRows
from modelgen.composition.contact_mode import (
    DIRECTION,
    OF_FRICTION,
    PATCH_FRICTION_ROWS,
    SUPPORT_POINTS,
    ContactMode,
    contact_count,
    friction_of_contacts,
)
from modelgen.composition.scene_symbols import Expression
from modelgen.model import FrictionConstraint, Model

REGULARISATION = 1e-11  # of A A^T with unit diagonal of A: singular values above 1e-4 are exact after REFINED
REFINED = 5  # passes of refinement, each of which divides what is left by 1 + sigma^2 / REGULARISATION
TimesMatrix = Callable[[Expression], Expression]
SLOW = 2.0  # times slip_speed: slip below this has the direction that the mode tells


@dataclass(frozen=True)
class SlipSpeeds:
    """Speeds below which slip (m/s), and spin or rolling (rad/s), have no direction of their own."""

    slip: float
    turn: float


@dataclass(frozen=True)
class Switches:
    """What a mode says about each row, as numbers or expressions."""

    holds: list[Expression]  # 1: the row holds, 0: it does not; numbers only where the mode is fixed
    ratios: list[Expression | None]  # of a friction row that slips: its force over minus the normal force
    reference: Expression  # (rows,)


def fixed_switches(
    model: Model, mode: ContactMode, rows: SceneRows, mu: Sequence[Expression], slow: SlipSpeeds
) -> Switches:
    """The switches of a mode that is fixed."""
    friction = friction_of_contacts(model)
    slipping = [
        _ratios(constraint, rows, number, mode.friction[number].direction, mu[number], slow)
        if mode.friction[number].state == "slips" and mode.active[index]
        else [None] * constraint.rows
        for number, (index, constraint) in enumerate(friction)
    ]
    flat = [value for each in slipping for value in each]
    begin = contact_count(model)
    ratios = [None] * begin + flat + [None] * (len(rows.rows) - begin - len(flat))
    holds = [float(_holds(model, mode, row, k)) for k, row in enumerate(rows.rows)]
    reference = ca.DM(list(mode.reference)) if mode.reference else ca.DM(len(rows.rows), 1)
    return Switches(holds, ratios, reference)


def _holds(model: Model, mode: ContactMode, row: Row, place: int) -> bool:
    if row.kind == "normal":
        return mode.active[row.owner]
    if row.kind == "friction":
        index, _ = friction_of_contacts(model)[row.owner]
        return mode.active[index] and mode.friction[row.owner].state == "sticks"
    if row.kind == "support":
        supports = [held for each in mode.patches for held in each.holds]
        first = len(supports) + PATCH_FRICTION_ROWS * sum(each.sticks for each in mode.patches)
        return supports[place - (_row_count(model, mode) - first)]
    return True


def _row_count(model: Model, mode: ContactMode) -> int:
    below = sum(constraint.rows for _, constraint in friction_of_contacts(model))
    joints = sum(joint.rows for joint in model.joints)
    of_patches = sum(SUPPORT_POINTS + PATCH_FRICTION_ROWS * each.sticks for each in mode.patches)
    return contact_count(model) + below + joints + of_patches


def vector_switches(
    model: Model, vector: Expression, rows: SceneRows, mu: Sequence[Expression], slow: SlipSpeeds
) -> Switches:
    """The switches that a mode vector tells."""
    n = contact_count(model)
    holds: list[Expression] = [vector[k] if touch else 0.0 for k, touch in enumerate(rows.contacts)]
    ratios: list[Expression | None] = [None] * n
    at = n
    for number, (index, constraint) in enumerate(friction_of_contacts(model)):
        sticks, slips = vector[at] * holds[index], vector[at + 1] * holds[index]
        direction = [vector[at + 2 + k] for k in range(DIRECTION)]
        at += OF_FRICTION
        found = _ratios(constraint, rows, number, direction, mu[number], slow, slips)
        holds += [sticks if rows.contacts[index] else 0.0] * constraint.rows
        ratios += found
    rest = len(rows.rows) - len(holds)
    return Switches(holds + [1.0] * rest, ratios + [None] * rest, vector[at:])


def _ratios(
    constraint: FrictionConstraint,
    rows: SceneRows,
    number: int,
    direction: Sequence[Expression],
    mu: Expression,
    slow: SlipSpeeds,
    slips: Expression = 1.0,
) -> list[Expression | None]:
    """Friction force over minus the normal force, along the rows of a constraint: mu^2 s / |mu s|.

    s is the slip; reversed where it points against `direction`, so that the force stays smooth through zero
    slip; that direction where slip is slow.
    """
    along = rows.along[number]
    if along is None:
        return [None] * constraint.rows
    own = [row for row in rows.rows if row.kind == "friction" and row.owner == number]
    if constraint.rows == 1:
        return [slips * mu[0] * direction[0]]
    stored = ca.vertcat(*(ca.dot(t, ca.vertcat(*direction)) for t in along))
    s = ca.vertcat(*(row.rate for row in own))
    limit = SLOW * (slow.slip if constraint.kind == "slip" else slow.turn)
    given = ca.logic_or(ca.sumsqr(s) <= limit**2, slips == 0)
    way = ca.if_else(ca.dot(s, stored) < 0, -1, 1)
    chosen = ca.if_else(given, ca.if_else(slips == 0, ca.DM.ones(2), stored), way * s)
    weighted = mu * chosen
    flat = ca.sumsqr(weighted)
    size = ca.sqrt(flat + (flat <= 0))
    ratio = slips * mu * weighted / size
    return [ratio[0], ratio[1]]


@dataclass(frozen=True)
class ForcesAndAccelerations:
    forces: Expression  # (rows,)
    udot: Expression


def held_forces(
    model: Model,
    rows: SceneRows,
    switches: Switches,
    times_inverse_mass: TimesMatrix,
    free: Expression,
    redundant: bool,
) -> ForcesAndAccelerations:
    """Forces of the rows that may hold, others left out; for a mode that is fixed."""
    listed = [k for k, holds in enumerate(switches.holds) if holds]
    J, G = _jacobian(rows, listed), _wrenches(model, rows, switches, listed)
    gamma = ca.vertcat(*(rows.rows[k].gamma for k in listed))
    reference = switches.reference[listed] if listed else ca.DM(0, 1)
    found = ca.DM(0, 1)
    if listed:
        slips = any(ratio is not None for ratio in switches.ratios)
        A, right = ca.mtimes(J, times_inverse_mass(G)), -gamma - ca.mtimes(J, free)
        own = ca.mtimes(J, times_inverse_mass(J.T)) if slips else A
        found = _solution(A, right, _scales(own), reference, symmetric=not slips, redundant=redundant)
    return _spread(model, rows, switches, listed, found, times_inverse_mass, free, G)


def switched_forces(
    model: Model, rows: SceneRows, switches: Switches, times_inverse_mass: TimesMatrix, free: Expression
) -> ForcesAndAccelerations:
    """Forces of all rows; a row that does not hold has force zero in place of its equation."""
    listed = [k for k, holds in enumerate(switches.holds) if not isinstance(holds, float) or holds]
    if not listed:
        return _spread(
            model, rows, switches, listed, ca.DM(0, 1), times_inverse_mass, free, ca.DM(model.n_u, 0)
        )
    holds = ca.vertcat(*(switches.holds[k] for k in listed))
    mask = ca.diag(holds)
    J = ca.vertcat(*(ca.if_else(holds[i], rows.rows[k].J, 0) for i, k in enumerate(listed)))
    G = ca.horzcat(
        *(ca.if_else(holds[i], column, 0) for i, column in enumerate(_columns(model, rows, switches, listed)))
    )
    gamma = ca.vertcat(*(ca.if_else(holds[i], rows.rows[k].gamma, 0) for i, k in enumerate(listed)))
    A = ca.mtimes(J, times_inverse_mass(G)) + ca.DM.eye(len(listed)) - mask
    right = -gamma - ca.mtimes(J, free)
    scale = _scales(ca.mtimes(J, times_inverse_mass(J.T)) + ca.DM.eye(len(listed)) - mask)
    found = _solution(A, right, scale, holds * switches.reference[listed], symmetric=False, redundant=True)
    return _spread(model, rows, switches, listed, found, times_inverse_mass, free, G)


def _jacobian(rows: SceneRows, listed: list[int]) -> Expression:
    return ca.vertcat(*(rows.rows[k].J for k in listed)) if listed else ca.DM(0, 0)


def _wrenches(model: Model, rows: SceneRows, switches: Switches, listed: list[int]) -> Expression:
    columns = _columns(model, rows, switches, listed)
    return ca.horzcat(*columns) if columns else ca.DM(model.n_u, 0)


def _columns(model: Model, rows: SceneRows, switches: Switches, listed: list[int]) -> list[Expression]:
    """J^T of each listed row, of a normal row with the friction of the slip below it."""
    below: dict[int, list[int]] = {}
    for k, row in enumerate(rows.rows):
        if row.kind == "friction" and switches.ratios[k] is not None:
            index, _ = friction_of_contacts(model)[row.owner]
            below.setdefault(index, []).append(k)
    columns = []
    for k in listed:
        column = rows.rows[k].J.T
        for j in below.get(k, []) if rows.rows[k].kind == "normal" else []:
            column = column - switches.ratios[j] * rows.rows[j].J.T
        columns.append(column)
    return columns


def _scales(A: Expression) -> Expression:
    """1 / sqrt of the diagonal, 1 where that is zero."""
    diagonal = ca.densify(ca.diag(A))
    return 1 / ca.sqrt(diagonal + (diagonal <= 0))


def _solution(
    A: Expression,
    right: Expression,
    scale: Expression,
    reference: Expression,
    *,
    symmetric: bool,
    redundant: bool,
) -> Expression:
    """f with A f = right: `reference` and, of least norm in the scale of the rows, what is to be added to it.

    Least norm: f = A^T y with (A A^T + delta) y = r, repeated for what is left of r, which leaves nothing of
    the part of A's null space in f.
    """
    if not redundant and symmetric:
        return reference + regular(A, right - ca.mtimes(A, reference), symmetric)
    S = ca.diag(scale)
    scaled = ca.mtimes(S, ca.mtimes(A, S))
    right = scale * (right - ca.mtimes(A, reference))
    if int(A.shape[0]) == 1:
        return reference + scale * right / (scaled + (scaled == 0))
    if not redundant:
        return reference + scale * regular(scaled, right, symmetric)
    normal = ca.mtimes(scaled, scaled.T) + REGULARISATION * ca.DM.eye(int(A.shape[0]))
    found = ca.DM(int(A.shape[0]), 1)
    for _ in range(REFINED):
        left = right - ca.mtimes(scaled, found)
        found = found + ca.mtimes(scaled.T, regular(normal, left, symmetric=True))
    return reference + scale * found


def regular(A: Expression, b: Expression, symmetric: bool) -> Expression:
    """Solution (n, k) of a regular system: by expressions (SX), or one call of a factorisation (MX)."""
    if isinstance(A, ca.SX):
        return eliminated(A, b) if symmetric else ca.solve(A, b)
    return ca.solve(ca.densify(A), ca.densify(b), "ldl" if symmetric else "qr")


def eliminated(matrix: ca.SX, right: ca.SX) -> ca.SX:
    """Solution (n, k) of a symmetric positive definite system by elimination without pivoting."""
    if matrix.sparsity().is_diag():
        return ca.horzcat(*(column / ca.diag(matrix) for column in ca.horzsplit(right)))
    first = matrix[1:, 0] / matrix[0, 0]
    schur = matrix[1:, 1:] - ca.mtimes(first, matrix[0, 1:])
    rest = eliminated(schur, right[1:, :] - ca.mtimes(first, right[0, :]))
    return ca.vertcat((right[0, :] - ca.mtimes(matrix[0, 1:], rest)) / matrix[0, 0], rest)


def _spread(
    model: Model,
    rows: SceneRows,
    switches: Switches,
    listed: list[int],
    found: Expression,
    times_inverse_mass: TimesMatrix,
    free: Expression,
    G: Expression,
) -> ForcesAndAccelerations:
    """Forces of all rows, zero of those that do not hold; of friction that slips from the normal force."""
    forces: list[Expression] = [ca.DM(1, 1)] * len(rows.rows)
    for place, k in enumerate(listed):
        holds = switches.holds[k]
        forces[k] = found[place] if isinstance(holds, float) else holds * found[place]
    for k, row in enumerate(rows.rows):
        ratio = switches.ratios[k]
        if ratio is not None:
            index, _ = friction_of_contacts(model)[row.owner]
            forces[k] = forces[k] - ratio * forces[index]
    udot = free + ca.mtimes(times_inverse_mass(G), found) if listed else free
    return ForcesAndAccelerations(ca.densify(ca.vertcat(ca.DM(0, 1), *forces)), udot)


def held_matrix(rows: SceneRows, switches: Switches, times_inverse_mass: TimesMatrix) -> Expression:
    """J M^-1 J^T over the rows that hold in a fixed mode, scaled to unit diagonal; its rank is theirs."""
    listed = [k for k, holds in enumerate(switches.holds) if holds]
    if not listed:
        return ca.DM(0, 0)
    J = _jacobian(rows, listed)
    A = ca.mtimes(J, times_inverse_mass(J.T))
    S = ca.diag(_scales(A))
    return ca.mtimes(S, ca.mtimes(A, S))
