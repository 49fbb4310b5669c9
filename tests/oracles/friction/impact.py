"""Impacts at one contact with Coulomb friction.

With u the velocity of the contact point of the moving body against the other, (t1, t2, n) or (t, n), and G
the inverse mass there, u_after = u + G p.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import brentq
from scipy.special import ellipk

Array = np.ndarray[Any, Any]
DIRECTIONS = 720  # looked at for roots


def inverse_mass(mass: float, inertia: Array, R: Array, arm: Array) -> Array:
    """G (3, 3) in world axes of one free body at an arm (world) from its centre of mass."""
    lever = np.cross(np.eye(3), arm)
    return np.asarray(np.eye(3) / mass + lever.T @ R @ np.linalg.inv(inertia) @ R.T @ lever)


def newton(G: Array, u: Array, e: float, mu: float) -> list[tuple[Array, Array]]:
    """Every (impulse, velocity after) with u_n after = -e u_n and Coulomb's law on the velocity after.

    Sticks if the impulse that stops all slip is in the cone; otherwise p_t = -mu p_n s with s along the slip
    after, for each direction s for which that is so. Several solutions, or none: mu is too large for the law.
    """
    aim = np.array([0.0, 0.0, -e * u[2]])
    stuck = np.linalg.solve(G, aim - u)
    found = [(stuck, aim)] if np.hypot(*stuck[:2]) <= mu * stuck[2] else []

    def blow(angle: float) -> tuple[Array, Array]:
        along = np.array([np.cos(angle), np.sin(angle), 0.0])
        push = np.array([0.0, 0.0, 1.0]) - mu * along
        impulse = (1 + e) * -u[2] / (G[2] @ push) * push
        return impulse, u + G @ impulse

    def turn(angle: float) -> float:
        # times G_n.push: no pole where that vanishes
        along = np.array([np.cos(angle), np.sin(angle), 0.0])
        push = np.array([0.0, 0.0, 1.0]) - mu * along
        after = u * (G[2] @ push) - (1 + e) * u[2] * (G @ push)
        return float(along[0] * after[1] - along[1] * after[0])

    grid = np.linspace(-np.pi, np.pi, DIRECTIONS + 1)
    values = [turn(angle) for angle in grid]
    for low, high, at_low, at_high in zip(grid, grid[1:], values, values[1:], strict=False):
        if at_low * at_high < 0:
            angle = brentq(turn, low, high, xtol=1e-15)
            impulse, after = blow(angle)
            if impulse[2] > 0 and after[0] * np.cos(angle) + after[1] * np.sin(angle) > 0:
                found.append((impulse, after))
    return found


@dataclass(frozen=True)
class Planar:
    """A blow in a plane through slip, rest and, it may be, reversed slip (Routh; Wang and Mason 1992).

    G = [[a, b], [b, c]] over (t, n). As the normal impulse grows, u_t and u_n change along straight lines.
    """

    a: float
    b: float
    c: float
    mu: float
    u_t: float
    u_n: float

    def _lines(self) -> list[tuple[float, float]]:
        """Tangential impulse per normal impulse, and the normal impulse at which each line begins."""
        side = np.sign(self.u_t) or np.sign(self.b * self.u_n)
        slip = -self.mu * side
        fast = self.b + self.a * slip  # d u_t / d p_n
        lines = [(0.0, float(slip))] if self.u_t else []
        dies = -self.u_t / fast if self.u_t * fast < 0 else (np.inf if self.u_t else 0.0)
        if np.isfinite(dies):
            stick = -self.b / self.a
            after = stick if abs(stick) <= self.mu else float(np.sign(stick) * self.mu)
            lines.append((float(dies), float(after)))
        return lines

    def at(self, normal: float) -> tuple[float, float, float, float]:
        """Tangential impulse, u_t, u_n and work of the normal impulse, when that has reached a value."""
        tangential, u_t, u_n, work = 0.0, self.u_t, self.u_n, 0.0
        lines = self._lines()
        ends = [begin for begin, _ in lines[1:]] + [np.inf]
        for (begin, share), end in zip(lines, ends, strict=True):
            grows = min(end, normal) - begin
            if grows <= 0:
                break
            change = (self.c + self.b * share) * grows
            work += (u_n + change / 2) * grows
            tangential, u_t, u_n = (
                tangential + share * grows,
                u_t + (self.b + self.a * share) * grows,
                u_n + change,
            )
        return tangential, u_t, u_n, work

    def _first(self, reached: Any) -> float:
        """The least normal impulse at which `reached`, negative at 0, is zero."""
        high = -self.u_n / self.c
        while reached(high) < 0:
            high *= 2
            assert high < 1e9, "the contact never parts: the blow jams"
        return float(brentq(reached, 0.0, high, xtol=1e-18, rtol=1e-15))

    @property
    def compression(self) -> float:
        """The normal impulse at which u_n is 0."""
        return self._first(lambda p: self.at(p)[2])

    def poisson(self, e: float) -> float:
        """The normal impulse at the end: restitution gives e times compression."""
        return (1 + e) * self.compression

    def newton(self, e: float) -> float:
        """u_n ends at -e times its first value."""
        return self._first(lambda p: self.at(p)[2] + e * self.u_n)

    def stronge(self, e: float) -> float:
        """Restitution gives back e^2 of the work that compression took."""
        least = self.compression
        aim = (1 - e * e) * self.at(least)[3]
        high = 2 * least
        while self.at(high)[3] < aim:
            high *= 2
        return (
            float(brentq(lambda p: self.at(p)[3] - aim, least, high, xtol=1e-18, rtol=1e-15)) if e else least
        )


def chained(v: Array, masses: Array, e: float, blows: int = 100_000) -> Array:
    """Speeds of balls in a line after blows one after another, always the leftmost pair that approaches.

    Equal elastic balls pass their speeds on: so does Newton's cradle.
    """
    v = np.array(v, float)
    for _ in range(blows):
        pairs = np.flatnonzero(v[:-1] - v[1:] > 1e-15 * np.abs(v).max())
        if not len(pairs):
            return v
        i = pairs[0]
        reduced = masses[i] * masses[i + 1] / (masses[i] + masses[i + 1])
        impulse = (1 + e) * reduced * (v[i] - v[i + 1])
        v[i] -= impulse / masses[i]
        v[i + 1] += impulse / masses[i + 1]
    raise AssertionError("the blows do not end")


def at_once(v: Array, masses: Array, e: float) -> Array:
    """Speeds after Newton's law at all touching pairs at once (Moreau): rate' >= -e rate, no pulling."""
    n = len(masses)
    J = np.eye(n)[1:] - np.eye(n)[:-1]
    rate, weighed = J @ v, J / masses
    for chosen in range(2 ** (n - 1)):
        held = [k for k in range(n - 1) if chosen >> k & 1]
        impulse = np.zeros(n - 1)
        aim = (1 + e) * rate
        if held:
            impulse[held] = np.linalg.solve((weighed @ J.T)[np.ix_(held, held)], -aim[held])
        if (impulse >= -1e-14).all() and (weighed @ J.T @ impulse + aim >= -1e-14).all():
            return np.asarray(v + weighed.T @ impulse)
    raise AssertionError("no set of blows obeys the law")


def quarter_swing(angle: float, length: float, g: float = 9.81) -> float:
    """Time in which a ball of a cradle, let go at rest at an angle, comes to the others."""
    return float(np.sqrt(length / g) * ellipk(np.sin(angle / 2) ** 2))
