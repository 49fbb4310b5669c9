"""Random extremal pairs by construction: choose both points and the gap, then pose the bodies to fit."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Any

import casadi as ca
import numpy as np

from tests.laws.shapes import SPECIMENS, Specimen

Array = np.ndarray[Any, np.dtype[np.float64]]


@dataclass(frozen=True)
class Configurations:
    """n extremal pairs; every array has one column per configuration."""

    alpha: Array  # (4,n) chart coordinates of o and f
    pose_o: Array  # (12,n)
    pose_f: Array
    twist_o: Array  # (6,n) world linear, body angular
    twist_f: Array
    accel_o: Array  # (6,n)
    accel_f: Array
    x_o: Array  # (3,n) shape frame
    x_f: Array
    d: Array  # (n,)


@cache
def surface(specimen: Specimen) -> ca.Function:
    """uv -> point and exterior normal by differentiation of the independent chart."""
    uv = ca.SX.sym("uv", 2)
    x = ca.vertcat(*specimen.chart(ca, uv[0], uv[1], specimen.parameters))
    E = ca.jacobian(x, uv)
    n = specimen.sign * ca.cross(E[:, 0], E[:, 1])
    return ca.Function("surface", [uv], [x, n / ca.norm_2(n)])


def columns(f: ca.Function, *arrays: Array) -> tuple[Array, ...]:
    """f on every column."""
    return tuple(np.asarray(out) for out in f.map(arrays[0].shape[1]).call(list(arrays)))


def rotation_taking(a: Array, b: Array, angle: Array) -> Array:
    """(n,3,3) rotations with R a = b for unit vectors (3,n), with a free turn about b."""

    def frame(z: Array) -> Array:
        other = np.where(np.abs(z[0]) < 0.6, np.array([[1.0], [0], [0]]), np.array([[0], [1.0], [0]]))
        x = np.cross(other, z, axis=0)
        x /= np.linalg.norm(x, axis=0)
        return np.stack([x, np.cross(z, x, axis=0), z], axis=-1).transpose(1, 0, 2)

    c, s, zero = np.cos(angle), np.sin(angle), np.zeros_like(angle)
    turn = np.array([[c, -s, zero], [s, c, zero], [zero, zero, zero + 1]]).transpose(2, 0, 1)
    return frame(b) @ turn @ frame(a).transpose(0, 2, 1)


def pose_of(p: Array, R: Array) -> Array:
    """(12,n) from positions (3,n) and rotations (n,3,3)."""
    return np.concatenate([p, R.transpose(0, 2, 1).reshape(-1, 9).T])


def rotation_of(pose: Array) -> Array:
    return pose[3:].T.reshape(-1, 3, 3).transpose(0, 2, 1)


def turned(R: Array, x: Array) -> Array:
    return np.einsum("nij,jn->in", R, x)


def random_pairs(o: Specimen, f: Specimen, count: int, seed: int) -> Configurations:
    """A third of the gaps positive, a third zero, a third negative."""
    random = np.random.default_rng(seed)
    alpha = np.array([random.uniform(*ends, count) for ends in (*o.box, *f.box)])
    (x_o, n_o), (x_f, n_f) = columns(surface(o), alpha[:2]), columns(surface(f), alpha[2:])
    d = np.repeat([0.3, 0.0, -0.15], count)[::3][:count] * random.uniform(0.2, 1.0, count)
    start, end = (axis / np.linalg.norm(axis, axis=0) for axis in random.normal(size=(2, 3, count)))
    R_o = rotation_taking(start, end, random.uniform(-3, 3, count))
    N = turned(R_o, n_o)
    R_f = rotation_taking(n_f, -N, random.uniform(-3, 3, count))
    p_o = random.normal(size=(3, count))
    p_f = p_o + turned(R_o, x_o) + d * N - turned(R_f, x_f)
    motion = random.normal(size=(4, 6, count))
    return Configurations(alpha, pose_of(p_o, R_o), pose_of(p_f, R_f), *motion, x_o, x_f, d)


def parameters(o: str, f: str, count: int) -> Array:
    """The lengths of both specimens on every column."""
    numbers = (*SPECIMENS[o].parameters, *SPECIMENS[f].parameters)
    return np.tile(np.array(numbers).reshape(-1, 1), (1, count))


def eta_of(layout: tuple[str, str], at: Configurations) -> Array:
    """eta as the form carries it."""
    carried = {
        "none": (at.x_o[:0], at.x_f[:0]),
        "chart": (at.alpha[:2], at.alpha[2:]),
        "point": (at.x_o, at.x_f),
    }
    return np.concatenate([carried[layout[0]][0], carried[layout[1]][1]])
