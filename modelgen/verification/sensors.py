"""The sensors of a scene against products of homogeneous matrices, differentiated along the motion."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import casadi as ca
import numpy as np
from scipy.spatial.transform import Rotation

from modelgen.derivation import Derivation
from modelgen.model import InputKind, Model
from modelgen.notation import component_names
from modelgen.scene.expression import evaluate
from modelgen.scene.scene_types import Measurand, Sensor
from modelgen.scene.sensors import sensor_sizes
from modelgen.verification.findings import Finding, compared
from modelgen.verification.random_input_settings import drawn_settings, with_settings

Array = np.ndarray[Any, Any]
ROUTE = "homogeneous matrices and their derivatives along the motion"


def sensor_inputs(model: Model, random: np.random.Generator) -> dict[str, Array]:
    """Arguments of the kernel at random motions, gaps, forces, gravity and settings of inputs."""
    from modelgen.dynamics.sensors import sensor_parameters  # of the kernel, as the runtime passes them

    kinds = _inputs(model)
    poses = [
        np.concatenate(
            [random.normal(size=3), Rotation.random(random_state=random).as_matrix().ravel(order="F")]
        )
        for _ in model.bodies
    ]
    found = {
        "t": np.array([0.3]),
        "pose": np.concatenate([np.zeros(0), *poses]),
        "twist": random.normal(size=6 * len(model.bodies)),
        "accel": random.normal(size=6 * len(model.bodies)),
        "pairs": random.normal(size=2 * len(model.pairs)),
        "joints": random.normal(size=6 * len(model.joints)),
        "gravity": random.normal(size=3),
        "parameters": np.array(sensor_parameters(model)),
    }
    return found | ({"inputs": drawn_settings(kinds, 1, random).ravel()} if kinds else {})


def check_sensors(function: ca.Function, derivation: Derivation, n: int, seed: int) -> list[Finding]:
    """Each sensor of the scene on n random states of its bodies."""
    random, model = np.random.default_rng(seed), derivation.model
    found, wanted = [], []
    for _ in range(n):
        given = sensor_inputs(model, random)
        found.append(np.asarray(function.call([ca.DM(value) for value in given.values()])[0]).ravel())
        wanted.append(_expected(derivation, given))
    return [compared("sensors", ROUTE, np.array(found).T, np.array(wanted).T)]


def _inputs(model: Model) -> tuple[InputKind, ...]:
    return tuple(InputKind(each.name, each.hold) for each in model.scene.inputs)


def _expected(derivation: Derivation, given: Mapping[str, Array]) -> Array:
    model, known = derivation.model, {"t": float(given["t"][0])}
    shown: list[float] = []
    for sensor in model.scene.sensors:
        values = _measured(sensor.measurand, derivation, given) if sensor.measurand else None
        if values is None:
            values = np.array([_value(sensor, model, given, known)])
        names = component_names(sensor_sizes((sensor,)))
        known |= dict(zip(names, np.atleast_1d(values).tolist(), strict=True))
        shown += [known[name] for name in names]
    return np.array(shown)


def _value(sensor: Sensor, model: Model, given: Mapping[str, Array], known: Mapping[str, float]) -> float:
    assert sensor.value is not None
    kinds = _inputs(model)
    expression = with_settings(sensor.value, kinds, given["inputs"]) if kinds else sensor.value
    return evaluate(expression, known)


def _measured(measured: Measurand, derivation: Derivation, given: Mapping[str, Array]) -> Array:
    model = derivation.model
    if measured.owner == "pair":
        index = [pair.name for pair in model.pairs].index(measured.name)
        return np.array([given["pairs"][2 * index + (measured.quantity == "force")]])
    if measured.owner == "joint":
        return _of_joint(measured, derivation, given)
    s = ca.SX.sym("s")
    relative = ca.inv(_placed(model, measured.relative_to, given, s)) @ _placed(
        model, measured.name, given, s
    )
    centre = model.bodies[_index(model, measured.name)].centre_of_mass
    point = np.append(measured.point if measured.point is not None else centre, 1.0)
    place, rotation = (relative @ point)[:3], relative[:3, :3]
    rate = ca.reshape(ca.jacobian(ca.vec(rotation), s), 3, 3) @ rotation.T
    angular = ca.vertcat(rate[2, 1], rate[0, 2], rate[1, 0])
    if measured.quantity == "orientation":
        matrix = np.asarray(ca.evalf(ca.substitute(rotation, s, 0)))
        turned = Rotation.from_matrix(matrix).as_quat()[[3, 0, 1, 2]]
        return np.asarray(turned if turned[0] >= 0 else -turned)
    shown = {"position": place, "velocity": ca.jacobian(place, s), "angular_velocity": angular}
    for name in ("velocity", "angular_velocity"):
        shown[name.replace("velocity", "acceleration")] = ca.jacobian(shown[name], s)
    fallen = shown["acceleration"] - ca.DM(given["gravity"])
    shown["proper_acceleration"] = rotation.T @ fallen
    return np.asarray(ca.evalf(ca.substitute(ca.densify(shown[measured.quantity]), s, 0))).ravel()


def _placed(model: Model, name: str | None, given: Mapping[str, Array], s: ca.SX) -> ca.SX:
    """The homogeneous matrix of the axes of a body, as written, at time s of its motion; the world's."""
    if name is None:
        return ca.SX.eye(4)
    index = _index(model, name)
    pose = given["pose"][12 * index : 12 * index + 12]
    twist, rate = (given[key][6 * index : 6 * index + 6] for key in ("twist", "accel"))
    moved = _moved(pose, twist, s, rate)
    rotation = ca.reshape(moved[3:], 3, 3)
    place = moved[:3] - rotation @ ca.DM(list(model.bodies[index].centre_of_mass))
    return ca.vertcat(ca.horzcat(rotation, place), ca.SX(ca.DM([[0, 0, 0, 1]])))


def _of_joint(measured: Measurand, derivation: Derivation, given: Mapping[str, Array]) -> Array:
    model = derivation.model
    index = [joint.name for joint in model.joints].index(measured.name)
    entry = model.joints[index]
    wrench = given["joints"][6 * index : 6 * index + 6]
    if measured.quantity == "force":
        return wrench[:3]
    poses = [given["pose"][12 * k : 12 * k + 12] for k in (entry.a, entry.b)]
    R = poses[1][3:].reshape(3, 3, order="F")
    if measured.quantity == "torque":
        lever = np.array(entry.frames[1].position) - np.array(model.bodies[entry.b].centre_of_mass)
        return np.asarray(R @ (wrench[3:] - np.cross(lever, R.T @ wrench[:3])))
    coordinates = derivation.function(f"mg_{model.joint_kinds[entry.kind].name}_coordinates")
    s = ca.SX.sym("s")
    twists = [given["twist"][6 * k : 6 * k + 6] for k in (entry.a, entry.b)]
    moved = [_moved(pose, twist, s) for pose, twist in zip(poses, twists, strict=True)]
    (found,) = coordinates.call([*moved, ca.DM(list(entry.parameters))])
    shown = found[0] if measured.quantity == "coordinate" else ca.jacobian(found[0], s)
    return np.asarray(ca.evalf(ca.substitute(ca.densify(shown), s, 0))).ravel()


def _moved(pose: Array, twist: Array, s: ca.SX, rate: Array = np.zeros(6)) -> ca.SX:
    """The pose (12,) at time s of the motion, to second order, with the rate of its twist."""
    turning, change = (ca.skew(ca.SX(ca.DM(each[3:]))) for each in (twist, rate))
    turn = ca.SX.eye(3) + s * turning + s**2 / 2 * (turning @ turning + change)
    rotation = ca.SX(ca.DM(pose[3:].reshape(3, 3, order="F"))) @ turn
    place = ca.SX(ca.DM(pose[:3])) + s * ca.DM(twist[:3]) + s**2 / 2 * ca.DM(rate[:3])
    return ca.vertcat(place, ca.vec(rotation))


def _index(model: Model, name: str) -> int:
    return [body.name for body in model.bodies].index(name)
