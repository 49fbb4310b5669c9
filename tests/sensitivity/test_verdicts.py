"""What a derivative is not: each cause of doubt is told with its time, its contact and its reason."""

from __future__ import annotations

from dataclasses import replace
from math import sqrt

import casadi
import numpy as np
import pytest

from modelgen import Accuracy, gradient, sensitivity
from modelgen.scene.read import read_text
from tests.sensitivity.differences import differentiable, shipped

G, R = 9.81, 0.1
BALL = """
[[body]]
name = "ball"
shape = { kind = "sphere", radius = 0.1 }
mass = 2.0
inertia = [0.008, 0.008, 0.008]
"""


def found_in(text: str, t: float, accuracy: Accuracy | str = "tight"):  # type: ignore[no-untyped-def]
    library = differentiable(read_text(text, "scene.toml"))
    return sensitivity(library, t, of=["ball.position"], by=["ball.velocity"], accuracy=accuracy)


def test_a_ball_that_just_reaches_a_ceiling() -> None:
    """It strikes more slowly than counts as a blow: a throw that is hardly slower does not strike."""
    high, fast = 0.5, 1e-4
    up = sqrt(2 * G * (high - R) + fast * fast)
    text = f"""{BALL}
velocity = [0.0, 0.0, {up!r}]
[[body]]
name = "ceiling"
motion = "fixed"
shape = {{ kind = "plane" }}
position = [0.0, 0.0, {high}]
rpy = ["pi", 0.0, 0.0]
[[contact]]
between = ["ball", "ceiling"]
"""
    verdict = found_in(text, 0.5, replace(Accuracy.tight(), rest_speed=1e-3)).verdict
    assert verdict.reason == "an event function only touches zero"
    assert verdict.t == pytest.approx((up - fast) / G, abs=1e-9)
    assert verdict.contact == "ball-ceiling"


def bouncing(seed: int, restitution: float) -> tuple[str, float, float]:
    """A ball that bounces and slips all the time; its friction, and when it rests."""
    rng = np.random.default_rng(seed)
    mu, height, up = rng.uniform(0.02, 0.1), rng.uniform(0.1, 0.5), rng.uniform(-1.0, 1.0)
    first = sqrt(up * up + 2 * G * height)
    rests = (up + first) / G + 2 * restitution * first / (G * (1 - restitution))
    text = f"""{BALL}
position = [0.0, 0.0, {R + height}]
velocity = [40.0, 0.0, {up}]
[[body]]
name = "floor"
motion = "fixed"
shape = {{ kind = "plane" }}
[[contact]]
between = ["ball", "floor"]
friction = {mu}
restitution = {restitution}
"""
    return text, mu, rests


@pytest.mark.parametrize("restitution", [0.05, 0.4, 0.85])
@pytest.mark.parametrize("seed", range(3))
def test_bounces_of_one_contact_that_end_have_derivatives(seed: int, restitution: float) -> None:
    """Friction is mu times the normal impulse, and that follows from the fall: x' = x0' - mu (g t - z0') at
    rest, however many bounces came before."""
    text, mu, rests = bouncing(seed, restitution)
    t = 1.5 * rests
    library = differentiable(read_text(text, "scene.toml"))
    of, by = ["ball.position", "ball.velocity"], ["ball.position", "ball.velocity"]
    found = sensitivity(library, t, of=of, by=by, accuracy="tight")
    assert found.verdict
    expected = np.zeros((6, 6))
    expected[:2, :2], expected[:2, 3:5], expected[3:5, 3:5] = np.eye(2), t * np.eye(2), np.eye(2)
    expected[0, 2], expected[0, 5], expected[3, 5] = mu, mu * t, mu
    across = found.jacobian[0][[1, 4]], expected[[1, 4]]  # slip that turns has less friction along y
    assert found.jacobian[0][[0, 2, 3, 5]] == pytest.approx(expected[[0, 2, 3, 5]], abs=1e-7)
    assert across[0][:, [0, 2, 3, 5]] == pytest.approx(across[1][:, [0, 2, 3, 5]], abs=1e-7)


def test_bounces_of_several_contacts_that_end() -> None:
    """Which corner of a cube that comes to rest strikes next, or which two at once, depends on the start."""
    library = shipped("cube_toss")
    found = sensitivity(library, 1.0, of=["cube.position"], by=["cube.velocity"], accuracy="tight")
    cut_off = "bounces that grow ever shorter are cut off"
    assert found.verdict.reason in (cut_off, "several events happen at one time")
    assert found.verdict.contact.startswith("cube-table")


CORNER = """
gravity = [0.0, 0.0, 0.0]
[[body]]
name = "floor"
motion = "fixed"
shape = { kind = "plane" }

[[body]]
name = "wall"
motion = "fixed"
rpy = [0.0, "pi/2", 0.0]
shape = { kind = "plane" }
"""


@pytest.mark.parametrize("apart", [0.0, 0.1])
def test_two_walls_are_struck_at_one_time_or_one_after_the_other(apart: float) -> None:
    text = f"""{CORNER}{BALL}
position = [0.6, 0.0, {0.6 + apart}]
velocity = [-1.0, 0.0, -1.0]
[[contact]]
between = ["ball", "floor"]
restitution = 0.5
[[contact]]
between = ["ball", "wall"]
restitution = 0.5
"""
    verdict = found_in(text, 1.0).verdict
    assert bool(verdict) == bool(apart)
    if not apart:
        assert verdict.reason == "several events happen at one time"
        assert verdict.t == pytest.approx(0.5, abs=1e-12)
        assert verdict.contact in ("ball-floor", "ball-wall")


def test_a_paradox_of_painleve() -> None:
    """No acceleration at the start: a step of time passes it."""
    found = sensitivity(shipped("painleve_rod"), 0.1, of=["rod.position"], by=["rod.velocity"])
    assert found.verdict.reason == "a part of the run is time-stepping"
    assert found.verdict.t == 0.0


def test_time_stepping() -> None:
    found = sensitivity(
        shipped("bouncing_ball"),
        0.1,
        of=["ball.position"],
        by=["ball.velocity"],
        method="time-stepping",
        step=1e-3,
    )
    assert found.verdict.reason == "a part of the run is time-stepping"
    assert found.verdict.t == 0.0


def test_a_box_that_falls_on_its_face() -> None:
    text = """
[[body]]
name = "floor"
motion = "fixed"
shape = { kind = "plane" }

[[body]]
name = "ball"
shape = { kind = "box", size = [0.2, 0.1, 0.2] }
density = 500.0
position = [0.0, 0.0, 0.4]

[[contact]]
between = ["ball", "floor"]
"""
    verdict = found_in(text, 0.5).verdict
    assert verdict.reason == "faces come to rest on each other, or rub"
    assert verdict.t == pytest.approx(sqrt(2 * 0.3 / G), abs=1e-9)
    assert verdict.contact.startswith("ball-floor:bottom")


@pytest.mark.parametrize(("by", "certain"), [("push", True), ("aside", False)])
def test_slip_that_begins(by: str, certain: bool) -> None:
    """A ball is pulled until it slips: by a force along the pull the slip keeps its direction."""
    text = f"""
gravity = [0.0, 0.0, -9.81]
[[body]]
name = "floor"
motion = "fixed"
shape = {{ kind = "plane" }}
{BALL}
position = [0.0, 0.0, 0.1]
[[contact]]
between = ["ball", "floor"]
friction = {{ static = 0.4, kinetic = 0.3 }}
[[input]]
name = "push"
default = 1.0
[[input]]
name = "aside"
default = 0.0
[[force]]
body = "ball"
force = ["40*t*push", "aside", 0.0]
"""
    library = differentiable(read_text(text, "scene.toml"))
    found = sensitivity(library, [0.5, 1.5], of=["ball.position"], by=[by], accuracy="tight")
    assert found.verdicts[0]
    assert bool(found.verdict) == certain
    if not certain:
        assert found.verdict.contact == "ball-floor"
        assert found.verdict.reason == "slip begins in a direction that depends on the change"
    assert np.all(np.isfinite(found.jacobian))


@pytest.mark.parametrize("apart", [-1e-3, -1e-10, 0.0, 1e-10, 1e-3])
def test_the_very_time_of_an_event(apart: float) -> None:
    """A ball strikes the floor, and has yet to do so in some changed runs: derivatives hold on one side."""
    text = f"""{BALL}
position = [0.0, 0.0, 0.5]
[[body]]
name = "floor"
motion = "fixed"
shape = {{ kind = "plane" }}
[[contact]]
between = ["ball", "floor"]
restitution = 0.6
"""
    strikes = sqrt(2 * (0.5 - R) / G)
    library = differentiable(read_text(text, "scene.toml"))
    of, by = ["ball.position"], ["ball.position"]
    strikes = sensitivity(library, 2 * strikes, of=of, by=by, accuracy="tight").events[0].t
    found = sensitivity(library, [strikes + apart, 0.4], of=of, by=by, accuracy="tight")
    assert found.verdicts[1]
    assert found.verdicts[0].kind == ("differentiable" if apart else "one-sided")
    assert found.jacobian[0, 2, 2] == pytest.approx(1.0 if apart < 0 else -0.6, abs=0.02)
    if not apart:
        assert found.verdicts[0].contact == "ball-floor"
        assert found.verdicts[0].t == pytest.approx(strikes, abs=1e-12)
    values = casadi.MX.sym("values", 2, 3)
    loss = casadi.Function("loss", [values], [casadi.sumsqr(values)])
    slope = gradient(library, [strikes + apart, 0.4], loss, of=of, by=by, accuracy="tight")
    assert slope.verdict == found.verdicts[0]
