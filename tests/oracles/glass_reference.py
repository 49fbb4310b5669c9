"""A body with a smooth convex base on a frictionless plane, from the moment when it leaves flat.

Three angles: theta, the lean of the axis from the vertical; phi, the azimuth towards which it leans; upsilon,
the yaw. The body turns by Rz(phi) Ry(theta) Rz(upsilon - phi). With the support function H of the base, at
the angle chi = phi - upsilon of its outward normal (in the body), the centre of mass stands at

    z = h cos theta + H(chi) sin theta,

and Euler's equations hold in the frame (f1, f2, f3) of the lean: f3 along the axis, f2 horizontal. No row,
no multiplier, no quaternion: what the core does is done nowhere here. The motion starts by its own power
series in the time since theta = 0, order by order, and goes on with SciPy's DOP853.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from mpmath import mp, mpf
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from tests.oracles.power_series import Series

G = 9.81
Value = Any  # a float or a Series: the equations are written once
Support = Callable[[Value], tuple[Value, Value, Value]]  # chi -> H, H', H''; m
DIGITS = 40


def sin_cos(x: Value) -> tuple[Value, Value]:
    if isinstance(x, Series):
        return x.sin_cos()
    return (mp.sin(x), mp.cos(x)) if isinstance(x, mpf) else (np.sin(x), np.cos(x))


def roots(x: Value) -> tuple[Value, Value]:
    """The square root and its inverse."""
    if isinstance(x, Series):
        return x.root(), x.root().inverse()
    root = mp.sqrt(x) if isinstance(x, mpf) else np.sqrt(x)
    return root, 1 / root


@dataclass(frozen=True)
class Glass:
    """A body, its base and its load; polynomials are coefficients in the time since the start."""

    support: Support
    mass: float
    inertia: tuple[float, float, float]  # about the axes of the base and the axis
    height: float  # of the centre of mass over the base, m
    above: float  # of the point of the force over the centre of mass, m
    force: Sequence[Sequence[float]]  # x, y; N, world
    torque: Sequence[Sequence[float]] = ((0.0,), (0.0,), (0.0,))  # N m, world
    velocity: tuple[float, float] = (0.0, 0.0)  # at the start
    spin: float = 0.0

    def loads(self, tau: Value, like: Value) -> list[Value]:
        """Fx, Fy, Tx, Ty, Tz."""
        each = [*self.force, *self.torque]
        if isinstance(like, Series):
            return [Series.of(p, len(like.c)) for p in each]
        return [np.polynomial.polynomial.polyval(tau, p) for p in each]

    def imbalance(
        self, tau: Value, angles: Sequence[Value], rates: Sequence[Value], accelerations: Sequence[Value]
    ) -> tuple[Value, Value, Value]:
        """Euler's equations in the frame of the lean, left minus right, N m; affine in the accelerations."""
        (theta, phi, yaw), (theta_d, phi_d, yaw_d), (theta_dd, phi_dd, yaw_dd) = angles, rates, accelerations
        chi, chi_d, chi_dd = phi - yaw, phi_d - yaw_d, phi_dd - yaw_dd
        (s, c), (sx, cx), (sp, cp) = sin_cos(theta), sin_cos(chi), sin_cos(phi)
        H, H1, H2 = self.support(chi)
        w = (-s * phi_d, theta_d, c * phi_d - chi_d)
        w_d = (-c * theta_d * phi_d - s * phi_dd, theta_dd, c * phi_dd - s * theta_d * phi_d - chi_dd)
        frame = (w[0], w[1], c * phi_d)
        one, two, three = self.inertia
        J11, J22 = one * cx * cx + two * sx * sx, one * sx * sx + two * cx * cx
        J12 = (two - one) * sx * cx
        J12_d, J11_d = (two - one) * (cx * cx - sx * sx) * chi_d, 2 * (two - one) * sx * cx * chi_d
        L = (J11 * w[0] + J12 * w[1], J12 * w[0] + J22 * w[1], three * w[2])
        L_d = (
            J11 * w_d[0] + J12 * w_d[1] + J11_d * w[0] + J12_d * w[1],
            J12 * w_d[0] + J22 * w_d[1] + J12_d * w[0] - J11_d * w[1],
            three * w_d[2],
        )
        h = self.height
        z_dd = (H * c - h * s) * theta_dd - (h * c + H * s) * theta_d * theta_d
        z_dd = z_dd + 2 * c * theta_d * H1 * chi_d + s * (H2 * chi_d * chi_d + H1 * chi_dd)
        N = self.mass * (z_dd + G)
        Fx, Fy, Tx, Ty, Tz = self.loads(tau, theta)
        F1, F2 = c * (Fx * cp + Fy * sp), Fy * cp - Fx * sp
        T_e = Tx * cp + Ty * sp
        M = (
            N * H1 * c - self.above * F2 + c * T_e - s * Tz,
            N * (h * s - H * c) + self.above * F1 + Ty * cp - Tx * sp,
            N * H1 * s + s * T_e + c * Tz,
        )
        return (
            L_d[0] + frame[1] * L[2] - frame[2] * L[1] - M[0],
            L_d[1] + frame[2] * L[0] - frame[0] * L[2] - M[1],
            L_d[2] + frame[0] * L[1] - frame[1] * L[0] - M[2],
        )

    def series(self, order: int) -> list[Series]:
        """theta, phi, yaw up to tau^order, each coefficient from the equations of its order.

        At tau^k the second equation holds theta_(k+2), the first phi_k, the third yaw_(k+2): the azimuth is
        not integrated but slaved to where the load presses.
        """
        with mp.workdps(DIGITS):
            push = [mpf(p[0]) for p in (*self.force, *self.torque)]
            press = (self.above * push[0] + push[3], self.above * push[1] - push[2])
            phi_0 = self._outward(press)
            H, H1, H2 = self.support(phi_0)
            one, two, three = (mpf(x) for x in self.inertia)
            s, c = mp.sin(phi_0), mp.cos(phi_0)
            stiff = self.mass * mpf(G) * (H + H2)
            heavy = one * s * s + two * c * c + self.mass * H * H
            cross, size = (two - one) * s * c, order + 3
            theta, phi = Series.of([], size), Series.of([phi_0], size)
            yaw = Series.of([0, self.spin], size)
            for k in range(order + 1):
                angles = [theta, phi, yaw]
                rates = [x.derivative() for x in angles]
                r = self.imbalance(None, angles, rates, [x.derivative() for x in rates])
                lean = -r[1].c[k] / heavy
                turn = -r[2].c[k] / three
                aside = r[0].c[k] + (cross - self.mass * H * H1) * lean
                theta = _raised(theta, k + 2, lean / ((k + 1) * (k + 2)))
                yaw = _raised(yaw, k + 2, turn / ((k + 1) * (k + 2)))
                if k:
                    phi = _raised(phi, k, aside / stiff)
            return [Series(x.c[: order + 1]) for x in (theta, phi, yaw)]

    def _outward(self, press: tuple[mpf, mpf]) -> mpf:
        """The angle of the base's normal where the load presses at the start: H n + H' n' = press / (m g)."""
        weight = self.mass * mpf(G)
        x, y = press[0] / weight, press[1] / weight
        angle = mp.atan2(y, x)
        for _ in range(60):
            H, H1, H2 = self.support(angle)
            s, c = mp.sin(angle), mp.cos(angle)
            angle += (y * c - x * s - H1) / (H + H2)
        return angle

    def accelerations(self, tau: float, angles: np.ndarray, rates: np.ndarray) -> np.ndarray:
        zero = np.array(self.imbalance(tau, angles, rates, np.zeros(3)))
        columns = [np.array(self.imbalance(tau, angles, rates, unit)) - zero for unit in np.eye(3)]
        return np.linalg.solve(np.array(columns).T, -zero)

    def energy(self, angles: np.ndarray, rates: np.ndarray) -> float:
        """Kinetic and potential, without the horizontal motion of the centre of mass."""
        (theta, phi, yaw), (theta_d, phi_d, yaw_d) = angles, rates
        H, H1, _ = self.support(phi - yaw)
        chi, chi_d, s, c = phi - yaw, phi_d - yaw_d, np.sin(theta), np.cos(theta)
        w1, w2, w3 = -s * phi_d, theta_d, c * phi_d - chi_d
        body = np.array([w1 * np.cos(chi) - w2 * np.sin(chi), w1 * np.sin(chi) + w2 * np.cos(chi), w3])
        z, z_d = self.height * c + H * s, (H * c - self.height * s) * theta_d + s * H1 * chi_d
        return float(0.5 * np.dot(self.inertia, body**2) + self.mass * (0.5 * z_d**2 + G * z))

    def power(self, tau: float, angles: np.ndarray, rates: np.ndarray) -> float:
        """Of the load, without what it does to the horizontal motion of the centre of mass."""
        (theta, phi, _), (theta_d, phi_d, yaw_d) = angles, rates
        Fx, Fy, Tx, Ty, Tz = self.loads(tau, theta)
        e, aside = np.array([np.cos(phi), np.sin(phi)]), np.array([-np.sin(phi), np.cos(phi)])
        point = self.above * (np.cos(theta) * theta_d * e + np.sin(theta) * phi_d * aside)
        spin = (
            yaw_d - phi_d
        )  # about the axis, beside phi_d about the vertical and theta_d about the horizontal
        turn = theta_d * aside + spin * np.sin(theta) * e
        return float(np.dot([Fx, Fy], point) + np.dot([Tx, Ty], turn) + Tz * (phi_d + spin * np.cos(theta)))


def _raised(series: Series, k: int, amount: mpf) -> Series:
    return Series(tuple(a + amount if i == k else a for i, a in enumerate(series.c)))


@dataclass(frozen=True)
class Motion:
    """Samples at `tau`; `imbalance` is the spread of energy less work, J."""

    tau: np.ndarray
    angles: np.ndarray  # (n, 3) rad
    rates: np.ndarray  # (n, 3) rad/s
    p: np.ndarray  # (n, 3) m, of the centre of mass
    rotation: np.ndarray  # (n, 3, 3)
    imbalance: float


def motion(glass: Glass, tau: np.ndarray, start: float, order: int = 24) -> Motion:
    """From `start` s after theta = 0, where the series of an order ends, through the times `tau`."""
    series = glass.series(order)
    with mp.workdps(DIGITS):
        angles = [float(x.at(mpf(start))) for x in series]
        rates = [float(x.derivative().at(mpf(start))) for x in series]

    def slope(t: float, y: np.ndarray) -> np.ndarray:
        a, b = y[:3], y[3:6]
        return np.array([*b, *glass.accelerations(t, a, b), glass.power(t, a, b)])

    initial = np.array([*angles, *rates, 0.0])
    atol = [1e-17, 1e-14, 1e-15, 1e-14, 1e-12, 1e-13, 1e-15]
    steps = {"first_step": start / 1000, "rtol": 3e-14, "atol": atol}
    done = solve_ivp(slope, (start, tau[-1]), initial, "DOP853", tau, **steps)
    a, b, work = done.y[:3].T, done.y[3:6].T, done.y[6]
    ledger = [glass.energy(x, y) - w for x, y, w in zip(a, b, work, strict=True)]
    ledger.append(glass.energy(np.array(angles), np.array(rates)))
    rotation = Rotation.from_euler("ZYZ", np.column_stack([a[:, 1], a[:, 0], a[:, 2] - a[:, 1]])).as_matrix()
    H = np.array([float(glass.support(x)[0]) for x in a[:, 1] - a[:, 2]])
    z = glass.height * np.cos(a[:, 0]) + H * np.sin(a[:, 0])
    p = np.column_stack([*_carried(glass, tau), z])
    return Motion(tau, a, b, p, rotation, float(np.ptp(ledger)))


def _carried(glass: Glass, tau: np.ndarray) -> list[np.ndarray]:
    """x and y of the centre of mass: the plane does not push along itself."""
    polynomial = np.polynomial.polynomial
    twice = [polynomial.polyint(p, 2) for p in glass.force]
    return [
        v * tau + polynomial.polyval(tau, p) / glass.mass for v, p in zip(glass.velocity, twice, strict=True)
    ]


def harmonics(mean: float, second: float = 0.0, third: float = 0.0) -> Support:
    """H = mean + second cos 2 chi + third cos 3 chi: a circle, or a smooth convex curve without symmetry."""

    def support(chi: Value) -> tuple[Value, Value, Value]:
        (s2, c2), (s3, c3) = sin_cos(2 * chi), sin_cos(3 * chi)
        H = mean + second * c2 + third * c3
        return H, -2 * second * s2 - 3 * third * s3, -4 * second * c2 - 9 * third * c3

    return support


def ellipse(a: float, b: float) -> Support:
    """H = sqrt(a^2 cos^2 chi + b^2 sin^2 chi)."""

    def support(chi: Value) -> tuple[Value, Value, Value]:
        s, c = sin_cos(chi)
        square, change = a * a * c * c + b * b * s * s, (b * b - a * a) * s * c
        H, inverse = roots(square)
        slope = change * inverse
        return H, slope, ((b * b - a * a) * (c * c - s * s) - slope * slope) * inverse

    return support
