"""Springs and dampers along the first coordinate of a joint, as loads on both bodies."""

from __future__ import annotations

import casadi as ca

from modelgen.joint.joint_frames import Meeting, meeting
from modelgen.joint.joint_kernels import numbers_of, parameters_of
from modelgen.joint.joint_limits import coordinate_of, is_turn
from modelgen.model import LoadKind


def spring_kernel(kind: LoadKind) -> ca.Function:
    """`mg_<kind>_wrench` of a load: the wrenches of -k (coordinate - rest) - c rate.

    parameters: those of the joint, then stiffness, damping, rest. An angle deviates by at most half a turn.
    """
    m, numbers, spring = meeting(), numbers_of(kind.joint), ca.SX.sym("spring", 3)
    stiffness, damping, _ = ca.vertsplit(spring)
    rate = m.rate(coordinate_of(kind.joint).value(m, numbers))
    push = -stiffness * _deflection(kind, m, numbers, spring) - damping * rate.total
    inputs = {"t": m.t, **m.moving, "parameters": parameters_of(m, numbers, spring)}
    outputs = {"wrench_a": push * rate.J_a.T, "wrench_b": push * rate.J_b.T}
    return m.kernel(f"mg_{kind.name}_wrench", inputs, outputs)


def deflection_kernel(kind: LoadKind) -> ca.Function:
    """`mg_<kind>_deflection`: (pose_a, pose_b, parameters) -> (deflection(1) m or rad, J(12)).

    The deflection is coordinate - rest, of the same parameters; its rate is J u.
    """
    m, numbers, spring = meeting(), numbers_of(kind.joint), ca.SX.sym("spring", 3)
    rate = m.rate(coordinate_of(kind.joint).value(m, numbers))
    inputs = {"pose_a": m.a.pose, "pose_b": m.b.pose, "parameters": parameters_of(m, numbers, spring)}
    outputs = {
        "deflection": _deflection(kind, m, numbers, spring),
        "J": ca.horzcat(rate.J_a, rate.J_b).T,
    }
    return m.kernel(f"mg_{kind.name}_deflection", inputs, outputs)


def _deflection(kind: LoadKind, m: Meeting, numbers: ca.SX, spring: ca.SX) -> ca.SX:
    off = coordinate_of(kind.joint).value(m, numbers) - spring[2]
    return ca.atan2(ca.sin(off), ca.cos(off)) if is_turn(kind.joint) else off
