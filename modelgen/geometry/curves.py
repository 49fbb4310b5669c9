"""Curves c(t) with two derivatives, by any regular parameter: the catalogue and the user's own."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, lru_cache
from math import inf, pi

import casadi as ca
import numpy as np

from modelgen.geometry import polynomial_pieces
from modelgen.geometry import support_maps as supports
from modelgen.geometry.expression_translation import lower, lowered_derivative
from modelgen.geometry.frames import zeros
from modelgen.geometry.support_maps import Support
from modelgen.geometry.surface_kernel import shape_parameters
from modelgen.model import ShapeKind
from modelgen.scene.expression_algebra import has_cubic
from modelgen.scene.scene_types import Curve, Shape

SAMPLES = 257  # of a user's curve, for its bounding radius


@dataclass(frozen=True)
class CurveJet:
    """A curve and its derivatives at t; |c'| must not vanish."""

    x: ca.SX  # (3,) m
    first: ca.SX  # (3,) c'
    second: ca.SX  # (3,) c''


@dataclass(frozen=True)
class SpaceCurve:
    """Description of one kind of curve; every callable takes the parameters last."""

    components: Callable[[ca.SX, ca.SX], ca.SX]
    domain: tuple[float, float]
    periodic: bool
    support: Callable[[ca.SX, ca.SX], Support] | None = None
    bounding: Callable[[Sequence[float]], float] = lambda p: inf  # m, radius about the shape's origin
    derivative: Callable[[int, ca.SX, ca.SX], ca.SX] | None = None  # of an order, where known in closed form

    def jet(self, t: ca.SX, p: ca.SX) -> CurveJet:
        if self.derivative is not None:
            return CurveJet(*(self.derivative(order, t, p) for order in range(3)))
        symbol = ca.SX.sym("t")
        x = self.components(symbol, p)
        first = ca.jacobian(x, symbol)
        values = ca.substitute([x, first, ca.jacobian(first, symbol)], [symbol], [t])
        return CurveJet(*values)


def _line(t: ca.SX, p: ca.SX) -> ca.SX:
    return ca.vertcat(zeros(2), t)


def _segment(t: ca.SX, p: ca.SX) -> ca.SX:
    return ca.vertcat(zeros(2), p[0] * t)


def _edge(t: ca.SX, p: ca.SX) -> ca.SX:
    return ca.vertcat(t, zeros(2))


def _circle(t: ca.SX, p: ca.SX) -> ca.SX:
    return ca.vertcat(p[0] * ca.cos(t), p[0] * ca.sin(t), zeros(1))


def _ellipse(t: ca.SX, p: ca.SX) -> ca.SX:
    return ca.vertcat(p[0] * ca.cos(t), p[1] * ca.sin(t), zeros(1))


def _helix(t: ca.SX, p: ca.SX) -> ca.SX:
    return ca.vertcat(p[0] * ca.cos(t), p[0] * ca.sin(t), p[1] * t)


_TURN, _ENDLESS = (-pi, pi), (-inf, inf)

CURVES: Mapping[str, SpaceCurve] = {
    "line": SpaceCurve(_line, _ENDLESS, False),
    "segment": SpaceCurve(_segment, (-0.5, 0.5), False, bounding=lambda p: p[0] / 2),
    "edge": SpaceCurve(_edge, _ENDLESS, False, bounding=lambda p: p[0] / 2),
    "circle": SpaceCurve(_circle, _TURN, True, supports.circle, lambda p: p[0]),
    "ellipse_curve": SpaceCurve(_ellipse, _TURN, True, supports.ellipse, lambda p: max(p[0:2])),
    "helix": SpaceCurve(_helix, _ENDLESS, False),
    "bezier_curve": SpaceCurve(
        polynomial_pieces.bezier_curve, (0.0, 1.0), False, bounding=polynomial_pieces.bezier_radius
    ),
}


def is_curve(shape: ShapeKind | Shape) -> bool:
    """Whether the shape is a curve instead of a surface."""
    return shape.curve is not None or shape.kind in CURVES


STRAIGHT: Mapping[str, tuple[float, float, float]] = {  # through the origin, along this axis
    "line": (0.0, 0.0, 1.0), "segment": (0.0, 0.0, 1.0), "edge": (1.0, 0.0, 0.0)
}  # fmt: skip


def is_straight(shape: ShapeKind | Shape) -> bool:
    """Whether the shape is a straight line, with or without ends."""
    return shape.kind in STRAIGHT


def may_bend(shape: ShapeKind | Shape) -> bool:
    """Whether the shape is a curve that may have inflections."""
    return is_curve(shape) and not is_straight(shape) and curve_of(shape).support is None


def curve_of(shape: ShapeKind | Shape) -> SpaceCurve:
    """The curve of a kind of the catalogue or of the user's own."""
    if shape.curve is None:
        return CURVES[shape.kind]
    if isinstance(shape, ShapeKind):
        return _user_curve(shape.curve, shape.parameter_names)
    return _user_curve(shape.curve, tuple(name for name, _ in shape.parameters))


@lru_cache(maxsize=512)
def _user_curve(curve: Curve, names: tuple[str, ...]) -> SpaceCurve:
    def derivative(order: int, t: ca.SX, p: ca.SX) -> ca.SX:
        symbols = {"t": t} | {name: p[i] for i, name in enumerate(names)}
        return lowered_derivative(curve.components, "t" * order, symbols, {})

    def components(t: ca.SX, p: ca.SX) -> ca.SX:
        return derivative(0, t, p)

    def bounding(p: Sequence[float]) -> float:
        """Largest distance from the origin on a grid, plus the largest step of the grid."""
        if not np.isfinite(curve.domain).all():
            return inf
        grid = np.linspace(*curve.domain, SAMPLES).reshape(1, -1)
        x = np.asarray(_point(curve, names)(grid, ca.DM(list(p))))
        steps = np.linalg.norm(np.diff(x, axis=1), axis=0)
        return float(np.linalg.norm(x, axis=0).max() + steps.max())

    has_spline = any(has_cubic(each.tree) for each in curve.components)
    return SpaceCurve(
        components, curve.domain, curve.periodic, bounding=bounding,
        derivative=derivative if has_spline else None,
    )  # fmt: skip


@lru_cache(maxsize=64)
def _point(curve: Curve, names: tuple[str, ...]) -> ca.Function:
    """t, parameters -> point (3)."""
    t, p = ca.SX.sym("t"), ca.SX.sym("p", len(names))
    symbols = {"t": t} | {name: p[i] for i, name in enumerate(names)}
    x = ca.vertcat(*(lower(expression, symbols) for expression in curve.components))
    return ca.Function("point", [t, p], [ca.densify(x)])


@cache
def curve_kernel(kind: ShapeKind) -> ca.Function:
    """`mg_<kind>_curve`: (s(1), parameters) -> (x(3) m, tangent(3) = c', of any length), shape frame."""
    argument, parameters = shape_parameters(kind)
    s = ca.SX.sym("s")
    jet = curve_of(kind).jet(s, parameters)
    outputs = ca.cse([ca.densify(jet.x), ca.densify(jet.first)])
    return ca.Function(f"mg_{kind.name}_curve", [s, argument], outputs, ["s", "parameters"], ["x", "tangent"])
