"""A cradle of equal balls in a row, each a pendulum of one angle, that strike elastically.

The pendulums hang side by side from pivots on a line and turn about parallel axes; with the angle a from the
vertical, a'' = -g sin(a) / reduced. Two balls whose centres come to a diameter apart strike along the line of
centres, n: with n.t the share of each ball's direction of motion, the impulse per l / inertia is

    j = 2 (a1' n.t1 - a2' n.t2) / ((n.t1)^2 + (n.t2)^2).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

Array = np.ndarray[Any, Any]
FREE = 1e-9  # s after a blow in which the pair is not watched


@dataclass(frozen=True)
class Cradle:
    """`reduced` is the length of the simple pendulum: (I + m l^2) / (m l)."""

    pivots: Array
    length: float
    radius: float
    reduced: float
    g: float = 9.81

    def centres(self, angles: Array) -> Array:
        """(n, 2), x and z."""
        return np.stack([self.pivots + self.length * np.sin(angles), -self.length * np.cos(angles)], axis=-1)

    def run(self, angles: Array, times: Array) -> tuple[Array, list[tuple[float, int]]]:
        """Angles and rates (n, balls) at the times, from rest, and each blow: when, and the first ball."""
        balls = len(self.pivots)
        state, t, states, blows = np.concatenate([angles, np.zeros(balls)]), 0.0, [], []
        for until in times:
            while t < until:
                begun = t
                watched = [self._gap(k, begun, blows) for k in range(balls - 1)]
                ran = solve_ivp(
                    self._slope, (t, until), state, "DOP853", events=watched, rtol=1e-13, atol=1e-15
                )
                t, state = ran.t[-1], ran.y[:, -1]
                if ran.status == 1:
                    pair = next(k for k in range(balls - 1) if len(ran.t_events[k]))
                    state = self._struck(state, pair)
                    blows.append((t, pair))
            states.append(state)
        return np.array(states), blows

    def _slope(self, _: float, state: Array) -> Array:
        angles, rates = np.split(state, 2)
        return np.concatenate([rates, -self.g / self.reduced * np.sin(angles)])

    def _gap(self, pair: int, begun: float, blows: list[tuple[float, int]]) -> Any:
        fresh = bool(blows) and blows[-1] == (begun, pair)

        def gap(t: float, state: Array) -> float:
            if fresh and t < begun + FREE:
                return self.radius
            centres = self.centres(state[: len(self.pivots)])
            return float(np.linalg.norm(centres[pair + 1] - centres[pair]) - 2 * self.radius)

        gap.terminal, gap.direction = True, -1  # type: ignore[attr-defined]
        return gap

    def _struck(self, state: Array, pair: int) -> Array:
        angles, rates = np.split(state.copy(), 2)
        two = slice(pair, pair + 2)
        line = np.subtract(*self.centres(angles)[two][::-1])
        share = np.stack([np.cos(angles[two]), np.sin(angles[two])], axis=-1) @ (line / np.linalg.norm(line))
        blow = 2 * (rates[pair] * share[0] - rates[pair + 1] * share[1]) / (share @ share)
        rates[two] += blow * np.array([-share[0], share[1]])
        return np.concatenate([angles, rates])
