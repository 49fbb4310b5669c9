"""A block at rest on a level plane under a growing pull that turns, until it slips.

With one coefficient of friction slip begins like tau^2 (tau the time since): s = tau^2 z with z smooth and

    2 z + tau z' = (f(t0 + tau) - k z / |z|) / tau,   |f(t0)| = k = mu g,   z(0) = f(t0) (f'.f)(t0) / (2 k^2).

All other solutions are infinitely fast at first and come to this one. z is found as a polynomial, by
collocation in Chebyshev's points; from its end on the equation of motion is an ordinary one.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

Array = np.ndarray[Any, Any]
DEGREE, REACH = 24, 0.05  # of the polynomial, and of its time, s


@dataclass(frozen=True)
class GentleSlip:
    """The pull per mass is (along t, across t^2), m/s^2."""

    mu: float = 0.3
    along: float = 2.0
    across: float = 1.5
    g: float = 9.81

    def pull(self, t: Any) -> Array:
        return np.array([self.along * t, self.across * t * t])

    @property
    def limit(self) -> float:
        return self.mu * self.g

    @cached_property
    def begins(self) -> float:
        """When slip begins."""
        return float(brentq(lambda t: np.hypot(*self.pull(t)) - self.limit, 0, 1e3, xtol=1e-15, rtol=1e-15))

    @cached_property
    def series(self) -> Array:
        """Chebyshev coefficients (DEGREE + 1, 2) of z over [0, REACH]."""
        nodes = (1 - np.cos(np.pi * (np.arange(DEGREE + 1) + 0.5) / (DEGREE + 1))) / 2
        tau, basis = REACH * nodes, chebyshev.chebvander(2 * nodes - 1, DEGREE)
        slopes = np.stack([
            chebyshev.chebval(2 * nodes - 1, chebyshev.chebder(unit)) for unit in np.eye(DEGREE + 1)
        ], axis=1) * 2 / REACH  # fmt: skip
        f = self.pull(self.begins + tau)
        start, rate = self.pull(self.begins), np.array([self.along, 2 * self.across * self.begins])
        found = np.zeros((DEGREE + 1, 2))
        found[0] = start * (rate @ start) / (2 * self.limit**2)
        linear = np.kron(np.eye(2), (2 * tau[:, None] * basis + tau[:, None] ** 2 * slopes))
        for _ in range(40):
            z = basis @ found
            size = np.linalg.norm(z, axis=1)
            residual = linear @ found.T.ravel() - (f - self.limit * z.T / size).ravel()
            turn = (np.eye(2)[:, :, None] - z.T[:, None] * z.T[None] / size**2) / size
            slope = linear + self.limit * np.block(
                [[turn[i, j][:, None] * basis for j in range(2)] for i in range(2)]
            )
            step = np.linalg.solve(slope, residual)
            found = found - step.reshape(2, -1).T
            if np.abs(step).max() < 1e-13:
                break
        return found

    def _near(self, tau: float) -> tuple[Array, Array]:
        """Way and slip at a time within the polynomial's reach."""
        z = chebyshev.chebval(2 * tau / REACH - 1, self.series)
        nodes, weights = np.polynomial.legendre.leggauss(DEGREE)
        times = tau * (nodes + 1) / 2
        slips = chebyshev.chebval(2 * times / REACH - 1, self.series) * times**2
        return slips @ weights * tau / 2, z * tau**2

    def at(self, t: float) -> tuple[Array, Array]:
        """Way and velocity of the block."""
        tau = t - self.begins
        if tau <= 0:
            return np.zeros(2), np.zeros(2)
        if tau <= REACH:
            return self._near(tau)
        way, slip = self._near(REACH)

        def slope(since: float, y: Array) -> Array:
            return np.concatenate([y[2:], self.pull(since) - self.limit * y[2:] / np.linalg.norm(y[2:])])

        span = (self.begins + REACH, t)
        ran = solve_ivp(slope, span, np.concatenate([way, slip]), "DOP853", rtol=1e-13, atol=1e-15)
        return ran.y[:2, -1], ran.y[2:, -1]
