"""A thin disc that rolls on its rim without slip: steady motions, their nutation, and any motion.

Frame: e1 along the tangent at the contact, level, e2 from the contact to the centre, e3 the axis of the disc;
tilt alpha between the disc and the plane, e3.z = cos(alpha), e2.z = sin(alpha). With w = (w1, w2, w3) in that
frame, A = m a^2 / 4 about a diameter and C = 2 A about the axis (Appell, Traite de mecanique rationnelle 2,
sections 458-463):

    alpha' = w1,   heading' = w2 / sin(alpha),   turn' = w3 - w2 cot(alpha)
    (A + m a^2) w1' = A w2^2 cot(alpha) - (C + m a^2) w2 w3 - m g a cos(alpha) + M1
    A w2' = (C w3 - A w2 cot(alpha)) w1 + M2
    (C + m a^2) w3' = m a^2 w1 w2 + M3

M = N d: the torque of rolling and spinning resistance.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from tests.oracles.friction.extrapolation import Array, Real, marched, reals, solved

GRAVITY = Real("9.81")


@dataclass(frozen=True)
class Disc:
    """The state is [x, y of the centre, heading, alpha, turn, w1, w2, w3]; resistances in m."""

    radius: Any
    mass: Any = 1
    rolling_resistance: Any = 0
    spinning_resistance: Any = 0

    @property
    def diameter(self) -> Any:
        return self.mass * self.radius**2 / 4

    def steady(self, alpha: Any, precession: Any) -> Array:
        """A state that rolls on a circle for ever, tilted by alpha, its heading turning at `precession`."""
        A, push = self.diameter, self.mass * GRAVITY * self.radius
        sine, cosine = np.sin(Real(alpha)), np.cos(Real(alpha))
        rolling = cosine * (A * precession**2 * sine - push) / (6 * A * precession * sine)
        return reals([0, 0, 0, alpha, 0, 0, precession * sine, rolling])

    def nutation(self, state: Array) -> Any:
        """The square of the rate at which a steady motion nutates; negative: it falls over."""
        A, push = self.diameter, self.mass * GRAVITY * self.radius
        alpha, w2, w3 = state[3], state[6], state[7]
        cot = np.cos(alpha) / np.sin(alpha)
        back = A * w2**2 / np.sin(alpha) ** 2 - push * np.sin(alpha) + 4 * A * w2**2
        return (back - (2 * A * w2 * cot - 6 * A * w3) * (2 * w3 - w2 * cot)) / (5 * A)

    def frame(self, state: Array) -> Array:
        """e1, e2, e3 as columns."""
        c, s = np.cos(state[2]), np.sin(state[2])
        cosine, sine = np.cos(state[3]), np.sin(state[3])
        return reals([[c, -cosine * s, sine * s], [s, cosine * c, -sine * c], [0, sine, cosine]])

    def rotation(self, state: Array) -> Array:
        """Body -> world for a body whose z axis is the disc's."""
        c, s = np.cos(state[4]), np.sin(state[4])
        return self.frame(state) @ reals([[c, -s, 0], [s, c, 0], [0, 0, 1]])

    def centre(self, state: Array) -> Array:
        return reals([state[0], state[1], self.radius * np.sin(state[3])])

    def contact(self, state: Array) -> Array:
        return self.centre(state) - self.radius * self.frame(state)[:, 1]

    def rates(self, state: Array) -> tuple[Array, Array]:
        """The state's derivative and the force of the plane, world axes."""
        _, _, _, alpha, _, w1, w2, w3 = state
        A, a, m = self.diameter, self.radius, self.mass
        cot, up = np.cos(alpha) / np.sin(alpha), reals([0, np.sin(alpha), np.cos(alpha)])
        free = reals([
            A * w2**2 * cot - 6 * A * w2 * w3 - m * GRAVITY * a * up[2],
            (2 * A * w3 - A * w2 * cot) * w1,
            4 * A * w1 * w2,
        ])  # fmt: skip
        drag = self._drag(reals([w1, w2, w3]), up)
        # N = m (a w1' cos(alpha) + n), linear in w'
        n = a * (w3 * w2 * up[2] - (w1**2 + w3 * w2 * cot) * up[1]) + GRAVITY
        left = np.diag(reals([5 * A, A, 6 * A])) - np.outer(drag * m * a * up[2], reals([1, 0, 0]))
        w_rates = solved(left, free + drag * m * n)
        accel = a * reals([w1 * w2 - w_rates[2], -(w1**2) - w3 * w2 * cot, w_rates[0] + w2 * w3])
        E = self.frame(state)
        v = E @ (a * reals([-w3, 0, w1]))
        turns = reals([v[0], v[1], w2 / up[1], w1, w3 - w2 * cot])
        return np.concatenate([turns, w_rates]), E @ (m * (accel + GRAVITY * up))

    def _drag(self, w: Array, up: Array) -> Array:
        spin = w @ up
        level = w - spin * up
        speed = np.sqrt(level @ level)
        along = level / speed if speed > 0 else level
        return -self.rolling_resistance * along - self.spinning_resistance * np.sign(spin) * up

    def energy(self, state: Array) -> Any:
        w1, w2, w3 = state[5:]
        kinetic = self.diameter * (5 * w1**2 + w2**2 + 6 * w3**2) / 2
        return kinetic + self.mass * GRAVITY * self.radius * np.sin(state[3])

    def run(self, state: Array, times: Any, tolerance: float = 1e-16) -> Array:
        """States (n, 8) at the times."""
        now, states = Real(0), []
        for t in reals(times):
            if t > now:
                state = marched(lambda s: self.rates(s)[0], state, t - now, tolerance=tolerance)[0]
            now = t
            states.append(state)
        return np.array(states)

    def settles_after(self, alpha: Any) -> Any:
        """About when a disc that precesses at a small tilt comes to lie flat by rolling resistance.

        From E = 3/2 m g a alpha, precession^2 = 4 g / (a alpha) and E' = -resistance m g precession alpha.
        """
        a = self.radius
        return 3 * a / (2 * self.rolling_resistance) * np.sqrt(a * alpha / GRAVITY)


def rolls_straight_above(radius: float, inertia: float = 0.5, g: float = 9.81) -> float:
    """The rate of rolling above which an upright disc (hoop: inertia 1) that rolls straight is stable."""
    return float(np.sqrt(g * inertia / 2 / ((inertia + 1) * inertia * radius)))


def spins_upright_above(radius: float, inertia: float = 0.5, g: float = 9.81, friction: bool = True) -> float:
    """The spin above which an upright disc that spins in place is stable, without slip or frictionless."""
    return float(np.sqrt(g / ((inertia / 2 + friction) * radius)))
