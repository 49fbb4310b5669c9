"""Composite shapes to test on, each with a level set that knows nothing of features, and plain numerics."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import casadi as ca
import numpy as np
from scipy.spatial import ConvexHull

from modelgen.geometry.shape_features import features_of
from modelgen.geometry.surface_catalogue import surface_of
from modelgen.rotations import rotation_of
from modelgen.scene import python_scenes as build
from modelgen.scene.custom_solid_checks import point_on, quadric
from modelgen.scene.pose_arithmetic import to_inner, to_outer
from modelgen.scene.scene_types import Condition, Feature, Shape

Level = Callable[[np.ndarray], float]
L_OUTLINE = [[0, 0], [2, 0], [2, 0.7], [0.8, 0.7], [0.8, 2], [0, 2]]
STAR = [
    [2 * r * np.cos(t), r * np.sin(t)] for t, r in zip(np.arange(10) * np.pi / 5, [1, 0.45] * 5, strict=True)
]


@dataclass(frozen=True)
class Specimen:
    shape: Shape
    level: Level  # negative inside, zero on the boundary, positive outside; of slope about 1 at the boundary
    size: float


def hull_level(points: np.ndarray) -> Level:
    planes = ConvexHull(points).equations
    return lambda x: float((planes[:, :3] @ x + planes[:, 3]).max())


def polygon_level(corners: np.ndarray) -> Level:
    """Distance to the sides, negative where a ray to the right crosses an odd number of them."""
    after = np.roll(corners, -1, axis=0)

    def level(x: np.ndarray) -> float:
        along = after - corners
        s = np.clip(((x - corners) * along).sum(axis=1) / (along**2).sum(axis=1), 0, 1)
        distance = np.linalg.norm(corners + s[:, None] * along - x, axis=1).min()
        crossing = (corners[:, 1] > x[1]) != (after[:, 1] > x[1])
        with np.errstate(divide="ignore", invalid="ignore"):
            cut = corners[:, 0] + (x[1] - corners[:, 1]) / along[:, 1] * along[:, 0]
        return float(-distance if (crossing & (cut > x[0])).sum() % 2 else distance)

    return level


def prism_level(flat: Level, length: float) -> Level:
    return lambda x: max(flat(x[:2]), abs(x[2]) - length / 2)


def frustum_level(x: np.ndarray) -> float:
    """Radii 1.2 below and 0.5 above, length 1.6."""
    slope = -0.7 / 1.6
    side = (np.hypot(x[0], x[1]) - (0.85 + slope * x[2])) / np.hypot(1, slope)
    return max(side, abs(x[2]) - 0.8)


def capsule_level(x: np.ndarray) -> float:
    return float(np.linalg.norm(x - [0, 0, np.clip(x[2], -0.5, 0.5)]) - 0.4)


def dome_level(radius: float, height: float) -> Callable[[np.ndarray], float]:
    return lambda x: max(float(np.linalg.norm(x - [0, 0, height - radius])) - radius, -x[2])


def half_torus_level(x: np.ndarray) -> float:
    return float(max(np.hypot(np.hypot(x[0], x[1]) - 1, x[2]) - 0.3, -x[1]))


def ellipse_level(x: np.ndarray) -> float:
    """Semi-axes 1.5, 1: the value over the length of its gradient."""
    f = (x[0] / 1.5) ** 2 + x[1] ** 2 - 1
    return float(f / (2 * np.hypot(x[0] / 1.5**2, x[1]) + 1e-9))


GEM = np.random.default_rng(7).normal(size=(12, 3)) + np.array([0.5, 0, 0])
ROUND = {"x": "1.5*cos(t)", "y": "-s*sin(t)", "domain": [0, "2*pi"], "parameters": {"s": 1}}
DOME = build.solid(
    face=[
        {
            "name": "round", "shape": {"kind": "sphere", "radius": 0.5},
            "conditions": [{"kind": "quadric", "numbers": [0, 0, 0, 1, 0, 0, 0, 0, 0, 0], "next": "rim"}],
        },
        {
            "name": "flat", "shape": {"kind": "plane", "rpy": ["pi", 0, 0]},
            "conditions": [{"kind": "quadric", "numbers": [0.25, *[0] * 3, -1, -1, *[0] * 4], "next": "rim"}],
        },
    ],
    edge=[
        {
            "name": "rim", "shape": {"kind": "circle", "radius": 0.5},
            "conditions": [
                {"kind": "wing", "numbers": [-1, 0], "next": "flat"},
                {"kind": "wing", "numbers": [0, 1], "next": "round"},
            ],
        },
    ],
    convex=True,
)  # fmt: skip

SPECIMENS = {
    "box": Specimen(build.box(1, 2, 3), lambda x: float((abs(x) - [0.5, 1, 1.5]).max()), 3.0),
    "cylinder": Specimen(
        build.cylinder(0.7, 2), lambda x: max(np.hypot(x[0], x[1]) - 0.7, abs(x[2]) - 1), 2.0
    ),
    "tube": Specimen(
        build.tube(0.9, 0.6, 2),
        lambda x: max(np.hypot(x[0], x[1]) - 0.9, 0.6 - np.hypot(x[0], x[1]), abs(x[2]) - 1), 2.0,
    ),
    "disc": Specimen(build.disc(0.7), lambda x: max(np.hypot(x[0], x[1]) - 0.7, abs(x[2])), 1.4),
    "capsule": Specimen(build.capsule(0.4, 1), capsule_level, 1.8),
    "frustum": Specimen(build.frustum(1.2, 0.5, 1.6), frustum_level, 2.4),
    "wide frustum": Specimen(build.frustum(0.5, 1.2, 1.6), lambda x: frustum_level(x * [1, 1, -1]), 2.4),
    "low dome": Specimen(build.dome(1, 0.4), dome_level(1, 0.4), 2.0),
    "high dome": Specimen(build.dome(0.6, 0.9), dome_level(0.6, 0.9), 2.0),
    "half_torus": Specimen(build.half_torus(1, 0.3), half_torus_level, 2.6),
    "tetrahedron": Specimen(
        build.polyhedron([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 2]]),
        hull_level(np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 2]])), 2.0,
    ),
    "gem": Specimen(build.polyhedron(GEM.tolist()), hull_level(GEM), 3.0),
    "L": Specimen(
        build.extrusion(1.5, points=L_OUTLINE), prism_level(polygon_level(np.array(L_OUTLINE)), 1.5), 2.0
    ),
    "star": Specimen(build.extrusion(0.6, points=STAR), prism_level(polygon_level(np.array(STAR)), 0.6), 4.0),
    "dome": Specimen(DOME, lambda x: max(float(np.linalg.norm(x)) - 0.5, -x[2]), 1.0),
    "elliptic": Specimen(build.extrusion(1.2, **ROUND), prism_level(ellipse_level, 1.2), 3.0),
}  # fmt: skip
CONVEX = [name for name, specimen in SPECIMENS.items() if features_of(specimen.shape).convex]


@cache
def jet_of_chart(shape: Shape) -> ca.Function:
    uv = ca.SX.sym("uv", 2)
    jet = surface_of(shape).jet(uv, ca.SX(ca.DM([value for _, value in shape.parameters])))
    return ca.Function("jet", [uv], [ca.densify(jet.x), ca.densify(jet.first)])


def chart_point(shape: Shape, eta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The point and the exterior normal of a chart, shape frame."""
    x, first = (np.array(value) for value in jet_of_chart(shape)(eta))
    normal = np.cross(first[:, 0], first[:, 1])
    return x[:, 0], normal / np.linalg.norm(normal)


def chart_coordinates(shape: Shape, x: np.ndarray) -> np.ndarray:
    """eta of a point x of a chart, by Gauss-Newton from the best node of a grid on."""
    assert shape.chart is not None
    axes = [np.linspace(*ends, 25) for ends in shape.chart.domain]
    grid = np.array(np.meshgrid(*axes, indexing="ij")).reshape(2, -1)
    points = np.array(jet_of_chart(shape)(grid)[0])
    eta = grid[:, np.argmin(np.linalg.norm(points - x[:, None], axis=0))]
    for _ in range(12):
        at, first = (np.array(value) for value in jet_of_chart(shape)(eta))
        eta = eta - np.linalg.lstsq(first, at[:, 0] - x, rcond=None)[0]
    return eta


def off_and_normal(shape: Shape, x: np.ndarray) -> tuple[float, np.ndarray]:
    """Distance of x to a surface of the catalogue, and its exterior normal there, shape frame."""
    p = dict(shape.parameters)
    flat = np.array([x[0], x[1], 0.0])
    radial = flat / max(np.linalg.norm(flat), 1e-300)
    up = np.array([0.0, 0.0, 1.0])
    if shape.kind == "plane":
        return x[2], up
    if shape.kind == "cylinder":
        return np.linalg.norm(flat) - p["radius"], radial
    if shape.kind == "sphere":
        return np.linalg.norm(x) - p["radius"], x / np.linalg.norm(x)
    if shape.kind == "cone":
        normal = np.cos(p["half_angle"]) * radial + np.sin(p["half_angle"]) * up
        return normal @ x, normal
    if shape.kind == "conical_side":
        normal = (radial + p["taper"] * up) / np.hypot(1.0, p["taper"])
        return normal @ (x - p["radius"] * radial), normal
    if shape.kind == "torus":
        arm = x - p["major"] * radial
        return np.linalg.norm(arm) - p["minor"], arm / np.linalg.norm(arm)
    at, normal = chart_point(shape, chart_coordinates(shape, x))
    return float(np.linalg.norm(x - at)), normal


def curve_frame(feature: Feature, t: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Point, unit tangent and the frame's z of an edge, frame of the composite."""
    pose, step = feature.shape.pose, 1e-6
    x, before, after = (np.array(point_on(feature.shape, t + s)) for s in (0.0, -step, step))
    R = rotation_of(pose.quaternion)
    tangent = R @ (after - before)
    return to_outer(pose, x), tangent / np.linalg.norm(tangent), R[:, 2]


def wing_vector(condition: Condition, tangent: np.ndarray, z: np.ndarray) -> np.ndarray:
    a, b = condition.numbers
    return a * np.cross(tangent, z) + b * z


def interval(feature: Feature) -> tuple[float, float]:
    """[t_min, t_max] of an edge."""
    bounds = [condition.numbers[2] for condition in feature.conditions if condition.kind == "parameter"]
    if bounds:
        return min(bounds), max(bounds)
    return feature.shape.curve.domain if feature.shape.curve else (-np.pi, np.pi)


def curve_parameter(feature: Feature, x: np.ndarray) -> float:
    """t of the point of an edge closest to x, frame of the composite."""
    low, high = interval(feature)
    local = to_inner(feature.shape.pose, x)
    if feature.shape.kind == "edge":
        return float(local[0])
    if feature.shape.kind == "circle":
        return float(np.arctan2(local[1], local[0]))
    for _ in range(9):
        nodes = np.linspace(low, high, 41)
        points = np.array([point_on(feature.shape, t) for t in nodes])
        best = nodes[np.argmin(np.linalg.norm(points - local, axis=1))]
        low, high = best - (high - low) / 30, best + (high - low) / 30
    return float(best)


def values(
    feature: Feature, x: np.ndarray, normal: np.ndarray | None = None
) -> list[tuple[str | None, float]]:
    """(next, value) of every condition at a point and, where given, a normal, frame of the composite."""
    shape, found = feature.shape, []
    local = to_inner(shape.pose, x)
    for condition in feature.conditions:
        if condition.kind == "quadric":
            value = float(quadric(condition.numbers, local[None])[0])
        elif condition.kind == "parameter":
            index, sign, bound = condition.numbers
            is_edge = feature.dimension == 1
            eta = [curve_parameter(feature, x)] if is_edge else chart_coordinates(shape, local)
            value = sign * (eta[int(index)] - bound)
        elif normal is None:
            continue
        elif condition.kind == "wing":
            _, tangent, z = curve_frame(feature, curve_parameter(feature, x))
            value = float(-normal @ wing_vector(condition, tangent, z))
        else:
            value = float(-normal @ np.array(condition.numbers))
        found.append((condition.next, value))
    return found


def by_name(shape: Shape) -> dict[str, Feature]:
    return {feature.name: feature for feature in features_of(shape).features}
