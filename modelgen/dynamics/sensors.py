"""The sensors of a scene as one kernel: from motions of bodies, gaps and forces to what each shows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce

import casadi as ca

from modelgen.dynamics.bodies import kernel
from modelgen.dynamics.inputs import input_argument, input_values
from modelgen.dynamics.symbolic_rotations import quaternion
from modelgen.geometry.expression_translation import lower
from modelgen.geometry.frames import cross, frame_of
from modelgen.joint.joint_frames import meeting
from modelgen.joint.joint_kernels import numbers_of, parameters_of
from modelgen.joint.joint_limits import coordinate_of
from modelgen.model import InputKind, Model
from modelgen.notation import component_names
from modelgen.scene.scene_types import Measurand, Sensor, Vector
from modelgen.scene.sensors import ACCELERATIONS, sensor_sizes

POSE, TWIST, WRENCH, OF_A_PAIR = 12, 6, 6, 2  # numbers of a body; of a joint; of a pair: gap, force
FORCES = ("force", "torque")  # quantities that need the forces at an instant


def need_rates(sensors: Sequence[Sensor]) -> bool:
    """Whether a sensor shows accelerations, forces or gaps, for which the right-hand side is evaluated."""
    measured = [sensor.measurand for sensor in sensors if sensor.measurand is not None]
    return any(each.owner == "pair" or each.quantity in (*FORCES, *ACCELERATIONS) for each in measured)


def sensor_parameters(model: Model) -> tuple[float, ...]:
    """The parameters of the kernel: of each sensor in turn the numbers that `_Symbols.take` asks for."""
    found: list[float] = []
    for sensor in model.scene.sensors:
        measured = sensor.measurand
        if measured is None:
            continue
        if measured.owner == "body":
            if measured.point is not None:
                found += _from(_centre(model, measured.name), measured.point)
            if measured.relative_to is not None:
                found += _from(_centre(model, measured.relative_to), (0.0, 0.0, 0.0))
        if measured.owner == "joint":
            entry = model.joints[_joint(model, measured.name)]
            if measured.quantity == "torque":
                found += _from(model.bodies[entry.b].centre_of_mass, entry.frames[1].position)
            elif measured.quantity != "force":
                found += entry.geometry
    return tuple(found)


def sensor_kernel(model: Model) -> ca.Function:
    """`mg_sensors`: (t, pose(12 a body), twist(6 a body), accel(6 a body: rate of the twist), pairs(2 a pair,
    then 2 a limit of a joint: least gap m, normal force N), joints(6 a joint: its wrench on the second body),
    gravity(3), parameters, inputs) -> (sensors): the components of all sensors in order."""
    symbols = _Symbols.of(model)
    known = dict(symbols.values)
    shown = []
    for sensor in model.scene.sensors:
        value = _measured(sensor.measurand, model, symbols) if sensor.measurand else _follows(sensor, known)
        names = component_names(sensor_sizes((sensor,)))
        known |= dict(zip(names, ca.vertsplit(value), strict=True))
        shown.append(value)
    return kernel("mg_sensors", symbols.arguments, {"sensors": ca.vertcat(ca.SX(0, 1), *shown)})


@dataclass
class _Symbols:
    """The arguments of the kernel, and how many of its parameters are taken."""

    arguments: dict[str, ca.SX]
    values: dict[str, ca.SX]  # time and inputs by name
    taken: int = 0

    @classmethod
    def of(cls, model: Model) -> _Symbols:
        inputs = tuple(InputKind(each.name, each.hold) for each in model.scene.inputs)
        t, settings = ca.SX.sym("t"), input_argument(inputs)
        sizes = {
            "pose": POSE * len(model.bodies),
            "twist": TWIST * len(model.bodies),
            "accel": TWIST * len(model.bodies),
            "pairs": OF_A_PAIR * (len(model.pairs) + len(model.limits)),
            "joints": WRENCH * len(model.joints),
            "gravity": 3,
            "parameters": len(sensor_parameters(model)),
        }
        named = {name: ca.SX.sym(name, size) for name, size in sizes.items()}
        return cls({"t": t, **named, **settings}, {"t": t} | input_values(inputs, t, settings))

    def take(self, size: int) -> ca.SX:
        """The next parameters."""
        self.taken += size
        return self.arguments["parameters"][self.taken - size : self.taken]

    def body(self, index: int) -> tuple[ca.SX, ca.SX]:
        """Pose and twist of a body."""
        pose, twist = self.arguments["pose"], self.arguments["twist"]
        return pose[POSE * index : POSE * (index + 1)], twist[TWIST * index : TWIST * (index + 1)]

    def motion(self, index: int, arm: ca.SX) -> _Motion:
        """The motion of a point of a body that is `arm` from its centre of mass, and of its axes."""
        pose, twist = self.body(index)
        rate, frame = self.arguments["accel"][TWIST * index : TWIST * (index + 1)], frame_of(pose)
        spin, spun = twist[3:6], cross(twist[3:6], arm)
        return _Motion(
            rotation=frame.rotation,
            position=frame.position + ca.mtimes(frame.rotation, arm),
            velocity=twist[0:3] + ca.mtimes(frame.rotation, spun),
            acceleration=rate[0:3] + ca.mtimes(frame.rotation, cross(rate[3:6], arm) + cross(spin, spun)),
            spin=spin,
            spin_rate=rate[3:6],
        )


@dataclass(frozen=True)
class _Motion:
    """Motion of a point of a body, in world axes, and of the body's axes, in body axes."""

    rotation: ca.SX
    position: ca.SX
    velocity: ca.SX
    acceleration: ca.SX
    spin: ca.SX
    spin_rate: ca.SX


def _follows(sensor: Sensor, known: dict[str, ca.SX]) -> ca.SX:
    assert sensor.value is not None
    return lower(sensor.value, known)


def _measured(measured: Measurand, model: Model, symbols: _Symbols) -> ca.SX:
    if measured.owner == "body":
        return _of_body(measured, model, symbols)
    if measured.owner == "joint":
        return _of_joint(measured, model, symbols)
    return _of_pairs(measured, model, symbols.arguments["pairs"])


def _of_pairs(measured: Measurand, model: Model, pairs: ca.SX) -> ca.SX:
    """The least gap or the sum of the forces of pairs; a gap is NaN only where all of them are."""
    indices = [index for index, pair in enumerate(model.pairs) if pair.name in measured.pairs]
    values = [pairs[OF_A_PAIR * k + ("gap", "force").index(measured.quantity)] for k in indices]
    if measured.quantity == "force":
        return ca.sum1(ca.vertcat(*values))
    return reduce(ca.fmin, values)


def _of_body(measured: Measurand, model: Model, symbols: _Symbols) -> ca.SX:
    arm = symbols.take(3) if measured.point is not None else ca.SX(3, 1)
    own = symbols.motion(_body(model, measured.name), arm)
    if measured.relative_to is None:
        return _in_world(measured.quantity, own, symbols.arguments["gravity"])
    return _seen(measured.quantity, own, symbols.motion(_body(model, measured.relative_to), symbols.take(3)))


def _in_world(quantity: str, own: _Motion, gravity: ca.SX) -> ca.SX:
    match quantity:
        case "position":
            return own.position
        case "velocity":
            return own.velocity
        case "acceleration":
            return own.acceleration
        case "angular_velocity":
            return ca.mtimes(own.rotation, own.spin)
        case "angular_acceleration":
            return ca.mtimes(own.rotation, own.spin_rate)
        case "proper_acceleration":
            return ca.mtimes(own.rotation.T, own.acceleration - gravity)
    return quaternion(own.rotation)


def _seen(quantity: str, own: _Motion, base: _Motion) -> ca.SX:
    """A quantity seen from the axes of a body, with `base` the motion of their origin: each the derivative of
    the one before it by time, in these axes."""
    back, spin = base.rotation.T, base.spin
    turned = ca.mtimes(back, own.rotation)
    place = ca.mtimes(back, own.position - base.position)
    velocity = ca.mtimes(back, own.velocity - base.velocity) - cross(spin, place)
    angular = ca.mtimes(turned, own.spin) - spin
    match quantity:
        case "position":
            return place
        case "velocity":
            return velocity
        case "acceleration":
            frame = cross(base.spin_rate, place) + cross(spin, cross(spin, place)) + 2 * cross(spin, velocity)
            return ca.mtimes(back, own.acceleration - base.acceleration) - frame
        case "angular_velocity":
            return angular
        case "angular_acceleration":
            return ca.mtimes(turned, own.spin_rate) - base.spin_rate - cross(spin, angular)
    return quaternion(turned)


def _of_joint(measured: Measurand, model: Model, symbols: _Symbols) -> ca.SX:
    index = _joint(model, measured.name)
    entry = model.joints[index]
    wrench = symbols.arguments["joints"][WRENCH * index : WRENCH * (index + 1)]
    if measured.quantity == "force":
        return wrench[0:3]
    (pose_a, twist_a), (pose_b, twist_b) = symbols.body(entry.a), symbols.body(entry.b)
    if measured.quantity == "torque":
        rotation = frame_of(pose_b).rotation
        return ca.mtimes(rotation, wrench[3:6]) - cross(ca.mtimes(rotation, symbols.take(3)), wrench[0:3])
    kind = model.joint_kinds[entry.kind].kind
    m, numbers = meeting(), numbers_of(kind)
    value = coordinate_of(kind).value(m, numbers)
    outputs = {"found": value if measured.quantity == "coordinate" else m.rate(value).total}
    function = m.kernel("joint", {**m.moving, "parameters": parameters_of(m, numbers)}, outputs)
    (found,) = function.call([pose_a, twist_a, pose_b, twist_b, symbols.take(len(entry.geometry))])
    return found


def _body(model: Model, name: str) -> int:
    return [body.name for body in model.bodies].index(name)


def _joint(model: Model, name: str) -> int:
    return [joint.name for joint in model.joints].index(name)


def _centre(model: Model, name: str) -> Vector:
    return model.bodies[_body(model, name)].centre_of_mass


def _from(centre: Vector, point: Vector) -> list[float]:
    """A point of a body from its centre of mass."""
    return [a - b for a, b in zip(point, centre, strict=True)]
