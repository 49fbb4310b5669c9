"""Upright bodies that slide and spin on a face until friction stops them, integrated without the core.

A body of mass m stands on a plane with friction mu, its centre of mass at the height h above the middle of
its face. The pressure p = max(0, a + b.x) over the face bears the weight and the moment of friction:

    integral p dA = m g,   integral p (x - mu h u) dA = 0,   u the direction of slip at x.

Quadrature is by polar coordinates about the centre of rotation, in which u depends on the angle alone. The
motion is integrated in the time s with dt = S ds, S = sqrt(v.v + (R w)^2), in which slip that ends in a
finite time decays exponentially, whatever the ratio of velocity and spin tends to.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy.integrate import DOP853

G = 9.81
NEARLY_TIPPING = 2e-3  # least distance, in radii, of the centre of pressure from the edge that is integrated
FAR = 3.0  # distance of the centre of rotation, in radii, from which u is smooth over the face
ANGLES = 40  # nodes of a sector


def _double_exponential(n: int) -> tuple[np.ndarray, np.ndarray]:
    t = np.linspace(-3.1, 3.1, n)
    arm = np.pi / 2 * np.sinh(t)
    weight = (t[1] - t[0]) * np.pi / 2 * np.cosh(t) / np.cosh(arm) ** 2
    return (1 + np.tanh(arm)) / 2, weight / weight.sum()


SECTOR, SECTOR_WEIGHT = _double_exponential(ANGLES)
POLYNOMIAL, SMOOTH = (np.polynomial.legendre.leggauss(n) for n in (3, 10))  # nodes along a ray


class Disc(NamedTuple):
    radius: float

    def breaks(self, c: np.ndarray) -> list[float]:
        """Directions from c near which the distance to the boundary is not smooth."""
        away = np.hypot(*c)
        to = np.arctan2(-c[1], -c[0])
        if away > self.radius:
            edge = np.arcsin(self.radius / away)
            return [to - edge, to, to + edge]
        return [to, to + np.pi / 2, to + np.pi, to - np.pi / 2]

    def cut(self, c: np.ndarray, e: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Distances along the rays from c in the directions e between which these are inside."""
        along, across = e @ c, e[:, 0] * c[1] - e[:, 1] * c[0]
        half = np.sqrt(np.maximum(self.radius**2 - across**2, 0.0))
        return -along - half, -along + half

    def crossings(self, normal: np.ndarray, offset: float) -> list[np.ndarray]:
        """Points of the boundary with normal . x = offset; normal of unit length."""
        if abs(offset) >= self.radius:
            return []
        half = np.sqrt(self.radius**2 - offset**2)
        side = np.array([-normal[1], normal[0]])
        return [offset * normal + half * side, offset * normal - half * side]


class Polygon(NamedTuple):
    """Convex, counterclockwise."""

    vertices: np.ndarray

    def breaks(self, c: np.ndarray) -> list[float]:
        d = self.vertices - c
        return [float(a) for a in np.arctan2(d[:, 1], d[:, 0])]

    def cut(self, c: np.ndarray, e: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        low, high = np.full(len(e), -np.inf), np.full(len(e), np.inf)
        for a, b in zip(self.vertices, np.roll(self.vertices, -1, axis=0), strict=True):
            normal = np.array([b[1] - a[1], a[0] - b[0]])
            way, left = e @ normal, normal @ (a - c)
            with np.errstate(divide="ignore", invalid="ignore"):
                at = left / way
            high = np.where(way > 0, np.minimum(high, at), high)
            low = np.where(way < 0, np.maximum(low, at), low)
            high = np.where((way == 0) & (left < 0), -np.inf, high)
        return low, np.maximum(low, high)

    def crossings(self, normal: np.ndarray, offset: float) -> list[np.ndarray]:
        value = self.vertices @ normal - offset
        points = []
        for k, a in enumerate(self.vertices):
            b, va, vb = self.vertices[k - 1], value[k], value[k - 1]
            if va * vb < 0:
                points.append(b + (a - b) * vb / (vb - va))
        return points


@dataclass(frozen=True)
class Spun:
    """A body: pieces of its face with signs, coefficient of friction, height in m, and the square of its
    radius of inertia about the vertical, over the square of `radius` in m."""

    pieces: tuple[tuple[int, Disc | Polygon], ...]
    mu: float
    height: float
    inertia: float
    radius: float

    def turned(self, angle: float) -> list[tuple[int, Disc | Polygon]]:
        turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
        return [
            (sign, Polygon(piece.vertices @ turn) if isinstance(piece, Polygon) else piece)
            for sign, piece in self.pieces
        ]


def nodes(
    piece: Disc | Polygon, pressure: np.ndarray, c: np.ndarray, ray: tuple[np.ndarray, np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """Nodes and weights of integrals over the part of a piece that is under pressure, along rays from c."""
    slope = np.hypot(*pressure[1:])
    is_cut = slope > 0
    breaks = list(piece.breaks(c))
    if is_cut:
        crossings = piece.crossings(pressure[1:] / slope, -pressure[0] / slope)
        breaks += [float(np.arctan2(*(x - c)[::-1])) for x in crossings]
        to = float(np.arctan2(pressure[2], pressure[1]))
        breaks += [to, to + np.pi]
    a = np.unique(np.round(np.mod(breaks, 2 * np.pi), 15))
    a = np.append(a, a[0] + 2 * np.pi)
    width = np.diff(a)
    angle = (a[:-1, None] + width[:, None] * SECTOR).ravel()
    weight = (width[:, None] * SECTOR_WEIGHT).ravel()
    e = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    low, high = piece.cut(c, e)
    if is_cut:
        at_c, rise = pressure[0] + pressure[1:] @ c, e @ pressure[1:]
        with np.errstate(divide="ignore", invalid="ignore"):
            zero = -at_c / rise
        low = np.where(rise > 0, np.maximum(low, zero), low)
        high = np.where(rise < 0, np.minimum(high, zero), high)
        high = np.where((rise == 0) & (at_c <= 0), low, high)
    low = np.maximum(low, 0.0)
    length = np.maximum(high - low, 0.0)
    keep = length > 0
    low, length, e, weight = low[keep], length[keep], e[keep], weight[keep]
    r = low[:, None] + length[:, None] * (1 + ray[0]) / 2
    w = (weight * length)[:, None] * ray[1] / 2 * r
    x = c + r[..., None] * e[:, None, :]
    return x.reshape(-1, 2), w.ravel()


def loaded(
    body: Spun, pieces: list, twist: np.ndarray, p: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points, weights and directions of slip over the loaded region."""
    v, w = twist[:2], twist[2]
    size = np.hypot(*v)
    c = np.array([-v[1], v[0]]) / w if size < FAR * body.radius * abs(w) else None
    points, weights = [], []
    for sign, piece in pieces:
        x, q = nodes(piece, p, np.zeros(2), SMOOTH) if c is None else nodes(piece, p, c, POLYNOMIAL)
        points.append(x), weights.append(sign * q)
    x, q = np.concatenate(points), np.concatenate(weights)
    slip = v + w * np.stack([-x[:, 1], x[:, 0]], axis=1)
    return x, q, slip / np.maximum(np.hypot(slip[:, 0], slip[:, 1]), 1e-300)[:, None]


def pressure(
    body: Spun, pieces: list, twist: np.ndarray, start: np.ndarray
) -> tuple[np.ndarray, np.ndarray, float]:
    """Pressure for a weight of 1, friction over mu and its torque; by Newton's method, whose matrix is exact
    because the pressure vanishes where the loaded region ends."""

    def equations(p: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
        x, q, u = loaded(body, pieces, twist, p)
        arm = (x - body.mu * body.height * u) / body.radius
        left = np.stack([np.ones(len(x)), arm[:, 0], arm[:, 1]])
        right = np.stack([np.ones(len(x)), x[:, 0], x[:, 1]])
        load = q * (p @ right)
        torque = float(load @ (x[:, 0] * u[:, 1] - x[:, 1] * u[:, 0]))
        return left @ load - [1, 0, 0], (left * q) @ right.T, load @ u, torque

    p = np.array(start)
    miss, matrix, force, torque = equations(p)
    for _ in range(60):
        step = np.linalg.lstsq(matrix, miss)[0]
        part = 1.0
        while True:
            tried = equations(p - part * step)
            if np.abs(tried[0]).max() < np.abs(miss).max() * (1 - part / 4) or part < 1e-6:
                break
            part /= 2
        if part < 1e-6:
            break
        p = p - part * step
        miss, matrix, force, torque = tried
        if np.abs(miss).max() < 1e-13:
            break
    if not np.abs(miss).max() < 1e-10:
        raise ArithmeticError(f"no pressure found: {miss}")
    return p, force, torque


def pressure_from_uniform(body: Spun, pieces: list, twist: np.ndarray) -> np.ndarray:
    """The pressure that grows from the uniform one with the height of the centre of mass; ArithmeticError if
    it ends before."""
    found, part, step = uniform(body), 0.0, 0.25
    while part < 1:
        try:
            tried = min(part + step, 1.0)
            found = pressure(replace(body, height=tried * body.height), pieces, twist, found)[0]
            part = tried
        except ArithmeticError:
            step /= 2
            if step < 1e-4:
                raise
    return found


class End(NamedTuple):
    """How slip on the whole face ends, or is at a time."""

    t: float  # s
    place: np.ndarray  # (2,) m
    turned: float  # rad
    ratio: float  # |v|/(R |w|), of which the limit is that of 0/0
    margin: float  # of the centre of pressure inside the edge of the face, in radii; -1: no pressure


def uniform(body: Spun) -> np.ndarray:
    """The uniform pressure of a weight of 1."""
    ones = np.array([1.0, 0.0, 0.0])
    return ones / sum(
        sign * nodes(piece, ones, np.zeros(2), POLYNOMIAL)[1].sum() for sign, piece in body.pieces
    )


def inside(piece: Disc | Polygon, x: np.ndarray) -> float:
    """Distance of a point inside a piece from its edge."""
    if isinstance(piece, Disc):
        return piece.radius - float(np.hypot(*x))
    ahead = np.roll(piece.vertices, -1, axis=0) - piece.vertices
    arm = x - piece.vertices
    return float(np.min((ahead[:, 0] * arm[:, 1] - ahead[:, 1] * arm[:, 0]) / np.hypot(*ahead.T)))


def course(
    body: Spun, v: np.ndarray, w: float, near: float, nearest: float, rtol: float = 1e-12
) -> list[End]:
    """Slip that has the velocity v (2,) m/s and the spin w rad/s at the time 0: the ends of the steps after
    which the centre of pressure is within `near` radii of the edge, and of the last step: where it is within
    `nearest`, slip ends by friction, or no pressure goes on. ArithmeticError if none begins."""
    r, size = body.radius, float(np.sqrt(v @ v + (body.radius * w) ** 2))
    twist = np.array([*v, w]) / size
    settled = np.append(twist, 0.0), pressure_from_uniform(body, list(body.pieces), twist)

    def followed(y: np.ndarray) -> tuple[tuple[np.ndarray, np.ndarray], np.ndarray, float]:
        """The pressure, its force and torque, followed from the end of the last step that was accepted;
        ArithmeticError if it does not go on."""
        if not np.isfinite(y).all():
            raise ArithmeticError("the step is too long")
        n = y[:3] / np.sqrt(y[:3] @ y[:3])
        (begin, p), end = settled, np.array([n[0], n[1], n[2] / r, y[5]])
        part, step = 0.0, 1.0
        while True:
            tried = min(part + step, 1.0)
            at = begin + tried * (end - begin)
            try:
                p, force, torque = pressure(body, body.turned(at[3]), at[:3], p)
            except ArithmeticError:
                step /= 4
                if step < 1 / 16:
                    raise
                continue
            part = tried
            if part == 1:
                return (end, p), force, torque

    def rate(s: float, y: np.ndarray) -> np.ndarray:
        """Of the directions of v and R w (3), the place (2), the angle, log S and the time."""
        _, force, torque = followed(y)
        n, speed = y[:3] / np.sqrt(y[:3] @ y[:3]), np.exp(y[6])
        slowing = -body.mu * G * np.array([*force, torque / (body.inertia * r)])
        along = slowing @ n
        return np.array([*(slowing - along * n), *(speed**2 * n[:2]), speed**2 * n[2] / r, along, speed])

    y = np.array([*(np.append(v, r * w) / size), 0, 0, 0, np.log(size), 0])
    first = 1 / (body.mu * G) / 1000
    way = DOP853(rate, 0.0, y, np.inf, rtol=rtol, atol=1e-14, first_step=first)
    reached: list[End] = []
    margin = np.inf
    while margin > nearest and way.y[6] > np.log(1e-16 * size):
        try:
            way.step()
        except ArithmeticError:  # no pressure goes on to the end of the step
            way.h_abs /= 4
            if way.h_abs < 1e-10 * first:
                break
            continue
        settled, force, _ = followed(way.y)
        margin = inside(body.turned(way.y[5])[0][1], body.mu * body.height * force) / r
        ratio = float(np.hypot(*way.y[:2]) / abs(way.y[2]))
        end = End(way.y[7], way.y[3:5], way.y[5], ratio, margin)
        if margin <= near:
            reached.append(end)
    return reached if margin <= near else [*reached, end]


def ending(body: Spun, v: np.ndarray, w: float, rtol: float = 1e-12) -> End:
    """The end of slip that has the velocity v (2,) m/s and the spin w rad/s at the time 0, by friction or by
    tipping (from NEARLY_TIPPING on)."""
    return course(body, v, w, NEARLY_TIPPING, NEARLY_TIPPING, rtol)[-1]
