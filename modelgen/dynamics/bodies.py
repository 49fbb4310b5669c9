"""Newton-Euler equations of one body, in its centre of mass: velocities in world axes, spin in body axes.

Sources: quaternion kinematics and Euler's equations as in the paper's Section 3; driven motion by the
exponential map. The quaternion (w, x, y, z) is taken to have unit length.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca

from modelgen.dynamics.inputs import input_argument, input_values
from modelgen.dynamics.symbolic_rotations import exponential
from modelgen.geometry.expression_translation import lower
from modelgen.geometry.frames import cross, dot, frame_of, zeros
from modelgen.model import BodyKind

INERTIA_SIZE = {"none": 0, "isotropic": 1, "diagonal": 3, "full": 6}


def body_kernels(kind: BodyKind) -> tuple[ca.Function, ...]:
    """The kernels of a body kind: (pose, motion, energy) of a free body, (motion, energy) of a point,
    (path,) of a driven one, none of a fixed one. Names, inputs and outputs are those of the manifest.
    """
    match kind.motion:
        case "fixed":
            return ()
        case "driven":
            return (_path(kind),)
        case "point":
            return (_motion(kind), _energy(kind))
        case "free":
            return (_pose(kind), _motion(kind), _energy(kind))


def kernel(name: str, inputs: dict[str, ca.SX], outputs: dict[str, ca.SX]) -> ca.Function:
    """A dense function whose outputs share common subexpressions."""
    shared = ca.cse([ca.densify(value) for value in outputs.values()])
    return ca.Function(name, list(inputs.values()), shared, list(inputs), list(outputs))


def rotation(quaternion: ca.SX) -> ca.SX:
    """The rotation matrix (3,3) body -> world of a unit quaternion (w, x, y, z)."""
    w, x, y, z = ca.vertsplit(quaternion)
    x2, y2, z2 = 2 * x, 2 * y, 2 * z
    xx, yy, zz = x * x2, y * y2, z * z2
    xy, xz, yz, wx, wy, wz = x * y2, x * z2, y * z2, w * x2, w * y2, w * z2
    return ca.vertcat(
        ca.horzcat(1 - (yy + zz), xy - wz, xz + wy),
        ca.horzcat(xy + wz, 1 - (xx + zz), yz - wx),
        ca.horzcat(xz - wy, yz + wx, 1 - (xx + yy)),
    )


@dataclass(frozen=True)
class State:
    """Symbols of one dynamic body."""

    q: ca.SX  # (3,) or (7,): p, quaternion
    u: ca.SX  # (3,) or (6,): v world, w body axes
    argument: ca.SX  # parameters of the kernel
    mass: ca.SX  # kg
    inertia: ca.SX  # (3,3) kg m^2, body axes

    @property
    def turns(self) -> bool:
        return int(self.u.numel()) == 6


def _state(kind: BodyKind) -> State:
    turns = kind.motion == "free"
    size = 1 + INERTIA_SIZE[kind.inertia]
    argument = ca.SX.sym("parameters", size if kind.folded is None else 0)
    q, u = ca.SX.sym("q", 7 if turns else 3), ca.SX.sym("u", 6 if turns else 3)
    return State(q, u, argument, *mass_and_inertia(kind, argument))


def mass_and_inertia(kind: BodyKind, parameters: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Mass (kg) and inertia (3,3) (kg m^2, body axes) of a dynamic kind with these parameters."""
    numbers: Any = parameters if kind.folded is None else ca.DM(list(kind.folded))
    return numbers[0], _inertia(kind, numbers[1:])


def _inertia(kind: BodyKind, numbers: Any) -> Any:
    match kind.inertia:
        case "none":
            return zeros(3, 3)
        case "isotropic":
            return numbers[0] * ca.DM.eye(3)
        case "diagonal":
            return ca.diag(numbers)
        case "full":
            xx, yy, zz, xy, xz, yz = ca.vertsplit(numbers)
            return ca.vertcat(ca.horzcat(xx, xy, xz), ca.horzcat(xy, yy, yz), ca.horzcat(xz, yz, zz))


def _pose(kind: BodyKind) -> ca.Function:
    """(q(7)) -> (pose(12))."""
    q = ca.SX.sym("q", 7)
    pose = ca.vertcat(q[0:3], ca.vec(rotation(q[3:7])))
    return kernel(f"mg_{kind.name}_pose", {"q": q}, {"pose": pose})


def _motion(kind: BodyKind) -> ca.Function:
    """(q, u, wrench, gravity(3), parameters) -> (qdot, udot) by Newton and Euler:
    m v_dot = F + m g, I w_dot = tau - w x I w.
    """
    state = _state(kind)
    wrench = ca.SX.sym("wrench", int(state.u.numel()) if kind.loaded else 0)
    gravity = ca.SX.sym("gravity", 3)
    force, torque = (wrench[0:3], wrench[3:]) if kind.loaded else (zeros(3), zeros(3))
    qdot, udot = state.u[0:3], force / state.mass + gravity
    if state.turns:
        spin = state.u[3:6]
        qdot = ca.vertcat(qdot, _quaternion_rate(state.q[3:7], spin))
        udot = ca.vertcat(udot, _spin_rate(kind, state.inertia, spin, torque))
    inputs = {"q": state.q, "u": state.u, "wrench": wrench, "gravity": gravity, "parameters": state.argument}
    return kernel(f"mg_{kind.name}_motion", inputs, {"qdot": qdot, "udot": udot})


def _quaternion_rate(quaternion: ca.SX, spin: ca.SX) -> ca.SX:
    """(0, w)/2 multiplied from the right: w in body axes."""
    half = spin / 2
    scalar, vector = quaternion[0], quaternion[1:4]
    return ca.vertcat(-dot(vector, half), scalar * half + cross(vector, half))


def _spin_rate(kind: BodyKind, inertia: ca.SX, spin: ca.SX, torque: ca.SX) -> ca.SX:
    """Euler's equations in body axes."""
    if kind.inertia == "isotropic":
        return torque / inertia[0, 0]
    if kind.inertia == "diagonal":
        x, y, z = ca.vertsplit(ca.diag(inertia))
        gyration = ca.vertcat(
            (y - z) * spin[1] * spin[2], (z - x) * spin[2] * spin[0], (x - y) * spin[0] * spin[1]
        )
        return (torque + gyration) / ca.vertcat(x, y, z)
    moment = torque - cross(spin, ca.mtimes(inertia, spin))
    columns = ca.horzsplit(inertia)
    adjugate = ca.horzcat(*(cross(columns[i - 2], columns[i - 1]) for i in range(3)))
    return ca.mtimes(adjugate, moment) / dot(columns[0], adjugate[:, 0])


def _energy(kind: BodyKind) -> ca.Function:
    """(q, u, gravity, parameters) -> (kinetic J, potential J, momentum(3) kg m/s, spin(3) kg m^2/s);
    momentum and spin in world axes, spin about the world origin.
    """
    state = _state(kind)
    gravity = ca.SX.sym("gravity", 3)
    p, v = state.q[0:3], state.u[0:3]
    momentum = state.mass * v
    kinetic, spin = dot(momentum, v), cross(p, momentum)
    if state.turns:
        own = ca.mtimes(state.inertia, state.u[3:6])
        kinetic += dot(own, state.u[3:6])
        spin += ca.mtimes(rotation(state.q[3:7]), own)
    inputs = {"q": state.q, "u": state.u, "gravity": gravity, "parameters": state.argument}
    potential = -state.mass * dot(gravity, p)
    outputs = {"kinetic": kinetic / 2, "potential": potential, "momentum": momentum, "spin": spin}
    return kernel(f"mg_{kind.name}_energy", inputs, outputs)


def _path(kind: BodyKind) -> ca.Function:
    """(t, parameters(12): pose at rest) -> (pose(12), twist(6), accel(6) = [v_dot world; w_dot body axes]).

    p = path(t) + p_0, R = exp(rotation vector(t)) R_0. A path that depends on inputs also takes `inputs`,
    their settings.
    """
    t, parameters, settings = ca.SX.sym("t"), ca.SX.sym("parameters", 12), input_argument(kind.inputs)
    values = {"t": t} | input_values(kind.inputs, t, settings)
    start, path = frame_of(parameters), kind.path
    if path is None:
        position, turn = zeros(3), ca.SX.eye(3)
    else:
        position = ca.vertcat(*(lower(component, values) for component in path.position))
        turn = exponential(ca.vertcat(*(lower(component, values) for component in path.rotation_vector)))
    spin_world = _spin_of(turn, t)
    velocity, to_body = ca.jacobian(position, t), ca.mtimes(turn, start.rotation).T
    twist = ca.vertcat(velocity, ca.mtimes(to_body, spin_world))
    accel = ca.vertcat(ca.jacobian(velocity, t), ca.mtimes(to_body, ca.jacobian(spin_world, t)))
    pose = ca.vertcat(position + start.position, ca.vec(to_body.T))
    outputs = {"pose": pose, "twist": twist, "accel": accel}
    return kernel(f"mg_{kind.name}_path", {"t": t, "parameters": parameters} | settings, outputs)


def _spin_of(turn: ca.SX, t: ca.SX) -> ca.SX:
    """Angular velocity (3,) in world axes of a rotation matrix that depends on t: the axis of R_dot R^T."""
    rate = ca.reshape(ca.jacobian(ca.vec(turn), t), 3, 3)
    skew = ca.mtimes(rate, turn.T)
    return ca.vertcat(skew[2, 1], skew[0, 2], skew[1, 0])
