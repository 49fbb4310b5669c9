"""Polynomial caps over the poles of charts, by Taylor series of the user's expressions.

With s the distance from the pole along its coordinate and theta the angle that the other one makes,
c = sum a_n(theta) s^n. The surface is smooth at the pole if and only if each a_n is a homogeneous polynomial
of degree n in cos(theta) and sin(theta): then c is a power series in (xi, eta) = s (cos(theta), sin(theta)).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import comb
from typing import Any

import numpy as np

from modelgen.errors import ExpressionError, SceneError
from modelgen.geometry.polynomial_pieces import cap_exponents
from modelgen.geometry.power_series import Array, taylor
from modelgen.scene.scene_types import Chart, Shape

DEGREE = 12  # total, of a cap
TAIL = 4  # further orders that the size of what is left out is taken from
ANGLES = 64  # around the pole; exceeds twice the harmonics of the highest order
WIDEST = 0.4  # of the domain, radius of a cap
TRUNCATION = 1e-15  # of the second derivatives that are left out, against first derivative / radius
SEEN = 1e-13  # of a cap and its two derivatives against the chart, at its edge, against its size
SHRINK = 0.8  # of a radius at which more is seen
NARROWEST = 1e-3  # of the domain, radius of a cap
SMOOTH = 1e-10  # of harmonics that no smooth surface has, in the same measure
ROUND = 1e-14  # of harmonics that no revolution about z has, against those of the first order
REGULAR = 1e-6  # |c_xi x c_eta| at the pole, against the larger of |c_xi|^2, |c_eta|^2

Complex = np.ndarray[Any, np.dtype[np.complex128]]


@dataclass(frozen=True)
class Pole:
    """An end of a chart's domain that is one point."""

    axis: int  # 0: of u, 1: of v
    end: int  # 0: lower, 1: upper

    @property
    def name(self) -> str:
        return f"{'uv'[self.axis]}_{('min', 'max')[self.end]}"

    @property
    def turn(self) -> int:
        """+1 if the angle is counted as the other coordinate grows, so that the exterior stays outside."""
        return 1 if self.axis == self.end else -1


@dataclass(frozen=True)
class Cap:
    """A polynomial over the unit disc, whose radius is `radius` of the chart's coordinate."""

    kind: str  # "cap", or "round_cap" about the z axis
    parameters: tuple[tuple[str, float], ...]
    radius: float


def poles_of(chart: Chart) -> tuple[Pole, ...]:
    return tuple(Pole(axis, end) for axis in (0, 1) for end in (0, 1) if chart.poles[axis][end])


def cap_at(shape: Shape, pole: Pole) -> Cap:
    """The cap of a pole of a chart; raises SceneError where the surface is not smooth there."""
    assert shape.chart is not None
    harmonics = _harmonics(shape, pole)
    _check_regular(shape, pole, harmonics[1])
    radius = _radius(shape, pole, harmonics)
    _check_smooth(shape, pole, harmonics, radius)
    scaled = harmonics[: DEGREE + 1] * (radius ** np.arange(DEGREE + 1))[:, None, None]
    reach = radius * _length(shape.chart, pole)
    if _is_round(scaled):
        return Cap("round_cap", _profile(scaled, pole.turn), reach)
    coefficients = zip(cap_exponents(DEGREE), _monomials(scaled, pole.turn), strict=True)
    named = (
        (f"{axis}_{i}_{j}", float(row[k])) for (i, j), row in coefficients for k, axis in enumerate("xyz")
    )
    return Cap("cap", tuple(named), reach)


def _harmonics(shape: Shape, pole: Pole) -> Complex:
    """(order, harmonic, 3): c = sum over n and k of h_nk exp(i k theta) s^n."""
    return np.asarray(np.fft.fft(_around(shape, pole, 0.0, DEGREE + TAIL), axis=1) / ANGLES)


def _around(shape: Shape, pole: Pole, distance: float, order: int) -> Array:
    """(order + 1, ANGLES, 3): series in s about a distance from the pole, s against the domain."""
    chart, size = shape.chart, (order + 1, ANGLES)
    assert chart is not None
    start, stop = chart.domain[1 - pole.axis]
    end, length = chart.domain[pole.axis][pole.end], _length(chart, pole) * (1 - 2 * pole.end)
    along, around = np.zeros(size), np.zeros(size)
    along[0], along[1] = end + length * distance, length
    around[0] = start + (stop - start) * np.arange(ANGLES) / ANGLES
    values = dict(zip("uv", (along, around) if pole.axis == 0 else (around, along), strict=True))
    for name, value in shape.parameters:
        values[name] = np.zeros(size)
        values[name][0] = value
    try:
        return np.stack([taylor(component, values) for component in chart.components], axis=-1)
    except ExpressionError as error:
        remedy = "write it smooth there, with the distance from the pole as coordinate"
        raise _refused(shape, pole, f"in {error.where}: {error.found}", remedy) from None


def _length(chart: Chart, pole: Pole) -> float:
    lower, upper = chart.domain[pole.axis]
    return upper - lower


def _radius(shape: Shape, pole: Pole, harmonics: Complex) -> float:
    """The largest radius, against the domain, at which what is left out cannot be seen.

    By the next coefficients, and by the chart itself at that distance, where those do not tell.
    """
    sizes = np.abs(harmonics).sum(axis=(1, 2))
    orders = np.arange(DEGREE + 1, DEGREE + TAIL + 1)
    second = orders * (orders - 1) * sizes[DEGREE + 1 :] / sizes[1]
    allowed = [
        (TRUNCATION / each) ** (1 / (n - 1)) for n, each in zip(orders, second, strict=True) if each > 0
    ]
    radius = float(min([WIDEST, *allowed]))
    while radius >= NARROWEST:
        if _error(_around(shape, pole, radius, 2), harmonics[: DEGREE + 1], radius) < SEEN:
            return radius
        radius *= SHRINK
    found = f"the chart is not its power series {NARROWEST:g} of the domain from the pole"
    raise _refused(shape, pole, found, "use a coordinate in which the surface changes more slowly")


def _error(there: Array, harmonics: Complex, radius: float) -> float:
    """Error of the polynomial and of two of its derivatives, relative to the size of the cap."""
    n = np.arange(len(harmonics))
    exact = np.fft.fft(there, axis=1) / ANGLES
    total = 0.0
    for k, falling in enumerate((np.ones_like(n), n, n * (n - 1) / 2)):
        summed = np.tensordot(falling * radius ** (n - k * 1.0), harmonics, axes=1)
        total += float(np.abs(summed - exact[k]).max()) * radius**k
    return total / (float(np.abs(harmonics[1]).sum()) * radius)


def _check_regular(shape: Shape, pole: Pole, first: Complex) -> None:
    """c_xi and c_eta at the pole, from the first harmonic of the first order, span a plane."""
    xi, eta = 2 * first[1].real, -2 * first[1].imag
    area = np.linalg.norm(np.cross(xi, eta))
    if not area > REGULAR * max(xi @ xi, eta @ eta):
        remedy = "let its coordinate grow with the distance from the pole"
        raise _refused(shape, pole, "the surface has no tangent plane at first order", remedy)


def _check_smooth(shape: Shape, pole: Pole, harmonics: Complex, radius: float) -> None:
    size = np.abs(harmonics[1]).sum() * radius
    wave = np.abs(np.fft.fftfreq(ANGLES, 1 / ANGLES))
    for n in range(DEGREE + 1):
        foreign = (wave > n) | (wave % 2 != n % 2)
        if np.abs(harmonics[n, foreign]).sum() * radius**n > SMOOTH * size:
            along, around = "uv"[pole.axis], "vu"[pole.axis]
            found = f"the surface is not smooth: derivative {n} along {along} depends on {around} as at a tip"
            raise _refused(
                shape, pole, found, "round the tip, or end the domain before it and leave the pole out"
            )


def _refused(shape: Shape, pole: Pole, found: str, remedy: str) -> SceneError:
    return SceneError(f"shape {shape.name!r}, pole {pole.name}", found, "a pole is a smooth point", remedy)


def _is_round(harmonics: Complex) -> bool:
    """Whether x + i y, or x - i y, is a real series times one exp(i theta), and z does not turn."""
    if harmonics[1, 1, 0] == 0:
        return False
    phase, side = _azimuth(harmonics)
    radii = (harmonics[:, 1, 0] * np.conj(phase)).real * phase
    wanted = np.zeros_like(harmonics)
    wanted[:, 1, 0], wanted[:, 1, 1] = radii, -1j * side * radii
    wanted[:, -1] = np.conj(wanted[:, 1])
    wanted[:, 0, 2] = harmonics[:, 0, 2]
    return bool(np.abs(harmonics - wanted).sum() <= ROUND * np.abs(harmonics[1]).sum())


def _azimuth(harmonics: Complex) -> tuple[complex, float]:
    """exp(i azimuth) at theta = 0, and +1 if the azimuth grows with theta, else -1."""
    x, y = harmonics[1, 1, 0], harmonics[1, 1, 1]
    return x / abs(x), float(np.sign(-(y / x).imag))


def _profile(harmonics: Complex, turn: int) -> tuple[tuple[str, float], ...]:
    """The parameters of a `round_cap`: its side, then the coefficients of r/s and of z in powers of s^2."""
    phase, side = _azimuth(harmonics)
    radii = 2 * (harmonics[1::2, 1, 0] * np.conj(phase)).real
    named = [(f"r_{k}", float(value)) for k, value in enumerate(radii)]
    heights = harmonics[0::2, 0, 2].real
    return ("side", side * turn), *named, *((f"z_{k}", float(value)) for k, value in enumerate(heights))


def _monomials(harmonics: Complex, turn: int) -> Array:
    """The coefficients of xi^i eta^j: s^n exp(i k theta) = (xi^2 + eta^2)^((n-k)/2) (xi + i eta)^k."""
    index = {exponents: row for row, exponents in enumerate(cap_exponents(DEGREE))}
    coefficients = np.zeros((len(index), 3))
    for n in range(DEGREE + 1):
        for k in range(n % 2, n + 1, 2):
            weight = harmonics[n, k] * (1 if k == 0 else 2)
            weight = weight if turn > 0 else np.conj(weight)
            for j in range(k + 1):
                part = (weight * 1j**j).real * comb(k, j)
                for m in range((n - k) // 2 + 1):
                    row = index[n - j - 2 * m, j + 2 * m]
                    coefficients[row] += part * comb((n - k) // 2, m)
    return coefficients
