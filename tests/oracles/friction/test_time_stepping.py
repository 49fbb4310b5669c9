"""Time-stepping: its order, its rest, what its relaxation loses, and where runs fall back on it."""

from __future__ import annotations

from math import atan2, cos, sin

import numpy as np
import pytest

from modelgen import simulate
from modelgen.runtime.trajectory import Outcome, Trajectory
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Scene
from tests.oracles.friction.painleve import INCONSISTENT, Rod
from tests.oracles.friction.sphere import SlideToRoll
from tests.oracles.pieces import TABLE, G, ball, imbalance, rotations, solid, times
from tests.running import library_of, scene_of

SCHEMES = ("stewart-trinkle", "anitescu-potra", "moreau")
STEPS = (4e-3, 2e-3, 1e-3, 5e-4)


def stepped(scene: Scene, until: float, step: float, **keys: object) -> Trajectory:
    library = library_of(scene)
    return simulate(library, until=until, method="time-stepping", step=step, **keys)  # type: ignore[arg-type]


def order(errors: list[float]) -> float:
    """The slope of log error over log step."""
    return float(np.polyfit(np.log(STEPS), np.log(errors), 1)[0])


@pytest.mark.parametrize("scheme", SCHEMES)
def test_a_ball_comes_to_roll_with_order_one(scheme: str) -> None:
    errors = []
    for step in STEPS:
        path = simulate(
            scene_of("sphere_slide_to_roll"), method="time-stepping", step=step, scheme=scheme, samples=5
        )
        thrown = SlideToRoll(0.1, 0.2, path.p[0, 1], path.v[0, 1], path.w[0, 1])
        errors.append(float(np.abs(path.p[-1, 1] - thrown.path(path.t)[-1]).max()))
        assert times(path, "slip-stop") == [pytest.approx(thrown.rolls_at, abs=2 * step)]
        assert path.force[0, 0] == pytest.approx(G)
        assert path.friction[0, 0, 0] == pytest.approx(-0.2 * G)
    assert errors[-1] < 3e-4
    assert order(errors) > 0.95


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize(("name", "until"), [("rolling_ellipsoid", 1.0), ("double_pendulum", 0.25)])
def test_what_is_smooth_is_followed_with_order_one(name: str, until: float, scheme: str) -> None:
    exact = simulate(scene_of(name), until=until, samples=5, accuracy="tight")
    errors = []
    for step in STEPS:
        path = simulate(
            scene_of(name), until=until, samples=5, method="time-stepping", step=step, scheme=scheme
        )
        assert path.gap_max < 1e-6
        assert path.joint_error_max < 1e-8
        errors.append(float(np.abs(path.p[-1] - exact.p[-1]).max()))
    assert 0.85 < order(errors) < 2.1


@pytest.mark.parametrize("scheme", SCHEMES)
def test_velocities_of_free_flight_are_of_order_two(scheme: str) -> None:
    """Loads and gyroscopic torques are those of the middle of a step, in time and in velocity."""
    axes, spin = (0.12, 0.09, 0.07), [3.0, 4.0, -2.0]
    egg = solid("egg", axes, position=[0, 0, 5.0], velocity=[0, 1.0, 0], angular_velocity=spin)
    scene = make.scene(
        "flight", [TABLE, egg], contact=[{"between": ["egg", "table"]}], gravity=[0, 0, 0],
        force=[{"body": "egg", "force": ["3*cos(5*t)", "-3*vy", "0.0"]}],
    )  # fmt: skip
    inertia = (
        np.array([axes[1] ** 2 + axes[2] ** 2, axes[0] ** 2 + axes[2] ** 2, axes[0] ** 2 + axes[1] ** 2]) / 5
    )
    pushed, damped, turned = [], [], []
    for step in STEPS:
        path = stepped(scene, 1.0, step, scheme=scheme, samples=1)
        own = rotations(path, 1)[-1].T @ path.w[-1, 1]
        turned.append(abs(float(inertia @ own**2 - inertia @ np.square(spin))))
        pushed.append(abs(float(path.v[-1, 1, 0] - 0.6 * np.sin(5.0))))
        damped.append(abs(float(path.v[-1, 1, 1] - np.exp(-3.0))))
    assert [order(errors) > 1.9 for errors in (pushed, damped, turned)] == [True] * 3


@pytest.mark.parametrize("scheme", SCHEMES)
def test_bounces_that_accumulate_end_in_rest_at_the_right_time(scheme: str) -> None:
    e, height = 0.7, 0.3
    rests = (2 * height / G) ** 0.5 * (1 + e) / (1 - e)
    contact = [{"between": ["b", "table"], "friction": 0.3, "restitution": e}]
    scene = make.scene("bounces", [TABLE, ball("b", [0, 0, 0.1 + height])], contact=contact)
    for step in (2e-3, 5e-4):
        path = stepped(scene, 3.0, step, scheme=scheme)
        assert times(path, "touch-down")[0] == pytest.approx(rests, abs=50 * step)
        assert 0.1 - 1e-10 < path.p[-1, 1, 2] < 0.1 + G * step**2 / 16
        assert (path.energy[1:] <= path.energy[0] * (1 + 10 * step)).all()


def test_a_row_of_balls_apart_passes_the_blow_on_and_one_in_touch_shares_it() -> None:
    for apart, ends in ((1e-3, [0, 0, 0, 0, 1]), (0.0, [-0.6, 0.4, 0.4, 0.4, 0.4])):
        balls = [ball(f"b{k}", [k * (0.2 + apart), 0, 0], velocity=[float(k == 0), 0, 0]) for k in range(5)]
        contact = [{"between": [f"b{k}", f"b{k + 1}"], "restitution": 1.0} for k in range(4)]
        path = stepped(make.scene("cradle", balls, contact=contact, gravity=[0, 0, 0]), 0.05, 1e-4)
        assert path.v[-1, :, 0] == pytest.approx(ends, abs=1e-9)
        assert path.energy[-1] == pytest.approx(path.energy[0])


def test_the_relaxation_slides_at_a_gap_of_the_step_and_the_law_at_none() -> None:
    """A body without turning slides down from rest: the gap is h mu v, its normal velocity h mu a."""
    slope, mu = 0.5, 0.3
    pull = G * (sin(slope) - mu * cos(slope))
    body = make.dynamic("b", make.sphere(0.1), mass=1.0, inertia=[1e12] * 3, position=[0, 0, 0.1])
    scene = make.scene(
        "slides", [TABLE, body], gravity=[G * sin(slope), 0, -G * cos(slope)],
        contact=[{"between": ["b", "table"], "friction": mu}],
    )  # fmt: skip
    for step in (2e-3, 1e-3):
        exact, relaxed = (stepped(scene, 1.0, step, solver=name) for name in ("coulomb", "relaxation"))
        assert exact.v[-1, 1] == pytest.approx([pull, 0, 0], abs=1e-9)
        assert np.abs(exact.gap).max() < 1e-12
        v = relaxed.v[-1, 1]
        assert relaxed.gap[-1, 0] == pytest.approx(step * mu * v[0], rel=1e-6)
        assert v[2] == pytest.approx(step * mu * pull, rel=1e-3)
        assert v[0] == pytest.approx(pull, abs=0.1 * step * G)


def test_the_ledger_holds_where_positions_follow_the_mean_velocity() -> None:
    path = simulate(
        scene_of("sphere_slide_to_roll"), method="time-stepping", step=1e-3, scheme="moreau", samples=20
    )
    assert imbalance(path) < 1e-12
    assert path.work[-1] == pytest.approx(-(0.5 * 9 - 0.5 * 1.4 * (5 / 7 * 3) ** 2), rel=1e-6)


def fallen_rod(theta: float, mu: float) -> Scene:
    rod, (c, s) = Rod(), (cos(theta), sin(theta))
    at = [-rod.half_length * c, 0.0, -rod.half_length * s]
    body = make.dynamic(
        "rod", make.point(*at), mass=1.0, inertia=[rod.inertia] * 3,
        position=[0, 0, -at[2]], velocity=[-3.0, 0, 0],
    )  # fmt: skip
    return make.scene("rod", [TABLE, body], contact=[{"between": ["rod", "table"], "friction": mu}])


def test_painleves_rod_is_named_and_passed_by_an_impulse() -> None:
    """The impulse that stops the slip of the tip at once, with its normal velocity kept at zero."""
    theta, mu, rod = atan2(2, 1), 2.0, Rod()
    assert rod.outcome(theta, 0.0, mu) == INCONSISTENT
    library = library_of(fallen_rod(theta, mu))
    path = simulate(library, until=0.05, samples=5)
    assert path.outcome is Outcome.DONE
    assert path.events[0].kind == "fallback-start"
    assert "fallback-end" in [e.kind for e in path.events]
    assert path.estimate is not None
    assert path.jams == 1
    assert any("s in all, the run went on by time-stepping" in told for told in path.estimate.uncertified)
    assert sum("Painleve" in warning for warning in path.warnings) == 1
    arm = rod.half_length * np.array([-cos(theta), -sin(theta)])
    rows = np.array([[1, 0, arm[1]], [0, 1, -arm[0]]])  # of the tip, over vx, vz and the rate about y
    weight = np.diag([1, 1, 1 / rod.inertia])
    blow = np.linalg.solve(rows @ weight @ rows.T, [3.0, 0.0])
    assert abs(blow[0]) < mu * blow[1]
    after = np.array([-3.0, 0.0, 0.0]) + weight @ rows.T @ blow
    first = simulate(library, until=2e-4, samples=1)
    assert first.v[-1, 1, [0, 2]] == pytest.approx(after[:2], abs=3e-3)
    assert first.w[-1, 1, 1] == pytest.approx(after[2], abs=1e-2)
    refused = simulate(library, until=0.05, fallback=False)
    assert refused.outcome is Outcome.NO_FRICTION
    assert refused.t_end == 0


def test_a_pile_of_balls_in_a_bowl_comes_to_rest_and_stays_there() -> None:
    bowl = make.fixed("bowl", make.sphere(1.0, cavity=True, position=[0, 0, 1.0]))
    spots = [(0.21 * np.cos(a), 0.21 * np.sin(a), 0.16) for a in np.arange(4) * np.pi / 2] + [
        (0.02, 0.01, 0.35)
    ]
    names = [f"b{k}" for k in range(len(spots))]
    pairs = [(name, "bowl") for name in names] + [(a, b) for k, a in enumerate(names) for b in names[:k]]
    law = {"friction": 0.3, "restitution": 0.2, "rolling_resistance": 2e-3, "spinning_resistance": 1e-3}
    contact = [{"between": pair, **law} for pair in pairs]
    balls = [ball(name, spot) for name, spot in zip(names, spots, strict=True)]
    path = stepped(make.scene("pile", [bowl, *balls], contact=contact), 3.0, 4e-3, samples=30)
    assert path.outcome is Outcome.DONE
    assert np.abs(path.v[-10:]).max() < 1e-9
    assert np.abs(path.p[-1] - path.p[-10]).max() < 1e-10
    assert np.nanmin(path.gap) > -1e-9
