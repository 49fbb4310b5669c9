"""Kernels of the joints: their rows with J and Gamma1 (2.6), and their coordinates."""

from __future__ import annotations

from functools import lru_cache

import casadi as ca

from modelgen.dynamics.inputs import input_argument, input_values
from modelgen.geometry.expression_translation import lower
from modelgen.joint.joint_equations import FORMS
from modelgen.joint.joint_frames import Meeting, Rate, meeting
from modelgen.model import JointKind
from modelgen.scene.joint_format import SPIN


def numbers_of(kind: str) -> ca.SX:
    """Symbols of the kind's own parameters."""
    return ca.SX.sym("numbers", len(FORMS[kind].numbers))


def parameters_of(m: Meeting, numbers: ca.SX, *more: ca.SX) -> ca.SX:
    """The argument: both placements (12 each), the characteristic length, the kind's numbers, and more."""
    return ca.vertcat(m.placements, m.length, numbers, *more)


def values_of(kind: JointKind, m: Meeting, numbers: ca.SX, settings: dict[str, ca.SX]) -> ca.SX:
    """The rows (k,) m that vanish, that of a given motion last; `settings` is the argument of its inputs."""
    form = FORMS[kind.kind]
    rows = [] if kind.motion is not None and form.moves else form.rows(m, numbers)
    if kind.motion is not None:
        assert form.given is not None
        rows.append(form.given(m, lower(kind.motion, {"t": m.t} | input_values(kind.inputs, m.t, settings))))
    return ca.vertcat(ca.SX(0, 1), *rows)


@lru_cache(maxsize=256)
def held_row_count(kind: JointKind) -> int:
    """Number of rows that a joint of this kind holds."""
    return int(values_of(kind, meeting(), numbers_of(kind.kind), input_argument(kind.inputs)).numel())


def inertial_row_count(kind: JointKind) -> int:
    """Number of rows of the armature of a joint of this kind."""
    return sum(3 if name == SPIN else 1 for name in kind.armature)


def row_count(kind: JointKind) -> int:
    """Number of all rows of a joint of this kind: those that it holds, then those of its armature."""
    return held_row_count(kind) + inertial_row_count(kind)


def rows_kernel(kind: JointKind) -> ca.Function:
    """`mg_<kind>_rows`: (t, pose_a, twist_a, pose_b, twist_b, parameters) ->
    (value(k) m, J(12 k), gamma1(k) m/s^2, bias(k) m/s); J row after row, a then b.

    value_dot = J u + bias and value_ddot = J u_dot + gamma1. A joint whose motion depends on inputs also
    takes `inputs`, their settings. Rows of armature I come last: J u is the rate of a coordinate times
    sqrt(I), and the value 0.
    """
    m, numbers, settings = meeting(), numbers_of(kind.kind), input_argument(kind.inputs)
    armature = ca.SX.sym("armature", len(kind.armature))
    value = values_of(kind, m, numbers, settings)
    rates = [m.rate(value)]
    for k, name in enumerate(kind.armature):
        rates.append(_scaled(ca.sqrt(armature[k]), _inertial_rate(kind.kind, name, m, numbers)))
        value = ca.vertcat(value, ca.SX(int(rates[-1].gamma.numel()), 1))
    J = ca.vertcat(*(ca.horzcat(rate.J_a, rate.J_b) for rate in rates))
    outputs = {
        "value": ca.densify(value),
        "J": ca.vec(J.T),
        "gamma1": ca.vertcat(*(rate.gamma for rate in rates)),
        "bias": ca.vertcat(*(rate.bias for rate in rates)),
    }
    inputs = {"t": m.t, **m.moving, "parameters": parameters_of(m, numbers, armature)} | settings
    return m.kernel(f"mg_{kind.name}_rows", inputs, outputs)


def _inertial_rate(kind: str, name: str, m: Meeting, numbers: ca.SX) -> Rate:
    """The rate that an armature belongs to."""
    if name == SPIN:
        return m.relative_spin()
    value = next(each.value for each in FORMS[kind].coordinates if each.name == name)
    return m.rate(value(m, numbers))


def _scaled(factor: ca.SX, rate: Rate) -> Rate:
    parts = (rate.J_a, rate.J_b, rate.gamma, rate.bias, rate.total)
    return Rate(*(factor * part for part in parts))


def coordinates_kernel(kind: JointKind) -> ca.Function:
    """`mg_<kind>_coordinates`: (pose_a, pose_b, parameters) -> (coordinate(c))."""
    m, numbers = meeting(), numbers_of(kind.kind)
    armature = ca.SX.sym("armature", len(kind.armature))
    values = [each.value(m, numbers) for each in FORMS[kind.kind].coordinates]
    parameters = parameters_of(m, numbers, armature)
    inputs = {"pose_a": m.a.pose, "pose_b": m.b.pose, "parameters": parameters}
    return m.kernel(f"mg_{kind.name}_coordinates", inputs, {"coordinate": ca.vertcat(ca.SX(0, 1), *values)})
