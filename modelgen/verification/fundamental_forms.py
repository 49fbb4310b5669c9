"""Fundamental forms, curvature and torsion of a scene's own shapes in closed form, by SymPy.

The components c(u, v) or c(t) are read off the function that CasADi has; everything after them is SymPy's.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np
import sympy as sp

from modelgen.geometry.surface_catalogue import exterior_sign
from modelgen.model import ShapeKind
from modelgen.verification.contact_sides import Feature, feature_of
from modelgen.verification.sympy_evaluation import value_of
from modelgen.verification.sympy_translation import definition
from modelgen.verification.trigonometric_simplification import Sign, short, square_root

LONGEST = 80  # operations in the components of a shape; longer ones are left to CasADi
SIGNED = ("paraboloid", "chart", "curve")  # kinds whose parameters may be negative
FUNCTIONS = (sp.sin, sp.cos)  # that the shortening knows; shapes with others are left to CasADi
WIDE = 25  # operations of |c_u x c_v| from which on it is a name of its own
PROBES = 9  # random points that decide which root of a square is meant


@dataclass(frozen=True)
class ClosedForms:
    """Quantities of one shape by name, as matrices in its coordinates and parameters."""

    shape: ShapeKind
    coordinates: tuple[sp.Symbol, ...]
    parameters: tuple[sp.Symbol, ...]
    quantities: Mapping[str, sp.MatrixBase]


def closed_forms(shape: ShapeKind) -> ClosedForms | None:
    """Closed forms of a surface (c, normal z, I, II, M, K, T) or of a curve (c, speed, curvature k, torsion
    tau).

    None of a point, of folded numbers, and of a shape whose formula is too long to be read.
    """
    feature = feature_of(shape, 1.0)
    if feature.dimension == 0 or shape.folded is not None or len(shape.parameter_names) > 8:
        return None
    names = ("u", "v") if feature.dimension == 2 else ("t",)
    coordinates = tuple(sp.Symbol(name, real=True) for name in names)
    parameters = tuple(
        sp.Symbol(name, real=True, positive=None if shape.kind in SIGNED else True)
        for name in shape.parameter_names
    )
    c = _components(feature, coordinates, parameters)
    if c is None:
        return None
    sign = _sign_over(feature, coordinates, parameters)
    if feature.dimension == 1:
        return ClosedForms(shape, coordinates, parameters, _curve(c, coordinates[0], sign))
    quantities = _surface(c, coordinates, sign, int(exterior_sign(shape)))
    return ClosedForms(shape, coordinates, parameters, quantities)


def _components(
    feature: Feature, coordinates: Sequence[sp.Symbol], parameters: Sequence[sp.Symbol]
) -> sp.MatrixBase | None:
    alpha, p = ca.SX.sym("alpha", feature.dimension), ca.SX.sym("p", len(parameters))
    x = ca.Function("x", [alpha, p], [ca.densify(feature.point(alpha, p))], ["alpha", "p"], ["x"])
    names = {
        "alpha": [f"alpha{k}" for k in range(len(coordinates))],
        "p": [f"p{k}" for k in range(len(parameters))],
        "x": ["x0", "x1", "x2"],
    }
    known: dict[sp.Basic, sp.Basic] = {}
    for key, symbols in (("alpha", coordinates), ("p", parameters)):
        known |= {sp.Symbol(n, real=True): s for n, s in zip(names[key], symbols, strict=True)}
    for line in definition(x, names):
        value = line.value.xreplace(known)
        known[line.target] = value.xreplace(
            {f: sp.nsimplify(f, rational=True) for f in value.atoms(sp.Float)}
        )
    c = sp.Matrix([known[sp.Symbol(name, real=True)] for name in names["x"]])
    c = c.xreplace({f: sp.sin(f.args[0]) / sp.cos(f.args[0]) for f in c.atoms(sp.tan)})
    foreign = {f for f in c.atoms(sp.Function) if not isinstance(f, FUNCTIONS)}
    powers = any(not e.exp.is_Integer for e in c.atoms(sp.Pow))
    return None if foreign or powers or sum(sp.count_ops(e) for e in c) > LONGEST else c


def _sign_over(feature: Feature, coordinates: Sequence[sp.Symbol], parameters: Sequence[sp.Symbol]) -> Sign:
    """The sign of an expression at random points of the domain, 0 where it changes."""
    random = np.random.default_rng(0)
    probes = []
    for _ in range(PROBES):
        values = {s: random.uniform(*ends) for s, ends in zip(coordinates, feature.ranges, strict=True)}
        sizes = np.sort(random.uniform(0.5, 1.5, len(parameters)))[::-1]
        if feature.shape.kind in SIGNED:
            sizes = sizes * random.choice([-1.0, 1.0], len(parameters))
        probes.append(values | dict(zip(parameters, sizes, strict=True)))

    def sign(expression: sp.Expr) -> int:
        signs = {int(np.sign(value_of(expression, probe))) for probe in probes}
        return signs.pop() if len(signs) == 1 else 0

    return sign


def _surface(c: sp.MatrixBase, uv: Sequence[sp.Symbol], sign: Sign, outward: int) -> dict[str, sp.MatrixBase]:
    """M upper triangular as in `contact.points.MontanaFrame`; K and T in its frame.

    Where W = |c_u x c_v| is long, M, K and T are written with W and the entries E, F, G and L, M, N.
    """
    u, v = uv
    c_u, c_v = c.diff(u), c.diff(v)
    second = c_u.diff(u), c_u.diff(v), c_v.diff(v)
    area = c_u.cross(c_v)
    first = [short(sp.expand(a.dot(b))) for a, b in ((c_u, c_u), (c_u, c_v), (c_v, c_v))]
    W = square_root(sp.expand(area.dot(area)), sign)
    long = sp.count_ops(W) > WIDE
    w = sp.Symbol("W", positive=True) if long else W
    bent = [short(-outward * sp.expand(area.dot(each))) / w for each in second]
    along = [short(sp.expand(first[0] * c_v.dot(each) - first[1] * c_u.dot(each))) for each in second[:2]]
    z = (outward * area).applyfunc(lambda x: short(x) / w)
    quantities = {"c": c, "z": z, "I": _symmetric(first), "II": _symmetric(bent)}
    if long:
        names = sp.symbols("E F G L M N", real=True)
        own = _frame_forms(names[:3], names[3:], along, w, sp.sqrt(names[0]), outward)
        return {**quantities, "W": sp.Matrix([[W]]), **own}
    own = _frame_forms(first, bent, along, w, square_root(first[0], sign), outward)
    return {**quantities, **{name: form.applyfunc(short) for name, form in own.items()}}


def _symmetric(entries: Sequence[sp.Expr]) -> sp.MatrixBase:
    return sp.Matrix([[entries[0], entries[1]], [entries[1], entries[2]]])


def _frame_forms(
    first: Sequence[sp.Expr],
    bent: Sequence[sp.Expr],
    along: Sequence[sp.Expr],
    W: sp.Expr,
    e: sp.Expr,
    outward: int,
) -> dict[str, sp.MatrixBase]:
    """M, K and T from E, F, G; L, M, N; E c_v.c_ua - F c_u.c_ua; W and e = sqrt(E)."""
    (E, F, _), (L, M, N) = first, bent
    K = (L / E, (E * M - F * L) * outward / (E * W), (E * E * N - 2 * E * F * M + F * F * L) / (E * W * W))
    T = along[0] * outward / (e * W * E), (E * along[1] - F * along[0]) / (E * W * W * e)
    metric = sp.Matrix([[e, F / e], [0, outward * W / e]])
    return {"M": metric, "K": _symmetric(K), "T": sp.Matrix([T])}


def _curve(c: sp.MatrixBase, t: sp.Symbol, sign: Sign) -> dict[str, sp.MatrixBase]:
    first, second = c.diff(t), c.diff(t, 2)
    area = first.cross(second)
    speed = square_root(short(sp.expand(first.dot(first))), sign)
    square = short(sp.expand(area.dot(area)))
    values = {"speed": speed, "k": short(square_root(square, sign) / speed**3)}
    if square != 0:
        values["tau"] = short(short(sp.expand(area.dot(second.diff(t)))) / square)
    return {"c": c, **{name: sp.Matrix([[value]]) for name, value in values.items()}}
