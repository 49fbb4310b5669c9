"""Springs and dampers along the first coordinate of a joint, as loads on both bodies."""

from __future__ import annotations

import casadi as ca

from modelgen.joint.joint_frames import meeting
from modelgen.joint.joint_limits import coordinate_of, is_turn
from modelgen.joint.joint_rows import numbers_of, parameters_of
from modelgen.model import LoadKind


def spring_kernel(kind: LoadKind) -> ca.Function:
    """`mg_<kind>_wrench` of a load: the wrenches of -k (coordinate - rest) - c rate.

    parameters: those of the joint, then stiffness, damping, rest. An angle deviates by at most half a turn.
    """
    m, numbers, spring = meeting(), numbers_of(kind.joint), ca.SX.sym("spring", 3)
    stiffness, damping, rest = ca.vertsplit(spring)
    value = coordinate_of(kind.joint).value(m, numbers)
    rate = m.rate(value)
    off = value - rest
    off = ca.atan2(ca.sin(off), ca.cos(off)) if is_turn(kind.joint) else off
    push = -stiffness * off - damping * rate.total
    inputs = {"t": m.t, **m.moving, "parameters": parameters_of(m, numbers, spring)}
    outputs = {"wrench_a": push * rate.J_a.T, "wrench_b": push * rate.J_b.T}
    return m.kernel(f"mg_{kind.name}_wrench", inputs, outputs)
