"""The rows, coordinates, limits and springs of joints against differences of what the joint keeps."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
import mpmath as mp
import numpy as np
from scipy.spatial.transform import Rotation

from modelgen.joint.joint_kernels import inertial_row_count
from modelgen.joint.joint_limits import is_turn
from modelgen.model import JointKind, LimitKind, LoadKind
from modelgen.scene.expression import evaluate
from modelgen.verification.findings import Finding, compared
from modelgen.verification.joint_reference import (
    COORDINATES,
    differenced,
    frames_at,
    inertial_values,
    rows_of,
)
from modelgen.verification.random_input_settings import drawn_settings, with_settings

Array = np.ndarray[Any, Any]
Motions = tuple[tuple[Array, Array, Array], ...]
MOTION = "differences, in 50 digits, of the relative placement of the frames along the motion"
TOGETHER = "the coordinates by which the frames were put together"
POWER = "differences of the coordinate, in 50 digits, along each direction of motion"
# how a kind is put together: shifts along and turns about the axes of the first frame, one coordinate each
STEPS: Mapping[str, tuple[str, ...]] = {
    "revolute": ("turn z",), "prismatic": ("shift z",), "cylindrical": ("shift z", "turn z"),
    "screw": ("shift z", "turn z"), "universal": ("turn x", "turn y"),
    "planar": ("shift x", "shift y", "turn z"),
}  # fmt: skip


@dataclass(frozen=True)
class Drawn:
    """Two bodies with a joint between them: moving at random, and put together as the joint wants."""

    t: float
    motions: Motions  # (pose, twist, accel) of both bodies
    parameters: Array
    coordinates: tuple[float, ...]  # of the joint, where it is put together
    together: Array  # pose of the second body

    @property
    def u(self) -> Array:
        return np.concatenate([twist for _, twist, _ in self.motions])

    @property
    def u_dot(self) -> Array:
        return np.concatenate([accel for _, _, accel in self.motions])

    @property
    def moving(self) -> tuple[Array, ...]:
        """pose_a, twist_a, pose_b, twist_b."""
        (pose_a, twist_a, _), (pose_b, twist_b, _) = self.motions
        return pose_a, twist_a, pose_b, twist_b


def draw(kind: str, parameters: Sequence[float], n: int, seed: int) -> list[Drawn]:
    """n configurations of one kind of joint with the numbers of one joint."""
    random = np.random.default_rng(seed)
    return [_drawn(kind, np.array(parameters, dtype=float), random) for _ in range(n)]


def _drawn(kind: str, parameters: Array, random: np.random.Generator) -> Drawn:
    size = parameters[24]
    motions = tuple((_pose(random, size), random.normal(size=6), random.normal(size=6)) for _ in range(2))
    coordinates, r, Q = _relative(kind, parameters, random)
    if kind == "gear":
        return Drawn(random.uniform(0.1, 1.0), motions, parameters, (), motions[1][0])
    own = [(parameters[k : k + 3], parameters[k + 3 : k + 12].reshape(3, 3, order="F")) for k in (0, 12)]
    p, R = motions[0][0][:3], motions[0][0][3:].reshape(3, 3, order="F")
    A, B = R @ own[0][1], R @ own[0][1] @ Q
    body = B @ own[1][1].T
    place = p + R @ own[0][0] + A @ r - body @ own[1][0]
    return Drawn(
        random.uniform(0.1, 1.0), motions, parameters, coordinates,
        np.concatenate([place, body.ravel(order="F")]),
    )  # fmt: skip


def _pose(random: np.random.Generator, size: float) -> Array:
    turn = Rotation.random(random_state=random).as_matrix()
    return np.concatenate([size * random.normal(size=3), turn.ravel(order="F")])


def _relative(
    kind: str, parameters: Array, random: np.random.Generator
) -> tuple[tuple[float, ...], Array, Array]:
    """Coordinates, and the second frame in the first, by shifts and turns one after the other."""
    size, numbers = parameters[24], parameters[25:]
    if kind in ("distance", "rope"):
        direction = random.normal(size=3)
        far = numbers[0] if kind == "distance" else size * random.uniform(0.2, 2.0)
        span = far * direction / np.linalg.norm(direction)
        return (float(far),), span, Rotation.random(random_state=random).as_matrix()
    if kind == "spherical":
        turn = Rotation.random(random_state=random).as_matrix()
        return (float(np.arccos(turn[2, 2])),), np.zeros(3), turn
    values = random.uniform(-1.5, 1.5, len(STEPS.get(kind, ())))
    if kind == "screw":
        values[0] = numbers[0] * values[1] / (2 * np.pi)
    r: Array = np.zeros(3)
    Q: Array = np.eye(3)
    for step, value in zip(STEPS.get(kind, ()), values, strict=True):
        word, axis = step.split()
        r = r + value * np.eye(3)["xyz".index(axis)] if word == "shift" else r
        Q = Q @ Rotation.from_euler(axis, value).as_matrix() if word == "turn" else Q
    return tuple(map(float, values)), r, Q


Both = Mapping[str, tuple[Any, Any]]  # what was found and what was wanted, by quantity


def check_rows(function: ca.Function, kind: JointKind, drawn: Sequence[Drawn]) -> list[Finding]:
    """Rows vanish where the joint holds; off it they, J u + bias and J u_dot + gamma1 are as differenced."""
    routes = {
        "value": MOTION,
        "J": f"J u + bias is the rate of value; {MOTION}",
        "gamma1": f"J u_dot + gamma1 is its second derivative; {MOTION}",
        "bias": f"bodies at rest; {MOTION}",
    }
    findings = _gathered(routes, [_off_the_joint(function, kind, at) for at in drawn])
    if kind.kind == "gear":
        return findings
    held = {"value": f"zero at {TOGETHER}"}
    return [*findings, *_gathered(held, [_on_the_joint(function, kind, at) for at in drawn])]


def _called(function: ca.Function, *values: Any) -> list[Any]:
    return list(function.call([ca.DM(each) for each in values]))


def _settings(kind: JointKind | LoadKind, at: Drawn) -> list[Array]:
    """The last argument of the rows, if their motion depends on inputs."""
    random = np.random.default_rng(int(1e6 * at.t))
    return [drawn_settings(kind.inputs, 1, random).ravel()] if kind.inputs else []


def _off_the_joint(function: ca.Function, kind: JointKind, at: Drawn) -> Both:
    settings, motion = _settings(kind, at), kind.motion
    if settings and motion is not None:
        motion = with_settings(motion, kind.inputs, settings[0])

    def rows(motions: Motions) -> tuple[Array, Array, Array]:
        now = frames_at(motions, at.parameters, at.t, 0)

        def values(h: Any) -> list[Any]:
            frames = frames_at(motions, at.parameters, at.t, h)
            held = rows_of(kind.kind, motion, frames)
            return [*held, *inertial_values(kind.kind, kind.armature, _armature(kind, at), frames, now)]

        return differenced(values)

    found = function(at.t, *at.moving, at.parameters, *settings)
    value, flat, gamma, bias = (np.asarray(x).ravel() for x in found)
    J = flat.reshape(-1, 12)
    wanted, first, second = rows(at.motions)
    wanted[len(wanted) - inertial_row_count(kind) :] = 0.0  # armature holds nothing
    still = tuple((pose, np.zeros(6), np.zeros(6)) for pose, _, _ in at.motions)
    return {
        "value": (value, wanted), "J": (J @ at.u + bias, first),
        "gamma1": (J @ at.u_dot + gamma, second), "bias": (bias, rows(still)[1]),
    }  # fmt: skip


def _armature(kind: JointKind, at: Drawn) -> Array:
    return at.parameters[len(at.parameters) - len(kind.armature) :]


def _on_the_joint(function: ca.Function, kind: JointKind, at: Drawn) -> Both:
    """Beside ones, so that zero is told against the length; without the row of a given motion."""
    pose_a, twist_a, _, twist_b = at.moving
    given: tuple[Any, ...] = (at.t, pose_a, twist_a, at.together, twist_b, at.parameters)
    given = (*given, *_settings(kind, at))
    value = np.asarray(_called(function, *given)[0]).ravel()
    kept = value[: len(value) - (kind.motion is not None)]
    return {"value": (1.0 + kept / at.parameters[24], np.ones_like(kept))}


def _gathered(routes: Mapping[str, str], entries: Sequence[Both]) -> list[Finding]:
    """One finding per quantity, over all configurations."""
    return [
        compared(name, route, *(np.array([entry[name][k] for entry in entries]).T for k in (0, 1)))
        for name, route in routes.items()
    ]


def check_coordinates(function: ca.Function, drawn: Sequence[Drawn]) -> list[Finding]:
    """The coordinates are those that the frames were put together by."""

    def at_one(at: Drawn) -> Both:
        found = function(at.motions[0][0], at.together, at.parameters)
        return {"coordinate": (np.asarray(found).ravel(), at.coordinates)}

    return _gathered({"coordinate": TOGETHER}, list(map(at_one, drawn)))


def first_coordinate(kind: str, at: Drawn) -> tuple[float, float, float]:
    """The coordinate that limits and springs act on, and its derivatives along the motion."""
    moved = differenced(lambda h: COORDINATES[kind](frames_at(at.motions, at.parameters, at.t, h))[:1])
    return tuple(float(x[0]) for x in moved)  # type: ignore[return-value]


def limit_numbers(kind: LimitKind, at: Drawn) -> tuple[Array, float]:
    """eta (0,) or (1,), two turns on; and the sign of the gap."""
    value, _, _ = first_coordinate(kind.kind, at)
    return np.array([value + 4 * np.pi] if is_turn(kind.kind) else []), -1.0 if kind.upper else 1.0


def gap_of(kind: LimitKind, at: Drawn, *turns: float) -> tuple[float, float, float]:
    """Gap between the coordinate (plus `turns`) and the bound, and its derivatives."""
    bound, sign = float(at.parameters[-1]), -1 if kind.upper else 1
    length, turned = float(at.parameters[24]), sum(turns)

    def gap(h: Any) -> list[Any]:
        value = COORDINATES[kind.kind](frames_at(at.motions, at.parameters, at.t, h))[kind.coordinate]
        if kind.kind == "spherical":
            return [sign * length * (mp.cos(bound) - mp.cos(value)) / mp.sin(bound)]
        return [sign * (length if is_turn(kind.kind) else 1) * (value + turned - bound)]

    return tuple(float(x[0]) for x in differenced(gap))  # type: ignore[return-value]


def check_limit(role: str, function: ca.Function, kind: LimitKind, drawn: Sequence[Drawn]) -> list[Finding]:
    """`rates` or `place` of a limit; an angle is found from within half a turn."""
    less, axis, origin = "the coordinate less its bound", "z axis of the first frame", "origin of the frame"
    rates = {"d": less, "J": f"J u = d_dot; {MOTION}", "gamma": f"J u_dot + gamma = d_ddot; {MOTION}",
             "eta_dot": MOTION, "normal": axis}  # fmt: skip
    place = {"eta_next": "the coordinate, from within half a turn", "d": less, "normal": axis,
             "residual": "how far eta was off", "point_o": origin, "point_f": origin}  # fmt: skip
    if role == "rates":
        return _gathered(rates, [_limit_rates(function, kind, at) for at in drawn])
    off = np.random.default_rng(7).uniform(-3.0, 3.0, (len(drawn), int(is_turn(kind.kind))))
    return _gathered(place, [_limit_place(function, kind, *each) for each in zip(drawn, off, strict=True)])


def _limit_rates(function: ca.Function, kind: LimitKind, at: Drawn) -> Both:
    eta, sign = limit_numbers(kind, at)
    value, rate, _ = first_coordinate(kind.kind, at)
    gap, first, second = gap_of(kind, at, *(eta - value))
    d, J_o, J_f, gamma, eta_dot, normal = (
        np.asarray(x).ravel() for x in function(*at.moving, eta, at.parameters)
    )
    J = np.concatenate([J_o, J_f])
    return {
        "d": (d, [gap]), "J": ([J @ at.u], [first]), "gamma": (J @ at.u_dot + gamma, [second]),
        "eta_dot": (eta_dot, [rate][: eta.size]), "normal": (normal, sign * _axis(at)),
    }  # fmt: skip


def _axis(at: Drawn) -> Array:
    R = at.motions[0][0][3:].reshape(3, 3, order="F")
    return np.asarray(R @ at.parameters[9:12])


def _limit_place(function: ca.Function, kind: LimitKind, at: Drawn, off: Array) -> Both:
    eta, sign = limit_numbers(kind, at)
    gap, _, _ = gap_of(kind, at, *(eta + off - first_coordinate(kind.kind, at)[0]))
    pose_a, _, pose_b, _ = at.moving
    out = [np.asarray(x).ravel() for x in function(pose_a, pose_b, eta + off, at.parameters)]
    frames = frames_at(at.motions, at.parameters, 0.0, 0.0)
    origins = [np.array([float(x) for x in origin]) for origin in frames.origins]
    return {
        "eta_next": (out[0], eta), "d": (out[1], [gap]), "normal": (out[4], sign * _axis(at)),
        "residual": (out[2], [0.0, *(np.abs(off) if eta.size else [0.0])]),
        "point_o": (out[5], origins[0]), "point_f": (out[6], origins[1]),
    }  # fmt: skip


def check_spring(role: str, function: ca.Function, kind: LoadKind, drawn: Sequence[Drawn]) -> list[Finding]:
    """Virtual work of a spring, -(k (c - rest) + damping c_dot), or of an actuator: the wrench is that force
    times dc along each of twelve directions, J."""
    if role == "deflection":
        routes = {"deflection": MOTION, "J": POWER}
        return _gathered(routes, [_deflected(function, kind, at) for at in drawn])
    routes = {f"wrench_{side}": f"virtual work; {POWER}" for side in "ab"}
    return _gathered(routes, [_pushed(function, kind, at) for at in drawn])


def _deflected(function: ca.Function, kind: LoadKind, at: Drawn) -> Both:
    pose_a, _, pose_b, _ = at.moving
    off, row = (np.asarray(x).ravel() for x in function(pose_a, pose_b, at.parameters))
    return {"deflection": (off, [_off(kind, at)]), "J": (row, _slopes(kind, at))}


def _off(kind: LoadKind, at: Drawn) -> float:
    """The first coordinate from rest, an angle within half a turn."""
    off = first_coordinate(kind.joint, at)[0] - at.parameters[-1]
    return float(np.arctan2(np.sin(off), np.cos(off)) if is_turn(kind.joint) else off)


def _slopes(kind: LoadKind, at: Drawn) -> Array:
    return np.array([_slope(kind.joint, at, k) for k in range(12)])


def _force(kind: LoadKind, at: Drawn, settings: list[Array]) -> float:
    """Along the first coordinate: of a spring -(k (c - rest) + damping c_dot), of an actuator as it says."""
    value, rate, _ = first_coordinate(kind.joint, at)
    if kind.law is None:
        stiffness, damping, _ = at.parameters[-3:]
        return float(-(stiffness * _off(kind, at) + damping * rate))
    law = with_settings(kind.law, kind.inputs, settings[0]) if settings else kind.law
    gain, *ends = at.parameters[-3:] if kind.limited else at.parameters[-1:]
    force = gain * evaluate(law, {"t": at.t, "coordinate": float(value), "rate": float(rate)})
    return float(np.clip(force, *ends)) if ends else float(force)


def _pushed(function: ca.Function, kind: LoadKind, at: Drawn) -> Both:
    settings = _settings(kind, at)
    wanted = _force(kind, at, settings) * _slopes(kind, at)
    found = _called(function, at.t, *at.moving, at.parameters, *settings)
    on_a, on_b = (np.asarray(x).ravel() for x in found)
    return {"wrench_a": (on_a, wanted[:6]), "wrench_b": (on_b, wanted[6:])}


def _slope(kind: str, at: Drawn, direction: int) -> float:
    """Derivative of the first coordinate along one of twelve unit twists."""
    unit = np.eye(12)[direction]
    motions = tuple(
        (pose, twist, np.zeros(6))
        for (pose, _, _), twist in zip(at.motions, (unit[:6], unit[6:]), strict=True)
    )
    return float(
        differenced(lambda h: COORDINATES[kind](frames_at(motions, at.parameters, 0.0, h))[:1])[1][0]
    )
