"""Lift-off in time-stepping, within a step of the true time, where the force ends smoothly."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad

from modelgen import Accuracy, simulate
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Scene
from tests.oracles.pieces import TABLE, G, ball, solid, times
from tests.running import library_of

SCHEMES = ("stewart-trinkle", "anitescu-potra", "moreau")
STEPS = (4e-3, 1e-3, 2.5e-4)


def check(scene: Scene, scheme: str, until: float, exact: float) -> None:
    for step in STEPS:
        record = Accuracy.balanced().time_stepping(step, scheme)  # type: ignore[arg-type]
        path = simulate(library_of(scene), until=until, accuracy=record, samples=2, estimate=False)
        found = times(path, "lift-off")
        assert found[0] == pytest.approx(exact, abs=1.001 * step)
        assert found[1:] == [pytest.approx(exact, abs=4 * step)] * (len(found) > 1)  # it touches once more
        assert len(times(path, "touch-down")) == len(found) - 1


@pytest.mark.cases(3)
@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize(("amplitude", "frequency"), [(0.02, 40.0), (0.3, 8.0), (0.004, 55.0)])
def test_a_ball_leaves_a_plate_where_gravity_no_longer_follows_it(
    amplitude: float, frequency: float, scheme: str
) -> None:
    """z = A sin w t, lift-off at A w^2 sin w t = g."""
    path = {"position": ["0.0", "0.0", f"{amplitude}*sin({frequency}*t)"]}
    bodies = [
        make.driven("plate", make.plane(), path=path),
        ball("b", [0, 0, 0.1], velocity=[0, 0, amplitude * frequency]),
    ]
    exact = np.arcsin(G / (amplitude * frequency**2)) / frequency
    scene = make.scene("plate", bodies, contact=[{"between": ["b", "plate"]}])
    check(scene, scheme, exact + 0.012, exact)


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize(("radius", "start"), [(1.0, 0.1), (0.4, 0.3), (3.0, 0.5)])
def test_a_ball_that_slides_down_a_dome_leaves_it_at_two_thirds_of_its_height(
    radius: float, start: float, scheme: str
) -> None:
    """cos(angle) = 2/3 cos(start); the time is an integral by conservation of energy, angle = start + s^2."""
    own, away = 0.1, radius + 0.1
    end = np.arccos(2 / 3 * np.cos(start))
    exact = quad(
        lambda s: 2 * s / np.sqrt(2 * G / away * (np.cos(start) - np.cos(start + s * s))) if s else 0.0,
        0.0, np.sqrt(end - start), epsabs=1e-9,
    )[0]  # fmt: skip
    bodies = [
        make.fixed("dome", make.sphere(radius)),
        ball("b", [away * np.sin(start), 0, away * np.cos(start)], radius=own),
    ]
    scene = make.scene("dome", bodies, contact=[{"between": ["b", "dome"]}])
    check(scene, scheme, exact + 0.05, exact)


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.cases(4)
@pytest.mark.parametrize("seed", range(18))
def test_an_ellipsoid_pulled_up_leaves_the_plane_when_the_event_driven_run_does(
    seed: int, scheme: str
) -> None:
    """It slides and turns while a force that grows with time lifts it off its centre."""
    random = np.random.default_rng(seed)
    axes = random.uniform(0.06, 0.12, 3)
    egg = solid(
        "egg", axes, position=[0, 0, float(axes[2])], velocity=[*random.uniform(-1, 1, 2), 0.0],
        angular_velocity=[0, 0, float(random.uniform(-2, 2))],
    )  # fmt: skip
    pull = {"body": "egg", "force": ["0.3*sin(5*t)", "0.0", "30*t"], "point": [0.0, 0.0, float(axes[2])]}
    scene = make.scene("pulled", [TABLE, egg], contact=[{"between": ["egg", "table"]}], force=[pull])
    exact = simulate(library_of(scene), until=0.5, accuracy=Accuracy.of(1e-12), samples=2, estimate=False)
    (lifts,) = times(exact, "lift-off")
    check(scene, scheme, 0.5, lifts)
