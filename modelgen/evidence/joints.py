"""The rows, coordinates, limits and springs of joints against differences of what the joint keeps."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np
from scipy.spatial.transform import Rotation

from modelgen.evidence.findings import Finding, compared
from modelgen.evidence.joint_truth import COORDINATES, differenced, frames_at, rows_of
from modelgen.joint.limits import is_turn
from modelgen.model import JointKind, LimitKind, LoadKind

Array = np.ndarray[Any, Any]
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
    motions: tuple[tuple[Array, Array, Array], ...]  # (pose, twist, accel) of both bodies
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
    motions = tuple(
        (_pose(random, size), random.normal(size=6), random.normal(size=6)) for _ in range(2)
    )
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
        r = far * direction / np.linalg.norm(direction)
        return (float(far),), r, Rotation.random(random_state=random).as_matrix()
    if kind == "spherical":
        return (), np.zeros(3), Rotation.random(random_state=random).as_matrix()
    values = random.uniform(-1.5, 1.5, len(STEPS.get(kind, ())))
    if kind == "screw":
        values[0] = numbers[0] * values[1] / (2 * np.pi)
    r, Q = np.zeros(3), np.eye(3)
    for step, value in zip(STEPS.get(kind, ()), values, strict=True):
        word, axis = step.split()
        r = r + value * np.eye(3)["xyz".index(axis)] if word == "shift" else r
        Q = Q @ Rotation.from_euler(axis, value).as_matrix() if word == "turn" else Q
    return tuple(map(float, values)), r, Q


def check_rows(function: ca.Function, kind: JointKind, drawn: Sequence[Drawn]) -> list[Finding]:
    """Rows vanish where the joint holds; off it they, J u + bias and J u_dot + gamma1 are as differenced."""
    found, wanted, kept = [], [], []
    for at in drawn:
        value, J, gamma, bias = (np.asarray(x).ravel() for x in function(at.t, *at.moving, at.parameters))
        J = J.reshape(-1, 12)
        found.append((value, J @ at.u + bias, J @ at.u_dot + gamma, bias))
        still = tuple((pose, np.zeros(6), np.zeros(6)) for pose, _, _ in at.motions)
        moved = differenced(lambda h, at=at: _rows(kind, at.motions, at, h))
        wanted.append((*moved, differenced(lambda h, at=at, still=still: _rows(kind, still, at, h))[1]))
        pose_a, twist_a, _, twist_b = at.moving
        kept.append(np.asarray(function(at.t, pose_a, twist_a, at.together, twist_b, at.parameters)[0]))
    findings = [
        _compared(name, f"{formula}{MOTION}", [f[k] for f in found], [w[k] for w in wanted])
        for k, (name, formula) in enumerate(
            (("value", ""), ("J", "J u + bias is the rate of value; "),
             ("gamma1", "J u_dot + gamma1 is its second derivative; "), ("bias", "bodies at rest; "))
        )
    ]  # fmt: skip
    held = [values.ravel()[: len(values.ravel()) - (kind.motion is not None)] for values in kept]
    if kind.kind == "gear" or not held[0].size:
        return findings
    size = float(drawn[0].parameters[24])
    rest = [1.0 + values / size for values in held]
    return [*findings, _compared("value", f"zero at {TOGETHER}", rest, [np.ones_like(x) for x in rest])]


def _rows(kind: JointKind, motions: Sequence[Any], at: Drawn, h: Any) -> list[Any]:
    return rows_of(kind.kind, kind.motion, frames_at(motions, at.parameters, at.t, h))


def _compared(name: str, route: str, found: Sequence[Array], wanted: Sequence[Array]) -> Finding:
    return compared(name, route, np.array(found).T, np.array(wanted).T)


def check_coordinates(function: ca.Function, drawn: Sequence[Drawn]) -> list[Finding]:
    """The coordinates are those that the frames were put together by."""
    found = [np.asarray(function(at.motions[0][0], at.together, at.parameters)).ravel() for at in drawn]
    return [_compared("coordinate", TOGETHER, found, [np.array(at.coordinates) for at in drawn])]


def first_coordinate(kind: str, at: Drawn) -> tuple[float, float, float]:
    """The coordinate that limits and springs act on, and its derivatives along the motion."""
    moved = differenced(lambda h: COORDINATES[kind](frames_at(at.motions, at.parameters, at.t, h))[:1])
    return tuple(float(x[0]) for x in moved)  # type: ignore[return-value]


def limit_numbers(kind: LimitKind, at: Drawn) -> tuple[Array, float, float]:
    """eta (0,) or (1,), two turns on; the lever of the gap; and the bound."""
    value, _, _ = first_coordinate(kind.kind, at)
    eta = np.array([value + 4 * np.pi] if is_turn(kind.kind) else [])
    lever = (-1.0 if kind.upper else 1.0) * (float(at.parameters[24]) if is_turn(kind.kind) else 1.0)
    return eta, lever, float(at.parameters[-1])


def check_limit(role: str, function: ca.Function, kind: LimitKind, drawn: Sequence[Drawn]) -> list[Finding]:
    """`rates` or `place` of a limit."""
    return (_limit_rates if role == "rates" else _limit_place)(function, kind, drawn)


def _limit_rates(function: ca.Function, kind: LimitKind, drawn: Sequence[Drawn]) -> list[Finding]:
    found, wanted = [], []
    for at in drawn:
        eta, lever, bound = limit_numbers(kind, at)
        value, rate, second = first_coordinate(kind.kind, at)
        out = [np.asarray(x).ravel() for x in function(*at.moving, eta, at.parameters)]
        d, J, gamma = out[0], np.concatenate(out[1:3]), out[3]
        found.append((d, [J @ at.u], J @ at.u_dot + gamma, out[4], out[5]))
        counted = eta[0] if eta.size else value
        axis = np.sign(lever) * _axis(at)
        wanted.append(([lever * (counted - bound)], [lever * rate], [lever * second], [rate][: eta.size], axis))
    names = ("d", "J", "gamma", "eta_dot", "normal")
    routes = ("the coordinate less its bound", f"J u = d_dot; {MOTION}",
              f"J u_dot + gamma = d_ddot; {MOTION}", MOTION, "z axis of the first frame")  # fmt: skip
    return [
        _compared(name, route, [f[k] for f in found], [w[k] for w in wanted])
        for k, (name, route) in enumerate(zip(names, routes, strict=True))
    ]


def _axis(at: Drawn) -> Array:
    R = at.motions[0][0][3:].reshape(3, 3, order="F")
    return np.asarray(R @ at.parameters[9:12])


def _limit_place(function: ca.Function, kind: LimitKind, drawn: Sequence[Drawn]) -> list[Finding]:
    """From within half a turn the angle is found, and residual says how far it was."""
    found, wanted = [], []
    random = np.random.default_rng(7)
    for at in drawn:
        eta, lever, bound = limit_numbers(kind, at)
        value, _, _ = first_coordinate(kind.kind, at)
        off = random.uniform(-3.0, 3.0, eta.size)
        pose_a, _, pose_b, _ = at.moving
        out = [np.asarray(x).ravel() for x in function(pose_a, pose_b, eta + off, at.parameters)]
        found.append((out[0], out[1], out[2], out[4], out[5], out[6]))
        counted = (eta + off)[0] if eta.size else value
        origins = [np.array([float(x) for x in p]) for p in _origins(at)]
        wanted.append((eta, [lever * (counted - bound)], [0.0, *(np.abs(off) if eta.size else [0.0])],
                       np.sign(lever) * _axis(at), *origins))  # fmt: skip
    names = ("eta_next", "d", "residual", "normal", "point_o", "point_f")
    routes = ("the coordinate, from within half a turn", "the coordinate less its bound",
              "how far eta was off", "z axis of the first frame", "origin of the frame",
              "origin of the frame")  # fmt: skip
    return [
        _compared(name, route, [f[k] for f in found], [w[k] for w in wanted])
        for k, (name, route) in enumerate(zip(names, routes, strict=True))
    ]


def _origins(at: Drawn) -> tuple[Any, Any]:
    return frames_at(at.motions, at.parameters, 0.0, 0.0).origins


def check_spring(function: ca.Function, kind: LoadKind, drawn: Sequence[Drawn]) -> list[Finding]:
    """Virtual work: the wrench is -(k (c - rest) + damping c_dot) dc along each of twelve directions."""
    found, wanted = [], []
    for at in drawn:
        stiffness, damping, rest = at.parameters[-3:]
        value, rate, _ = first_coordinate(kind.joint, at)
        off = value - rest
        off = np.arctan2(np.sin(off), np.cos(off)) if is_turn(kind.joint) else off
        push = -stiffness * off - damping * rate
        out = [np.asarray(x).ravel() for x in function(at.t, *at.moving, at.parameters)]
        found.append(np.concatenate(out))
        wanted.append(push * np.array([_slope(kind.joint, at, k) for k in range(12)]))
    halves = ((f"wrench_{side}", slice(6 * k, 6 * k + 6)) for k, side in enumerate("ab"))
    return [
        _compared(name, f"virtual work; {POWER}", [f[part] for f in found], [w[part] for w in wanted])
        for name, part in halves
    ]


def _slope(kind: str, at: Drawn, direction: int) -> float:
    """Derivative of the first coordinate along one of twelve unit twists."""
    unit = np.eye(12)[direction]
    twists = (unit[:6], unit[6:])
    motions = tuple((pose, twist, np.zeros(6)) for (pose, _, _), twist in zip(at.motions, twists, strict=True))
    return float(differenced(lambda h: COORDINATES[kind](frames_at(motions, at.parameters, 0.0, h))[:1])[1][0])
