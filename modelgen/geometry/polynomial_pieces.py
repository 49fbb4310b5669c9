"""Polynomial pieces of free forms; their degree follows from the number of their parameters.

bezier: a tensor-product Bernstein cell on [0,1]^2. bezier_graph: a bicubic cell of heights over a rectangle.
bezier_curve: a Bernstein piece on [0,1]. cap: a polynomial on the unit disc, of a total degree. round_cap:
one that is a revolution about z.
Control points are relative to the first one, so that derivatives keep their digits far from the origin.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import comb, hypot, isqrt

import casadi as ca

from modelgen.geometry.charts import Jet
from modelgen.geometry.frames import zeros
from modelgen.geometry.implicit_surfaces import Implicit

GRAPH_DEGREE = 3


def bernstein(degree: int, t: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX]:
    """The Bernstein polynomials of a degree and their first two derivatives at t, (degree + 1,) each."""
    low, middle, high = (_bernstein(degree - k, t) for k in (2, 1, 0))
    first = degree * (ca.vertcat(zeros(1), middle) - ca.vertcat(middle, zeros(1)))
    outer, inner = ca.vertcat(zeros(2), low), ca.vertcat(zeros(1), low, zeros(1))
    second = degree * (degree - 1) * (outer - 2 * inner + ca.vertcat(low, zeros(2)))
    return high, first, second


def _bernstein(degree: int, t: ca.SX) -> ca.SX:
    up, down = _powers(degree, t), _powers(degree, 1 - t)
    return ca.vertcat(*(comb(degree, k) * up[k] * down[degree - k] for k in range(degree + 1)))


def _powers(degree: int, x: ca.SX) -> list[ca.SX]:
    powers = [ca.SX(1)]
    for _ in range(degree):
        powers.append(powers[-1] * x)
    return powers


def bezier(uv: ca.SX, p: ca.SX) -> Jet:
    """Parameters: the first control point, then the others less the first, v fastest, x y z of each."""
    degree = isqrt(p.size1() // 3) - 1
    net = ca.vertcat(zeros(3), p[3:])
    u, v = bernstein(degree, uv[0]), bernstein(degree, uv[1])
    columns = [_contracted([net[k::3] for k in range(3)], degree, u, v, order) for order in _ORDERS]
    return Jet(columns[0] + p[0:3], ca.horzcat(*columns[1:3]), ca.horzcat(*columns[3:6]))


_ORDERS = ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2))


def _contracted(
    nets: Sequence[ca.SX], degree: int, u: Sequence[ca.SX], v: Sequence[ca.SX], order: tuple[int, int]
) -> ca.SX:
    """The derivative of an order in u and v of tensor-product polynomials, one for each net."""
    values = []
    for net in nets:
        square = ca.reshape(net, degree + 1, degree + 1)  # column i: row i of the net, over v
        values.append(ca.mtimes([v[order[1]].T, square, u[order[0]]]))
    return ca.vertcat(*values)


def bezier_radius(p: Sequence[float]) -> float:
    """Largest distance of a control point from the origin: the surface or curve lies in their hull."""
    points = [p[0:3]] + [[p[k] + p[i + k] for k in range(3)] for i in range(3, len(p), 3)]
    return max(hypot(*point) for point in points)


def bezier_graph(uv: ca.SX, p: ca.SX) -> Jet:
    """(x0 + hx u, y0 + hy v, z); parameters x0, hx, y0, hy, then the heights as `bezier` has its points."""
    z = _heights(uv[0], uv[1], p)
    line = ca.vertcat(p[0] + p[1] * uv[0], p[2] + p[3] * uv[1])
    first = ca.vertcat(ca.diag(ca.vertcat(p[1], p[3])), ca.horzcat(z[1], z[2]))
    return Jet(ca.vertcat(line, z[0]), first, ca.vertcat(zeros(2, 3), ca.horzcat(*z[3:6])))


def bezier_graph_equation(x: ca.SX, p: ca.SX) -> Implicit:
    """z - f(x, y) = 0, exterior +z."""
    z = _heights((x[0] - p[0]) / p[1], (x[1] - p[2]) / p[3], p)
    fx, fy = z[1] / p[1], z[2] / p[3]
    fxx, fxy, fyy = z[3] / p[1] ** 2, z[4] / (p[1] * p[3]), z[5] / p[3] ** 2
    bent = ca.vertcat(ca.horzcat(-fxx, -fxy, zeros(1)), ca.horzcat(-fxy, -fyy, zeros(1)), zeros(1, 3))
    return Implicit(x[2] - z[0], ca.vertcat(-fx, -fy, 1), zeros(1), bent)


def _heights(u: ca.SX, v: ca.SX, p: ca.SX) -> list[ca.SX]:
    """z and its derivatives z_u, z_v, z_uu, z_uv, z_vv."""
    net = ca.vertcat(zeros(1), p[5:])
    across, along = bernstein(GRAPH_DEGREE, u), bernstein(GRAPH_DEGREE, v)
    values = [_contracted([net], GRAPH_DEGREE, across, along, order) for order in _ORDERS]
    return [values[0] + p[4], *values[1:]]


def bezier_graph_radius(p: Sequence[float]) -> float:
    corners = [(x, y) for x in (p[0], p[0] + p[1]) for y in (p[2], p[2] + p[3])]
    heights = [p[4], *(p[4] + offset for offset in p[5:])]
    return hypot(max(hypot(*corner) for corner in corners), max(map(abs, heights)))


def bezier_curve(t: ca.SX, p: ca.SX) -> ca.SX:
    """Parameters: the first control point, then the others less the first."""
    degree = p.size1() // 3 - 1
    weights = _bernstein(degree, t)
    offset = ca.mtimes(ca.reshape(ca.vertcat(zeros(3), p[3:]), 3, degree + 1), weights)
    return p[0:3] + offset


def cap_exponents(degree: int) -> tuple[tuple[int, int], ...]:
    """Exponents (i, j) of the monomials u^i v^j of a cap in the order of its parameters, by total degree."""
    return tuple((n - j, j) for n in range(degree + 1) for j in range(n + 1))


def cap_degree(parameters: int) -> int:
    """Total degree of a cap with so many parameters: 3 (degree + 1)(degree + 2)/2."""
    return (isqrt(8 * (parameters // 3) + 1) - 3) // 2


def cap(uv: ca.SX, p: ca.SX) -> Jet:
    """Parameters: the coefficients of the monomials, x y z of each."""
    degree = cap_degree(p.size1())
    u, v = (_derivatives(degree, uv[k]) for k in range(2))
    columns = []
    for du, dv in _ORDERS:
        rows = [zeros(3) for _ in range(degree + 1)]  # for each power of v
        for k, (i, j) in enumerate(cap_exponents(degree)):
            rows[j] += p[3 * k : 3 * k + 3] * u[du][i]
        columns.append(sum((row * v[dv][j] for j, row in enumerate(rows)), zeros(3)))
    return Jet(columns[0], ca.horzcat(*columns[1:3]), ca.horzcat(*columns[3:6]))


def _derivatives(degree: int, x: ca.SX) -> tuple[list[ca.SX], list[ca.SX], list[ca.SX]]:
    """The powers of x and their first two derivatives."""
    powers = _powers(degree, x)
    first = [k * powers[k - 1] if k else zeros(1) for k in range(degree + 1)]
    second = [k * (k - 1) * powers[k - 2] if k > 1 else zeros(1) for k in range(degree + 1)]
    return powers, first, second


def round_cap(uv: ca.SX, p: ca.SX) -> Jet:
    """(u f(w), side v f(w), g(w)) with w = u^2 + v^2.

    Parameters: side, +1 or -1, then the coefficients of f and, one more, those of g.
    """
    count = (p.size1() - 2) // 2
    w = uv[0] ** 2 + uv[1] ** 2
    f, f1, f2 = _in_powers(p[1 : 1 + count], w)
    g, g1, g2 = _in_powers(p[1 + count :], w)
    u, v = uv[0], uv[1]
    x = (u * f, f + 2 * u * u * f1, 2 * u * v * f1, u * _bent(u, 3, f1, f2), v * _bent(u, 1, f1, f2))
    y = (v * f, 2 * u * v * f1, f + 2 * v * v * f1, u * _bent(v, 1, f1, f2), v * _bent(v, 3, f1, f2))
    z = (g, 2 * u * g1, 2 * v * g1, _bent(u, 1, g1, g2), 4 * u * v * g2, _bent(v, 1, g1, g2))
    x_vv, y_uu = u * _bent(v, 1, f1, f2), v * _bent(u, 1, f1, f2)
    rows = (*x, x_vv), tuple(p[0] * each for each in (*y[0:3], y_uu, *y[3:])), z
    columns = [ca.vertcat(*(row[k] for row in rows)) for k in range(6)]
    return Jet(columns[0], ca.horzcat(*columns[1:3]), ca.horzcat(*columns[3:6]))


def _bent(x: ca.SX, factor: int, first: ca.SX, second: ca.SX) -> ca.SX:
    return 2 * factor * first + 4 * x * x * second


def _in_powers(coefficients: ca.SX, w: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX]:
    """A polynomial and its first two derivatives at w, by Horner's rule."""
    value, first, half = zeros(1), zeros(1), zeros(1)
    for k in reversed(range(coefficients.size1())):
        value, first, half = value * w + coefficients[k], first * w + value, half * w + first
    return value, first, 2 * half


def round_cap_radius(p: Sequence[float]) -> float:
    """A bound of the distance from the origin on the unit disc."""
    count = (len(p) - 2) // 2
    return hypot(sum(map(abs, p[1 : 1 + count])), sum(map(abs, p[1 + count :])))


def cap_radius(p: Sequence[float]) -> float:
    """A bound of the distance from the origin on the unit disc."""
    return sum(hypot(*p[k : k + 3]) for k in range(0, len(p), 3))
