"""A ball on a plane, pulled to a point by a spring: it rolls and slips in turn along a line, in closed form.

With the friction force f on the ball, x'' = -k x / m + f / m and r w' = -f / (I / r^2), I = 2/5 m r^2,
s = x' - r w. It slips with f = -mu m g sign(s), a cosine about -+ mu m g / k; it rolls with
x'' = -5/7 k x / m, f = 2/7 k x.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

G = 9.81


@dataclass(frozen=True)
class SprungBall:
    """Let go at rest at `start` m; mass 1 kg, radius 0.1 m."""

    start: float
    stiffness: float = 40.0
    mu: float = 0.2

    def run(self, until: float) -> tuple[float, float, list[tuple[str, float]]]:
        """Place and velocity at the end, and what happened when."""
        t, x, v, slip = 0.0, self.start, 0.0, 0.0
        slips = 2 / 7 * self.stiffness * abs(x) > self.mu * G
        sign = -np.sign(x)
        events = []
        while True:
            arc, slide, over = self._slides(x, v, slip, sign) if slips else self._rolls(x, v)
            lasts = self._first(over, until - t)
            if lasts is None:
                x, v = arc(until - t)
                return x, v, events
            x, v = arc(lasts)
            slip, t = 0.0 if slips else slide(lasts), t + lasts
            needs = 2 / 7 * self.stiffness * abs(x) > self.mu * G * (1 + 1e-12)
            turns = slips and needs
            events.append(("slip-reversal" if turns else "slip-stop" if slips else "slip-start", t))
            slips, sign = turns or not slips, -sign if turns else -np.sign(x)

    def _slides(self, x: float, v: float, slip: float, sign: float) -> tuple[Callable, Callable, Callable]:
        rate, off = np.sqrt(self.stiffness), -sign * self.mu * G / self.stiffness
        arc = _arc(x, v, rate, off)
        # r w grows by 5/2 mu g sign
        slide = lambda t: slip + arc(t)[1] - v - 2.5 * self.mu * G * sign * t  # noqa: E731
        return arc, slide, lambda t: sign * slide(t)

    def _rolls(self, x: float, v: float) -> tuple[Callable, Callable, Callable]:
        arc = _arc(x, v, np.sqrt(5 / 7 * self.stiffness), 0.0)
        return arc, lambda t: 0.0, lambda t: self.mu * G - 2 / 7 * self.stiffness * abs(arc(t)[0])

    @staticmethod
    def _first(over: Callable, end: float) -> float | None:
        """The first time at which the function falls through zero."""
        times = np.linspace(0, end, 4001)[1:]
        values = np.array([over(t) for t in times])
        begun = int(np.argmax(values > 0))
        after = np.flatnonzero(values[begun:] < 0)
        if not len(after):
            return None
        k = begun + int(after[0])
        return float(brentq(over, times[k - 1], times[k], xtol=1e-15))


def _arc(x: float, v: float, rate: float, off: float) -> Callable[[float], tuple[float, float]]:
    def at(t: float) -> tuple[float, float]:
        c, s = np.cos(rate * t), np.sin(rate * t)
        return off + (x - off) * c + v / rate * s, v * c - (x - off) * rate * s

    return at
