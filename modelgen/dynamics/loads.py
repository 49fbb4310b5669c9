"""Kernels of the loads: forces, torques and springs as wrenches on the bodies' centres of mass."""

from __future__ import annotations

from dataclasses import dataclass, field

import casadi as ca

from modelgen.dynamics.bodies import kernel
from modelgen.dynamics.inputs import input_argument, input_values
from modelgen.dynamics.symbolic_rotations import quaternion
from modelgen.geometry.expression_branches import Branches
from modelgen.geometry.expression_translation import lower
from modelgen.geometry.frames import cross, dot, frame_of, zeros
from modelgen.model import BodyMotion, LoadKind
from modelgen.scene.expression_parity import parity
from modelgen.scene.scene_types import ForceLoad, TorqueLoad

QUATERNION = frozenset({"qw", "qx", "qy", "qz"})
NO_LENGTH = 1e-30  # m: guards the direction of a spring of length zero, which then exerts no force


@dataclass(frozen=True)
class Point:
    """A material point of a body, and the symbols that it hangs on."""

    pose: ca.SX  # argument
    twist: ca.SX  # argument
    arm: ca.SX  # (3,) m, body axes, from the centre of mass
    rotation: ca.SX  # (3,3) body -> world
    quaternion: ca.SX  # argument: which of both that the rotation has is continuous

    @property
    def position(self) -> ca.SX:
        return self.pose[0:3] + ca.mtimes(self.rotation, self.arm)

    @property
    def velocity(self) -> ca.SX:
        if not self.twist.numel():
            return zeros(3)
        return self.twist[0:3] + ca.mtimes(self.rotation, cross(self.twist[3:6], self.arm))

    def wrench(self, force: ca.SX) -> ca.SX:
        """[force; torque in body axes] of a force (3,) in world axes at the point."""
        return ca.vertcat(force, cross(self.arm, ca.mtimes(self.rotation.T, force)))


@dataclass(frozen=True)
class LoadFormulas:
    """The wrenches of a load on its bodies a and b, and the arguments of its kernels."""

    inputs: dict[str, ca.SX]
    wrenches: dict[str, ca.SX]
    quaternion: ca.SX = field(default_factory=lambda: zeros(0))  # argument on branches


def load_kernel(kind: LoadKind) -> ca.Function:
    """`mg_<kind>_wrench`: (t, pose_a, twist_a, pose_b, twist_b, parameters) -> (wrench_a(6), wrench_b(6)).

    A load that depends on inputs also takes `inputs`, their settings.
    """
    formulas = load_formulas(kind)
    return kernel(f"mg_{kind.name}_wrench", formulas.inputs, formulas.wrenches)


def load_formulas(kind: LoadKind, branches: Branches | None = None) -> LoadFormulas:
    """Those of `load_kernel`, on `branches` if there are any."""
    t = ca.SX.sym("t")
    spring = kind.kind == "spring"
    numbers, points = _points(kind)
    a, b = points[0], points[1] if spring else Point(zeros(0), zeros(0), zeros(3), ca.SX.eye(3), zeros(0))
    settings = input_argument(kind.inputs)
    values = {"t": t} | input_values(kind.inputs, t, settings)
    wrench_a, wrench_b = (
        _spring(a, b, numbers[-3:]) if spring else (_given(kind, values, a, branches), ca.SX(0, 1))
    )
    inputs = {"t": t, "pose_a": a.pose, "twist_a": a.twist, "pose_b": b.pose, "twist_b": b.twist}
    return LoadFormulas(
        inputs | {"parameters": numbers} | settings,
        {"wrench_a": wrench_a, "wrench_b": wrench_b},
        a.quaternion,
    )


def deflection_kernel(kind: LoadKind) -> ca.Function:
    """`mg_<kind>_deflection` of a spring: (pose_a, pose_b, parameters) -> (deflection(1) m, J(12)).

    The deflection is L - L_0; its rate is J u.
    """
    numbers, (a, b) = _points(kind)
    length, direction = _line(a, b)
    return kernel(
        f"mg_{kind.name}_deflection",
        {"pose_a": a.pose, "pose_b": b.pose, "parameters": numbers},
        {
            "deflection": length - numbers[-1],
            "J": ca.densify(ca.vertcat(-a.wrench(direction), b.wrench(direction))),
        },
    )


def _points(kind: LoadKind) -> tuple[ca.SX, list[Point]]:
    """The parameters, arms first, and the point of each body at which the load acts."""
    numbers = ca.SX.sym("parameters", 3 * sum(kind.arms) + (3 if kind.kind == "spring" else 0))
    points: list[Point] = []
    used = 0
    for motion, off in zip(kind.motions, kind.arms or (False,), strict=True):
        points.append(_point("ab"[len(points)], motion, numbers[used : used + 3] if off else zeros(3)))
        used += 3 * off
    return numbers, points


def _point(name: str, motion: BodyMotion, arm: ca.SX) -> Point:
    pose = ca.SX.sym(f"pose_{name}", 12)
    twist = ca.SX.sym(f"twist_{name}", 0 if motion == "fixed" else 6)
    rotation = ca.SX.eye(3) if motion == "point" else frame_of(pose).rotation
    return Point(pose, twist, arm, rotation, ca.SX.sym("quaternion", 4 if motion == "free" else 0))


def _given(kind: LoadKind, values: dict[str, ca.SX], point: Point, branches: Branches | None) -> ca.SX:
    """The wrench of a force or torque that the scene gives as expressions of t, inputs and the body's state;
    `values` are time and inputs by name."""
    load = kind.load
    assert load is not None
    turn = quaternion(point.rotation)
    if branches and kind.motions[0] == "free" and _reads_quaternion(load):
        turn = _turn_on_branch(turn, point, load, branches)
    symbols = values | _state_symbols(point, kind.motions[0], turn)
    vector = ca.vertcat(*(lower(component, symbols, branches) for component in load.components))
    match load:
        case ForceLoad(frame=frame):
            return point.wrench(vector if frame == "world" else ca.mtimes(point.rotation, vector))
        case TorqueLoad(frame=frame):
            return ca.vertcat(zeros(3), vector if frame == "body" else ca.mtimes(point.rotation.T, vector))


def _reads_quaternion(load: ForceLoad | TorqueLoad) -> bool:
    return any(component.names & QUATERNION for component in load.components)


def _turn_on_branch(turn: ca.SX, point: Point, load: ForceLoad | TorqueLoad, branches: Branches) -> ca.SX:
    """The quaternion with qw >= 0 as the body's own, which is continuous, on the branch by its qw, unless the
    load is the same with either."""
    own = ca.if_else(ca.dot(turn, point.quaternion) < 0, -1, 1) * turn
    is_even = all(parity(component.tree, QUATERNION) == 1 for component in load.components)
    return own if is_even else branches.of(own[0]) * own


def _state_symbols(point: Point, motion: BodyMotion, turn: ca.SX) -> dict[str, ca.SX]:
    """The state of the centre of mass in world axes, by the names of expressions."""
    velocity = point.twist[0:3] if motion != "fixed" else zeros(3)
    turns = motion in ("driven", "free")
    spin = ca.mtimes(point.rotation, point.twist[3:6]) if turns else zeros(3)
    columns = {"xyz": point.pose[0:3], "v": velocity, "w": spin, "q": turn}
    symbols = {axis: columns["xyz"][i] for i, axis in enumerate("xyz")}
    symbols |= {f"{letter}{axis}": columns[letter][i] for letter in "vw" for i, axis in enumerate("xyz")}
    return symbols | {f"q{axis}": columns["q"][i] for i, axis in enumerate("wxyz")}


def _spring(a: Point, b: Point, numbers: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Force k (L - L_0) + c L_dot along the line from a to b, pulling them together."""
    stiffness, damping, rest_length = ca.vertsplit(numbers)
    length, direction = _line(a, b)
    rate = dot(direction, b.velocity - a.velocity)
    force = (stiffness * (length - rest_length) + damping * rate) * direction
    return a.wrench(force), b.wrench(-force)


def _line(a: Point, b: Point) -> tuple[ca.SX, ca.SX]:
    """Length of the line from a to b, m, and its direction (3,)."""
    between = b.position - a.position
    length = ca.sqrt(dot(between, between))
    return length, between / ca.fmax(length, NO_LENGTH)
