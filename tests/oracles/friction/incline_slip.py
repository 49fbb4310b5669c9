"""Slip in two directions that dies in finite time, in closed form: a ball or block thrown across an incline.

The slip s of a ball (share 7/2) or of a block without rotation (share 1) obeys
s' = g_t - share mu g_n s/|s|. With psi its angle from downhill, u = tan(psi / 2) and
kappa = share mu / tan(angle),

    |s| = C u^kappa / sin(psi),
    end - t = C / (2 g_t) (u^(kappa - 1) / (kappa - 1) + u^(kappa + 1) / (kappa + 1)).

For kappa > 1 the slip dies, its direction turning downhill like (end - t)^(1 / (kappa - 1)): no power series.
From then on a ball rolls and a block rests.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import brentq

Array = np.ndarray[Any, Any]


@dataclass(frozen=True)
class InclineSlip:
    """In the incline's plane, x downhill and y across: v of the centre and slip s at t = 0, s_y > 0."""

    angle: float
    mu: float
    v: Array
    s: Array
    share: float = 3.5
    g: float = 9.81

    @property
    def downhill(self) -> float:
        return self.g * np.sin(self.angle)

    @property
    def kappa(self) -> float:
        return float(self.share * self.mu / np.tan(self.angle))

    @property
    def first(self) -> float:
        """u at t = 0."""
        return float(np.tan(np.arctan2(self.s[1], self.s[0]) / 2))

    @property
    def size(self) -> float:
        """C."""
        return float(self.s[1] / self.first**self.kappa)

    def _left(self, u: float) -> float:
        """The time left at u."""
        k = self.kappa
        return self.size / (2 * self.downhill) * (u ** (k - 1) / (k - 1) + u ** (k + 1) / (k + 1))

    @property
    def end(self) -> float:
        """When slip dies."""
        return self._left(self.first)

    def _covered(self, u: float) -> Array:
        """The integral of s over the time left at u."""
        k, scale = 2 * self.kappa, self.size**2 / (4 * self.downhill)
        along = u ** (k - 2) / (k - 2) - u ** (k + 2) / (k + 2)
        across = 2 * (u ** (k - 1) / (k - 1) + u ** (k + 1) / (k + 1))
        return np.asarray(scale * np.array([along, across]))

    def at(self, t: float) -> tuple[Array, Array, Array]:
        """Way of the centre since t = 0, its velocity and the slip."""
        pull = np.array([self.downhill, 0.0])
        if t >= self.end:
            slip, covered = np.zeros(2), self._covered(self.first)
        else:
            u = brentq(lambda u: self._left(u) - (self.end - t), 0.0, self.first, xtol=1e-300, rtol=1e-15)
            slip = self.size * u ** (self.kappa - 1) / 2 * np.array([1 - u * u, 2 * u])
            covered = self._covered(self.first) - self._covered(u)
        free = 1 - 1 / self.share
        v = self.v + free * pull * t + (slip - self.s) / self.share
        way = self.v * t + free * pull * t * t / 2 + (covered - self.s * t) / self.share
        if self.share == 1 and t >= self.end:
            v = np.zeros(2)
        return way, v, slip
