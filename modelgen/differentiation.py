"""Derivatives of the formulas of a model, for derivatives of its runs.

Each formula is packed: y(w, x), with x the vector of what is differentiated and w that of what is not. Of
contacts and joints, w holds the forces of their rows and the accelerations of their bodies, and y the wrench
J^T f, the rates J u and the accelerations J a + gamma, so that no derivative of J by itself is needed
(section 3 of Anitescu, Cremer and Potra, 1995, differentiated at fixed forces and accelerations). A tangent
is (w, x, x_dot) -> y_dot = dy/dx x_dot, an adjoint (w, x, y_bar) -> x_bar = (dy/dx)^T y_bar.

The composed right-hand side solves (J M^-1 J^T) f = -(J a + gamma) for its forces. Differentiated at fixed
forces and accelerations, these equations leave a residual r_dot and accelerations a_dot; then
  (J M^-1 J^T) f_dot = -(r_dot + J a_dot),    u_ddot = a_dot + M^-1 J^T f_dot,
which takes fewer operations than the derivative of the elimination.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import accumulate

import casadi as ca

from modelgen.composition.all_sticking_dynamics import equations_of_forces
from modelgen.composition.constraint_forces import eliminated
from modelgen.composition.shared_reciprocals import with_shared_reciprocals
from modelgen.derivation import Derivation, Formula
from modelgen.dynamics.bodies import body_kernels
from modelgen.geometry.frames import zeros

ROWS = 6  # most rows of a contact or joint
SIZES: Mapping[str, int] = {"t": 1, "q": 7, "u": 6, "wrench": 6, "gravity": 3, "pose": 12, "twist": 6}
TASKS: Mapping[str, str] = {
    "pose": "pose", "motion": "motion", "path": "path", "wrench": "load", "branch": "load",
    "rates": "contact", "place": "placement", "rows": "joint", "sensors": "sensors", "rhs": "scene",
}  # fmt: skip
"""The task of core/sensitivity that a role serves."""
ON_BRANCH = ("branch", "quaternion")  # arguments of a load on its branches, which are not differentiated
Computed = tuple[Mapping[str, ca.SX], ca.SX]  # arguments by name, and what is computed of them


@dataclass(frozen=True)
class PackedFormula:
    """y(w, x) of one kind, with its derivative along x."""

    task: str
    kind: int
    name: str
    tangent: ca.Function  # (w, x, x_dot) -> y_dot; of the scene (x, gravity, parameters, x_dot, ..) -> y_dot
    adjoint: ca.Function  # (w, x, y_bar) -> x_bar


def packed_formulas(derivation: Derivation, formulas: Iterable[Formula]) -> tuple[PackedFormula, ...]:
    """Those of the formulas of a model that its runs are differentiated by, with their derivatives."""
    given = tuple(formulas)
    on_branch = {formula.kind for formula in given if formula.role == "branch"}
    return tuple(
        _differentiated_scene(derivation, formula)
        if formula.role == "rhs"
        else _differentiated(formula, *_packed(derivation, formula))
        for formula in given
        if formula.role in TASKS and not (formula.role == "wrench" and formula.kind in on_branch)
    )


def _differentiated(formula: Formula, w: ca.SX, x: ca.SX, y: ca.SX) -> PackedFormula:
    x_dot, y_bar = ca.SX.sym("x_dot", x.numel()), ca.SX.sym("y_bar", y.numel())
    along, back = ca.jtimes(y, x, x_dot), ca.jtimes(y, x, y_bar, True)
    return _packed_formula(
        formula,
        ({"w": w, "x": x, "x_dot": x_dot}, along),
        ({"w": w, "x": x, "y_bar": y_bar}, back),
    )


def _packed_formula(formula: Formula, tangent: Computed, adjoint: Computed) -> PackedFormula:
    return PackedFormula(
        TASKS[formula.role],
        formula.kind,
        formula.name,
        _function(f"{formula.name}_tangent", "y_dot", *tangent),
        _function(f"{formula.name}_adjoint", "x_bar", *adjoint),
    )


def _function(name: str, result: str, arguments: Mapping[str, ca.SX], value: ca.SX) -> ca.Function:
    shared = ca.cse(ca.densify(value))
    return with_shared_reciprocals(
        ca.Function(name, list(arguments.values()), [shared], list(arguments), [result])
    )


def _differentiated_scene(derivation: Derivation, formula: Formula) -> PackedFormula:
    """The derivatives of the composed right-hand side."""
    function, equations = formula.function, equations_of_forces(derivation.model, derivation.functions())
    moved, values = _arguments_of_scene(function)
    x = ca.vertcat(*moved.values())
    solved = dict(zip(function.name_out(), function.call(values), strict=True))
    force, accel = ca.SX.sym("force", solved["force"].numel()), ca.SX.sym("accel", solved["udot"].numel())
    given = dict(zip(equations.name_out(), equations.call([*values, force, accel]), strict=True))
    J, response = given["J"], given["response"]
    parts = [given[name] for name in ("qdot", "udot", "eta_dot", "residual")]
    ends = [0, *accumulate(int(part.numel()) for part in parts)]

    def at_solution(value: ca.SX) -> ca.SX:
        return ca.substitute(value, ca.vertcat(force, accel), ca.vertcat(solved["force"], solved["udot"]))

    def solution(right: ca.SX) -> ca.SX:
        return eliminated(ca.mtimes(J, response), right) if right.numel() else right

    x_dot, y_bar = ca.SX.sym("x_dot", x.numel()), ca.SX.sym("y_bar", ends[3])
    q_dot, a_dot, eta_dot, r_dot = ca.vertsplit(at_solution(ca.jtimes(ca.vertcat(*parts), x, x_dot)), ends)
    f_dot = solution(-(r_dot + ca.mtimes(J, a_dot)))
    along = ca.vertcat(q_dot, a_dot + ca.mtimes(response, f_dot), eta_dot)
    q_bar, u_bar, eta_bar = ca.vertsplit(y_bar, ends[:4])
    r_bar = -solution(ca.mtimes(response.T, u_bar))
    part_bar = ca.vertcat(q_bar, u_bar + ca.mtimes(J.T, r_bar), eta_bar, r_bar)
    back = at_solution(ca.jtimes(ca.vertcat(*parts), x, part_bar, True))
    parts_dot = ca.vertsplit(x_dot, [0, *accumulate(int(part.numel()) for part in moved.values())])
    rates = {f"{name}_dot": part for name, part in zip(moved, parts_dot, strict=True)}
    return _packed_formula(
        formula, (moved | rates, along), ({"w": ca.SX(0, 1), "x": x, "y_bar": y_bar}, back)
    )


def _arguments_of_scene(function: ca.Function) -> tuple[dict[str, ca.SX], list[ca.SX]]:
    """x = [q, u, eta], gravity and parameters; what of them each argument of the composed right-hand side is,
    which does not depend on time."""
    symbols = {name: ca.SX.sym(name, function.numel_in(name)) for name in function.name_in()}
    state = ca.vertcat(*(symbols[name] for name in ("q", "u", "eta")))
    moved = {"x": state, "gravity": symbols["gravity"], "parameters": symbols["parameters"]}
    return moved, list(symbols.values())


def _packed(derivation: Derivation, formula: Formula) -> tuple[ca.SX, ca.SX, ca.SX]:
    """(w, x, y) of a formula."""
    if formula.role in ("rates", "rows"):
        return _packed_rows(formula)
    function = _loaded_motion(derivation, formula) if formula.role == "motion" else formula.function
    x, values = _arguments(function)
    chosen = ON_BRANCH if formula.role == "branch" else ()
    fixed = [ca.SX.sym(name, function.numel_in(name)) for name in chosen]
    results = dict(zip(function.name_out(), function.call([*values, *fixed]), strict=True))
    if formula.role == "place":
        return ca.SX(0, 1), x, ca.vertcat(results["d"], results["eta_next"])
    padded = [_padded(value, SIZES.get(_base(name))) for name, value in results.items()]
    return ca.vertcat(ca.SX(0, 1), *fixed), x, ca.vertcat(*padded)


def _loaded_motion(derivation: Derivation, formula: Formula) -> ca.Function:
    """The equations of motion under a wrench, which constraints exert on every body."""
    kind = replace(derivation.model.body_kinds[formula.kind], loaded=True)
    return next(function for function in body_kernels(kind) if function.name().endswith("_motion"))


def _packed_rows(formula: Formula) -> tuple[ca.SX, ca.SX, ca.SX]:
    """Of a contact: wrenches of o and f, accelerations and rates of the rows, d, t1, t2, rates of eta; of a
    joint: wrenches of a and b, accelerations, rates and values of the rows."""
    function = formula.function
    x, values = _arguments(function)
    results = dict(zip(function.name_out(), function.call(values), strict=True))
    given = dict(zip(function.name_in(), values, strict=True))
    force, accel = ca.SX.sym("force", ROWS), [ca.SX.sym(f"accel_{side}", 6) for side in "of"]
    contact = formula.role == "rates"
    gamma = results["gamma" if contact else "gamma1"]
    rows = int(gamma.numel())
    sides = [given[f"twist_{side}"] for side in ("of" if contact else "ab")]
    jacobians = [_jacobian(results, side, rows) for side in range(2)]
    wrenches = [ca.mtimes(J.T, force[:rows]) for J in jacobians]
    along = sum((ca.mtimes(J, a) for J, a in zip(jacobians, accel, strict=True)), gamma)
    rate = sum(
        (ca.mtimes(J, _padded(twist, 6)) for J, twist in zip(jacobians, sides, strict=True)), zeros(rows)
    )
    if contact:
        tangents = results.get("tangents", zeros(6))
        rest = [results["d"], tangents, results["eta_dot"]]
    else:
        rate += results["bias"]
        rest = [_padded(results["value"], ROWS)]
    y = ca.vertcat(*wrenches, _padded(along, ROWS), _padded(rate, ROWS), *rest)
    return ca.vertcat(force, *accel), x, y


def _jacobian(results: Mapping[str, ca.SX], side: int, rows: int) -> ca.SX:
    """J (rows, 6) of one body; its kernel lacks columns that a body has not, and lists rows one by one."""
    if "J" in results:
        return ca.reshape(results["J"], 12, rows).T[:, 6 * side : 6 * side + 6]
    listed = results["J_f" if side else "J_o"]
    columns = int(listed.numel()) // rows
    if not columns:
        return zeros(rows, 6)
    return ca.horzcat(ca.reshape(listed, columns, rows).T, zeros(rows, 6 - columns))


def _arguments(function: ca.Function) -> tuple[ca.SX, list[ca.SX]]:
    """x of all arguments but those that choose the branch of a load, each at its full size, and what of it
    each argument is."""
    symbols, values = [], []
    for name, size in _sizes(function):
        if name in ON_BRANCH:
            continue
        symbol = ca.SX.sym(name, size)
        symbols.append(symbol)
        used = int(function.numel_in(name))
        values.append(symbol[:used] if used else ca.SX(0, 1))
    return ca.vertcat(*symbols), values


def _sizes(function: ca.Function) -> Iterator[tuple[str, int]]:
    of_all_bodies = "pairs" in function.name_in() or (
        "q" in function.name_in() and "eta" in function.name_in()
    )
    for name in function.name_in():
        own = int(function.numel_in(name))
        yield name, own if of_all_bodies else SIZES.get(_base(name), own)


def _base(name: str) -> str:
    """ "pose" of "pose_o"; results of the equations of motion have the sizes of their arguments."""
    return {"qdot": "q", "udot": "u", "accel": "twist"}.get(name, name.partition("_")[0])


def _padded(value: ca.SX, size: int | None) -> ca.SX:
    missing = 0 if size is None else size - int(value.numel())
    return ca.vertcat(value, zeros(missing)) if missing else value
