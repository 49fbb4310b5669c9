"""Data on which the errata are decided: random contacts, the paper's quantities, and independent values.

The paper's quantities are taken from the forms that follow it; what is compared with is the motion alone.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

import casadi as ca
import numpy as np

from modelgen.contact.contact_symbols import Pair, Partner, pair
from modelgen.contact.curve_curve import crossing
from modelgen.contact.form_table import eta_layout
from modelgen.contact.normal_row import jet_of_curve, levers
from modelgen.contact.paper_curves import (
    Strand,
    angles_function,
    curve_surface_theorem,
    curves_theorem,
    relative,
    strand,
)
from modelgen.contact.paper_surfaces import angle_function, montana
from modelgen.contact.surface_points import montana_frame
from modelgen.model import ContactKind, ShapeKind, Side
from modelgen.verification.contacts import Sample, along_motion, moving_inputs, sample
from modelgen.verification.extremal_motion import columns
from modelgen.verification.random_configurations import partnership

Array = np.ndarray[Any, Any]

_SHAPES: Mapping[str, tuple[str, tuple[float, ...]]] = {  # parameter names, and lengths in m
    "ellipsoid": ("a b c", (1.0, 0.7, 0.5)),
    "torus": ("major minor", (1.0, 0.4)),
    "sphere": ("radius", (0.6,)),
    "circle": ("radius", (0.7,)),
    "ellipse_curve": ("a b", (0.9, 0.5)),
    "helix": ("radius pitch", (0.5, 0.15)),
}


@dataclass(frozen=True)
class Ground:
    """Configurations of one kind of contact; arrays have the configuration as their first axis."""

    sample: Sample
    paper: Mapping[str, Array]  # quantities of the paper by name
    angle_rates: Mapping[str, Array]  # rates of psi and phi by differentiation of the angles themselves

    @property
    def n(self) -> int:
        return self.sample.n

    def world(self, side: str) -> Body:
        """Velocities and accelerations in world axes, and the contact point of one side."""
        at, known = self.sample.at, self.sample.truth
        pose, twist, accel = (getattr(at, f"{name}_{side}").T for name in ("pose", "twist", "accel"))
        R = pose[:, 3:].reshape(-1, 3, 3).transpose(0, 2, 1)

        def turned(x: Array) -> Array:
            return np.asarray(np.einsum("nij,nj->ni", R, x))

        return Body(
            p=pose[:, :3], R=R, v=twist[:, :3], w=turned(twist[:, 3:]), v_dot=accel[:, :3],
            w_dot=turned(accel[:, 3:]), r=getattr(known, f"point_{side}").T - pose[:, :3],
            slide=turned(getattr(known, f"x_{side}_dot").T),
        )  # fmt: skip

    @property
    def N(self) -> Array:
        return self.sample.truth.normal.T

    @property
    def N_dot(self) -> Array:
        return self.sample.truth.normal_rate.T


@dataclass(frozen=True)
class Body:
    """(n,3) each, world axes; R (n,3,3)."""

    p: Array
    R: Array
    v: Array
    w: Array
    v_dot: Array
    w_dot: Array
    r: Array  # lever of the contact point
    slide: Array  # R l_dot


def _kind(o: str, f: str, form: str) -> tuple[ContactKind, tuple[float, ...]]:
    one, two = (Side(ShapeKind(name, name, tuple(_SHAPES[name][0].split())), "free") for name in (o, f))
    return ContactKind("paper", form, one, two), _SHAPES[o][1] + _SHAPES[f][1]


@cache
def ground(o: str, f: str, form: str, n: int, seed: int) -> Ground:
    """n configurations of two shapes in one of the forms that follow the paper."""
    kind, numbers = _kind(o, f, form)
    drawn = sample(partnership(kind, numbers, 1.0), n, seed)
    symbols = pair(kind, eta_layout(kind))
    build = {"paper": _surfaces, "curve_paper": _curve_on_surface, "curves_paper": _two_curves}[form]
    values, angle = build(symbols)
    arguments = [
        symbols.o.pose, symbols.o.twist, symbols.f.pose, symbols.f.twist, symbols.eta,
        ca.vertcat(symbols.o.argument, symbols.f.argument),
    ]  # fmt: skip
    function = ca.Function("paper", arguments, list(values.values()))
    inputs = moving_inputs(drawn)
    found = {
        name: _stacked(out, drawn.n) for name, out in zip(values, columns(function, *inputs), strict=True)
    }
    names = tuple(name for name in angle.name_out() if not name.endswith("_dot"))
    slopes = along_motion(drawn, angle, names)
    return Ground(drawn, found, {name: slope.ravel() for name, slope in zip(names, slopes, strict=True)})


def _stacked(out: Array, n: int) -> Array:
    """(n,), (n,rows) or (n,rows,columns) of what a mapped function returns side by side."""
    width = out.shape[1] // n
    value = out.reshape(out.shape[0], n, width).transpose(1, 0, 2)
    return (
        value[..., 0]
        if width == 1 and out.shape[0] > 1
        else value.reshape(n)
        if value[0].size == 1
        else value
    )


def _surfaces(at: Pair) -> tuple[dict[str, ca.SX], ca.Function]:
    """Quantities of Theorem 4.1, with the literal frames of Appendix E.1."""
    m = montana(at)
    values = {
        "M_o": m.o.M, "M_f": m.f.M, "K_o": m.o.K, "K_f": m.f.K, "T_o": m.o.T, "T_f": m.f.T,
        "R_psi": m.R_psi, "v": m.v, "w": m.w, "d": m.d, "axes_o": m.axes_o, "axes_f": m.axes_f,
    }  # fmt: skip
    for side, partner, uv in (("o", at.o, at.eta_o), ("f", at.f, at.eta_f)):
        values |= {f"{name}_{side}": value for name, value in _literal(partner, uv).items()}
    return {name: ca.densify(value) for name, value in values.items()}, angle_function(at, "angle")


def _literal(partner: Partner, uv: ca.SX) -> dict[str, ca.SX]:
    """x = c_u/|c_u|, y = c_v/|c_v|, M = diag(|c_u|, |c_v|), K = [x y]^T [z_u/|c_u|, z_v/|c_v|]."""
    symbols = ca.SX.sym("uv", 2)
    frame = montana_frame(partner, symbols)
    tangents, turning = ca.jacobian(frame.point, symbols), ca.jacobian(frame.normal, symbols)
    lengths = ca.vertcat(*(ca.norm_2(tangents[:, k]) for k in range(2)))
    axes = tangents @ ca.diag(1 / lengths)
    K = axes.T @ turning @ ca.diag(1 / lengths)
    values = {"literal_axes": axes, "literal_M": ca.diag(lengths), "literal_K": K}
    placed = ca.substitute(list(values.values()), [symbols], [uv])
    placed[0] = partner.rotation @ placed[0]
    return dict(zip(values, placed, strict=True))


def _curve(partner: Partner, t: ca.SX, piece: Strand, side: str) -> dict[str, ca.SX]:
    """kappa = k sin(phi), k cos(phi), speed, torsion, tangent, k times the principal normal (world), phi."""
    jet = jet_of_curve(partner, t)
    third = ca.jacobian(jet.second, t)
    binormal = ca.cross(jet.first, jet.second)
    bent = ca.cross(binormal, jet.first) / ca.sumsqr(jet.first) ** 2
    values = {
        "kappa": piece.normal_curvature, "geodesic": piece.geodesic_curvature, "speed": piece.speed,
        "tau": ca.dot(binormal, third) / ca.sumsqr(binormal), "T": piece.axes[:, 0],
        "kN": partner.rotation @ bent, "axes": piece.axes,
        "T_rate": partner.rotation @ ca.jacobian(jet.first / ca.norm_2(jet.first), t),
    }  # fmt: skip
    return {f"{name}_{side}": ca.densify(value) for name, value in values.items()}


def _curve_on_surface(at: Pair) -> tuple[dict[str, ca.SX], ca.Function]:
    """Quantities of Theorem 4.6."""
    o = montana_frame(at.o, at.eta_o)
    N = at.o.rotation @ o.normal
    here = levers(at, o.point, jet_of_curve(at.f, at.eta_f).x)
    f = strand(at.f, at.eta_f, -N)
    V, axes_o = relative(at, N, here, f.axes), at.o.rotation @ o.axes
    values = {
        "M_o": o.M, "K_o": o.K, "T_o": o.T, "R_psi": axes_o.T @ f.axes, "v": V.v, "w": V.w,
        "d": ca.dot(N, here.point_f - here.point_o), "axes_o": axes_o,
    }  # fmt: skip
    values = {name: ca.densify(value) for name, value in values.items()}
    angle = angles_function(at, curve_surface_theorem(at), "angle")
    return values | _curve(at.f, at.eta_f, f, "f"), angle


def _two_curves(at: Pair) -> tuple[dict[str, ca.SX], ca.Function]:
    """Quantities of Theorem 4.3."""
    here = crossing(at)
    o, f = strand(at.o, at.eta[0], here.N), strand(at.f, at.eta[1], -here.N)
    V, R_psi = relative(at, here.N, here.levers, f.axes), o.axes.T @ f.axes
    values = {"R_psi": R_psi, "v": V.v, "w": V.w, "d": here.d}
    angle = angles_function(at, curves_theorem(at), "angle")
    return values | _curve(at.o, at.eta[0], o, "o") | _curve(at.f, at.eta[1], f, "f"), angle
