"""Derivation of the formulas of a Model: one CasADi function per kind and role, each with its source."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import casadi as ca

from modelgen.composition.all_sticking_dynamics import closed_right_hand_side, why_not_closed
from modelgen.composition.contact_mode import ContactMode, own_feature_pairs
from modelgen.composition.right_hand_side import (
    SLIP_SPEED,
    SolvedScene,
    in_all_modes,
    in_mode,
    right_hand_side,
    slip_speeds,
)
from modelgen.contact.form_table import FORMS, contact_kernels, eta_layout
from modelgen.contact.support_separation import aim_kernel, has_separation, seek_kernel
from modelgen.dynamics import loads
from modelgen.dynamics.bodies import body_kernels
from modelgen.dynamics.sensors import sensor_kernel
from modelgen.errors import expect
from modelgen.geometry.curves import curve_kernel, is_curve
from modelgen.geometry.points import is_point, point_kernel
from modelgen.geometry.surface_kernel import surface_kernel
from modelgen.interruption import nothing_swallowed
from modelgen.joint import joint_springs
from modelgen.joint.joint_actuators import actuator_kernel
from modelgen.joint.joint_equations import FORMS as FORMS_OF_JOINTS
from modelgen.joint.joint_kernels import coordinates_kernel, row_count, rows_kernel
from modelgen.joint.joint_limits import CITATION, limit_kernels
from modelgen.model import LoadKind, Model, ShapeKind

Role = Literal[
    "pose",
    "motion",
    "energy",
    "path",
    "wrench",
    "deflection",
    "branch",
    "switches",
    "surface",
    "curve",
    "point",
    "rates",
    "place",
    "aim",
    "seek",
    "angle",
    "rows",
    "coordinates",
    "sensors",
    "rhs",
]

CITATIONS: dict[str, str] = {
    "pose": "rotation matrix of a unit quaternion",
    "motion": "Newton-Euler equations, Section 3",
    "energy": "kinetic and potential energy, linear and angular momentum",
    "path": "exponential map of the prescribed rotation vector, differentiated twice",
    "force": "wrench of a force about the centre of mass",
    "torque": "wrench of a torque",
    "spring": "Hooke's law with viscous damping along the line of the anchors",
    "angle": "Theorems 4.1 (4.3), 4.3 (4.13), 4.6 (4.29): contact angles and their rates",
    "slip": "velocity and spin past each other along t1, t2, N: Montana's rolling, (3.11) with t for N",
    "aim": "one Newton step of the separation function from known contact points",
    "seek": "separation function of convex shapes on the sphere of normals",
    "surface": "surface point and exterior unit normal, Section 2",
    "curve": "point of a curve and its derivative, Section 2",
    "point": "a point by itself",
    "joint_spring": "Hooke's law with viscous damping along the coordinate of a joint",
    "actuator": "virtual work of a force along the coordinate of a joint",
    "rows": "joints Theta with J and Gamma1 (2.3), (2.6)",
    "coordinates": "relative coordinates of the frames of a joint",
    "sensors": "kinematics of points of bodies and joints; sums over the contacts of a pair",
    "rhs": "Newton-Euler equations with J a + gamma = 0, Section 3",
}


_SHAPE_KERNELS: Mapping[str, Callable[[ShapeKind], ca.Function]] = {
    "surface": surface_kernel, "curve": curve_kernel, "point": point_kernel
}  # fmt: skip


@dataclass(frozen=True)
class Formula:
    """A function with named inputs and outputs, its source, its role, and the index of its kind."""

    name: str
    function: ca.Function
    citation: str
    role: Role
    kind: int

    @property
    def instructions(self) -> int:
        return int(self.function.n_instructions())


@dataclass(frozen=True)
class Derivation:
    """The formulas of one Model, in the order of the generated code."""

    model: Model
    formulas: tuple[Formula, ...]

    def rhs(self, mode: ContactMode | None = None, feature_pairs: Sequence[int] | None = None) -> ca.Function:
        """The right-hand side of the whole scene (see `as_casadi`).

        Args:
            mode: of the contacts; None: a function of all modes, with an argument `mode`.
            feature_pairs: of a function of all modes, which each contact follows, or -1; None: those of
                contacts that can follow only one.

        Raises ModelgenError where the mode is none of the model.
        """
        return right_hand_side(self.solved(mode, feature_pairs))

    def solved(
        self,
        mode: ContactMode | None = None,
        feature_pairs: Sequence[int] | None = None,
        slip_speed: float = SLIP_SPEED,
    ) -> SolvedScene:
        """The whole scene with its forces, as expressions; arguments as those of `rhs`.

        `slip_speed`: the setting of a run of that name.
        """
        functions, slow = self.functions(), slip_speeds(self.model, slip_speed)
        if mode is not None:
            return in_mode(self.model, functions, mode, slow, ca.MX)
        pairs = own_feature_pairs(self.model) if feature_pairs is None else tuple(feature_pairs)
        return in_all_modes(self.model, functions, pairs, slow)

    def functions(self) -> Mapping[str, ca.Function]:
        """All functions by name."""
        return {formula.name: formula.function for formula in self.formulas}

    def of_kinds(self) -> Derivation:
        """Without the composed right-hand side."""
        return Derivation(self.model, tuple(each for each in self.formulas if each.role != "rhs"))

    def function(self, name: str) -> ca.Function:
        """The function of that name; KeyError if there is none."""
        return self.functions()[name]


@nothing_swallowed()
def derive(model: Model) -> Derivation:
    """All formulas of the Model: bodies, loads, surfaces, contacts, and the composed right-hand side.

    Raises ModelgenError if it is given something else.
    """
    expect("derive", model, Model)
    formulas = (
        *(*_of_bodies(model), *_of_loads(model), *_of_shapes(model), *_of_contacts(model)),
        *(*_of_limits(model), *_of_joints(model), *_of_sensors(model)),
    )
    if why_not_closed(model):
        return Derivation(model, formulas)
    rhs = closed_right_hand_side(model, {formula.name: formula.function for formula in formulas})
    return Derivation(model, (*formulas, _formula(rhs, "rhs", 0, CITATIONS["rhs"])))


def _formula(function: ca.Function, role: Role, kind: int, citation: str) -> Formula:
    return Formula(function.name(), function, citation, role, kind)


def _of_bodies(model: Model) -> list[Formula]:
    found: list[Formula] = []
    roles: dict[str, Role] = {"pose": "pose", "motion": "motion", "energy": "energy", "path": "path"}
    for index, kind in enumerate(model.body_kinds):
        for function in body_kernels(kind):
            role = roles[function.name().rsplit("_", 1)[1]]
            found.append(_formula(function, role, index, CITATIONS[role]))
    return found


def _of_loads(model: Model) -> list[Formula]:
    found: list[Formula] = []
    for index, kind in enumerate(model.load_kinds):
        wrench = _wrench_kernel(kind)(kind)
        found.append(_formula(wrench, "wrench", index, CITATIONS[kind.kind]))
        if kind.is_spring:
            deflection = (joint_springs if kind.joint else loads).deflection_kernel(kind)
            found.append(_formula(deflection, "deflection", index, CITATIONS[kind.kind]))
    return found


def _wrench_kernel(kind: LoadKind) -> Callable[[LoadKind], ca.Function]:
    if kind.kind == "actuator":
        return actuator_kernel
    return joint_springs.spring_kernel if kind.joint else loads.load_kernel


def _of_shapes(model: Model) -> list[Formula]:
    found: list[Formula] = []
    for index, kind in enumerate(model.shape_kinds):
        role: Role = "point" if is_point(kind) else "curve" if is_curve(kind) else "surface"
        kernel = _SHAPE_KERNELS[role](kind)
        found.append(_formula(kernel, role, index, CITATIONS[role]))
    return found


def _of_contacts(model: Model) -> list[Formula]:
    found: list[Formula] = []
    for index, kind in enumerate(model.contact_kinds):
        kernels, citation = contact_kernels(kind), FORMS[kind.form].citation
        rates = citation if kind.rows == 1 else f"{citation}; {CITATIONS['slip']}"
        found.append(_formula(kernels.rates, "rates", index, rates))
        found.append(_formula(kernels.place, "place", index, citation))
        if eta_layout(kind) == ("point", "point") and has_separation(kind.o.shape, kind.f.shape):
            found.append(_formula(aim_kernel(kind), "aim", index, CITATIONS["aim"]))
            found.append(_formula(seek_kernel(kind), "seek", index, CITATIONS["seek"]))
        angle = FORMS[kind.form].angle
        if angle is not None:
            found.append(_formula(angle(kind), "angle", index, CITATIONS["angle"]))
    return found


def _of_limits(model: Model) -> list[Formula]:
    """Formulas of the limits of joints; their kinds are numbered after the contact kinds."""
    found: list[Formula] = []
    for index, kind in enumerate(model.limit_kinds, start=len(model.contact_kinds)):
        rates, place = limit_kernels(kind)
        found += [_formula(rates, "rates", index, CITATION), _formula(place, "place", index, CITATION)]
    return found


def _of_joints(model: Model) -> list[Formula]:
    found: list[Formula] = []
    for index, kind in enumerate(model.joint_kinds):
        if row_count(kind):
            found.append(_formula(rows_kernel(kind), "rows", index, CITATIONS["rows"]))
        if FORMS_OF_JOINTS[kind.kind].coordinates:
            found.append(_formula(coordinates_kernel(kind), "coordinates", index, CITATIONS["coordinates"]))
    return found


def _of_sensors(model: Model) -> list[Formula]:
    if not model.scene.sensors:
        return []
    return [_formula(sensor_kernel(model), "sensors", 0, CITATIONS["sensors"])]
