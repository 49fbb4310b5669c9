"""Kernels of loads that jump or have kinks: their wrenches on a branch, and their switching functions."""

from __future__ import annotations

from collections.abc import Mapping

import casadi as ca

from modelgen.derivation import Derivation, Formula
from modelgen.dynamics.bodies import kernel
from modelgen.dynamics.loads import LoadFormulas, load_formulas
from modelgen.geometry.expression_branches import Branches
from modelgen.geometry.frames import POSE_SIZE, TWIST_SIZE, zeros
from modelgen.joint.joint_actuators import actuator_formulas
from modelgen.model import LoadKind, Model

CITATION = "load between two zeros of its switching functions (Filippov 1988)"
SIZES = {"pose_a": POSE_SIZE, "twist_a": TWIST_SIZE, "pose_b": POSE_SIZE, "twist_b": TWIST_SIZE}


def with_branches(derivation: Derivation) -> Derivation:
    """The derivation and the kernels of its loads on their branches."""
    return Derivation(derivation.model, (*derivation.formulas, *_formulas(derivation.model)))


def switch_count(kind: LoadKind) -> int:
    """Number of switching functions of a load."""
    return 0 if kind.is_spring else len(_on_branches(kind)[1].functions)


def _formulas(model: Model) -> list[Formula]:
    found: list[Formula] = []
    for index, kind in enumerate(model.load_kinds):
        if kind.is_spring:
            continue
        load, branches = _on_branches(kind)
        if not branches.functions:
            continue
        inputs = load.inputs | {"branch": ca.vertcat(*branches.symbols), "quaternion": load.quaternion}
        wrench = kernel(f"mg_{kind.name}_branch", inputs, load.wrenches)
        found.append(Formula(wrench.name(), wrench, CITATION, "branch", index))
        switches = kernel(f"mg_{kind.name}_switches", inputs, _switches(load, branches))
        found.append(Formula(switches.name(), switches, CITATION, "switches", index))
    return found


def _on_branches(kind: LoadKind) -> tuple[LoadFormulas, Branches]:
    branches = Branches()
    formulas = actuator_formulas if kind.kind == "actuator" else load_formulas
    return formulas(kind, branches), branches


def _switches(load: LoadFormulas, branches: Branches) -> dict[str, ca.SX]:
    """Values (n) of the switching functions, their gradients row after row: by t, poses and twists at their
    full size and parameters; by inputs; and, of functions of t and poses alone, 1 and what velocities add to
    the second rate, else 0."""
    value = ca.vertcat(*branches.functions)
    columns = []
    for name, argument in load.inputs.items():
        if name == "inputs":
            continue
        missing = SIZES.get(name, argument.numel()) - argument.numel()
        columns += [ca.jacobian(value, argument), zeros(value.numel(), missing)]
    inputs = load.inputs.get("inputs", ca.SX(0, 1))
    return {
        "switching": value,
        "gradient": ca.vec(ca.densify(ca.horzcat(*columns)).T),
        "input_gradient": ca.vec(ca.densify(ca.jacobian(value, inputs)).T),
        "second_rate": ca.vec(_second_rates(load.inputs, value).T),
    }


def _second_rates(inputs: Mapping[str, ca.SX], value: ca.SX) -> ca.SX:
    """(n, 2) whether a function depends on no twist, and its second rate where no body accelerates."""
    twists = ca.vertcat(*(inputs[f"twist_{side}"] for side in "ab"))
    moving = [(inputs["t"], ca.SX(1))]
    moving += [
        (inputs[f"pose_{side}"], _pose_rate(inputs[f"pose_{side}"], inputs[f"twist_{side}"])) for side in "ab"
    ]
    places, rates = (ca.vertcat(*column) for column in zip(*moving, strict=True))
    second = ca.jtimes(ca.jtimes(value, places, rates), places, rates)
    still = [0 if depends else 1 for depends in ca.which_depends(value, twists, 1, True)]
    return ca.horzcat(ca.SX(still), ca.densify(second))


def _pose_rate(pose: ca.SX, twist: ca.SX) -> ca.SX:
    if not pose.numel() or not twist.numel():
        return zeros(pose.numel())
    return ca.vertcat(twist[:3], ca.vec(ca.mtimes(ca.reshape(pose[3:], 3, 3), ca.skew(twist[3:]))))
