"""Loads that jump or have kinks: each is an event, and what a run states of its error holds.

Against motion in pieces by another integrator (`switched_motion`), and against closed forms.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from math import pi, sqrt
from random import Random

import numpy as np
import pytest

from modelgen import Accuracy, simulate, start
from modelgen.codegen.library import Library
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene.read import read_text
from tests.laws.switched_motion import NAMES, SwitchedMotion, UndecidedError, drawn
from tests.running import library_of

ACCURACIES = ("fast", "balanced", "tight")
RESOLVED = 2e-11  # of the other integrator, relative
UNTIL = 2.0

POINT = """
gravity = [0.0, 0.0, 0.0]
[[body]]
name = "m"
mass = 2.0
inertia = [1, 1, 1]
position = {place}
velocity = {velocity}
[[force]]
body = "m"
force = {force}
"""
ROLLING = """
[[body]]
name = "m"
mass = 2.0
inertia = [0.2, 0.2, 0.2]
position = {place}
velocity = {velocity}
angular_velocity = {spin}
shape = {{ kind = "sphere", radius = 0.5 }}
[[body]]
name = "table"
motion = "fixed"
shape = {{ kind = "plane" }}
[[contact]]
between = ["m", "table"]
friction = 50.0
[[force]]
body = "m"
force = {force}
"""
RAIL = """
gravity = [0.0, 0.0, 0.0]
[[body]]
name = "m"
mass = 2.0
inertia = [1, 1, 1]
velocity = [0, 0, {velocity}]
[[joint]]
name = "rail"
kind = "prismatic"
between = ["world", "m"]
[[actuator]]
joint = "rail"
force = "{force}"
"""


def built(text: str) -> Library:
    return library_of(read_text(text, "scene.toml"))


def point(force: Sequence[str], place: Sequence[float], velocity: Sequence[float]) -> Library:
    return built(POINT.format(force=list(force), place=list(place), velocity=list(velocity)))


def run(library: Library, accuracy: str, until: float = UNTIL) -> Trajectory:
    return simulate(library, until=until, accuracy=getattr(Accuracy, accuracy)())


def assert_within_estimate(path: Trajectory, place: np.ndarray, velocity: np.ndarray) -> None:
    """The first body is where it should be, within the estimate and what the reference resolves."""
    assert path.estimate is not None
    known = RESOLVED * (1 + float(np.linalg.norm(place)) + float(np.linalg.norm(velocity)))
    assert np.linalg.norm(path.p[-1, 0] - place) <= path.estimate.position[-1] + known
    assert np.linalg.norm(path.v[-1, 0] - velocity) <= path.estimate.velocity[-1] + known


def starts(random: Random) -> tuple[list[float], list[float]]:
    place, velocity = ([round(random.uniform(-1, 1), 3) for _ in range(3)] for _ in range(2))
    return place, velocity


def ends(accelerations: Sequence[str], start: Sequence[float]) -> np.ndarray:
    """Where the motion ends; skips motions that another integrator does not decide."""
    try:
        end = SwitchedMotion(accelerations).end(start, UNTIL)
    except UndecidedError:
        pytest.skip("a zero is kept, only touched, or one of several")
    if not np.abs(end).max() < 100:
        pytest.skip("the motion runs away")
    return end


@pytest.mark.cases(6)
@pytest.mark.parametrize("seed", range(40))
def test_a_point_in_free_flight(seed: int) -> None:
    random = Random(seed)
    force = [drawn(random, NAMES) for _ in range(3)]
    place, velocity = starts(random)
    end = ends([f"0.5*({each})" for each in force], [*place, *velocity])
    library = point(force, place, velocity)
    for accuracy in ACCURACIES:
        path = run(library, accuracy)
        assert not path.doubts
        assert_within_estimate(path, end[:3], end[3:])


@pytest.mark.cases(4)
@pytest.mark.parametrize("seed", range(40, 60))
def test_a_ball_that_rolls_on_a_plane(seed: int) -> None:
    """Friction takes 2/7 of the force; what presses on the ball only changes the normal force."""
    random = Random(seed)
    names = ("x", "y", "vx", "vy")
    force = [drawn(random, names) for _ in range(2)]
    place, velocity = starts(random)
    place[2], velocity[2] = 0.5, 0.0
    press = f"-abs({random.uniform(-2, 2):.3f}*{random.choice(names)})"
    end = ends([f"({each})*{5 / 14!r}" for each in force], [*place[:2], *velocity[:2]])
    spin = [-velocity[1] / 0.5, velocity[0] / 0.5, 0.0]
    library = built(ROLLING.format(force=[*force, press], place=place, velocity=velocity, spin=spin))
    for accuracy in ACCURACIES:
        path = run(library, accuracy)
        assert not path.doubts
        assert_within_estimate(path, np.array([*end[:2], 0.5]), np.array([*end[2:], 0.0]))


@pytest.mark.cases(4)
@pytest.mark.parametrize("seed", range(60, 80))
def test_an_actuator_of_a_joint(seed: int) -> None:
    random = Random(seed)
    law = drawn(random, ("x", "vx"))
    velocity = round(random.uniform(-1, 1), 3)
    end = ends([f"0.5*({law})"], [0.0, velocity])
    force = re.sub(r"\bx\b", "coordinate", re.sub(r"\bvx\b", "rate", law))
    library = built(RAIL.format(force=force, velocity=velocity))
    for accuracy in ACCURACIES:
        path = run(library, accuracy)
        assert not path.doubts
        assert_within_estimate(path, np.array([0, 0, end[0]]), np.array([0, 0, end[1]]))


X, V = (0.3, 0.0, 0.0), (1.0, 0.0, 0.0)
W = 3.0
CLOSED = {  # force on 2 kg along x, from 0.3 m at 1 m/s: place and velocity after 2 s, number of events
    "dry friction stops it": ("-4*sign(vx)", 0.3 + 0.25, 0.0, 1),
    "dry friction and a weak force": ("1.5 - 4*sign(vx)", 0.3 + 0.8 / 2, 0.0, 1),
    "dry friction and a strong force": ("-6 - 4*sign(vx)", 0.3 + 0.1 - 1.8**2 / 2, -1.8, 1),
    "dry friction written twice": ("-2*sign(vx) - 2*sign(3*vx)", 0.3 + 0.25, 0.0, 2),
    "a force that grows beyond dry friction": (
        "-4*sign(vx) + 6*max(0, t - 1)", 0.3 + 0.25 + 1.5 * (1 / 3) ** 3 / 3, 1.5 * (1 / 3) ** 2, 3,
    ),
    "a force that jumps in time": ("3*sign(t - 0.7) + 3", 0.3 + 2 + 1.5 * 1.3**2, 1 + 3 * 1.3, 1),
    "a square wave": (f"2*sign(sin({W!r}*t))", 0.3 + 2 + pi / W * (2 - 1.5 * pi / W) + 0.0, None, 1),
    "a spring that only pushes": (
        "-18*max(0, x - 0.3)", 0.3 - (2 - pi / W), -1.0, 1,
    ),
    "a wall between two forces": ("-2*sign(x - 0.8)", None, None, 2),
    "a jump of an argument that makes none": ("-0.5*sign(abs(x - 0.5))", 0.3 + 2 - 0.5, 0.5, 1),
    "a root of the speed": ("-3*sqrt(abs(vx))*sign(vx)", 0.3 + 4 / 9, 0.0, 1),
}  # fmt: skip


@pytest.mark.parametrize("accuracy", ACCURACIES)
@pytest.mark.parametrize("name", CLOSED)
def test_closed_forms(name: str, accuracy: str) -> None:
    force, place, velocity, events = CLOSED[name]
    if name == "a square wave":  # 1 m/s^2 up to pi/3 s, then as much the other way
        turned = pi / W
        place = 0.3 + turned + turned**2 / 2 + (1 + turned) * (2 - turned) - (2 - turned) ** 2 / 2
        velocity = 1 + turned - (2 - turned)
    if name == "a wall between two forces":  # accelerated up to 0.8 m, then stopped by as much
        speed = sqrt(1 + 2 * 0.5)
        left = 2 - (speed - 1)
        place, velocity = 0.8 + speed * left - left**2 / 2, speed - left
        events = 1
    path = run(point([force, "0", "0"], X, V), accuracy)
    assert not path.doubts
    assert_within_estimate(path, np.array([place, 0, 0]), np.array([velocity, 0, 0]))
    assert [event.kind for event in path.events] == ["load-switch"] * events


@pytest.mark.parametrize("accuracy", ACCURACIES)
def test_dry_friction_along_two_axes_ends_at_two_times(accuracy: str) -> None:
    path = run(point(["-4*sign(vx)", "-4*sign(vy)", "0"], (0, 0, 0), (1, 1.2, 0.5)), accuracy)
    assert_within_estimate(path, np.array([0.25, 0.36, 1.0]), np.array([0, 0, 0.5]))
    assert [event.t for event in path.events] == pytest.approx([0.5, 0.6], abs=1e-8)


@pytest.mark.parametrize("accuracy", ACCURACIES)
def test_a_force_towards_a_point_holds_there(accuracy: str) -> None:
    """It starts at rest where the force turns: no load of either side may act, one between them does."""
    path = run(point(["0.5 - sign(x)", "0", "0"], (0, 0, 0), (0, 0, 0)), accuracy)
    assert not path.doubts
    assert not path.events
    assert np.abs(path.p[:, 0]).max() < 1e-12


def test_swings_that_end_are_finitely_many() -> None:
    """Each swing of -sign(x) against 0.8 of dry friction is a ninth as wide: it ends at a time."""
    path = run(point(["-sign(x) - 0.8*sign(vx)", "0", "0"], (1, 0, 0), (0, 0, 0)), "balanced", 20.0)
    assert len(path.events) < 60
    assert np.abs(path.p[-1, 0]).max() < 1e-5


def test_branches_that_change_with_the_side_are_not_trusted() -> None:
    """Both sides of 0.8 m/s lead back to it, with different branches of min."""
    path = run(point(["min(2*x, -3*sign(vx - 0.8))", "0", "0"], (-0.2, 0, 0), V), "balanced", 1.0)
    assert any("time-stepping" in doubt for doubt in path.doubts)


REPELLING = {  # force on 2 kg at 1/3 m from rest: the others leave it in one way, or are held there
    "sign(x - 1/3)": True,
    "2*sign(x - 1/3) - 1.9": True,
    "1 + sign(x - 1/3)": True,
    "-1 - sign(1/3 - x)": True,
    "-1 + sign(1/3 - x)": False,
    "sign(vx)": True,
    "0.5*sign(vx) + t": True,
    "-sign(vx)*sign(x - 1)": True,
    "2*sign(x - 1/3) - 2.1": False,
    "1.5 + sign(vx)": False,
    "-sign(x - 1/3)": False,
    "0.2 - sign(vx)": False,
    "abs(x - 1/3)": False,
    "max(0, x - 1/3)": False,
    "sign(t)": False,
}


@pytest.mark.parametrize("accuracy", ACCURACIES)
@pytest.mark.parametrize("force", REPELLING)
def test_a_start_that_loads_leave_to_either_side_is_not_trusted(force: str, accuracy: str) -> None:
    path = run(point([force, "0", "0"], (1 / 3, 0, 0), (0, 0.1, 0)), accuracy, 0.5)
    assert path.indeterminate_t == (0.0 if REPELLING[force] else None)
    assert any("not unique" in doubt for doubt in path.doubts) == REPELLING[force]
    assert path.indeterminate_load == ("force on m" if REPELLING[force] else "")


@pytest.mark.parametrize("seed", range(6))
def test_an_event_that_loads_leave_to_either_side_is_not_trusted(seed: int) -> None:
    """It is brought to rest at a place where the load then pushes away."""
    random = Random(seed)
    speed, brake = random.uniform(0.5, 1.5), random.uniform(2.0, 4.0)
    rest = speed**2 / brake  # 2 kg
    force = f"-{brake!r}*sign(vx)*max(0, sign(t_off - t)) + 3*max(0, sign(t - t_off))*sign(vx)"
    until = speed * 2 / brake
    path = run(
        point([force.replace("t_off", repr(until + 0.2)), "0", "0"], (0, 0, 0), (speed, 0, 0)), "balanced"
    )
    assert path.p[-1, 0, 0] == pytest.approx(rest)
    assert path.indeterminate_t == pytest.approx(until + 0.2)


def test_what_a_contact_keeps_at_a_jump_is_trusted() -> None:
    """The load only presses on the ball, which the contact keeps at its jump."""
    library = built(
        ROLLING.format(
            force=["0", "0", "-1 - sign(z - 0.5)"], place=[0, 0, 0.5], velocity=[0, 0, 0], spin=[0] * 3
        )
    )
    assert not run(library, "balanced").doubts


HELD = """
[[input]]
name = "grip"
default = 4.0
"""


def held(text: str = "1.5 - grip*sign(vx)") -> Library:
    return built(POINT.format(force=[text, "0", "0"], place=list(X), velocity=list(V)) + HELD)


@pytest.mark.parametrize("accuracy", ACCURACIES)
def test_an_input_releases_what_dry_friction_holds(accuracy: str) -> None:
    """1.25 m/s^2 stop it in 0.8 s; from 1 s on a grip of 0.5 N leaves 1 N of 1.5 N, from 1.6 s on one of 4 N
    brakes again."""
    sim = start(held(), accuracy=accuracy)
    assert [event.t for event in sim.step(1.0)] == pytest.approx([0.8], abs=1e-7)
    sim.inputs["grip"] = 0.5
    sim.step(1.6)
    sim.inputs["grip"] = 4.0
    sim.step(3.0)
    braked = 0.3**2 / (2 * 1.25)
    assert sim.state[0] == pytest.approx(0.3 + 0.4 + 0.5 * 0.6**2 / 2 + braked, abs=1e-7)
    assert sim.state[3] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("force", ["1.5 - grip*sign(vx)", "-grip*sign(x - 0.5)", "grip*max(abs(x), vx)"])
@pytest.mark.parametrize("instant", [0.3, 0.8, 1.0, 1.4])
def test_a_saved_state_goes_on_bit_for_bit(force: str, instant: float) -> None:
    """Branches, and what slides, are part of it."""
    sim = start(held(force), accuracy="balanced")
    sim.step(instant)
    mark = sim.save()
    ends = []
    for _ in range(2):
        events = sim.step(2.0)
        ends.append((bytes(sim.state), events))
        sim.load(mark)
    other = start(held(force), accuracy="balanced")
    other.load(mark)
    ends.append((b"", other.step(2.0)))
    assert ends[0] == ends[1] == (bytes(other.state), ends[2][1])


@pytest.mark.parametrize("force", ["1.5 - grip*sign(vx)", "-grip*sign(x - 0.5)", "grip*max(abs(x), vx)"])
def test_a_run_in_pieces_is_that_in_one(force: str) -> None:
    path = run(held(force), "tight")
    sim = start(held(force), accuracy="tight")
    events = [event for k in range(1, 41) for event in sim.step(k * UNTIL / 40)]
    assert path.estimate is not None
    assert np.allclose(sim.state[:3], path.p[-1, 0], rtol=0, atol=2 * path.estimate.position[-1] + RESOLVED)
    assert [each.t for each in events] == pytest.approx([each.t for each in path.events], abs=1e-10)


@pytest.mark.parametrize("real", ["float", pytest.param("long double", marks=pytest.mark.slow)])
def test_other_real_types(real: str) -> None:
    scene = read_text(POINT.format(force=["1.5 - 4*sign(vx)", "0", "0"], place=list(X), velocity=list(V)))
    path = run(library_of(scene, real), "fast")
    eps = float(np.finfo(np.float32 if real == "float" else float).eps)
    assert [event.t for event in path.events] == pytest.approx([0.8], abs=1e3 * eps + 1e-9)
    assert path.p[-1, 0, 0] == pytest.approx(0.7, abs=1e3 * eps + 1e-9)


def test_fixed_steps_locate_them_too() -> None:
    """Classical Runge-Kutta steps are exact for loads that are constant between two zeros."""
    library = point(["1.5 - 4*sign(vx)", "0", "0"], X, V)
    path = simulate(library, until=UNTIL, accuracy=Accuracy.balanced(), method="rk4", step=0.013)
    assert path.p[-1, 0, 0] == pytest.approx(0.7, abs=1e-12)
    assert [event.t for event in path.events] == pytest.approx([0.8], abs=1e-12)
