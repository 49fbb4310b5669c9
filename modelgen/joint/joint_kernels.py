"""Kernels of the joints: their rows with J and Gamma1 (2.6), and their coordinates."""

from __future__ import annotations

from functools import lru_cache

import casadi as ca

from modelgen.dynamics.inputs import input_argument, input_values
from modelgen.geometry.expression_translation import lower
from modelgen.joint.joint_equations import FORMS
from modelgen.joint.joint_frames import Meeting, meeting
from modelgen.model import JointKind


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
def row_count(kind: JointKind) -> int:
    """Number of rows of a joint of this kind."""
    return int(values_of(kind, meeting(), numbers_of(kind.kind), input_argument(kind.inputs)).numel())


def rows_kernel(kind: JointKind) -> ca.Function:
    """`mg_<kind>_rows`: (t, pose_a, twist_a, pose_b, twist_b, parameters) ->
    (value(k) m, J(12 k), gamma1(k) m/s^2, bias(k) m/s); J row after row, a then b.

    value_dot = J u + bias and value_ddot = J u_dot + gamma1. A joint whose motion depends on inputs also
    takes `inputs`, their settings.
    """
    m, numbers, settings = meeting(), numbers_of(kind.kind), input_argument(kind.inputs)
    value = values_of(kind, m, numbers, settings)
    rate = m.rate(value)
    J = ca.horzcat(rate.J_a, rate.J_b)
    outputs = {"value": value, "J": ca.vec(J.T), "gamma1": rate.gamma, "bias": rate.bias}
    inputs = {"t": m.t, **m.moving, "parameters": parameters_of(m, numbers)} | settings
    return m.kernel(f"mg_{kind.name}_rows", inputs, outputs)


def coordinates_kernel(kind: JointKind) -> ca.Function:
    """`mg_<kind>_coordinates`: (pose_a, pose_b, parameters) -> (coordinate(c))."""
    m, numbers = meeting(), numbers_of(kind.kind)
    values = [each.value(m, numbers) for each in FORMS[kind.kind].coordinates]
    inputs = {"pose_a": m.a.pose, "pose_b": m.b.pose, "parameters": parameters_of(m, numbers)}
    return m.kernel(f"mg_{kind.name}_coordinates", inputs, {"coordinate": ca.vertcat(ca.SX(0, 1), *values)})
