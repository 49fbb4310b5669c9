"""The surfaces of the laws, written a second time, without the package: charts with pythonic arithmetic.

Each chart works on any numbers that know cos, sin and powers (CasADi symbols, mpmath numbers), so that both
independent routes use it. The polynomial patch is a chart of the user's own, oblique and of no symmetry.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from modelgen.model import ShapeKind
from modelgen.scene.expression import parse_expression
from modelgen.scene.scene_types import Chart

PATCH = (
    "u + k*v + 0.1*u*v",
    "v - 0.2*u + 0.05*u**2",
    "0.35*u**2 - 0.2*u*v + 0.55*v**2 + 0.1*u**3 - h*u*v**2",
)


def ellipsoid(m: Any, u: Any, v: Any, p: Any) -> list[Any]:
    return [p[0] * m.cos(v) * m.cos(u), p[1] * m.cos(v) * m.sin(u), p[2] * m.sin(v)]


def sphere(m: Any, u: Any, v: Any, p: Any) -> list[Any]:
    return ellipsoid(m, u, v, [p[0]] * 3)


def torus(m: Any, u: Any, v: Any, p: Any) -> list[Any]:
    out = p[0] + p[1] * m.cos(v)
    return [out * m.cos(u), out * m.sin(u), p[1] * m.sin(v)]


def superellipsoid(m: Any, u: Any, v: Any, p: Any) -> list[Any]:
    """Radial projection of the sphere; each |x|^p as (x^2)^(p/2)."""
    e = ellipsoid(m, u, v, [1, 1, 1])
    a, b, c = ((e[i] / p[i]) ** 2 for i in range(3))
    gauge = ((a ** (p[3] / 2) + b ** (p[3] / 2)) ** (p[4] / p[3]) + c ** (p[4] / 2)) ** (1 / p[4])
    return [entry / gauge for entry in e]


def cylinder(m: Any, u: Any, v: Any, p: Any) -> list[Any]:
    return [p[0] * m.cos(u), p[0] * m.sin(u), v]


def cone(m: Any, u: Any, v: Any, p: Any) -> list[Any]:
    radius = -v * m.sin(p[0]) / m.cos(p[0])
    return [radius * m.cos(u), radius * m.sin(u), v]


def conical_side(m: Any, u: Any, v: Any, p: Any) -> list[Any]:
    radius = p[0] - v * p[1]
    return [radius * m.cos(u), radius * m.sin(u), v]


def paraboloid(m: Any, u: Any, v: Any, p: Any) -> list[Any]:
    return [u, v, u * u / (2 * p[0]) + v * v / (2 * p[1])]


def plane(m: Any, u: Any, v: Any, p: Any) -> list[Any]:
    return [u, v, 0 * u]


def patch(m: Any, u: Any, v: Any, p: Any) -> list[Any]:
    k, h = p[0], p[1]
    return [
        u + k * v + u * v / 10,
        v - u / 5 + u * u / 20,
        35 * u * u / 100 - u * v / 5 + 55 * v * v / 100 + u**3 / 10 - h * u * v * v,
    ]


def bezier(m: Any, u: Any, v: Any, p: Any) -> list[Any]:
    """De Casteljau's construction on the control points: the first, and the others less the first."""
    net = [[p[k] + (p[3 * n + k] if n else 0) for k in range(3)] for n in range(16)]
    rows = [casteljau(net[4 * i : 4 * i + 4], v) for i in range(4)]
    return casteljau(rows, u)


def bezier_graph(m: Any, u: Any, v: Any, p: Any) -> list[Any]:
    points = [[p[0] + p[1] * i / 3, p[2] + p[3] * j / 3] for i in range(4) for j in range(4)]
    heights = [p[4], *(p[4] + each for each in p[5:])]
    net = [[*point, height] for point, height in zip(points, heights, strict=True)]
    return casteljau([casteljau(net[4 * i : 4 * i + 4], v) for i in range(4)], u)


def casteljau(points: list[list[Any]], t: Any) -> list[Any]:
    while len(points) > 1:
        points = [[(1 - t) * a + t * b for a, b in zip(*pair, strict=True)] for pair in pairwise(points)]
    return points[0]


@dataclass(frozen=True)
class Specimen:
    """A surface for the laws: its kind, its independent chart, lengths, and the box of its coordinates."""

    kind: ShapeKind
    chart: Callable[[Any, Any, Any, Any], list[Any]]
    parameters: tuple[float, ...]
    box: tuple[tuple[float, float], tuple[float, float]]

    @property
    def sign(self) -> int:
        return -1 if self.kind.cavity else 1


def _user_chart() -> Chart:
    names = ("u", "v", "k", "h")
    x, y, z = (parse_expression(text, names) for text in PATCH)
    return Chart((x, y, z), ((-0.8, 0.8), (-0.8, 0.8)))


CELL = tuple(
    x
    for i in range(4)
    for j in range(4)
    for x in (0.4 * i - 0.02 * j * j, 0.45 * j + 0.03 * i, 0.05 * i * i - 0.04 * i * j + 0.06 * j * j)
)
HILL = (-0.6, 1.2, -0.5, 1.1, 0.3, *(x + 0.1 for x in CELL[5::3]))
_INSIDE = ((0.05, 0.95), (0.05, 0.95))
_GLOBE = ((-3.0, 3.0), (-1.2, 1.2))
_FLAT = ((-0.7, 0.7), (-0.7, 0.7))


def _specimen(
    name: str, chart: Callable[..., list[Any]], names: str, parameters: tuple[float, ...], box: Any
) -> Specimen:
    shape = name.removesuffix("_cavity")
    user = _user_chart() if shape == "patch" else None
    kind = ShapeKind(name, "chart" if user else shape, tuple(names.split()), shape != name, chart=user)
    return Specimen(kind, chart, parameters, box)


SPECIMENS = {
    specimen.kind.name: specimen
    for specimen in (
        _specimen("plane", plane, "", (), _FLAT),
        _specimen("sphere", sphere, "radius", (0.6,), _GLOBE),
        _specimen("ellipsoid", ellipsoid, "a b c", (1.0, 0.7, 0.5), _GLOBE),
        _specimen("torus", torus, "major minor", (1.0, 0.4), ((-3.0, 3.0), (-3.0, 3.0))),
        _specimen("cylinder", cylinder, "radius", (0.6,), ((-3.0, 3.0), (-1.0, 1.0))),
        _specimen("cone", cone, "half_angle", (0.5,), ((-3.0, 3.0), (-1.6, -0.7))),
        _specimen("conical_side", conical_side, "radius taper", (0.7, -0.4), ((-3.0, 3.0), (-1.0, 1.0))),
        _specimen("paraboloid", paraboloid, "rho_x rho_y", (1.3, -0.8), _FLAT),
        _specimen("superellipsoid", superellipsoid, "a b c p q", (1.0, 0.8, 0.6, 2.6, 3.3), _GLOBE),
        _specimen("patch", patch, "k h", (0.3, 0.15), _FLAT),
        _specimen("bezier", bezier, " ".join(f"p{k}" for k in range(48)), CELL, _INSIDE),
        _specimen("bezier_graph", bezier_graph, " ".join(f"p{k}" for k in range(20)), HILL, _INSIDE),
        _specimen("plane_cavity", plane, "", (), _FLAT),
        _specimen("sphere_cavity", sphere, "radius", (1.7,), _GLOBE),
        _specimen("ellipsoid_cavity", ellipsoid, "a b c", (2.1, 1.8, 2.4), _GLOBE),
        _specimen("torus_cavity", torus, "major minor", (3.0, 1.5), ((-3.0, 3.0), (-3.0, 3.0))),
        _specimen("patch_cavity", patch, "k h", (0.3, 0.15), _FLAT),
    )
}
