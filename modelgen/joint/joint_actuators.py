"""Actuators on the first coordinate of a joint, as loads on both bodies."""

from __future__ import annotations

import casadi as ca

from modelgen.dynamics.bodies import kernel
from modelgen.dynamics.inputs import input_argument, input_values
from modelgen.dynamics.loads import LoadFormulas
from modelgen.geometry.expression_branches import Branches
from modelgen.geometry.expression_translation import lower
from modelgen.joint.joint_frames import meeting
from modelgen.joint.joint_kernels import numbers_of, parameters_of
from modelgen.joint.joint_limits import coordinate_of
from modelgen.model import LoadKind


def actuator_kernel(kind: LoadKind) -> ca.Function:
    """`mg_<kind>_wrench` of a load: the wrenches of a force along the coordinate of a joint.

    parameters: those of the joint, then the gain, and the least and largest force, N or N m, if the kind has
    limits. The force is gain times the expression, cut off at the limits; an angle lies within half a turn.
    An actuator that depends on inputs also takes `inputs`, their settings.
    """
    formulas = actuator_formulas(kind)
    return kernel(f"mg_{kind.name}_wrench", formulas.inputs, formulas.wrenches)


def actuator_formulas(kind: LoadKind, branches: Branches | None = None) -> LoadFormulas:
    """Those of `actuator_kernel`, on `branches` if there are any."""
    assert kind.law is not None
    m, numbers, own = meeting(), numbers_of(kind.joint), ca.SX.sym("actuator", 3 if kind.limited else 1)
    value, settings = coordinate_of(kind.joint).value(m, numbers), input_argument(kind.inputs)
    rate = m.rate(value)
    names = {"t": m.t, "coordinate": value, "rate": rate.total} | input_values(kind.inputs, m.t, settings)
    push = own[0] * lower(kind.law, names, branches)
    if kind.limited:
        least, greatest = (branches.least, branches.greatest) if branches else (ca.fmin, ca.fmax)
        push = least(greatest(push, own[1]), own[2])
    inputs = {"t": m.t, **m.moving, "parameters": parameters_of(m, numbers, own)} | settings
    outputs = {"wrench_a": push * rate.J_a.T, "wrench_b": push * rate.J_b.T}
    if branches and branches.functions:
        branches.functions = m.placed(branches.functions)
    return LoadFormulas(inputs, dict(zip(outputs, m.placed(outputs.values()), strict=True)))


def law_of(kind: LoadKind) -> ca.Function:
    """The expression of an actuator as a function (t, coordinate, rate, inputs) -> (force)."""
    assert kind.law is not None
    t, state, settings = ca.SX.sym("t"), ca.SX.sym("state", 2), input_argument(kind.inputs)
    names = {"t": t, "coordinate": state[0], "rate": state[1]} | input_values(kind.inputs, t, settings)
    given = {"t": t, "state": state} | settings
    return ca.Function("law", list(given.values()), [lower(kind.law, names)], list(given), ["force"])
