"""An independent route without any differentiation of formulas: 60-digit Newton and differences.

The extremal pair is solved for at three instants of an exact motion, tangents by differences of the charts,
and d, N, the contact points and their coordinates are differenced in time.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import fields, replace
from typing import Any, TypeVar

import mpmath as mp
import numpy as np

from tests.laws.configurations import Array
from tests.laws.shapes import Specimen

DIGITS = 60
TANGENT_STEP = mp.mpf(10) ** -20
NEWTON_STEP = mp.mpf(10) ** -14
TIME_STEP = mp.mpf(10) ** -8
TOLERANCE = 1e-9

Found = dict[str, Any]
Quantities = Callable[[Any], Found]  # alpha -> residual "g" of extremality, "d", "N" and so on
Columns = TypeVar("Columns")


def column(values: Any) -> Any:
    return mp.matrix([mp.mpf(value) for value in values])


def cross(a: Any, b: Any) -> Any:
    return mp.matrix([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def inner(a: Any, b: Any) -> Any:
    return (a.T * b)[0]


def moved(pose: Array, twist: Array, accel: Array, t: Any) -> tuple[Any, Any]:
    """p + v t + a t^2/2 and R exp(hat(w t + w_dot t^2/2)) by the exponential series."""
    p, R = column(pose[:3]), mp.matrix(3, 3)
    for k in range(9):
        R[k % 3, k // 3] = mp.mpf(pose[3 + k])
    v, w = column(twist[:3]), column(twist[3:])
    h = w * t + column(accel[3:]) * t**2 / 2
    hat = mp.matrix([[0, -h[2], h[1]], [h[2], 0, -h[0]], [-h[1], h[0], 0]])
    return p + v * t + column(accel[:3]) * t**2 / 2, R * mp.expm(hat)


def frame(shape: Specimen, alpha: Any) -> tuple[Any, list[Any], Any]:
    """Point, tangents by central differences, and exterior normal, shape frame."""

    def at(u: Any, v: Any) -> Any:
        return mp.matrix(shape.chart(mp, u, v, [mp.mpf(p) for p in shape.parameters]))

    u, v, h = alpha[0], alpha[1], TANGENT_STEP
    tangents = [(at(u + h, v) - at(u - h, v)) / (2 * h), (at(u, v + h) - at(u, v - h)) / (2 * h)]
    normal = cross(*tangents) * shape.sign
    return at(u, v), tangents, normal / mp.norm(normal)


def solved(quantities: Quantities, alpha: Any) -> dict[str, Any]:
    """The extremal pair near alpha, by Newton with differences."""
    for _ in range(5):
        g = quantities(alpha)["g"]
        G = mp.matrix(len(alpha), len(alpha))
        for k in range(len(alpha)):
            shifted = alpha.copy()
            shifted[k] += NEWTON_STEP
            G[:, k] = (quantities(shifted)["g"] - g) / NEWTON_STEP
        alpha = alpha - mp.lu_solve(G, g)
    found = quantities(alpha)
    assert mp.norm(found["g"]) < mp.mpf(10) ** -38
    return found | {"alpha": alpha}


def differenced(
    at_instant: Callable[[Any], Quantities], alpha: Array, more: Callable[[Any, Found], Found] | None = None
) -> dict[str, Array]:
    """Each quantity at t = 0, its rate as `<name>_dot`, and `d_ddot`, of the extremal pair near alpha.

    `more` adds to what is found at an instant.
    """

    def at(t: Any) -> Found:
        found = solved(at_instant(t), start)
        return found | more(t, found) if more else found

    with mp.workdps(DIGITS):
        h, start = TIME_STEP, column(alpha)
        before, now, after = (at(t) for t in (-h, mp.mpf(0), h))
        rates = {f"{name}_dot": doubles((after[name] - before[name]) / (2 * h)) for name in now}
        second = doubles((after["d"] - 2 * now["d"] + before["d"]) / h**2)
        return {**{name: doubles(value) for name, value in now.items()}, **rates, "d_ddot": second}


def at_index(drawn: Columns, index: int) -> Columns:
    """One configuration of many, which are the columns of each field."""
    names = [entry.name for entry in fields(drawn)]  # type: ignore[arg-type]
    return replace(drawn, **{n: getattr(drawn, n)[..., index : index + 1] for n in names})  # type: ignore[type-var]


def assert_same(pairs: Iterable[tuple[Any, Any]]) -> None:
    """Each found value is the wanted one, within TOLERANCE of its size if that is above 1."""
    for found, wanted in pairs:
        assert np.linalg.norm(found - wanted) < TOLERANCE * max(1.0, float(np.linalg.norm(wanted)))


def doubles(value: Any) -> Array:
    entries = list(value) if hasattr(value, "rows") else [value]
    return np.array([float(entry) for entry in entries])
