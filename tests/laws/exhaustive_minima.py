"""All minima of the distance of two parametrised shapes by brute force, independent of the project's code.

A grid over the coordinates of both shapes is searched for local minima; Newton's method starts from each. The
signed distance of two surfaces that overlap a little has its minima where the distance of the second from the
surface at depth `offset` inside the first has them, and is less by `offset`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import casadi as ca
import numpy as np

Array = np.ndarray[Any, Any]


@dataclass(frozen=True)
class Parametrised:
    """A closed surface, or a curve, of coordinates in a box."""

    name: str
    at: Callable[..., Sequence[Any]]  # casadi expressions of the coordinates: x, y, z in m
    domain: tuple[tuple[float, float], ...]
    periodic: tuple[bool, ...]
    outward: float = 1.0  # sign of d/du x d/dv against the exterior normal; 0: a curve

    @property
    def size(self) -> int:
        return len(self.domain)

    def grid(self, n: int) -> list[Array]:
        """n values of each coordinate, in the middles of n equal parts."""
        return [low + (np.arange(n) + 0.5) * (high - low) / n for low, high in self.domain]


@dataclass(frozen=True)
class Minima:
    """Minima of one pair: signed distance (m), and points in world axes."""

    d: Array  # (m,)
    point_o: Array  # (m, 3) m
    point_f: Array  # (m, 3) m


@cache
def place_of(shape: Parametrised) -> ca.Function:
    """Point and exterior normal (0 of a curve) at coordinates, axes of the shape."""
    w = ca.SX.sym("w", shape.size)
    x = ca.vertcat(*shape.at(*ca.vertsplit(w)))
    normal = ca.SX.zeros(3)
    if shape.outward:
        jacobian = ca.jacobian(x, w)
        across = shape.outward * ca.cross(jacobian[:, 0], jacobian[:, 1])
        normal = across / ca.norm_2(across)
    return ca.Function("place", [w], [x, normal])


@cache
def square_distance(o: Parametrised, f: Parametrised) -> ca.Function:
    """|x_f - (x_o - offset n_o)|^2 / 2 with gradient and Hessian, f at `pose` (12) in axes of o."""
    w, pose, offset = ca.SX.sym("w", o.size + f.size), ca.SX.sym("pose", 12), ca.SX.sym("offset")
    x_o, normal = place_of(o)(w[: o.size])
    x_f, _ = place_of(f)(w[o.size :])
    r = pose[:3] + ca.mtimes(ca.reshape(pose[3:], 3, 3), x_f) - x_o + offset * normal
    value = ca.sumsqr(r) / 2
    hessian, gradient = ca.hessian(value, w)
    return ca.Function("square", [w, pose, offset], [value, gradient, hessian])


def points_of(shape: Parametrised, w: Array) -> tuple[Array, Array]:
    """Points and normals at rows of coordinates."""
    return tuple(np.array(each).T for each in place_of(shape)(w.T))  # type: ignore[return-value]


@cache
def points_on_grid(shape: Parametrised, n: int) -> tuple[Array, Array, Array]:
    """Coordinates, points and normals on a grid, in rows."""
    at = np.stack(np.meshgrid(*shape.grid(n), indexing="ij"), -1).reshape(-1, shape.size)
    return at, *points_of(shape, at)


def grid_minima(o: Parametrised, f: Parametrised, pose: Array, offset: float, n: int) -> Array:
    """Coordinates of both, in rows, of the local minima of the distance on a grid."""
    (first, x_o, normal), (second, x_f, _) = (points_on_grid(shape, n) for shape in (o, f))
    x_o = (x_o - offset * normal).astype(np.float32)
    x_f = (pose[:3] + x_f @ pose[3:].reshape(3, 3, order="F").T).astype(np.float32)
    squares = (x_o**2).sum(1)[:, None] + (x_f**2).sum(1) - 2 * x_o @ x_f.T
    squares = squares.reshape((n,) * (o.size + f.size))
    least = squares
    for axis, periodic in enumerate((*o.periodic, *f.periodic)):
        least = _least_of_neighbours(least, axis, periodic)
    row, column = np.divmod(np.flatnonzero(squares <= least), len(second))
    return np.hstack([first[row], second[column]])


def _least_of_neighbours(values: Array, axis: int, periodic: bool) -> Array:
    """Of each value and its neighbours along an axis the least."""
    given = np.moveaxis(values, axis, 0)
    least = given.copy()
    np.minimum(least[1:], given[:-1], out=least[1:])
    np.minimum(least[:-1], given[1:], out=least[:-1])
    if periodic:
        np.minimum(least[0], given[-1], out=least[0])
        np.minimum(least[-1], given[0], out=least[-1])
    return np.moveaxis(least, 0, axis)


def nearest_on_grid(shape: Parametrised, x: Array, n: int = 200) -> Array:
    """Coordinates, in rows, of the points of a grid that are nearest to points in the axes of the shape."""
    at, points, _ = points_on_grid(shape, n)
    return at[[np.argmin(np.linalg.norm(points - each, axis=1)) for each in x]].reshape(-1, shape.size)


def descended(
    o: Parametrised, f: Parametrised, pose: Array, offset: float, w: Array, steps: int = 60
) -> tuple[Array, Array]:
    """Newton's method with a trust region from rows of coordinates; True: in a strict minimum."""
    square = square_distance(o, f)
    k, trust = w.shape[1], np.full(len(w), 0.2)

    def evaluate(at: Array) -> tuple[Array, Array, Array]:
        value, gradient, hessian = (np.array(each) for each in square(at.T, pose, offset))
        return value[0], gradient.T, hessian.reshape(k, len(at), k).transpose(1, 0, 2)

    value, gradient, hessian = evaluate(w)
    for _ in range(steps):
        eigenvalue, vector = np.linalg.eigh(hessian)
        bent = np.maximum(np.abs(eigenvalue), 1e-9)
        along = np.einsum("nij,ni->nj", vector, gradient) / bent
        step = -np.einsum("nij,nj->ni", vector, along)
        length = np.linalg.norm(step, axis=1)
        step *= np.minimum(1, trust / np.maximum(length, 1e-300))[:, None]
        there = evaluate(w + step)
        better = there[0] <= value * (1 + 4e-16)
        trust = np.where(better, np.minimum(2 * trust, 0.5), np.minimum(trust, length) / 4)
        w = np.where(better[:, None], w + step, w)
        value = np.where(better, there[0], value)
        gradient = np.where(better[:, None], there[1], gradient)
        hessian = np.where(better[:, None, None], there[2], hessian)
    eigenvalue = np.linalg.eigvalsh(hessian)
    left = np.linalg.norm(np.linalg.solve(hessian + 1e-14 * np.eye(k), gradient[:, :, None]), axis=1)
    return w, (eigenvalue[:, 0] > 1e-7 * eigenvalue[:, -1]) & (left[:, 0] < 1e-6)


def exhaustive(
    o: Parametrised, f: Parametrised, pose: Array, *, near: tuple[Array, Array] | None = None,
    offset: float = 0.0, n: int = 32, merge: float = 1e-5,
) -> Minima:  # fmt: skip
    """All minima of the signed distance above -offset, sorted; f at `pose` in the axes of o.

    near: rows of points on both, in the axes of o, from which Newton's method starts too.
    """
    starts = grid_minima(o, f, pose, offset, n)
    if near is not None:
        in_f = (near[1] - pose[:3]) @ pose[3:].reshape(3, 3, order="F")
        starts = np.vstack([starts, np.hstack([nearest_on_grid(o, near[0]), nearest_on_grid(f, in_f)])])
    w, converged = descended(o, f, pose, offset, starts)
    if not converged.any():
        return Minima(np.zeros(0), np.zeros((0, 3)), np.zeros((0, 3)))
    return described(o, f, pose, offset, w[converged], merge)


def described(o: Parametrised, f: Parametrised, pose: Array, offset: float, w: Array, merge: float) -> Minima:
    """The points at minima, each once, without those at which one shape is on the inside of the other."""
    x_o, normal = points_of(o, w[:, : o.size])
    x_f, normal_f = points_of(f, w[:, o.size :])
    R = pose[3:].reshape(3, 3, order="F")
    x_f, normal_f = pose[:3] + x_f @ R.T, normal_f @ R.T
    r = x_f - x_o + offset * normal
    d = np.linalg.norm(r, axis=1) - offset
    outside = ((r * normal).sum(1) >= 0) & ((r * normal_f).sum(1) <= 0)
    inside_box = np.ones(len(w), dtype=bool)
    for k, ((low, high), periodic) in enumerate(
        zip((*o.domain, *f.domain), (*o.periodic, *f.periodic), strict=True)
    ):
        if not periodic:
            inside_box &= (w[:, k] >= low) & (w[:, k] <= high)
    kept: list[int] = []
    for i in np.argsort(d):
        new = all(np.linalg.norm(x_o[i] - x_o[j]) + np.linalg.norm(x_f[i] - x_f[j]) > merge for j in kept)
        if outside[i] and inside_box[i] and new:
            kept.append(int(i))
    return Minima(d[kept], x_o[kept], x_f[kept])
