"""Features tile the boundary of their solid, and every way from one to the next leads back."""

from __future__ import annotations

import numpy as np
import pytest

from modelgen.geometry.shape_features import features_of, is_composite, is_convex
from modelgen.rotations import rotation_of
from modelgen.scene import python_scenes as build
from modelgen.scene.pose_arithmetic import to_inner
from modelgen.scene.scene_types import Condition, Feature, Pose, Shape

from .composites import (
    CONVEX,
    SPECIMENS,
    Specimen,
    by_name,
    curve_frame,
    interval,
    off_and_normal,
    values,
    wing_vector,
)

EPS = 1e-6
BACK = {(2, 1): "wing", (1, 0): "direction"}


@pytest.fixture(params=SPECIMENS)
def specimen(request: pytest.FixtureRequest) -> Specimen:
    return SPECIMENS[request.param]


def boundary_points(specimen: Specimen, count: int, seed: int = 3) -> list[np.ndarray]:
    """Where segments from inside to outside cross the boundary, by bisection of the level."""
    random = np.random.default_rng(seed)
    found: list[np.ndarray] = []
    inside = [x for x in random.uniform(-2, 2, (4000, 3)) if specimen.level(x) < -1e-3]
    while len(found) < count:
        a = inside[random.integers(len(inside))]
        direction = random.normal(size=3)
        b = a + 6 * direction / np.linalg.norm(direction)
        for _ in range(60):
            middle = (a + b) / 2
            a, b = (middle, b) if specimen.level(middle) < 0 else (a, middle)
        found.append(b)
    return found


def edge_points(feature: Feature) -> list[float]:
    low, high = interval(feature)
    return [low + (high - low) * share for share in (0.13, 0.4, 0.5, 0.88)]


def holds(feature: Feature, x: np.ndarray, normal: np.ndarray | None = None, slack: float = 0.0) -> bool:
    return all(value >= -slack for _, value in values(feature, x, normal))


def turned(feature: Feature, x: np.ndarray) -> tuple[float, np.ndarray]:
    """Distance of x to the surface of a face and the exterior normal, frame of the composite."""
    pose = feature.shape.pose
    off, normal = off_and_normal(feature.shape, to_inner(pose, x))
    side = -1.0 if feature.shape.cavity else 1.0
    return side * off, side * rotation_of(pose.quaternion) @ normal


def test_names_are_unique_and_conditions_lead_somewhere(specimen: Specimen) -> None:
    features = by_name(specimen.shape)
    assert len(features) == len(features_of(specimen.shape).features)
    assert {c.next for f in features.values() for c in f.conditions} - {None} <= set(features)


def test_what_leads_on_leads_back(specimen: Specimen) -> None:
    features = by_name(specimen.shape)
    for feature in features.values():
        for condition in feature.conditions:
            if condition.next is None:
                continue
            other = features[condition.next]
            needed = BACK.get((feature.dimension, other.dimension))
            back = [c for c in other.conditions if c.next == feature.name]
            assert any(needed in (None, c.kind) for c in back), (feature.name, other.name)
            assert (condition.kind == "wing") == (feature.dimension == 1 and other.dimension == 2)
            assert (condition.kind == "direction") == (feature.dimension == 0)


@pytest.mark.cases(4)
@pytest.mark.parametrize("name", [name for name in SPECIMENS if name != "disc"])
def test_every_point_of_the_boundary_is_on_one_face(name: str) -> None:
    """Up to points within rounding of an edge, and to the overlap of a fan and its core."""
    specimen = SPECIMENS[name]
    faces = [f for f in features_of(specimen.shape).features if f.dimension == 2]
    seen: set[str] = set()
    for x in boundary_points(specimen, 150 if name != "elliptic" else 25):
        near = [face for face in faces if abs(turned(face, x)[0]) < 1e-9 * specimen.size]
        strict = [face.name for face in near if holds(face, x, slack=-1e-9)]
        loose = [face.name for face in near if holds(face, x, slack=1e-9)]
        cores = {name.removesuffix("_core") for name in strict}
        assert len(cores) <= 1 <= len(loose), x
        seen.update(strict)
    assert len(seen) == len(faces) or name in ("gem", "star")


@pytest.mark.cases(5)
def test_points_of_faces_lie_on_the_boundary_with_the_exterior_outside(specimen: Specimen) -> None:
    random = np.random.default_rng(5)
    for face in features_of(specimen.shape).features:
        if face.dimension != 2 or face.shape.chart is not None:
            continue
        hits = 0
        for _ in range(300):
            reach = specimen.size * random.choice([0.1, 0.3, 1.0])
            x = np.array(face.shape.pose.position) + random.uniform(-1, 1, 3) * reach
            off, normal = turned(face, x)
            x = x - off * normal
            off, normal = turned(face, x)
            if face.shape.kind == "cone" and to_inner(face.shape.pose, x)[2] >= 0:
                continue
            if holds(face, x):
                hits += 1
                assert abs(specimen.level(x)) < 1e-12 * specimen.size
                if min((v for _, v in values(face, x)), default=1.0) > 1e-3:
                    assert specimen.level(x + 1e-4 * normal) > 0
                    thin = specimen.shape.kind == "disc"
                    assert (
                        specimen.level(x - 1e-4 * normal) > 0
                        if thin
                        else specimen.level(x - 1e-4 * normal) < 0
                    )
        assert hits > 3, face.name


def test_wings_are_unit_tangent_to_their_face_and_point_into_it(specimen: Specimen) -> None:
    features = by_name(specimen.shape)
    slack = 1e-11 if specimen.shape.kind == "disc" else 1e-12
    for edge in (f for f in features.values() if f.dimension == 1):
        wings = [c for c in edge.conditions if c.kind == "wing"]
        assert len(wings) == 2
        for t in edge_points(edge):
            x, tangent, z = curve_frame(edge, t)
            assert abs(tangent @ z) < 1e-9
            assert abs(specimen.level(x)) < 1e-12 * specimen.size
            for wing in wings:
                check_wing(
                    features[str(wing.next)], edge.name, x, wing_vector(wing, tangent, z), tangent, slack
                )


def check_wing(
    face: Feature, edge: str, x: np.ndarray, w: np.ndarray, tangent: np.ndarray, slack: float
) -> None:
    off, normal = turned(face, x)
    assert np.linalg.norm(w) == pytest.approx(1.0, abs=1e-14)
    assert abs(w @ tangent) < 1e-9
    assert abs(off) < 1e-12
    assert abs(w @ normal) < 1e-8 if face.shape.chart else abs(w @ normal) < slack + 1e-9
    into, out = (dict(values(face, x + s * EPS * w)) for s in (1.0, -1.0))
    at = dict(values(face, x))
    assert abs(at[edge]) < 1e-9 if face.shape.chart else abs(at[edge]) < 1e-13
    assert all(value > 0 for value in into.values())
    assert 0.4 * EPS < into[edge] < 2 * EPS
    assert -2 * EPS < out[edge] < -0.4 * EPS
    assert min(value for name, value in out.items() if name != edge) > 0 if len(out) > 1 else True


def test_edges_are_convex(specimen: Specimen) -> None:
    """The exterior normals of both faces are in the cone of the edge, as is their mean, strictly."""
    features = by_name(specimen.shape)
    for edge in (f for f in features.values() if f.dimension == 1):
        x, tangent, z = curve_frame(edge, edge_points(edge)[0])
        wings = [c for c in edge.conditions if c.kind == "wing"]
        normals = [turned(features[str(wing.next)], x)[1] for wing in wings]
        if specimen.shape.kind == "disc":
            normals.append(2 * x / np.linalg.norm(x))
        mean = np.sum(normals, axis=0)
        assert all(-mean @ wing_vector(wing, tangent, z) > 1e-3 for wing in wings)
        assert all(-n @ wing_vector(w, tangent, z) > -1e-8 for n in normals for w in wings)
        assert specimen.level(x + 1e-4 * mean) > 0


def test_edges_end_at_their_vertices_and_directions_lie_along_them(specimen: Specimen) -> None:
    features = by_name(specimen.shape)
    for vertex in (f for f in features.values() if f.dimension == 0):
        at = np.array([value for _, value in vertex.shape.parameters])
        assert len(vertex.conditions) >= 3
        for condition in vertex.conditions:
            edge = features[str(condition.next)]
            (bound,) = [c for c in edge.conditions if c.next == vertex.name]
            x, tangent, _ = curve_frame(edge, bound.numbers[2])
            np.testing.assert_allclose(x, at, atol=1e-14 * specimen.size)
            np.testing.assert_allclose(condition.numbers, bound.numbers[1] * tangent, atol=1e-9)


def test_smooth_joins_have_the_same_boundary_point_and_normal_on_both_sides() -> None:
    features = by_name(SPECIMENS["capsule"].shape)
    for angle in np.linspace(-3, 3, 7):
        x = np.array([0.4 * np.cos(angle), 0.4 * np.sin(angle), 0.5])
        side, cap = features["side"], features["cap_top"]
        assert abs(turned(side, x)[0]) + abs(turned(cap, x)[0]) < 1e-15
        np.testing.assert_allclose(turned(side, x)[1], turned(cap, x)[1], atol=1e-15)
        assert dict(values(side, x))["cap_top"] == dict(values(cap, x))["side"] == 0.0
        beyond = x + np.array([0, 0, EPS])
        assert dict(values(side, beyond))["cap_top"] < 0 < dict(values(cap, beyond))["side"]


def test_a_ring_cut_in_half_ends_at_both_ends_and_nowhere_else() -> None:
    """On the whole torus, the end that is left is the nearer one; both may be far beyond."""
    ring = by_name(SPECIMENS["half_torus"].shape)["ring"]
    for azimuth in np.linspace(-np.pi, np.pi, 61):
        for tube in np.linspace(-np.pi, np.pi, 17):
            rho = 1 + 0.3 * np.cos(tube)
            x = np.array([rho * np.cos(azimuth), rho * np.sin(azimuth), 0.3 * np.sin(tube)])
            at = dict(values(ring, x))
            if x[1] > 1e-9:
                assert min(at.values()) > 0
            if x[1] < -1e-9:
                assert (
                    min(at, key=at.__getitem__) == ("rim_a" if x[0] > 1e-9 else "rim_b") or abs(x[0]) < 1e-9
                )
                assert min(at.values()) < 0


def test_concave_edges_carry_nothing() -> None:
    features = by_name(SPECIMENS["L"].shape)
    assert "edge3" not in features
    assert "corner_top3" not in features
    assert None in {c.next for c in features["side2"].conditions}
    assert "edge2" in features
    assert [c.next for c in features["rim_top3"].conditions if c.kind == "parameter"].count(None) == 1


def test_the_rim_of_a_disc_leads_to_the_side_that_the_normal_is_on() -> None:
    rim = by_name(SPECIMENS["disc"].shape)["rim"]
    for up, side in ((1.0, "top"), (-1.0, "bottom")):
        for inward in (1e-3, 0.1, 10.0):
            normal = np.array([-inward, 0.0, up]) / np.hypot(inward, up)
            at = dict(values(rim, np.array([0.7, 0.0, 0.0]), normal))
            assert min(at, key=at.__getitem__) == side
            assert at[side] < 0


def test_a_hollow_box_is_six_faces() -> None:
    hollow = build.box(1, 2, 3, cavity=True)
    features = features_of(hollow).features
    assert len(features) == 6
    assert all(f.shape.cavity and {c.next for c in f.conditions} == {None} for f in features)
    assert not is_convex(hollow)
    joined = features_of(build.capsule(1, 2, cavity=True)).features
    assert [c.next for f in joined for c in f.conditions] == ["cap_top", "cap_bottom", "side", "side"]


@pytest.mark.parametrize(
    ("shape", "dimension", "convex"),
    [
        (build.sphere(1), 2, True), (build.plane(), 2, True), (build.cylinder(1), 2, True),
        (build.torus(2, 1), 2, False), (build.paraboloid(1, 1), 2, False), (build.circle(1), 1, False),
        (build.paraboloid(-1, -2), 2, True), (build.paraboloid(-1, 2), 2, False),
        (build.sphere(1, cavity=True), 2, False),
        (build.helix(1, 1, position=[1, 2, 3]), 1, False), (build.point(1, 2, 3), 0, True),
        (build.superellipsoid(1, 1, 1, 4, 4), 2, True),
    ],
)  # fmt: skip
def test_a_smooth_shape_is_one_feature(shape: Shape, dimension: int, convex: bool) -> None:
    composite = features_of(shape)
    (feature,) = composite.features
    assert (feature.name, feature.dimension, feature.conditions) == ("", dimension, ())
    assert feature.shape.pose == Pose()
    assert not is_composite(shape)
    assert composite.convex == is_convex(shape) == convex


def test_convex_is_told() -> None:
    assert set(SPECIMENS) - set(CONVEX) == {"half_torus", "L", "star", "tube"}


def test_conditions_are_plain_numbers(specimen: Specimen) -> None:
    lengths = {"quadric": 10, "parameter": 3, "wing": 2, "direction": 3}
    for feature in features_of(specimen.shape).features:
        for condition in feature.conditions:
            assert isinstance(condition, Condition)
            assert len(condition.numbers) == lengths[condition.kind]
            assert all(type(number) is float and np.isfinite(number) for number in condition.numbers)
