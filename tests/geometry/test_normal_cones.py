"""The closest point of a convex solid lies on the one feature all of whose conditions hold."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from scipy.optimize import minimize_scalar, nnls

from modelgen.geometry.shape_features import features_of
from modelgen.rotations import rotation_of
from modelgen.scene.pose_arithmetic import to_inner
from modelgen.scene.scene_types import Feature

from .composites import GEM, SPECIMENS, curve_frame, curve_parameter, off_and_normal, values

Closest = Callable[[np.ndarray], np.ndarray]
TIE = 1e-6


def least_distance(planes: np.ndarray) -> Closest:
    """The projection on {x: planes (n,k+1) @ (x, 1) <= 0}: Lawson and Hanson's reduction to nnls."""

    def closest(x: np.ndarray) -> np.ndarray:
        G, h = -planes[:, :-1], planes[:, :-1] @ x + planes[:, -1]
        E = np.vstack([G.T, h])
        f = np.zeros(len(E))
        f[-1] = 1
        residual = E @ nnls(E, f)[0] - f
        return x - residual[:-1] / residual[-1]

    return closest


def hull_planes(points: np.ndarray) -> np.ndarray:
    from scipy.spatial import ConvexHull

    return ConvexHull(points).equations


def turned_about_z(planes: list[list[float]]) -> Closest:
    """Of the body whose half section rho, z is bounded by lines (a, b, c): a rho + b z + c <= 0."""
    section = least_distance(np.array(planes, dtype=float))

    def closest(x: np.ndarray) -> np.ndarray:
        rho = np.hypot(x[0], x[1])
        out, z = section(np.array([rho, x[2]]))
        return np.array([x[0] / rho * out, x[1] / rho * out, z])

    return closest


def on_capsule(x: np.ndarray) -> np.ndarray:
    core = np.array([0, 0, np.clip(x[2], -0.5, 0.5)])
    return core + 0.4 * (x - core) / np.linalg.norm(x - core)


def on_disc(x: np.ndarray) -> np.ndarray:
    shrink = min(1.0, 0.7 / np.hypot(x[0], x[1]))
    return np.array([shrink * x[0], shrink * x[1], 0.0])


def on_dome(x: np.ndarray) -> np.ndarray:
    if x[2] >= 0:
        return 0.5 * x / np.linalg.norm(x)
    shrink = min(1.0, 0.5 / np.hypot(x[0], x[1]))
    return np.array([shrink * x[0], shrink * x[1], 0.0])


def on_elliptic_prism(x: np.ndarray) -> np.ndarray:
    z = np.clip(x[2], -0.6, 0.6)
    if (x[0] / 1.5) ** 2 + x[1] ** 2 <= 1:
        return np.array([x[0], x[1], z])

    def distance(t: float) -> float:
        return float(np.hypot(1.5 * np.cos(t) - x[0], np.sin(t) - x[1]))

    start = min(np.linspace(-np.pi, np.pi, 721), key=distance)
    t = minimize_scalar(
        distance, bounds=(start - 0.01, start + 0.01), method="bounded", options={"xatol": 1e-12}
    ).x
    return np.array([1.5 * np.cos(t), np.sin(t), z])


SLOPE = 0.7 / 1.6
PROJECTIONS: dict[str, Closest] = {
    "box": lambda x: np.clip(x, [-0.5, -1, -1.5], [0.5, 1, 1.5]),
    "cylinder": turned_about_z([[1, 0, -0.7], [0, 1, -1], [0, -1, -1]]),
    "disc": on_disc,
    "capsule": on_capsule,
    "frustum": turned_about_z([[1, SLOPE, -0.85], [0, 1, -0.8], [0, -1, -0.8]]),
    "wide frustum": turned_about_z([[1, -SLOPE, -0.85], [0, 1, -0.8], [0, -1, -0.8]]),
    "tetrahedron": least_distance(hull_planes(np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 2]]))),
    "gem": least_distance(hull_planes(GEM)),
    "dome": on_dome,
    "elliptic": on_elliptic_prism,
}


def margin(feature: Feature, x: np.ndarray, normal: np.ndarray) -> float:
    """The least condition at the closest point and its normal; -inf where the point is not on the feature."""
    pose = feature.shape.pose
    if feature.dimension == 2:
        off, own = off_and_normal(feature.shape, to_inner(pose, x))
        if abs(off) > TIE or np.linalg.norm(rotation_of(pose.quaternion) @ own - normal) > TIE:
            return -np.inf
    elif feature.dimension == 1:
        at, tangent, _ = curve_frame(feature, curve_parameter(feature, x))
        if np.linalg.norm(at - x) > TIE or abs(tangent @ normal) > TIE:
            return -np.inf
    elif np.linalg.norm([value for _, value in feature.shape.parameters] - x) > TIE:
        return -np.inf
    return min((value for _, value in values(feature, x, normal)), default=np.inf)


def exterior_points(name: str, count: int) -> list[np.ndarray]:
    random = np.random.default_rng(11)
    points = (
        random.uniform(-1, 1, (20 * count, 3))
        * SPECIMENS[name].size
        * random.uniform(0.3, 2, (20 * count, 1))
    )
    return [x for x in points if SPECIMENS[name].level(x) > 1e-2][:count]


@pytest.mark.cases(5)
@pytest.mark.parametrize("name", PROJECTIONS)
def test_exactly_one_feature_holds_the_closest_point(name: str) -> None:
    features = features_of(SPECIMENS[name].shape).features
    held: set[str] = set()
    for p in exterior_points(name, 60 if name == "elliptic" else 150):
        x = PROJECTIONS[name](p)
        normal = (p - x) / np.linalg.norm(p - x)
        margins = {feature.name: margin(feature, x, normal) for feature in features}
        strict = {each for each, least in margins.items() if least > TIE}
        assert len({each.removesuffix("_core") for each in strict}) <= 1, (p, strict)
        assert max(margins.values()) > -TIE, (p, margins)
        held |= strict
    dimensions = {feature.dimension for feature in features if feature.name in held}
    assert dimensions == {feature.dimension for feature in features}


@pytest.mark.parametrize("name", PROJECTIONS)
def test_every_feature_is_reached_from_every_other(name: str) -> None:
    features = {feature.name: feature for feature in features_of(SPECIMENS[name].shape).features}
    graph = {each: {c.next for c in feature.conditions} - {None} for each, feature in features.items()}
    for start in graph:
        reached = {start}
        while more := set().union(*(graph[each] for each in reached)) - reached:
            reached |= more
        assert reached == set(graph)
