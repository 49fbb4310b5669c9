"""Shipped scenes against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import ellipj, ellipk

from modelgen import Accuracy, simulate
from modelgen.scene import python_scenes as make
from tests.running import library_of, run, scene_of

G = 9.81


def test_a_ball_leaves_a_fixed_sphere_at_two_thirds_of_its_height() -> None:
    path = run("ball_leaves_sphere", Accuracy.tight())
    lift = next(e for e in path.events if e.kind == "lift-off")
    at = run("ball_leaves_sphere", Accuracy.tight(), until=lift.t, samples=1).p[-1, 1]
    assert np.arctan2(at[0], at[2]) == pytest.approx(0.845528201857, abs=1e-7)
    assert lift.t == pytest.approx(0.95138511073, abs=1e-6)
    # the time again, as the quadrature of the energy integral with theta = theta_0 + s^2
    start, end = 0.1, np.arccos(2 / 3 * np.cos(0.1))
    rate = lambda s: 2 * s / np.sqrt(2 * G / 1.1 * (np.cos(start) - np.cos(start + s * s)))  # noqa: E731
    assert lift.t == pytest.approx(quad(rate, 0, np.sqrt(end - start), epsabs=1e-13)[0], abs=1e-9)


@pytest.mark.parametrize("accuracy", [Accuracy.balanced(), Accuracy.tight()], ids=lambda each: each.name)
def test_a_bouncing_ball_follows_its_geometric_series(accuracy: Accuracy) -> None:
    path = run("bouncing_ball", accuracy)
    fall, e = np.sqrt(2 / G), 0.7
    impacts = [event.t for event in path.events if event.kind == "impact"]
    exact = fall * (1 + 2 * e * (1 - e ** np.arange(len(impacts))) / (1 - e))
    assert np.abs(np.array(impacts) - exact).max() < 1e-9
    assert path.events[-1].kind == "touch-down"
    assert path.events[-1].t == pytest.approx(fall * (1 + e) / (1 - e), abs=1e-9)
    scales = scene_of("bouncing_ball").manifest.instance["scales"]
    slowest = accuracy.rest_speed * scales["length"] / scales["time"]
    assert e ** (len(impacts) + 1) < slowest / (G * fall) < e ** len(impacts)


def test_forty_nine_elastic_balls_keep_their_energy() -> None:
    # SimBenchmark's bouncing scene: the mean square energy error must stay below 1e-8 J^2
    balls = [
        make.dynamic(
            f"b{i}_{j}",
            make.sphere(0.1),
            mass=10.0,
            inertia=[0.04, 0.04, 0.04],
            position=[i * 1.0, j * 1.0, 5.0],
        )
        for i in range(7)
        for j in range(7)
    ]
    contact = [{"between": [ball.name, "floor"], "restitution": 1.0} for ball in balls]
    scene = make.scene(
        "forty_nine", [make.fixed("floor", make.plane()), *balls], contact=contact, run={"until": 20.0}
    )
    path = simulate(library_of(scene), accuracy=Accuracy.balanced(), samples=200)
    assert path.energy[0] == pytest.approx(49 * 10 * G * 5, rel=1e-12)
    assert np.mean((path.energy - path.energy[0]) ** 2) < 1e-8
    assert sum(event.kind == "impact" for event in path.events) == 49 * 10


def test_a_ball_in_a_bowl_is_a_pendulum() -> None:
    path = run("ball_in_bowl", Accuracy.tight(), until=2.0, samples=50)
    k = np.sin(0.5) ** 2
    omega = np.sqrt(G / 0.02)
    sn = ellipj(ellipk(k) - omega * path.t, k)[0]
    angle = 2 * np.arcsin(np.sqrt(k) * sn)
    assert np.abs(path.p[:, 1, 0] - 0.02 * np.sin(angle)).max() < 1e-10
    assert np.abs(path.p[:, 1, 2] + 0.02 * np.cos(angle)).max() < 1e-10
    force = 1.0 * G * (3 * np.cos(angle) - 2 * np.cos(1.0))
    assert np.abs(path.force[:, 0] - force).max() < 1e-7


@pytest.mark.parametrize(("axis", "frequency"), [("y", 18.5717844298), ("x", 13.1332980048)])
@pytest.mark.parametrize("form", ["support", "implicit"])
def test_an_ellipsoid_rocks_with_its_linear_frequency(axis: str, frequency: float, form: str) -> None:
    tilt = 1e-5
    a, b, c = 0.12, 0.09, 0.07
    reach = np.hypot(a if axis == "y" else b, 0) * np.sin(tilt)
    height = np.hypot(reach, c * np.cos(tilt))
    egg = make.dynamic(
        "egg",
        make.ellipsoid(a, b, c),
        mass=1.2,
        inertia=[0.00312, 0.004632, 0.0054],
        position=[0, 0, float(height)],
        axis_angle={"axis": [float(axis == "x"), float(axis == "y"), 0.0], "angle": tilt},
    )
    contact = [{"between": ["egg", "table"], "form": form}]
    scene = make.scene("rocking", [make.fixed("table", make.plane()), egg], contact=contact)
    path = simulate(library_of(scene), accuracy=Accuracy.tight(), until=5.0, samples=4000)
    angle = 2 * path.quaternion[:, 1, 1 if axis == "x" else 2]
    down = np.flatnonzero((angle[:-1] > 0) & (angle[1:] <= 0))
    times = path.t[down] + angle[down] / (angle[down] - angle[down + 1]) * (path.t[1] - path.t[0])
    measured = 2 * np.pi * (len(times) - 1) / (times[-1] - times[0])
    assert measured == pytest.approx(frequency, rel=1e-6)
