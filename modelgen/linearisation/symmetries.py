"""Motions of single bodies that a scene does not notice, and those of them that it does not notice together.

A generator moves one body: it shifts it or turns it about the origin of the world (from the left), or turns
it about an axis of the body through its centre of mass (from the right). It changes q by qdot = B s(q) and
all velocities and accelerations by one linear map rho:

    shift e:       s = (e, 0)           rho (v, w) = (0, 0)
    left turn e:   s = (e x p, R^T e)   rho (v, w) = (e x v, 0)
    right turn e:  s = (0, e)           rho (v, w) = (0, -e x w)

with v in world and w in body axes. A combination of generators is a symmetry of the equations u_dot = a(q, u)
with the constraints g(q) = 0, J(q) u = 0, if at all states that keep the constraints

    dg s = 0,    d(J u)/dq B s + J rho(u) = 0,    da/dq B s + da/du rho(u) = rho(a).

Source: P. J. Olver, Applications of Lie Groups to Differential Equations (1993), ch. 2.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from modelgen.linearisation.touching_contact import Array

AXES, STILL = np.eye(3), np.zeros((3, 3))


@dataclass(frozen=True)
class Generators:
    """Of all bodies, as columns: three shifts, three left turns, and of a body with orientation three right
    turns."""

    bodies: tuple[tuple[int, int], ...]  # of each dynamic body its first coordinate in u, and how many

    @property
    def count(self) -> int:
        return sum(9 if size == 6 else 6 for _, size in self.bodies)

    @property
    def left_turns(self) -> list[int]:
        """The columns of turns about the origin of the world."""
        firsts = np.cumsum([0, *(9 if size == 6 else 6 for _, size in self.bodies)])[:-1]
        return [int(first) + k for first in firsts for k in (3, 4, 5)]

    def shifts(self, places: list[Array], turns: list[Array]) -> Array:
        """(n, count) s of each generator; of each body p (3,) and R (3, 3)."""
        return self._columns(
            np.hstack([AXES, -_cross(p), STILL])
            if size == 3
            else np.block([[AXES, -_cross(p), STILL], [STILL, R.T, AXES]])
            for (_, size), p, R in zip(self.bodies, places, turns, strict=True)
        )

    def carried(self, u: Array) -> Array:
        """(n, count) rho of each generator, of velocities or accelerations u (n,)."""
        parts = []
        for first, size in self.bodies:
            v, w = u[first : first + 3], u[first + 3 : first + size]
            of_v = np.hstack([STILL, -_cross(v), STILL])
            parts.append(of_v if size == 3 else np.vstack([of_v, np.hstack([STILL, STILL, _cross(w)])]))
        return self._columns(iter(parts))

    def turning(self, c: Array, turns: list[Array]) -> Array:
        """(n, n) the derivative of the components of s = sum c_k s_k along motions of the bodies."""
        found = np.zeros((self._size, self._size))
        for (first, size), R, own in zip(self.bodies, turns, self._split(c), strict=True):
            v, w = slice(first, first + 3), slice(first + 3, first + size)
            found[v, v] = _cross(own[3:6])
            if size == 6:
                found[w, w] = _cross(R.T @ own[3:6])
        return found

    def rotating(self, c: Array) -> Array:
        """(n, n) of the combination: rho as a matrix."""
        found = np.zeros((self._size, self._size))
        for (first, size), own in zip(self.bodies, self._split(c), strict=True):
            v, w = slice(first, first + 3), slice(first + 3, first + size)
            found[v, v] = _cross(own[3:6])
            if size == 6:
                found[w, w] = -_cross(own[6:9])
        return found

    @property
    def _size(self) -> int:
        return sum(size for _, size in self.bodies)

    def _split(self, c: Array) -> Iterator[Array]:
        at = 0
        for _, size in self.bodies:
            width = 9 if size == 6 else 6
            yield c[at : at + width]
            at += width

    def _columns(self, blocks: Iterator[Array]) -> Array:
        found, at = np.zeros((self._size, self.count)), 0
        for (first, size), block in zip(self.bodies, blocks, strict=True):
            width = 9 if size == 6 else 6
            found[first : first + size, at : at + width] = block[:, :width]
            at += width
        return found


def _cross(x: Array) -> Array:
    """(3, 3): x times, as a vector product."""
    return np.asarray(np.cross(x, AXES).T)
