"""Where Coulomb's law with rigid bodies has no acceleration, or two: Painleve's rod and a brake shoe.

At a sliding contact the normal acceleration is d'' = free + gain N with N >= 0 and slip along `side`:

    gain > 0, free < 0   slides on, N = -free / gain
    gain > 0, free > 0   parts
    gain < 0, free > 0   both slides on and parts: indeterminate
    gain < 0, free < 0   neither: inconsistent; only a blow stops the slip (Genot and Brogliato 1999)
"""

from __future__ import annotations

from dataclasses import dataclass
from math import atan2, cos, inf, sin, sqrt

SLIDES, PARTS, INDETERMINATE, INCONSISTENT = "slides", "parts", "indeterminate", "inconsistent"


def outcome(free: float, gain: float) -> str:
    if gain > 0:
        return SLIDES if free < 0 else PARTS
    return INDETERMINATE if free > 0 else INCONSISTENT


@dataclass(frozen=True)
class Rod:
    """A uniform rod of half length l whose lower tip slides at angle theta to the plane.

    The tip is at the centre minus l (cos theta, sin theta); `rate` is theta'. side = +1: it runs ahead of the
    centre, along -x, as chalk that is pushed; -1: it is drawn behind.
    """

    half_length: float = 0.5
    mass: float = 1.0
    g: float = 9.81

    @property
    def inertia(self) -> float:
        return self.mass * self.half_length**2 / 3

    def gain(self, theta: float, mu: float, side: int = 1) -> float:
        """d'' per N: (1 + 3 cos(theta) (cos(theta) - side mu sin(theta))) / m, 1/kg."""
        return (1 + 3 * cos(theta) * (cos(theta) - side * mu * sin(theta))) / self.mass

    def free(self, theta: float, rate: float) -> float:
        return self.half_length * rate**2 * sin(theta) - self.g

    def outcome(self, theta: float, rate: float, mu: float, side: int = 1) -> str:
        return outcome(self.free(theta, rate), self.gain(theta, mu, side))

    def force(self, theta: float, rate: float, mu: float, side: int = 1) -> float:
        """N of the sliding rod, where it is unique."""
        assert self.outcome(theta, rate, mu, side) == SLIDES
        return -self.free(theta, rate) / self.gain(theta, mu, side)

    @staticmethod
    def least_mu() -> tuple[float, float]:
        """The least mu for which the gain vanishes somewhere, 4/3, and the angle, arctan 2."""
        return 4 / 3, atan2(2, 1)

    @staticmethod
    def paradox(mu: float) -> tuple[float, float]:
        """The range of theta in which the gain is negative for side = +1; empty (inf, -inf) for mu <= 4/3.

        4 cos^2 + sin^2 = 3 mu sin cos: tan^2 - 3 mu tan + 4 = 0.
        """
        if mu <= 4 / 3:
            return inf, -inf
        root = sqrt(9 * mu * mu - 16)
        return atan2(3 * mu - root, 2), atan2(3 * mu + root, 2)

    def lifts_at(self, theta: float) -> float:
        """|theta'| above which a free tip leaves the plane by itself: the border free = 0."""
        return sqrt(self.g / (self.half_length * sin(theta)))


@dataclass(frozen=True)
class BrakeShoe:
    """An arm on a hinge at height h above a moving belt, its shoe a distance b along it from the hinge.

    `load` is the moment that presses the shoe on; the belt runs from the shoe to the hinge (side = +1) or
    from the hinge to the shoe (-1). Moments about the hinge: N (b - side mu h) = load. Friction that presses
    the shoe on, the more it rubs, jams for mu >= b / h: no rubbing state then carries the load.
    """

    height: float = 0.1
    distance: float = 0.05
    load: float = 1.0
    inertia: float = 0.01

    @property
    def jams_above(self) -> float:
        return self.distance / self.height

    def gain(self, mu: float, side: int) -> float:
        return self.distance * (self.distance - side * mu * self.height) / self.inertia

    def outcome(self, mu: float, side: int) -> str:
        return outcome(-self.load * self.distance / self.inertia, self.gain(mu, side))

    def force(self, mu: float, side: int) -> float:
        assert self.outcome(mu, side) == SLIDES
        return self.load / (self.distance - side * mu * self.height)
