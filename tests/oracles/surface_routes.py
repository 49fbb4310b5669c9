"""Second routes to motion on surfaces of shipped scenes, told without the program's charts or cells."""

from __future__ import annotations

from collections.abc import Mapping

import casadi as ca
import numpy as np
from scipy.interpolate import BSpline

from modelgen.scene.free_form_values import Net
from tests.oracles.stationary_route import Array, Gap, rotation


def pebble_on_plane(lengths: Mapping[str, float], centre: Array) -> Gap:
    """The height over z = 0 of the lowest point of the pebble of `bean_with_poles`, its centre of mass at p.

    The surface is an image of the unit sphere, which here has its poles on the x axis.
    """
    a, b, c, bulge, k = (lengths[name] for name in "abcek")

    def gap(p: ca.SX, e: ca.SX, angle: ca.SX) -> ca.SX:
        around, along = angle[0], angle[1]
        x, y, z = ca.sin(along), ca.cos(along) * ca.cos(around), ca.cos(along) * ca.sin(around)
        point = ca.vertcat(a * x, b * y * (1 + k * x), c * z + bulge * z * z)
        return p[2] + (rotation(e) @ (point - ca.DM(centre)))[2]

    return gap


def ellipsoid_on_patch(axes: Array, net: Net) -> Gap:
    """The stationary value over (u, v) of the distance of an ellipsoid from the patch's tangent plane."""
    points = np.array(net.points)
    knots = [np.array(each) for each in net.knots]
    to_powers = [_to_powers(each, net.degree) for each in knots]
    powers = np.einsum("iu,jv,uvk->ijk", *to_powers, points)

    def gap(p: ca.SX, e: ca.SX, at: ca.SX) -> ca.SX:
        rows, columns = (_powers(at[axis], each, net.degree) for axis, each in enumerate(knots))
        x = ca.vertcat(*(rows.T @ ca.DM(powers[:, :, k]) @ columns for k in range(3)))
        along = ca.jacobian(x, at)
        across = ca.cross(along[:, 0], along[:, 1])
        n = across / ca.norm_2(across)
        return ca.dot(n, p - x) - ca.norm_2(ca.DM(axes) * (rotation(e).T @ n))

    return gap


def _powers(t: ca.SX, knots: Array, degree: int) -> ca.SX:
    """1, t, ..., t^degree, and (t - k)_+^degree of every inner knot k."""
    inner = knots[degree + 1 : -degree - 1]
    return ca.vertcat(*(t**k for k in range(degree + 1)), *(ca.fmax(t - k, 0) ** degree for k in inner))


def _to_powers(knots: Array, degree: int) -> Array:
    """(functions, functions): B-splines to truncated powers, from values on more points than functions."""
    nodes = np.linspace(knots[0], knots[-1], 8 * len(knots))
    t = ca.SX.sym("t")
    powers = ca.Function("powers", [t], [_powers(t, knots, degree)]).map(len(nodes))
    splines = BSpline.design_matrix(nodes, knots, degree).toarray()
    return np.linalg.lstsq(np.array(powers(nodes)).T, splines, rcond=None)[0]
