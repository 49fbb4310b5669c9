"""The smooth right-hand side of a small scene as one expression, with all contacts held closed.

M a = f + J^T lambda and J a + gamma = 0 give (J M^-1 J^T) lambda = -(J a_free + gamma) and
a = a_free + M^-1 J^T lambda (Section 3).

It serves users of CasADi and instruction counts; the core never compiles it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import accumulate, pairwise

import casadi as ca

from modelgen.dynamics.bodies import kernel, mass_and_inertia
from modelgen.geometry.frames import dot, zeros
from modelgen.model import BodyEntry, BodyKind, FeaturePairEntry, Model
from modelgen.notation import SETTING_SIZE

MAX_CONTACTS = 4

Functions = Mapping[str, ca.Function]


@dataclass(frozen=True)
class Symbols:
    """Inputs of the composed function; `parameters` holds those of bodies, then feature pairs, then loads."""

    t: ca.SX
    q: ca.SX
    u: ca.SX
    eta: ca.SX
    gravity: ca.SX
    parameters: ca.SX
    inputs: ca.SX  # settings of the inputs of the scene, if it has any

    @property
    def arguments(self) -> dict[str, ca.SX]:
        """By name, without what is empty for all scenes of a kind."""
        return {name: symbol for name, symbol in vars(self).items() if name != "inputs" or symbol.numel()}


@dataclass(frozen=True)
class Moving:
    """A body of the instance as expressions; `accel` without contact forces."""

    kind: BodyKind
    parameters: ca.SX
    pose: ca.SX
    twist: ca.SX
    qdot: ca.SX
    accel: ca.SX

    def weigh(self, row: ca.SX) -> ca.SX:
        """M^-1 J^T of this body's columns of J; zero where the motion is given."""
        if self.kind.motion not in ("point", "free"):
            return zeros(int(row.numel()))
        mass, inertia = mass_and_inertia(self.kind, self.parameters)
        if self.kind.motion == "point":
            return row / mass
        return ca.vertcat(row[0:3] / mass, solve_symmetric(inertia, row[3:6]))


@dataclass(frozen=True)
class Row:
    """A row of a contact as expressions: J and M^-1 J^T by body."""

    J: Mapping[int, ca.SX]
    MJ: Mapping[int, ca.SX]
    gamma: ca.SX


@dataclass(frozen=True)
class Touch:
    """A contact of the instance as expressions."""

    rows: tuple[Row, ...]
    eta_dot: ca.SX


@dataclass(frozen=True)
class Written:
    """A model as expressions, its contacts on the first of each pair."""

    symbols: Symbols
    bodies: list[Moving]
    touches: list[Touch]

    @property
    def rows(self) -> list[Row]:
        return [row for touch in self.touches for row in touch.rows]

    @property
    def qdot(self) -> ca.SX:
        return ca.vertcat(*(body.qdot for body in self.bodies))

    def udot(self, force: ca.SX) -> ca.SX:
        """Under forces along all rows."""
        return ca.vertcat(
            *(_acceleration(index, body, self.rows, force) for index, body in enumerate(self.bodies))
        )


def why_not_closed(model: Model) -> str:
    """Reasons why a scene cannot have one right-hand side in closed form; empty if it has one."""
    if model.joints:
        return f"joint {model.joints[0].name!r}"
    if len(model.pairs) > MAX_CONTACTS:
        return f"{len(model.pairs)} contacts"
    for pair in model.pairs:
        n = pair.feature_pairs[1] - pair.feature_pairs[0]
        if any(model.contact_kinds[model.feature_pairs[k].kind].rows > 1 for k in range(*pair.feature_pairs)):
            return f"friction at contact {pair.name!r}"
        if n != 1:
            return f"contact {pair.name!r} goes over {n} pairs of faces, edges, vertices, pieces or caps"
    return ""


def right_hand_side(model: Model, functions: Functions) -> ca.Function:
    """`mg_rhs`: (t, q, u, eta, gravity, parameters) -> (qdot, udot, eta_dot, force(n_pair) N).

    Of a pair that more than one contact follows, the first is closed; the eta of the others stay.
    """
    written = _written(model, functions)
    force = _forces(written.bodies, written.rows)
    outputs = {
        "qdot": written.qdot,
        "udot": written.udot(force),
        "eta_dot": _eta_dot(model, written.touches),
        "force": force,
    }
    return kernel("mg_rhs", written.symbols.arguments, outputs)


def pushed(model: Model, functions: Functions) -> ca.Function:
    """(t, q, u, eta, gravity, parameters, force) -> (qdot, udot, eta_dot) under given forces along all rows
    of all contacts, N or N m; for models whose pairs have one feature pair each."""
    written = _written(model, functions)
    force = ca.SX.sym("force", len(written.rows))
    outputs = {
        "qdot": written.qdot, "udot": written.udot(force), "eta_dot": _eta_dot(model, written.touches)
    }  # fmt: skip
    return kernel("pushed", {**written.symbols.arguments, "force": force}, outputs)


def _written(model: Model, functions: Functions) -> Written:
    blocks = (model.bodies, model.feature_pairs, model.loads)
    sizes = [len(entry.parameters) for block in blocks for entry in block]
    symbols = Symbols(
        ca.SX.sym("t"),
        ca.SX.sym("q", model.n_q),
        ca.SX.sym("u", model.n_u),
        ca.SX.sym("eta", model.n_eta),
        ca.SX.sym("gravity", 3),
        ca.SX.sym("parameters", sum(sizes)),
        ca.SX.sym("inputs", SETTING_SIZE * len(model.scene.inputs)),
    )
    parameters = [symbols.parameters[a:b] for a, b in pairwise(accumulate(sizes, initial=0))]
    n, m = len(model.bodies), len(model.feature_pairs)
    bodies = _bodies(model, symbols, parameters[:n], parameters[n + m :], functions)
    touches = [
        _touch(model, entry, bodies, symbols.eta, given, functions)
        for entry, given in zip(model.feature_pairs, parameters[n : n + m], strict=True)
    ]
    return Written(symbols, bodies, touches)


def solve_symmetric(matrix: ca.SX, vector: ca.SX) -> ca.SX:
    """Solution (n,) of a symmetric positive definite system by elimination without pivoting."""
    n = int(vector.numel())
    if matrix.sparsity().is_diag():
        return vector / ca.diag(matrix)
    first = matrix[1:, 0] / matrix[0, 0]
    schur = matrix[1:, 1:] - ca.mtimes(first, matrix[0, 1:])
    rest = solve_symmetric(schur, vector[1:n] - first * vector[0])
    return ca.vertcat((vector[0] - ca.mtimes(matrix[0, 1:], rest)) / matrix[0, 0], rest)


def _bodies(
    model: Model, symbols: Symbols, parameters: list[ca.SX], of_loads: list[ca.SX], functions: Functions
) -> list[Moving]:
    bodies = [
        _placed(model.body_kinds[entry.kind], entry, symbols, given, functions)
        for entry, given in zip(model.bodies, parameters, strict=True)
    ]
    wrenches = [zeros(6) for _ in bodies]
    for load, given in zip(model.loads, of_loads, strict=True):
        function = functions[f"mg_{model.load_kinds[load.kind].name}_wrench"]
        partners = [(bodies[index].pose, bodies[index].twist) for index in load.bodies]
        known = [argument for pair in partners for argument in pair]
        pads = [ca.SX(0, 1)] * (4 - len(known))
        settings = [symbols.inputs] if model.load_kinds[load.kind].inputs else []
        arguments = _fit(function, [symbols.t, *known, *pads, given, *settings])
        for index, wrench in zip(load.bodies, function.call(arguments), strict=False):
            wrenches[index] += wrench
    return [
        _accelerated(body, entry, symbols, wrench, functions)
        for body, entry, wrench in zip(bodies, model.bodies, wrenches, strict=True)
    ]


def _placed(
    kind: BodyKind, entry: BodyEntry, symbols: Symbols, parameters: ca.SX, functions: Functions
) -> Moving:
    none = ca.SX(0, 1)
    if kind.motion == "fixed":
        return Moving(kind, parameters, parameters, zeros(6), none, zeros(6))
    if kind.motion == "driven":
        path = functions[f"mg_{kind.name}_path"]
        settings = [symbols.inputs] if kind.inputs else []
        pose, twist, accel = path.call([symbols.t, parameters, *settings])
        return Moving(kind, parameters, pose, twist, none, accel)
    q, u = _state(kind, entry, symbols)
    if kind.motion == "point":
        return Moving(
            kind, parameters, ca.vertcat(q, ca.vec(ca.SX.eye(3))), ca.vertcat(u, zeros(3)), none, none
        )
    (pose,) = functions[f"mg_{kind.name}_pose"].call([q])
    return Moving(kind, parameters, pose, u, none, none)


def _state(kind: BodyKind, entry: BodyEntry, symbols: Symbols) -> tuple[ca.SX, ca.SX]:
    n_q, n_u = (3, 3) if kind.motion == "point" else (7, 6)
    return symbols.q[entry.q : entry.q + n_q], symbols.u[entry.u : entry.u + n_u]


def _accelerated(
    body: Moving, entry: BodyEntry, symbols: Symbols, wrench: ca.SX, functions: Functions
) -> Moving:
    kind = body.kind
    if kind.motion not in ("point", "free"):
        return body
    q, u = _state(kind, entry, symbols)
    push = wrench[0 : u.numel()] if kind.loaded else ca.SX(0, 1)
    motion = functions[f"mg_{kind.name}_motion"]
    qdot, accel = motion.call([q, u, push, symbols.gravity, body.parameters])
    return Moving(kind, body.parameters, body.pose, body.twist, qdot, accel)


def _fit(function: ca.Function, arguments: list[ca.SX]) -> list[ca.SX]:
    """Arguments of size 0 where the function takes none."""
    return [argument if function.numel_in(index) else ca.SX(0, 1) for index, argument in enumerate(arguments)]


def _touch(
    model: Model,
    entry: FeaturePairEntry,
    bodies: list[Moving],
    eta: ca.SX,
    parameters: ca.SX,
    functions: Functions,
) -> Touch:
    o, f = bodies[entry.o], bodies[entry.f]
    rates = functions[f"mg_{model.contact_kinds[entry.kind].name}_rates"]
    start = model.contacts[model.pairs[entry.pair].contacts[0]].eta
    own = eta[start : start + rates.numel_in("eta")]
    arguments = _fit(rates, [o.pose, o.twist, f.pose, f.twist, own, parameters])
    _, J_o, J_f, gamma, eta_dot, *_ = rates.call(arguments)
    rows = []
    for k in range(gamma.numel()):
        J = {entry.o: _part(J_o, gamma, k), entry.f: _part(J_f, gamma, k)}
        MJ = {index: bodies[index].weigh(row) for index, row in J.items()}
        rows.append(Row(J, MJ, gamma[k]))
    return Touch(tuple(rows), eta_dot)


def _part(J: ca.SX, gamma: ca.SX, k: int) -> ca.SX:
    """The k-th row of a block that stands row after row."""
    size = J.numel() // gamma.numel()
    return J[k * size : (k + 1) * size]


def _eta_dot(model: Model, touches: list[Touch]) -> ca.SX:
    """eta_dot by contact; zero for contacts that the closed form does not follow."""
    first = {pair.contacts[0]: touch.eta_dot for pair, touch in zip(model.pairs, touches, strict=True)}
    return ca.vertcat(*(first.get(k, zeros(entry.room)) for k, entry in enumerate(model.contacts)))


def _forces(bodies: list[Moving], rows: list[Row]) -> ca.SX:
    m = len(rows)
    A, b = zeros(m, m), zeros(m)
    for i, row in enumerate(rows):
        b[i] = -row.gamma - sum(dot(J, bodies[k].accel[0 : J.numel()]) for k, J in row.J.items() if J.numel())
        for j, other in enumerate(rows):
            shared = [k for k in row.J if k in other.J and row.J[k].numel()]
            A[i, j] = sum((dot(row.J[k], other.MJ[k]) for k in shared), ca.SX(0))
    return solve_symmetric(A, b) if m else zeros(0)


def _acceleration(index: int, body: Moving, rows: list[Row], force: ca.SX) -> ca.SX:
    if body.kind.motion not in ("point", "free"):
        return ca.SX(0, 1)
    pushes = [row.MJ[index] * force[i] for i, row in enumerate(rows) if index in row.MJ]
    return sum(pushes, body.accel)
