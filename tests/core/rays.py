"""Friction over a polygon by another way: along rays from the centre of rotation, which are cut where they pass the boundary
or the line where the pressure vanishes; over the angle by Gauss' rule between the corners."""

from __future__ import annotations

from typing import Any

import numpy as np

Array = np.ndarray[Any, Any]
NODES, WEIGHTS = np.polynomial.legendre.leggauss(60)


def _corner_angles(loops: list[Array], centre: Array, pressure: Array, at: Array) -> Array:
    """The directions in which rays pass a corner, or the end of the line where the pressure vanishes."""
    points = []
    for loop in loops:
        for p, q in zip(loop, np.roll(loop, -1, axis=0), strict=True):
            points.append(p)
            low, high = (pressure[0] + pressure[1:] @ (x - at) for x in (p, q))
            if low * high < 0:
                points.append(p + low / (low - high) * (q - p))
    arms = np.array(points) - centre
    angles = np.sort(np.arctan2(arms[:, 1], arms[:, 0]))
    return np.array([*angles, angles[0] + 2 * np.pi])


def _radii(loops: list[Array], centre: Array, way: Array) -> Array:
    """Where a ray passes the boundary, in order."""
    found = []
    for loop in loops:
        for p, q in zip(loop, np.roll(loop, -1, axis=0), strict=True):
            edge, arm = q - p, p - centre
            across = way[0] * edge[1] - way[1] * edge[0]
            if across == 0:
                continue
            r, s = (
                (arm[0] * edge[1] - arm[1] * edge[0]) / across,
                (arm[0] * way[1] - arm[1] * way[0]) / across,
            )
            if r > 0 and 0 <= s < 1:
                found.append(r)
    return np.array(sorted(found))


def _along(r0: float, r1: float, level: Array) -> tuple[float, float]:
    """Integrals of (level[0] + level[1] r) r and (..) r^2 where that is not negative."""
    if level[1] != 0:
        zero = -level[0] / level[1]
        if level[1] > 0:
            r0 = max(r0, zero)
        else:
            r1 = min(r1, zero)
    elif level[0] < 0:
        return 0.0, 0.0
    if r1 <= r0:
        return 0.0, 0.0
    power = [r1**k - r0**k for k in range(5)]
    return (
        level[0] * power[2] / 2 + level[1] * power[3] / 3,
        level[0] * power[3] / 3 + level[1] * power[4] / 4,
    )


def friction_along_rays(loops: list[Array], pressure: Array, at: Array, twist: Array) -> Array:
    """(3,) force and torque about `at` of unit friction; the twist of `at` must spin, the loops have corners (n, 2)."""
    v, w = twist[:2], twist[2]
    centre = at + np.array([-v[1], v[0]]) / w
    total = np.zeros(3)
    ends = _corner_angles(loops, centre, pressure, at)
    for low, high in zip(ends[:-1], ends[1:], strict=True):
        for node, weight in zip(NODES, WEIGHTS, strict=True):
            angle = (low + high) / 2 + node * (high - low) / 2
            way = np.array([np.cos(angle), np.sin(angle)])
            level = np.array([pressure[0] + pressure[1:] @ (centre - at), pressure[1:] @ way])
            radii = _radii(loops, centre, way)
            pairs = np.concatenate([[0.0], radii]) if len(radii) % 2 else radii
            for r0, r1 in pairs.reshape(-1, 2):
                force, torque = _along(r0, r1, level)
                total += weight * (high - low) / 2 * np.array([-way[1] * force, way[0] * force, torque])
    total *= -np.sign(w)
    arm = centre - at
    total[2] += arm[0] * total[1] - arm[1] * total[0]
    return total
