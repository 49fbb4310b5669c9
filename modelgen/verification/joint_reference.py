"""The independent route of joints: what each kind keeps, from the placement of its frames, in 50 digits.

The second frame stands in the first at r with rotation Q. Bodies move by p + v t + a t^2/2 and
R (I + h + h^2/2), h = hat(w t + w_dot t^2/2), exact to second order; everything is differenced in t.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from operator import add, mul, sub, truediv
from typing import Any

import mpmath as mp
import numpy as np

from modelgen.scene.expression import Binary, Call, Cubic, Expression, Name, Node, Number, Unary
from modelgen.scene.joint_format import SPIN

Array = np.ndarray[Any, Any]
DIGITS = 50
STEP = mp.mpf(10) ** -12  # s: differences err by its square
_BINARY = {"+": add, "-": sub, "*": mul, "/": truediv, "**": mp.power}
_NAMED = {"abs": mp.fabs, "min": min, "max": max, "sign": mp.sign}


@dataclass(frozen=True)
class Frames:
    """Both frames of a joint at one instant: positions (3), rotations (3,3), world."""

    t: Any
    origins: tuple[Any, Any]
    turns: tuple[Any, Any]
    length: Any  # m, by which angles count
    numbers: Sequence[Any]

    @property
    def r(self) -> Any:
        return self.turns[0].T * self.span

    @property
    def span(self) -> Any:
        """r in world axes."""
        return self.origins[1] - self.origins[0]

    @property
    def Q(self) -> Any:
        return self.turns[0].T * self.turns[1]


def turned_about_z(f: Frames) -> Any:
    """Angle of the second x axis seen along the first z axis."""
    return mp.atan2(f.Q[1, 0], f.Q[0, 0])


def _off_turn(f: Frames, angle: Any) -> Any:
    """Sine of the turn beyond an angle, times the part of the second x axis across the first z axis."""
    return mp.hypot(f.Q[0, 0], f.Q[1, 0]) * mp.sin(turned_about_z(f) - angle)


def _parallel(f: Frames) -> list[Any]:
    return [f.length * f.Q[0, 2], f.length * f.Q[1, 2]]


def _aligned(f: Frames) -> list[Any]:
    return [f.length * f.Q[1, 2], f.length * f.Q[2, 0], f.length * f.Q[0, 1]]


def _meshed(f: Frames) -> list[Any]:
    n_a, n_b = f.numbers[:2]
    angles = []
    for turn, start in zip(f.turns, (f.numbers[2:11], f.numbers[11:20]), strict=True):
        moved = mp.matrix(3, 3)
        for k in range(9):
            moved[k % 3, k // 3] = start[k]
        moved = moved.T * turn
        angles.append(mp.atan2(moved[1, 0], moved[0, 0]))
    return [f.length * mp.sin(n_a * angles[0] + n_b * angles[1]) / mp.hypot(n_a, n_b)]


ROWS: Mapping[str, Callable[[Frames], list[Any]]] = {
    "revolute": lambda f: [*f.span, *_parallel(f)],
    "prismatic": lambda f: [f.r[0], f.r[1], *_aligned(f)],
    "cylindrical": lambda f: [f.r[0], f.r[1], *_parallel(f)],
    "spherical": lambda f: [*f.span],
    "universal": lambda f: [*f.span, f.length * f.Q[0, 1]],
    "planar": lambda f: [f.r[2], *_parallel(f)],
    "weld": lambda f: [*f.span, *_aligned(f)],
    "screw": lambda f: [
        f.r[0], f.r[1], *_parallel(f),
        f.numbers[0] / (2 * mp.pi) * _off_turn(f, 2 * mp.pi * f.r[2] / f.numbers[0]),
    ],
    "distance": lambda f: [mp.norm(f.r) - f.numbers[0]],
    "rope": lambda f: [],
    "gear": _meshed,
}  # fmt: skip
COORDINATES: Mapping[str, Callable[[Frames], list[Any]]] = {
    "revolute": lambda f: [turned_about_z(f)],
    "prismatic": lambda f: [f.r[2]],
    "cylindrical": lambda f: [f.r[2], turned_about_z(f)],
    "screw": lambda f: [f.r[2], turned_about_z(f)],
    "universal": lambda f: [mp.atan2(f.Q[2, 1], f.Q[1, 1]), mp.atan2(f.Q[0, 2], f.Q[0, 0])],
    "planar": lambda f: [f.r[0], f.r[1], turned_about_z(f)],
    "spherical": lambda f: [mp.acos(f.Q[2, 2])],
    "distance": lambda f: [mp.norm(f.r)],
    "rope": lambda f: [mp.norm(f.r)],
}
ARMATURE_COORDINATES: Mapping[str, tuple[str, ...]] = {
    "revolute": ("angle",), "prismatic": ("displacement",), "cylindrical": ("displacement", "angle"),
    "screw": ("displacement",), "universal": ("angle_x", "angle_y"), "planar": ("x", "y", "angle"),
}  # fmt: skip
GIVEN: Mapping[str, Callable[[Frames, Any], Any]] = {
    "revolute": lambda f, angle: f.length * _off_turn(f, angle),
    "prismatic": lambda f, lift: f.r[2] - lift,
    "screw": lambda f, lift: f.r[2] - lift,
    "distance": lambda f, distance: mp.norm(f.r) - distance,
}


def rows_of(kind: str, motion: Expression | None, f: Frames) -> list[Any]:
    """The rows of a kind, that of a given motion last."""
    if motion is None:
        return ROWS[kind](f)
    held = [] if kind == "distance" else ROWS[kind](f)  # a given distance takes the place of the constant one
    return [*held, GIVEN[kind](f, precise(motion.tree, f.t))]


def inertial_values(kind: str, names: Sequence[str], armature: Array, f: Frames, before: Frames) -> list[Any]:
    """What the rates with an armature I are the rates of, times sqrt(I): coordinates, and of a spin the turn
    from `before`, axes of the first frame there, whose first two derivatives there are the spin and its
    rate."""
    found: list[Any] = []
    for name, inertia in zip(names, armature, strict=True):
        root = mp.sqrt(mp.mpf(float(inertia)))
        if name != SPIN:
            found.append(root * COORDINATES[kind](f)[ARMATURE_COORDINATES[kind].index(name)])
            continue
        turn = f.Q * before.Q.T
        sine = mp.matrix([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]]) / 2
        found += [root * each for each in sine]
    return found


def precise(node: Node, t: Any) -> Any:
    """An expression of t in the working precision."""
    match node:
        case Number(value):
            return mp.mpf(value)
        case Name():
            return t
        case Unary(_, x):
            return -precise(x, t)
        case Call(fn, args):
            return (_NAMED.get(fn) or getattr(mp, fn))(*(precise(arg, t) for arg in args))
        case Binary(op, a, b):
            return _BINARY[op](precise(a, t), precise(b, t))
        case Cubic():
            return precise(node.tree(), t)


def hat(w: Any) -> Any:
    return mp.matrix([[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]])


def placed(pose: Array) -> tuple[Any, Any]:
    """Position and rotation of a pose (12,)."""
    R = mp.matrix(3, 3)
    for k in range(9):
        R[k % 3, k // 3] = mp.mpf(float(pose[3 + k]))
    return mp.matrix([mp.mpf(float(x)) for x in pose[:3]]), R


def frames_at(motions: Sequence[tuple[Array, Array, Array]], parameters: Array, t: Any, h: Any) -> Frames:
    """The frames at t + h of bodies with (pose, twist, accel) at t; `parameters` as the kernels take them."""
    origins, turns = [], []
    for k, (pose, twist, accel) in enumerate(motions):
        p, R = placed(pose)
        v, a = (mp.matrix([mp.mpf(float(x)) for x in values]) for values in (twist, accel))
        step = hat(v[3:] * h + a[3:] * h**2 / 2)
        R = R * (mp.eye(3) + step + step * step / 2)
        own, turn = placed(parameters[12 * k : 12 * k + 12])
        origins.append(p + v[:3] * h + a[:3] * h**2 / 2 + R * own)
        turns.append(R * turn)
    rest = [mp.mpf(float(x)) for x in parameters[24:]]
    return Frames(t + h, (origins[0], origins[1]), (turns[0], turns[1]), rest[0], rest[1:])


def differenced(value: Callable[[Any], Sequence[Any]]) -> tuple[Array, Array, Array]:
    """value(h), its first and its second derivative at h = 0."""
    with mp.workdps(DIGITS):
        before, now, after = (list(value(s * STEP)) for s in (-1, 0, 1))
        triples = list(zip(before, now, after, strict=True))
        first = [float((z - x) / (2 * STEP)) for x, _, z in triples]
        second = [float((z - 2 * y + x) / STEP**2) for x, y, z in triples]
        return np.array([float(y) for y in now]), np.array(first), np.array(second)
