"""Volume and second moments of closed surfaces of the catalogue in closed form.

All are centred at the origin, and their principal axes are those of the shape. Sections at z of a
superellipsoid (|x/a|^p + |y/b|^p)^(q/p) + |z/c|^q = 1 are
|x/a|^p + |y/b|^p <= s^p with s = (1 - |z/c|^q)^(1/q): Dirichlet's
integral over a section and Euler's beta function over z give its moments.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import gamma, pi

import numpy as np

from modelgen.geometry.composites.moments import Moments
from modelgen.scene.scene_types import Shape


def surface_moments(shape: Shape) -> Moments | None:
    """The moments of the material inside a surface; None for shapes of other kinds, and for cavities."""
    form = None if shape.cavity or shape.chart is not None else _FORMS.get(shape.kind)
    return None if form is None else form(*(value for _, value in shape.parameters))


def _ellipsoid(a: float, b: float, c: float) -> Moments:
    volume = 4 / 3 * pi * a * b * c
    return _centred(volume, volume / 5 * a**2, volume / 5 * b**2, volume / 5 * c**2)


def _torus(major: float, minor: float) -> Moments:
    """Over a section of the tube, int rho = A R and int rho^3 = A (R^3 + 3/4 R r^2)."""
    volume = 2 * pi**2 * major * minor**2
    across = volume * (major**2 / 2 + 3 / 8 * minor**2)
    return _centred(volume, across, across, volume * minor**2 / 4)


def _superellipsoid(a: float, b: float, c: float, p: float, q: float) -> Moments:
    area = 4 * gamma(1 + 1 / p) ** 2 / gamma(1 + 2 / p)  # of the section of a = b = s = 1
    across = 4 / p**2 * gamma(3 / p) * gamma(1 / p) / gamma(1 + 4 / p)  # int x^2 over that section
    volume, wide, high = (2 / q * _beta(k / q, 1 + m / q) for k, m in ((1, 2), (1, 4), (3, 2)))
    scale = a * b * c
    return _centred(
        scale * area * volume,
        scale * across * wide * a**2,
        scale * across * wide * b**2,
        scale * area * high * c**2,
    )


def _beta(x: float, y: float) -> float:
    """int_0^1 t^(x - 1) (1 - t)^(y - 1) dt."""
    return gamma(x) * gamma(y) / gamma(x + y)


def _centred(volume: float, xx: float, yy: float, zz: float) -> Moments:
    return Moments(volume, np.zeros(3), np.diag([xx, yy, zz]))


_FORMS: Mapping[str, Callable[..., Moments]] = {
    "sphere": lambda r: _ellipsoid(r, r, r),
    "ellipsoid": _ellipsoid,
    "torus": _torus,
    "superellipsoid": _superellipsoid,
}
