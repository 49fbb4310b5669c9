"""Identities that SymPy decides on the exported functions themselves, instruction by instruction."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import casadi as ca
import sympy as sp

from modelgen.derivation import Formula
from modelgen.geometry.frames import zeros
from modelgen.geometry.surface_catalogue import surface_of
from modelgen.model import BodyKind, ContactKind, Model, ShapeKind
from modelgen.verification.findings import Finding, proved
from modelgen.verification.sympy_translation import component, definition

SURFACES = ("plane", "sphere", "ellipsoid", "torus", "cylinder", "cone", "paraboloid")
ROOTED = ("torus",)  # whose equation has a root, of which squaring would lose the sign
CURVES = ("line", "segment", "edge", "circle", "ellipse_curve", "helix")

Vector = Any  # a column of sympy expressions


def vectors(function: ca.Function) -> tuple[dict[str, Vector], dict[str, Vector]]:
    """Inputs as columns of symbols, outputs as columns of expressions in them."""
    inputs = {name: _column(name, function.numel_in(k)) for k, name in enumerate(function.name_in())}
    known: dict[sp.Basic, sp.Basic] = {}
    for line in definition(function):
        known[line.target] = line.value.xreplace(known)
    outputs = {
        name: sp.Matrix([known.get(symbol, symbol) for symbol in _column(name, function.numel_out(k))])
        for k, name in enumerate(function.name_out())
    }
    return inputs, outputs


def _column(name: str, size: int) -> Vector:
    return sp.Matrix([component(name, k, size, {}) for k in range(size)])


def vanishes(expressions: Sequence[sp.Expr], relations: Mapping[sp.Expr, sp.Expr]) -> bool:
    """Whether all are zero: as rational functions, with powers of symbols x^2 replaced by `relations`."""
    return all(_reduced(expression, relations) == 0 for expression in expressions)


def _reduced(expression: sp.Expr, relations: Mapping[sp.Expr, sp.Expr]) -> sp.Expr:
    arguments = sorted({f.args[0] for f in expression.atoms(sp.sin, sp.cos, sp.tan)}, key=sp.default_sort_key)
    expression = expression.replace(sp.tan, lambda x: sp.sin(x) / sp.cos(x))
    rules = dict(relations)
    for argument in arguments:
        s, c = sp.Dummy("s"), sp.Dummy("c")
        expression = expression.xreplace({sp.sin(argument): s, sp.cos(argument): c})
        rules[c] = 1 - s**2
    roots = {p: sp.expand(p.base).as_content_primitive() for p in expression.atoms(sp.Pow) if _is_root(p)}
    for base in sorted({own for _, own in roots.values()}, key=sp.count_ops):
        symbol = sp.Dummy("r")
        powers = {p: c**p.exp * symbol ** int(2 * p.exp) for p, (c, own) in roots.items() if own == base}
        expression, rules[symbol] = expression.xreplace(powers), base
    top = sp.expand(sp.numer(sp.together(sp.expand(expression))))
    for symbol, square in reversed(list(rules.items())):
        top = sp.expand(sp.rem(top, symbol**2 - sp.expand(square), symbol)) if top.has(symbol) else top
    return top


def _is_root(power: sp.Pow) -> bool:
    return bool(power.exp.is_Rational and power.exp.q == 2)


def prove_pose(formula: Formula, kind: BodyKind) -> list[Finding]:
    """R v = q v q* for unit q."""
    given, found = vectors(formula.function)
    q = given["q"]
    w, axis = q[3], sp.Matrix(q[4:7])
    square = {w: 1 - axis.dot(axis)}
    R = sp.Matrix(3, 3, lambda i, j: found["pose"][3 + 3 * j + i])
    wrong = [a - b for a, b in zip(found["pose"][:3], q[:3], strict=True)]
    for k in range(3):
        v = sp.eye(3)[:, k]
        turned = v * (w**2 - axis.dot(axis)) + 2 * axis * axis.dot(v) + 2 * w * axis.cross(v)
        wrong += list(R[:, k] - turned)
    return [proved("pose", "R v = q v q* for unit quaternions", vanishes(wrong, square))]


def _body(kind: BodyKind, given: Mapping[str, Vector]) -> tuple[sp.Expr, Vector]:
    """Mass and inertia (3,3) from the parameters."""
    m, *rest = given["parameters"]
    if kind.inertia == "isotropic":
        return m, rest[0] * sp.eye(3)
    if kind.inertia == "diagonal":
        return m, sp.diag(*rest)
    if kind.inertia == "full":
        xx, yy, zz, xy, xz, yz = rest
        return m, sp.Matrix([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return m, sp.zeros(3, 3)


def prove_motion(formula: Formula, kind: BodyKind) -> list[Finding]:
    """m v_dot = F + m g, I w_dot + w x I w = tau; p_dot = v, 2 q* q_dot = (0, w)."""
    given, found = vectors(formula.function)
    m, inertia = _body(kind, given)
    u, wrench, udot, qdot = given["u"], given["wrench"], found["udot"], found["qdot"]
    force = sp.Matrix(wrench[:3]) if wrench.shape[0] else sp.zeros(3, 1)
    wrong = list(m * sp.Matrix(udot[:3]) - force - m * given["gravity"])
    moved = list(sp.Matrix(qdot[:3]) - sp.Matrix(u[:3]))
    rules: dict[sp.Expr, sp.Expr] = {}
    if kind.motion == "free":
        w, torque = sp.Matrix(u[3:]), sp.Matrix(wrench[3:]) if wrench.shape[0] else sp.zeros(3, 1)
        wrong += list(inertia * sp.Matrix(udot[3:]) + w.cross(inertia * w) - torque)
        q, rate = given["q"][3:], qdot[3:]
        a, b, c, d = sp.Matrix(q[1:]), q[0], sp.Matrix(rate[1:]), rate[0]
        rules = {b: 1 - a.dot(a)}
        moved += [2 * (b * d + a.dot(c)), *(2 * (b * c - d * a - a.cross(c)) - w)]
    return [
        proved("qdot", "p_dot = v and 2 q* q_dot = (0, w)", vanishes(moved, rules)),
        proved("udot", "m v_dot = F + m g and I w_dot + w x I w = tau", vanishes(wrong, {})),
    ]


def prove_energy(formula: Formula, kind: BodyKind) -> list[Finding]:
    """T = (m v.v + w.I w)/2, U = -m g.p, m v, p x m v + R I w with R v = q v q*."""
    given, found = vectors(formula.function)
    m, inertia = _body(kind, given)
    p, v = sp.Matrix(given["q"][:3]), sp.Matrix(given["u"][:3])
    own, spin = sp.Integer(0), p.cross(m * v)
    rules: dict[sp.Expr, sp.Expr] = {}
    if kind.motion == "free":
        w = sp.Matrix(given["u"][3:])
        b, a = given["q"][3], sp.Matrix(given["q"][4:])
        rules, L = {b: 1 - a.dot(a)}, inertia * w
        own, spin = w.dot(L), spin + L * (b**2 - a.dot(a)) + 2 * a * a.dot(L) + 2 * b * a.cross(L)
    wanted = {
        "kinetic": sp.Matrix([(m * v.dot(v) + own) / 2]),
        "potential": sp.Matrix([-m * given["gravity"].dot(p)]),
        "momentum": m * v, "spin": spin,
    }  # fmt: skip
    routes = ("(m v.v + w.I w)/2", "-m g.p", "m v", "p x m v + q (I w) q*")
    return [
        proved(name, route, vanishes(list(found[name] - wanted[name]), rules))
        for (name, route) in zip(wanted, routes, strict=True)
    ]


def prove_surface(formula: Formula, kind: ShapeKind) -> list[Finding]:
    """The point satisfies the equation; the normal is a unit vector across both tangents."""
    given, found = vectors(formula.function)
    x, n, uv = found["x"], found["n"], given["uv"]
    across = [n.dot(x.diff(symbol)) for symbol in uv]
    findings = [proved("n", "n.n = 1, n.c_u = n.c_v = 0", vanishes([n.dot(n) - 1, *across], {}))]
    equation = surface_of(kind).implicit
    if equation is None or kind.kind in ROOTED:
        return findings
    place, p = ca.SX.sym("x", 3), ca.SX.sym("parameters", len(kind.parameter_names))
    value = ca.Function(
        "phi", [place, p], [ca.densify(equation(place, p).value + zeros(1))], ["x", "parameters"], ["phi"]
    )
    inputs, outputs = vectors(value)
    phi = outputs["phi"][0].xreplace(dict(zip(inputs["x"], x, strict=True)))
    return [proved("x", "the equation of the surface holds at x", vanishes([phi], {})), *findings]


def prove_curve(formula: Formula, kind: ShapeKind) -> list[Finding]:
    """The tangent is the derivative of the point."""
    given, found = vectors(formula.function)
    wrong = list(found["x"].diff(given["s"][0]) - found["tangent"])
    return [proved("tangent", "derivative of x by s", vanishes(wrong, {}))]


def prove_centres(formula: Formula, kind: ContactKind) -> list[Finding]:
    """d_ddot = J u_dot + gamma for two centres that move by p + v t + a t^2/2, f's seen from o."""
    given, found = vectors(formula.function)
    t = sp.Symbol("t", real=True)
    moved: dict[sp.Expr, sp.Expr] = {}
    apart: dict[
        sp.Expr, sp.Expr
    ] = {}  # symbols of f as those of o and a difference: (p + r) - p is r at once
    speed, gain = sp.Integer(0), found["gamma"][0]
    both = bool(given["twist_o"].shape[0] and given["twist_f"].shape[0])
    for side in "of":
        p, v, J = given[f"pose_{side}"], given[f"twist_{side}"], found[f"J_{side}"]
        if not v.shape[0]:
            continue
        a = sp.symbols(f"a_{side}_:3", real=True)
        moved |= {p[k]: p[k] + v[k] * t + a[k] * t**2 / 2 for k in range(3)}
        speed += sum(J[k] * v[k] for k in range(3))
        gain += sum(J[k] * a[k] for k in range(3))
        if both and side == "f":
            columns = ((p, given["pose_o"]), (v, given["twist_o"]), (a, sp.symbols("a_o_:3", real=True)))
            apart = {f[k]: o[k] + sp.Symbol(f"{f[k]}_rel", real=True) for f, o in columns for k in range(3)}
    d = found["d"][0].xreplace(moved).xreplace(apart)
    first, second = (d.diff(t, order).subs(t, 0) for order in (1, 2))
    speed, gain = speed.xreplace(apart), gain.xreplace(apart)
    return [
        proved("J", "J u is the derivative of d along the motion", vanishes([first - speed], {})),
        proved("gamma", "J u_dot + gamma is its second derivative", vanishes([second - gain], {})),
    ]


def _unfolded(kind: BodyKind | ShapeKind) -> bool:
    return kind.folded is None


def _two_spheres(kind: ContactKind) -> bool:
    """Centres in the origins of their bodies, numbers left as parameters, the normal row alone."""
    sides = (kind.o, kind.f)
    plain = all(
        s.placement == "identity" and s.shape.kind in ("sphere", "point") and _unfolded(s.shape)
        for s in sides
    )
    return kind.form == "explicit" and kind.rows == 1 and plain


MUST_BE_PROVED: Mapping[str, tuple[str, Callable[..., bool], Callable[..., list[Finding]]]] = {  # by role
    "pose": ("body_kinds", lambda kind: True, prove_pose),
    "motion": ("body_kinds", _unfolded, prove_motion),
    "energy": ("body_kinds", _unfolded, prove_energy),
    "surface": ("shape_kinds", lambda kind: _unfolded(kind) and kind.kind in SURFACES, prove_surface),
    "curve": ("shape_kinds", lambda kind: _unfolded(kind) and kind.kind in CURVES, prove_curve),
    "rates": ("contact_kinds", _two_spheres, prove_centres),
}


def must_be_proved(formula: Formula, model: Model) -> bool:
    """Whether the formula stands in the table, as opposed to being tested on random configurations alone."""
    if formula.role not in MUST_BE_PROVED:
        return False
    group, applies, _ = MUST_BE_PROVED[formula.role]
    kinds = getattr(model, group)
    return formula.kind < len(kinds) and bool(applies(kinds[formula.kind]))  # limits follow the contacts


def prove(formula: Formula, model: Model) -> list[Finding]:
    """The identities of a formula that must be proved; none for others."""
    if not must_be_proved(formula, model):
        return []
    group, _, proof = MUST_BE_PROVED[formula.role]
    return proof(formula, getattr(model, group)[formula.kind])
