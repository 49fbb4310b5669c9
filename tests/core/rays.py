"""Friction over a polygon by another way: along rays from the centre of rotation, cut at the boundary.

They end as well where the pressure vanishes. Over the angle by Gauss' rule between the corners; each answer
comes with what another number of nodes changes of it.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import Any

import numpy as np

Array = np.ndarray[Any, Any]
FINE, COARSE = 50, 36  # nodes between two corners


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


def _rays(
    loops: list[Array], centre: Array, pressure: Array, at: Array, nodes: int
) -> Iterator[tuple[float, Array, float, float]]:
    """Weight, direction and the two integrals along each piece of each ray."""
    ends = _corner_angles(loops, centre, pressure, at)
    for low, high in pairwise(ends):
        for node, weight in zip(*np.polynomial.legendre.leggauss(nodes), strict=True):
            angle = (low + high) / 2 + node * (high - low) / 2
            way = np.array([np.cos(angle), np.sin(angle)])
            level = np.array([pressure[0] + pressure[1:] @ (centre - at), pressure[1:] @ way])
            radii = _radii(loops, centre, way)
            for r0, r1 in (np.concatenate([[0.0], radii]) if len(radii) % 2 else radii).reshape(-1, 2):
                yield weight * (high - low) / 2, way, *_along(r0, r1, level)


def _resultant(loops: list[Array], pressure: Array, at: Array, nodes: int) -> Array:
    total = np.zeros(3)
    for weight, way, force, arm in _rays(loops, at, pressure, at, nodes):
        total += weight * np.array([force, *(arm * way)])
    return total


def resultant_along_rays(loops: list[Array], pressure: Array, at: Array) -> tuple[Array, float]:
    """(3,) resultant of a pressure and its first moments about `at`, and how far that may be off."""
    fine, coarse = (_resultant(loops, pressure, at, nodes) for nodes in (FINE, COARSE))
    return fine, float(np.abs(fine - coarse).max())


def _friction(loops: list[Array], pressure: Array, at: Array, twist: Array, nodes: int) -> Array:
    centre, sign = at + np.array([-twist[1], twist[0]]) / twist[2], -np.sign(twist[2])
    total = np.zeros(3)
    for weight, way, force, torque in _rays(loops, centre, pressure, at, nodes):
        total += sign * weight * np.array([-way[1] * force, way[0] * force, torque])
    arm = centre - at
    total[2] += arm[0] * total[1] - arm[1] * total[0]
    return total


def friction_along_rays(loops: list[Array], pressure: Array, at: Array, twist: Array) -> tuple[Array, float]:
    """(3,) force and torque about `at` of unit friction, and how far that may be off.

    The twist of `at` must spin; the loops are corners (n, 2).
    """
    fine, coarse = (_friction(loops, pressure, at, twist, nodes) for nodes in (FINE, COARSE))
    return fine, float(np.abs(fine - coarse).max())
