"""Stick and slip along a line, in closed form piece by piece: on a belt, on an incline, under a pull."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import asin, atan2, cos, hypot, inf, pi, sin, sqrt, tan

from scipy.optimize import brentq

STICK, SLIP = "stick", "slip"
Path = Callable[[float], tuple[float, float]]  # place and speed at a time since the piece's start


@dataclass(frozen=True)
class Piece:
    start: float
    mode: str
    at: Path


@dataclass(frozen=True)
class Motion:
    pieces: tuple[Piece, ...]

    def at(self, t: float) -> tuple[float, float]:
        """Place and speed."""
        piece = [piece for piece in self.pieces if piece.start <= t][-1]
        return piece.at(t - piece.start)

    @property
    def events(self) -> tuple[tuple[float, str], ...]:
        """When each mode after the first begins."""
        return tuple((piece.start, piece.mode) for piece in self.pieces[1:])


@dataclass(frozen=True)
class BeltOscillator:
    """A block on a belt that runs at `belt` > 0, held by a spring with its rest at 0."""

    mass: float = 1.0
    stiffness: float = 100.0
    belt: float = 0.2
    mu_static: float = 0.4
    mu_kinetic: float = 0.3
    g: float = 9.81

    @property
    def limit(self) -> float:
        """The longest place where it can stick."""
        return self.mu_static * self.mass * self.g / self.stiffness

    def motion(self, x: float, v: float, until: float) -> Motion:
        """From place and speed; where v is the belt's speed it sticks if it may."""
        pieces: list[Piece] = []
        t, lasts = 0.0, 0.0
        while t < until:
            sticks = v == self.belt and -self.limit <= x < self.limit * (1 - 1e-12)
            at, lasts = self._stick(x) if sticks else self._slip(x, v)
            pieces.append(Piece(t, STICK if sticks else SLIP, at))
            t += lasts
            x, v = at(lasts)[0] if t < until else x, self.belt
        return Motion(tuple(pieces))

    def _stick(self, x: float) -> tuple[Path, float]:
        return lambda s: (x + self.belt * s, self.belt), (self.limit - x) / self.belt

    def _slip(self, x: float, v: float) -> tuple[Path, float]:
        """x = middle + size cos(angle), angle = rate s - phase, until the speed is the belt's again."""
        ahead = v > self.belt or (v == self.belt and x < 0)
        middle = (-1 if ahead else 1) * self.mu_kinetic * self.mass * self.g / self.stiffness
        rate = sqrt(self.stiffness / self.mass)
        size, phase = hypot(x - middle, v / rate), atan2(v / rate, x - middle)

        def at(s: float) -> tuple[float, float]:
            angle = rate * s - phase
            return middle + size * cos(angle), -size * rate * sin(angle)

        if size * rate < self.belt:
            return at, inf
        back = asin(min(1.0, self.belt / (size * rate)))
        end = -back if ahead else pi + back
        return at, (end + phase) % (2 * pi) / rate


def thrown_up_incline(
    angle: float, speed: float, mu_static: float, mu_kinetic: float, g: float = 9.81
) -> Motion:
    """A block thrown up an incline, its place measured up the slope: it stays or slides down."""
    fall, rub = g * sin(angle), mu_kinetic * g * cos(angle)
    stops = speed / (fall + rub)
    top = speed * stops / 2
    up = Piece(0.0, SLIP, lambda s: (speed * s - (fall + rub) * s * s / 2, speed - (fall + rub) * s))
    if tan(angle) <= mu_static:
        return Motion((up, Piece(stops, STICK, lambda _: (top, 0.0))))
    return Motion((up, Piece(stops, SLIP, lambda s: (top - (fall - rub) * s * s / 2, -(fall - rub) * s))))


def pulled_harder(mass: float, pull: float, mu_static: float, mu_kinetic: float, g: float = 9.81) -> Motion:
    """A block at rest on a level plane, pulled with the force pull t, pull in N/s."""
    kick = (mu_static - mu_kinetic) * g

    def at(s: float) -> tuple[float, float]:
        return kick * s * s / 2 + pull / mass * s**3 / 6, kick * s + pull / mass * s * s / 2

    slips = mu_static * mass * g / pull
    return Motion((Piece(0.0, STICK, lambda _: (0.0, 0.0)), Piece(slips, SLIP, at)))


@dataclass(frozen=True)
class PulledToAndFro:
    """A block at rest on a level plane under the force pull sin(rate t); one coefficient of friction.

    It slips, stops, sticks or turns back; the time of each stop is the root of one equation.
    """

    mass: float = 1.0
    pull: float = 5.0
    rate: float = 4.0
    mu: float = 0.3
    g: float = 9.81

    def motion(self, until: float) -> Motion:
        share = self.mu * self.mass * self.g / self.pull
        pieces, x, t = [Piece(0.0, STICK, lambda _: (0.0, 0.0))], 0.0, 0.0
        while share < 1:
            if abs(sin(self.rate * t)) < share:
                pieces.append(Piece(t, STICK, lambda _, x=x: (x, 0.0)))  # type: ignore[misc]
                t = self._next_slip(t, share)
            if t > until:
                break
            at, lasts = self._slip(t, x, share)
            pieces.append(Piece(t, SLIP, at))
            x, t = at(lasts)[0], t + lasts
        return Motion(tuple(pieces[1:] if len(pieces) > 1 else pieces))

    def _next_slip(self, t: float, share: float) -> float:
        """|sin| rises to `share`."""
        half = (self.rate * t - asin(share)) // pi + 1
        return (half * pi + asin(share)) / self.rate

    def _slip(self, t: float, x: float, share: float) -> tuple[Path, float]:
        r, push, rub = self.rate, self.pull / self.mass, self.mu * self.g
        sign = 1 if sin(r * (t + 1e-9 / r)) > 0 else -1
        first = cos(r * t)

        def at(s: float) -> tuple[float, float]:
            v = push / r * (first - cos(r * (t + s))) - sign * rub * s
            gone = push / r * (first * s - (sin(r * (t + s)) - sin(r * t)) / r) - sign * rub * s * s / 2
            return x + gone, v

        # fastest where the pull falls back to the friction
        half = (r * t + asin(share)) // pi + 1
        fastest = (half * pi - asin(share)) / r - t
        return at, float(brentq(lambda s: at(s)[1], fastest, 2 * pi / r, xtol=1e-16, rtol=1e-15))
