"""Measured profiles as splines of one feature: noise, outliers, corners; a wheel on a rail."""

from __future__ import annotations

import re
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from modelgen import closest_points, import_scene, read
from modelgen.errors import ModelgenError
from modelgen.importing.profile_file import read_points
from modelgen.importing.profile_fit import fit_profile, noise_of
from modelgen.scene import python_scenes as make
from tests.benchmarks.measured_outlines import curve_distance
from tests.benchmarks.wheel_and_rail import compared, poses, wheel_on_rail
from tests.importing.profiles import measured, rail_head, wheel_tread
from tests.running import library_of

Array = np.ndarray[Any, Any]
NOISE = 1e-6  # m


def spline(nodes: Array) -> CubicSpline:
    """SciPy's spline through nodes with the chords as parameter."""
    u = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(nodes, axis=0), axis=1))])
    return CubicSpline(u, nodes)


def off(nodes: Array, points: Array) -> Array:
    """Distances of points from the spline through nodes."""
    curve = spline(nodes)
    dense = np.linspace(0, curve.x[-1], 20001)
    return np.abs(curve_distance(curve, lambda t: curve(t, 1), dense)(points))


def oval(count: int) -> Array:
    t = np.linspace(0, 2 * np.pi, count, endpoint=False)
    return np.stack([0.03 * np.cos(t) + 0.004 * np.cos(2 * t), 0.025 * np.sin(t)], axis=1)


@pytest.mark.parametrize("profile", [rail_head, wheel_tread])
@pytest.mark.parametrize("seed", [1, 2])
def test_noise_is_smoothed_away(profile: Any, seed: int) -> None:
    """An average of 4 points, the fewest that are judged, may be off by twice the noise, by chance or not."""
    exact = profile()
    fitted = fit_profile(measured(exact, NOISE, seed))
    assert len(fitted.nodes) < 100
    assert fitted.noise == pytest.approx(NOISE, rel=0.1)
    assert fitted.rms == pytest.approx(NOISE, rel=0.1)
    assert off(fitted.nodes, exact).max() < 2.5 * NOISE
    assert np.sqrt(np.mean(off(fitted.nodes, exact) ** 2)) < NOISE / 2


def test_a_tolerance_is_kept_where_there_is_no_noise() -> None:
    exact = rail_head(1500)
    fitted = fit_profile(exact, tolerance=1e-7)
    assert fitted.largest < 5e-7
    assert off(fitted.nodes, exact).max() == pytest.approx(fitted.largest, rel=1e-3)
    assert len(fit_profile(exact, tolerance=1e-5).nodes) < len(fitted.nodes) / 2


@pytest.mark.parametrize(("profile", "count"), [(rail_head, 300), (wheel_tread, 263)])
@pytest.mark.parametrize("digits", [6, 7, 15])
@pytest.mark.parametrize("seed", range(4))
def test_sparse_points_of_arcs_are_followed(profile: Any, count: int, digits: int, seed: int) -> None:
    """Points that are exact or rounded, at distances that differ by up to 40 %, too few to be averaged where
    arcs meet: they are followed within six times the noise, and what a jump of curvature, of 160 1/m at most,
    makes of a distance of points: 2.8 um at most."""
    exact = profile(20 * count)
    apart = 20 * (1 + 0.2 * np.random.default_rng(seed).uniform(-1, 1, count))
    places = np.cumsum(apart) - apart[0]
    points = exact[np.round(places / places[-1] * (len(exact) - 1)).astype(int)].round(digits)
    fitted = fit_profile(points)
    longest = float(np.linalg.norm(np.diff(points, axis=0), axis=1).max())
    assert len(fitted.outliers) <= 1
    assert len(fitted.nodes) <= count + 2
    assert off(fitted.nodes, exact).max() < 6 * fitted.noise + 160 * longest**2 / 32 < 6 * fitted.noise + 3e-6


@pytest.mark.parametrize("closed", [False, True])
@pytest.mark.parametrize("noise", [0.0, 1e-7])
@pytest.mark.parametrize("seed", range(5))
def test_a_corner_is_refused_where_it_is(closed: bool, noise: float, seed: int) -> None:
    """A curve around the origin that turns by 10 to 120 degrees at one place, at a point or between two; a
    closed one begins there."""
    rng = np.random.default_rng(seed)
    slope = np.tan(np.radians(rng.uniform(5, 60)))  # r'/r on both sides of the corner
    angle = (np.linspace(0, 2 * np.pi, 600, endpoint=False) if closed else np.linspace(-1.5, 1.5, 300)) + (
        seed % 2
    ) * rng.uniform(0, 0.01)
    radius = 0.05 * (1 + 2 * slope * np.abs(np.sin(angle / 2)))
    points = measured(radius[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1), noise, seed)
    with pytest.raises(ModelgenError, match=r"a corner, .*turns by") as refused:
        fit_profile(points, closed=closed)
    x, y = map(float, re.findall(r"-?[\d.e-]+(?=[,)])", refused.value.found)[:2])
    assert np.hypot(x - 0.05, y) < 2e-3


def test_noise_is_found_whatever_the_distances_of_points() -> None:
    rng = np.random.default_rng(5)
    t = np.sort(rng.uniform(0, 2 * np.pi, 2000))
    circle = np.stack([np.cos(t), np.sin(t)], axis=1)
    assert noise_of(measured(circle, 1e-5, 1), closed=True) == pytest.approx(1e-5, rel=0.15)


def test_points_that_lie_off_are_left_out_and_told(tmp_path: Path) -> None:
    points = measured(oval(900), NOISE, 3)
    points[[100, 500]] += 30 * NOISE
    fitted = fit_profile(points, closed=True)
    assert fitted.outliers == (100, 500)
    assert fitted.largest < 6 * NOISE
    path = tmp_path / "cam-1.csv"
    np.savetxt(path, 1e3 * points, delimiter=";", header="x;y", comments="")
    found = import_scene(path, kind="extrusion", unit="mm", length=0.02)
    assert found.left_out == ("2 points that lie off the others, of lines 102, 502",)
    (body,) = found.scene.bodies
    assert (body.name, body.shapes[0].kind) == ("cam_1", "extrusion")
    assert "- least radius of curvature" in found.text


CORNER = np.concatenate([np.linspace([0, 0], [1, 0], 300), np.linspace([1, 0.003], [1, 1], 300)])


@pytest.mark.parametrize(
    ("points", "told"),
    [
        (CORNER, "a corner.* 90 degrees"),
        (np.random.default_rng(1).permutation(oval(200)), "points that go to and fro"),
        (oval(30), "30 points; .*64 at least"),
        (np.full((100, 2), np.nan), "no pairs of finite numbers"),
    ],
)  # fmt: skip
def test_what_is_no_smooth_profile_is_refused(points: Array, told: str) -> None:
    with pytest.raises(ModelgenError, match=told):
        fit_profile(points)


def damaged_arc(seed: int) -> Array:
    """Points of an arc of which one to three have a coordinate anywhere."""
    random = np.random.default_rng(seed)
    count = int(random.integers(80, 300))
    angles = np.linspace(0, random.uniform(1, 3), count)
    points = random.uniform(0.01, 1) * np.column_stack([np.cos(angles), np.sin(angles)])
    for _ in range(int(random.integers(1, 4))):
        points[random.integers(count), random.integers(2)] *= 10.0 ** random.uniform(-20, 9)
    return points


@pytest.mark.parametrize("seed", [*range(12), 144, 520, 944])
def test_points_with_some_anywhere_are_fitted_or_refused(seed: int) -> None:
    points = damaged_arc(seed)
    with suppress(ModelgenError):
        found = fit_profile(points, closed=bool(seed % 2))
        assert np.isfinite(found.nodes).all()


@pytest.mark.parametrize(
    ("text", "columns", "expected"),
    [
        ("1,2\n3,4\n", None, [[1, 2], [3, 4]]),
        ("# measured\nr; z; n\n\n1; 2; 9\n3; 4; 9\n", "z,r", [[2, 1], [4, 3]]),
        ("1\t2\t3\n4\t5\t6\n", "3,1", [[3, 1], [6, 4]]),
        ('"a" "b"\n1e1 2\n', "a,b", [[10, 2]]),
    ],
)
def test_columns_are_read(
    text: str, columns: str | None, expected: list[list[float]], tmp_path: Path
) -> None:
    path = tmp_path / "p.csv"
    path.write_text(text)
    assert read_points(path, columns, "m")[0].tolist() == expected


@pytest.mark.parametrize(
    ("text", "options", "told"),
    [
        ("1,2\n3,x\n", ("1,2", "m"), "line 2: '3 x'; two numbers"),
        ("r,z\n1,2\n", ("r,y", "m"), "no column 'y'; columns: r, z"),
        ("1,2\n", ("1", "m"), "--columns: '1'; two columns"),
        ("1,2\n", ("1,2", "mil"), "--unit: 'mil'; allowed: m, cm, mm"),
    ],
)
def test_files_that_are_no_profile_are_refused(
    text: str, options: tuple[str, str], told: str, tmp_path: Path
) -> None:
    path = tmp_path / "p.csv"
    path.write_text(text)
    with pytest.raises(ModelgenError, match=told):
        read_points(path, *options)


def test_a_wall_has_its_exterior_on_the_right_and_its_distance_is_that_of_its_profile() -> None:
    nodes = fit_profile(rail_head(300), tolerance=1e-4).nodes
    wall = make.fixed("wall", make.profile_wall(nodes.tolist(), 1.0))
    ball = make.dynamic("ball", make.sphere(0.002), density=1.0, position=[0.0, 0.1, 0.0])
    scene = make.scene("wall", [wall, ball], contact=[{"between": ["ball", "wall"], "points": 1}])
    places = np.array([[0.02, 0.005, 0.1], [-0.037, -0.003, 0.0], [0.001, 0.003, -0.4]])
    balls = np.concatenate([np.tile(np.eye(3), (3, 1, 1)), places[:, :, None]], axis=2)
    found = closest_points(library_of(scene), "ball-wall", balls, np.eye(3, 4))
    assert found.d == pytest.approx(off(nodes, places[:, :2]) - 0.002, abs=1e-11)


@pytest.mark.slow
def test_a_wheel_on_a_rail_of_measured_profiles_touches_where_a_dense_search_says() -> None:
    """42 poses, all minima within 3 mm: flange and tread."""
    for own, dense in compared(wheel_on_rail(NOISE), poses()):
        assert own == pytest.approx(dense, abs=1e-9)


def test_profiles_are_scenes_that_are_read_again(tmp_path: Path) -> None:
    path = tmp_path / "rail.csv"
    np.savetxt(path, measured(rail_head(600), NOISE, 4)[::-1], delimiter=",")
    found = import_scene(path, kind="profile_wall", length=10.0)
    scene = tmp_path / "rail.toml"
    scene.write_text(found.text)
    (shape,) = read(scene).bodies[0].shapes
    assert shape.chart is not None
    assert shape.parameters == found.scene.bodies[0].shapes[0].parameters
