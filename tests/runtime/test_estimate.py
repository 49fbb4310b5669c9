"""What a run says of its own error is honest, and it says where nothing can be said."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from modelgen import Accuracy, simulate, start
from modelgen.runtime.core_session import Session
from modelgen.runtime.error_estimate import estimate_of
from modelgen.runtime.run_distance import distance_between, motions_compared
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene import python_scenes as make
from modelgen.scene.read import read_text
from tests.benchmark.cases import Verdict, judged, scene_named, true_form
from tests.benchmark.test_reference import BILLIARD
from tests.running import NAMES, library_of, scene_of

CASES, SEED = 16, 6


@pytest.mark.cases(1)
@pytest.mark.parametrize("name", ["bouncing_ball", "ellipsoid_on_plane", "double_pendulum"])
def test_an_estimate_is_within_ten_times_of_the_error(name: str) -> None:
    library, truth = scene_of(name), library_of(true_form(scene_named(name)), "long double")
    verdicts = [judged(name, library, truth, SEED, number) for number in range(CASES)]
    assert not [verdict for verdict in verdicts if verdict.under]
    assert len([verdict for verdict in verdicts if verdict.over]) <= 1
    assert len([verdict for verdict in verdicts if verdict.status == "estimated"]) > CASES // 2


def across_impacts(path: Trajectory, true: Trajectory) -> np.ndarray[Any, Any]:
    """Which samples lie between an impact of a run and one of the other, of which each is the nearest of its
    kind to the other."""
    across = np.zeros(len(path.t), dtype=bool)
    for event in path.events:
        mine, theirs = (
            np.array(
                [each.t for each in run.events if (each.kind, each.contact) == (event.kind, event.contact)]
            )
            for run in (path, true)
        )
        if not (event.speed > 0 and len(theirs)):
            continue
        like = theirs[abs(theirs - event.t).argmin()]
        if mine[abs(mine - like).argmin()] == event.t:
            across |= (path.t >= min(event.t, like)) & (path.t <= max(event.t, like))
    return across


QUICK = ("bouncing_ellipsoid", "double_pendulum", "glass_on_table", "sliding_puck", "ball_in_bowl")
OTHERS = [pytest.param(name, marks=pytest.mark.slow) for name in NAMES if name not in QUICK]


@pytest.mark.cases(5)
@pytest.mark.parametrize("accuracy", ["fast", "balanced"])
@pytest.mark.parametrize("name", [*QUICK, *OTHERS])
def test_each_kind_of_error_of_the_samples_is_covered(name: str, accuracy: str) -> None:
    """Position, velocity and spin against a run at 1e-13, whose own error counts as known: never less than a
    third of the error, and not more than a hundred times. Velocities are compared but where one run is
    before an impact and the other after it."""
    library = scene_of(name)
    path, true = (simulate(library, accuracy=each) for each in (accuracy, "tight"))
    assert path.estimate is not None
    assert true.estimate is not None
    bodies = list(enumerate(library.manifest.instance["bodies"]))
    moving = [k for k, body in bodies if body["motion"] in ("point", "free")]
    turning = [k for k, body in bodies if body["motion"] == "free"]
    n = min(path.estimate.predicted, true.estimate.predicted)
    across = across_impacts(path, true)
    for key, column, some in (("position", "p", moving), ("velocity", "v", moving), ("spin", "w", turning)):
        difference = distance_between(getattr(path, column), getattr(true, column), some)[:n]
        apart = difference.max() if key == "position" else difference[~across[:n]].max()
        stated, known = (float(getattr(run.estimate, key)[n - 1]) for run in (path, true))
        assert (apart - known) / 3 <= stated <= 100 * max(apart, known), key
        assert stated == getattr(path, f"{key}_error")[n - 1]


SMOOTH = ("ellipsoid_on_plane", "gripper")
MORE = [
    pytest.param(name, marks=pytest.mark.slow) for name in ("rolling_ellipsoid", "turntable", "user_surface")
]


@pytest.mark.parametrize("name", [*SMOOTH, *MORE])
def test_samples_of_the_first_steps_are_covered(name: str) -> None:
    """Samples between two steps err as the step that holds them does; that of the companion is shorter, also
    while steps grow. The truth is a run whose steps end at the samples."""
    library, rng = scene_of(name), np.random.default_rng(3)
    for _ in range(12):
        until, samples = float(rng.uniform(0.05, 0.3)), int(rng.integers(3, 40))
        path, true = simulate(library, until=until, samples=samples), start(library, accuracy="tight")
        error = []
        for k, t in enumerate(path.t):
            if k:
                true.step(t)
            places = true.session.poses()[: len(path.body_names), :3]
            error.append(np.linalg.norm(path.p[k] - places, axis=1).max())
        assert path.estimate is not None
        assert (np.array(error) <= path.estimate.position + 1e-15).all()


@pytest.mark.parametrize("name", ["egg_on_spline", "ball_in_bowl", "bean_with_poles", "linked_rings"])
def test_samples_fewer_than_steps_are_covered(name: str) -> None:
    """Between the ends of steps the error of a run changes its sign. An interpolated companion errs as much
    at samples near such a zero. The truth is a tight run whose steps end at the samples."""
    library = scene_of(name)
    until = 0.15 * library.manifest.instance["run"]["until"]
    for samples in range(2, 18):
        path, true = simulate(library, until=until, samples=samples), start(library, accuracy="tight")
        assert path.estimate is not None
        assert samples <= path.steps
        error = [0.0]
        for k, t in enumerate(path.t[1:], 1):
            true.step(t)
            places = true.session.poses()[: len(path.body_names), :3]
            error.append(np.linalg.norm(path.p[k] - places, axis=1).max())
        assert (np.array(error) <= path.estimate.position + 1e-15).all(), samples


@pytest.mark.cases(3)
@pytest.mark.parametrize("seed", range(20, 50))
def test_samples_denser_than_steps_are_covered(seed: int) -> None:
    """Of a double pendulum and a ball on a spring at `fast`, 400 samples in a few dozen steps."""
    rng = np.random.default_rng(seed)
    links = [
        make.dynamic(
            f"link{k}", make.sphere(0.05), mass=float(rng.uniform(0.3, 3)), position=[0.3 + 0.5 * k, 0, 0],
            inertia=rng.uniform(0.01, 0.02, 3).tolist(),
            angular_velocity=[0, float(rng.uniform(-4, 4)) if k == 0 else 0.0, 0],
        )
        for k in range(2)
    ]  # fmt: skip
    bob = make.dynamic(
        "bob", make.sphere(0.05), mass=1.0, inertia=[0.01] * 3, position=[0.5, 2, 0.1],
        velocity=rng.uniform(-1, 1, 3).tolist(),
    )  # fmt: skip
    floor = make.fixed("floor", make.plane(), position=[0, 0, -1.2])
    between = ["world", "link0"], ["link0", "link1"]
    turned = {"axis": [1, 0, 0], "angle": "-pi/2"}
    scene = make.scene(
        "dense", [floor, *links, bob],
        joint=[
            {
                "name": f"j{k}", "kind": "revolute", "between": pair, "axis_angle": turned,
                "position": [0.5 * k, 0, 0],
            }
            for k, pair in enumerate(between)
        ],
        spring=[
            {
                "between": ["floor", "bob"], "anchors": [[0, 2, 2.2], [0, 0, 0]], "rest_length": 0.5,
                "stiffness": float(rng.uniform(20, 200)),
            }
        ],
    )  # fmt: skip
    library = library_of(scene)
    path = simulate(library, until=1.5, samples=400, accuracy="fast")
    true = simulate(library, until=1.5, samples=400, accuracy="tight", estimate=False)
    assert path.steps < 200
    runs = [{key: getattr(run, key) for key in ("p", "quaternion", "v", "w")} for run in (path, true)]
    errors = motions_compared(runs[0], runs[1], library.manifest.instance)[:4]
    stated = path.position_error, path.rotation_error, path.velocity_error, path.spin_error
    assert (errors <= np.array(stated)).all()


@pytest.mark.parametrize("step", [1e-2, 1e-3])
@pytest.mark.parametrize("name", ["ball_leaves_sphere", "double_pendulum"])
def test_event_times_told_by_time_stepping_are_covered(name: str, step: float) -> None:
    """First events, which a step tells at its end; the motion is wrong by more than is predicted before."""
    path = simulate(scene_of(name), accuracy=Accuracy.balanced().time_stepping(step))
    true = simulate(scene_of(name), accuracy="tight", estimate=False)
    assert path.estimate is not None
    assert path.estimate.horizon is not None
    told, real = (next(e for e in run.events if e.contact == true.events[0].contact) for run in (path, true))
    error = abs(told.t - real.t)
    assert error > 1e-4
    assert path.estimate.events is not None
    assert error / 3 < path.estimate.events
    if len(path.events) == 1:
        assert path.estimate.events < 100 * error


def test_a_run_without_events_states_no_error_of_their_times() -> None:
    path = simulate(scene_of("ellipsoid_on_plane"), until=0.1)
    assert path.estimate is not None
    assert path.estimate.events is None


def test_a_verdict_knows_what_is_too_low_and_too_high() -> None:
    verdict = Verdict("egg", 0, "estimated")
    assert replace(verdict, ratio=0.09).under
    assert replace(verdict, ratio=11.0).over
    assert not replace(verdict, ratio=2.0).under
    assert not replace(verdict, ratio=2.0).over


def test_an_estimate_changes_nothing_of_its_run() -> None:
    egg = scene_of("ellipsoid_on_plane")
    alone, judged_too = simulate(egg, estimate=False), simulate(egg)
    assert alone.estimate is None
    assert alone.summary()["estimate"] is None
    assert np.isinf(alone.position_error).all()
    assert judged_too.estimate is not None
    assert judged_too.estimate.status == "estimated"
    assert judged_too.estimate.horizon is None
    assert judged_too.steps == alone.steps
    assert (judged_too.p == alone.p).all()
    assert (np.diff(judged_too.position_error) >= 0).all()
    stated = judged_too.summary()["estimate"]
    assert stated["position"] == judged_too.position_error[-1]
    assert stated["statement"].startswith("estimated error ")


@pytest.mark.parametrize("step", [2e-2, 5e-3, 1e-3])
@pytest.mark.parametrize("method", ["rk4", "stewart-trinkle", "anitescu-potra"])
def test_an_estimate_at_fixed_steps_is_twice_the_error(method: str, step: float) -> None:
    """Of a method of any order: a shorter step takes the share of the error that its order says."""
    egg, plain = scene_of("ellipsoid_on_plane"), Accuracy.balanced()
    accuracy = plain.fixed_step(step) if method == "rk4" else plain.time_stepping(step, method)
    path = simulate(egg, accuracy=accuracy, until=0.3, samples=6)
    error = np.linalg.norm(path.p - simulate(egg, accuracy="tight", until=0.3, samples=6).p, axis=-1).max()
    assert error > 1e-14
    assert 1.2 * error < path.position_error[-1] < 5 * error


def test_drift_that_nobody_removes_is_in_the_estimate() -> None:
    box = scene_of("box_dropped")
    drifting = simulate(box, accuracy=replace(Accuracy.balanced(), project=0))
    error = np.linalg.norm(drifting.p - simulate(box, accuracy="tight").p, axis=-1).max()
    assert error > 1e-11
    assert error < drifting.position_error[-1] < 10 * error


def test_the_estimate_falls_with_the_tolerance() -> None:
    egg = scene_of("ellipsoid_on_plane")
    errors = [simulate(egg, accuracy=Accuracy.of(10.0**-k)).position_error[-1] for k in (4, 7, 10, 13)]
    assert errors == sorted(errors, reverse=True)
    assert errors[0] > 1e-6
    assert errors[-1] < 1e-12


def test_a_billiard_is_said_to_be_beyond_its_horizon_and_honest_before_it() -> None:
    room = read_text(BILLIARD, "billiard.toml")
    library, truth = library_of(room), library_of(room, "long double")
    path = simulate(library, accuracy="fast")
    real = simulate(truth, accuracy=Accuracy.finest(), estimate=False)
    assert path.estimate is not None
    assert path.estimate.status == "beyond predictable horizon"
    assert path.estimate.horizon is not None
    assert 0 < path.estimate.horizon < path.t_end
    n = path.estimate.predicted
    assert path.t[n - 1] == path.estimate.horizon
    error = np.linalg.norm((path.p - real.p).astype(float), axis=-1).max(axis=1)[:n].max()
    assert error / 10 < path.position_error[n - 1] < 10 * error
    assert f"horizon ({path.estimate.horizon:.6g} s)" in path.estimate.statement


def test_what_a_second_run_cannot_show_is_said() -> None:
    rings = simulate(scene_of("linked_rings"), until=0.1)
    assert rings.estimate is not None
    assert rings.estimate.uncertified == ()
    egg = simulate(
        scene_of("ellipsoid_on_plane"), until=0.1, accuracy=replace(Accuracy.fast(), use_gamma=False)
    )
    assert egg.estimate is not None
    assert "Gamma2 is left out" in egg.estimate.statement


@pytest.mark.cases(3)
@pytest.mark.parametrize("accuracy", ["fast", "balanced", "tight"])
def test_a_sample_that_falls_on_an_impact_is_left_out_of_the_errors_of_velocities(accuracy: str) -> None:
    """Balls that meet walls at round times, which are samples."""
    stated = []
    for k in range(1, 10):
        wall = make.fixed("wall", make.plane(), position=[0.12 * k, 0, 0], rpy=[0, -np.pi / 2, 0])
        ball = make.dynamic(
            "ball", make.sphere(0.1), density=1.0, position=[-0.1, 0, 0], velocity=[1.2, 0, 0]
        )
        contact = [{"between": ["ball", "wall"], "restitution": 0.5}]
        library = library_of(make.scene("met", [wall, ball], contact=contact, gravity=[0, 0, 0]))
        path = simulate(library, until=1.0, accuracy=accuracy)
        assert len(path.events) == 1
        stated.append(path.velocity_error.max())
    assert max(stated) < 1e-12


def test_impacts_that_one_run_has_alone_hide_no_error_of_velocities() -> None:
    """Each impact is compared with the nearest of the other run, also where that lacks one before it."""
    table, contact = make.fixed("table", make.plane()), [{"between": ["ball", "table"], "restitution": 0.8}]
    ball = make.dynamic("ball", make.sphere(0.1), density=1e3, position=[0, 0, 0.3])
    library = library_of(make.scene("bounces", [table, ball], contact=contact))
    path = simulate(library, until=1.5, samples=50, estimate=False)
    twin = replace(path, events=path.events[1:], v=path.v + 1e-6)
    found = estimate_of(path, twin, Accuracy.balanced(), library.manifest.instance)
    assert len(path.events) > 3
    assert (found.velocity >= 1e-6).mean() > 0.9


@pytest.mark.cases(3)
@pytest.mark.parametrize("accuracy", ["fast", "balanced"])
def test_so_is_one_that_falls_on_it_within_the_error_of_its_time(accuracy: str) -> None:
    """Eggs that turn as they fall onto a table; a run at 1e-13 tells when."""
    table, contact = make.fixed("table", make.plane()), [{"between": ["egg", "table"], "restitution": 0.5}]
    for spin in range(1, 8):
        egg = make.dynamic(
            "egg", make.ellipsoid(0.1, 0.08, 0.06), density=1e3, position=[0, 0, 0.3],
            angular_velocity=[spin, 3.0, 1.0],
        )  # fmt: skip
        library = library_of(make.scene("falls", [table, egg], contact=contact))
        blow = simulate(library, until=0.3, accuracy="tight", estimate=False).events[0]
        path = simulate(library, until=1.1 * blow.t, accuracy=accuracy, samples=11)
        assert path.t[10] == pytest.approx(blow.t, rel=1e-15)
        assert path.velocity_error[-1] < 1e-5 * blow.speed


def test_event_times_have_an_estimate() -> None:
    path = simulate(scene_of("double_pendulum"), accuracy="fast")
    assert path.estimate is not None
    assert path.estimate.events_unmatched == 0
    assert path.estimate.events is not None
    fine = simulate(scene_of("double_pendulum"), accuracy="tight", estimate=False)
    pairs = zip(path.events, fine.events, strict=True)
    error = max(abs(a.t - b.t) for a, b in pairs)
    assert error / 10 < path.estimate.events < 10 * error


def test_a_companion_that_ends_early_is_compared_at_the_samples_of_its_run(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    advance, calls = Session.advance, list[float]()

    def stopping(self: Session, *arguments: Any) -> int:
        if self.accuracy.name.endswith("companion"):
            calls.append(float(self.run.t))
            if self.run.t > 5:
                raise KeyboardInterrupt
        return advance(self, *arguments)

    monkeypatch.setattr(Session, "advance", stopping)
    found = simulate(scene_of("ellipsoid_on_plane"), until=20.0, samples=2000)
    assert found.interrupted
    assert found.estimate is not None
    assert 5 < calls[-1] < 19
    assert found.estimate.predicted == round(calls[-1] / 0.01) + 1
    assert found.estimate.horizon is None
    assert found.position_error[found.estimate.predicted - 1] < 1e-6


def test_a_companion_that_does_not_start_is_no_estimate() -> None:
    egg = scene_of("ellipsoid_on_plane")
    path = simulate(egg, until=0.1, estimate=False)
    none = estimate_of(path, None, Accuracy.balanced(), egg.manifest.instance, "it did not start")
    assert none.statement == "uncertified: it did not start"
    assert none.as_json()["position"] is None
    assert none.status == "uncertified"


def test_energy_that_is_off_is_doubted() -> None:
    egg = scene_of("rolling_ellipsoid")
    wrong = simulate(egg, until=1.0, accuracy=replace(Accuracy.balanced(), use_gamma=False))
    assert wrong.estimate is not None
    assert wrong.energy_drift > 1e-2
    assert any("energy drift" in reason for reason in wrong.doubts)
    assert simulate(egg, until=1.0).is_trusted
