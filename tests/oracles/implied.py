"""A second formulation of a body that slides on fixed surfaces, with coordinates for the contact points.

Each contact is a set of equations G(q, s) = 0 with one more equation than coordinates s: two points coincide,
and the tangents of the body are perpendicular to the normal. Differentiated twice,

    G_q B u' + G_s s'' + (G_q B u + G_s s')' at fixed u, s' = 0,

and the vector y with y G_s = 0 leaves one row J u' + gamma = 0 for each contact. s follows from
s' = -G_s^+ G_q B u. Nothing is taken from the contact kernels.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import least_squares

from tests.oracles.pieces import G

Equations = Callable[[ca.SX, ca.SX, ca.SX], ca.SX]  # of the centre, the rotation and s


def rotation(w: ca.SX, x: ca.SX, y: ca.SX, z: ca.SX) -> ca.SX:
    """Of a quaternion, from Rodrigues' formula."""
    v = ca.vertcat(x, y, z)
    S = ca.skew(v)
    return ca.SX.eye(3) + 2 * (w * S + S @ S) / (w * w + ca.dot(v, v))


@dataclass(frozen=True)
class Slider:
    """A body with mass and principal moments in its own axes; per contact its equations and a start for s."""

    mass: float
    inertia: Sequence[float]
    contacts: Sequence[tuple[Equations, Sequence[float]]]

    def _functions(self) -> list[tuple[ca.Function, ca.Function]]:
        q, u = ca.SX.sym("q", 7), ca.SX.sym("u", 6)
        turning = 0.5 * ca.vertcat(-ca.dot(q[4:], u[3:]), q[3] * u[3:] + ca.cross(q[4:], u[3:]))
        velocity = ca.vertcat(u[:3], turning)
        found = []
        for equations, start in self.contacts:
            s, rate = ca.SX.sym("s", len(start)), ca.SX.sym("rate", len(start))
            value = equations(q[:3], rotation(*ca.vertsplit(q[3:])), s)
            change = ca.jtimes(value, q, velocity) + ca.jtimes(value, s, rate)
            second = ca.jtimes(change, q, velocity) + ca.jtimes(change, s, rate)
            by_u, by_s = ca.jacobian(change, u), ca.jacobian(value, s)
            found.append(
                (
                    ca.Function("value", [q, s], [value]),
                    ca.Function("rows", [q, u, s, rate], [by_u, by_s, second]),
                )
            )
        return found

    def run(self, p: np.ndarray, quaternion: np.ndarray, v: np.ndarray, w: np.ndarray, t: np.ndarray) -> Slid:
        """From a start that touches, w in body axes."""
        functions = self._functions()
        q = np.concatenate([p, quaternion])
        places = [
            _solved(value, q, start) for (value, _), (_, start) in zip(functions, self.contacts, strict=True)
        ]
        apart = max(np.abs(np.array(f(q, s))).max() for (f, _), s in zip(functions, places, strict=True))
        cuts = np.cumsum([13, *map(len, places)])[:-1]

        def pushed(x: np.ndarray) -> tuple[np.ndarray, list[np.ndarray], np.ndarray]:
            state, *found = np.split(x, cuts)
            return self._accelerations(state[:7], state[7:], found, functions)

        def motion(_: float, x: np.ndarray) -> np.ndarray:
            accelerations, rates, _ = pushed(x)
            turn, w = x[3:7], x[10:13]
            turning = 0.5 * np.concatenate([[-turn[1:] @ w], turn[0] * w + np.cross(turn[1:], w)])
            return np.concatenate([x[7:10], turning, accelerations, *rates])

        start = np.concatenate([q, v, w, *places])
        found = solve_ivp(motion, (t[0], t[-1]), start, "DOP853", t, rtol=1e-12, atol=1e-13)
        force = np.abs([pushed(x)[2] for x in found.y.T])
        return Slid(found.y[:3].T, found.y[3:7].T, force, float(apart))

    def _accelerations(
        self, q: np.ndarray, u: np.ndarray, places: Sequence[np.ndarray], functions: Sequence[tuple]
    ) -> tuple[np.ndarray, list[np.ndarray], np.ndarray]:
        rows, gammas, rates = [], [], []
        for (_, function), s in zip(functions, places, strict=True):
            by_u, by_s, _ = (np.array(each) for each in function(q, u, s, np.zeros(len(s))))
            rate = -np.linalg.lstsq(by_s, by_u @ u, rcond=None)[0]
            second = np.array(function(q, u, s, rate)[2]).ravel()
            y = np.linalg.svd(by_s)[0][:, -1]
            rows.append(y @ by_u)
            gammas.append(y @ second)
            rates.append(rate)
        inertia, w = np.array(self.inertia), u[3:]
        free = np.concatenate([[0, 0, -G], -np.cross(w, inertia * w) / inertia])
        J, weight = np.array(rows), 1 / np.concatenate([[self.mass] * 3, inertia])
        force = np.linalg.solve(J * weight @ J.T, -J @ free - np.array(gammas))
        return free + weight * (J.T @ force), rates, force * np.linalg.norm(J[:, :3], axis=1)


@dataclass(frozen=True)
class Slid:
    """What the second formulation finds: centres, quaternions and the size of the forces."""

    p: np.ndarray
    quaternion: np.ndarray
    force: np.ndarray  # (n, m) N, without sign
    apart: float  # m, how far the start is from touching


def _solved(value: ca.Function, q: np.ndarray, start: Sequence[float]) -> np.ndarray:
    """The coordinates s at which the equations of one contact hold."""
    tight = dict.fromkeys(("xtol", "ftol", "gtol"), 1e-15)
    return np.asarray(least_squares(lambda s: np.array(value(q, s)).ravel(), start, **tight).x)
