"""Limits of joints: contacts without shapes, whose gap is how far a coordinate is from its bound.

An angle is counted on through whole turns: it is the contact's eta, which the pose corrects within half a
turn. A tilt has no derivative at zero; its gap is that of the cosines, which is as steep at the bound.
"""

from __future__ import annotations

import casadi as ca

from modelgen.geometry.frames import zeros
from modelgen.joint.joint_equations import FORMS, Coordinate
from modelgen.joint.joint_frames import Meeting, meeting
from modelgen.joint.joint_kernels import numbers_of, parameters_of
from modelgen.model import LimitKind

CITATION = "limit of a joint's coordinate as a complementarity condition (2.6)"
FAR = 1e30  # 1/m: a limit has no singular closest points


def coordinate_of(kind: str, index: int = 0) -> Coordinate:
    """The first coordinate, which springs and given motions of a joint act on, or a later one."""
    return FORMS[kind].coordinates[index]


def is_turn(kind: str) -> bool:
    """Whether it is an angle."""
    return coordinate_of(kind).measure == "angle"


def limit_kernels(kind: LimitKind) -> tuple[ca.Function, ca.Function]:
    """`mg_<kind>_rates` and `mg_<kind>_place` with the arguments of those of contacts; o and f are a and b.

    parameters: those of the joint, then the bound in rad or m.
    """
    m, numbers, bound = meeting(), numbers_of(kind.kind), ca.SX.sym("bound")
    parameters = parameters_of(m, numbers, bound)
    coordinate, sign = coordinate_of(kind.kind, kind.coordinate), -1.0 if kind.upper else 1.0
    value, lever, at = coordinate.value(m, numbers), ca.SX(sign), bound
    if coordinate.measure == "angle":
        lever = sign * m.length
    elif coordinate.measure == "tilt":
        value, lever, at = -m.cosine("za", "zb"), sign * m.length / ca.sin(bound), -ca.cos(bound)
    eta = ca.SX.sym("eta", 1 if coordinate.measure == "angle" else 0)
    gap = lever * ((eta if eta.numel() else value) - at)
    sides = {"pose_o": m.a.pose, "pose_f": m.b.pose, "eta": eta, "parameters": parameters}
    return (
        _rates(kind, m, value, lever, gap, eta, parameters),
        m.kernel(f"mg_{kind.name}_place", sides, _place(m, value, sign, gap, eta)),
    )


def _rates(
    kind: LimitKind, m: Meeting, value: ca.SX, lever: ca.SX, gap: ca.SX, eta: ca.SX, parameters: ca.SX
) -> ca.Function:
    rate = m.rate(value)
    inputs = {
        "pose_o": m.a.pose, "twist_o": m.a.twist, "pose_f": m.b.pose, "twist_f": m.b.twist,
        "eta": eta, "parameters": parameters,
    }  # fmt: skip
    outputs = {
        "d": gap,
        "J_o": lever * rate.J_a.T,
        "J_f": lever * rate.J_b.T,
        "gamma": lever * rate.gamma,
        "eta_dot": rate.total if eta.numel() else ca.SX(0, 1),
        "normal": _axis(m, ca.SX(-1.0 if kind.upper else 1.0)),
    }
    return m.kernel(f"mg_{kind.name}_rates", inputs, outputs)


def _place(m: Meeting, value: ca.SX, sign: float, gap: ca.SX, eta: ca.SX) -> dict[str, ca.SX]:
    """The angle nearest to eta that the pose allows; a length needs none."""
    off = value - eta if eta.numel() else zeros(1)
    wrapped = ca.atan2(ca.sin(off), ca.cos(off))
    return {
        "eta_next": eta + wrapped if eta.numel() else ca.SX(0, 1),
        "d": gap,
        "residual": ca.vertcat(0, ca.fabs(wrapped)),
        "margin": ca.SX([1.0, FAR]),
        "normal": _axis(m, ca.SX(sign)),
        "point_o": m.a.position,
        "point_f": m.b.position,
    }


def _axis(m: Meeting, sign: ca.SX) -> ca.SX:
    return sign * m.axis("za")
