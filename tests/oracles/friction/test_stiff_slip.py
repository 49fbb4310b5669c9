"""Slip so slow that friction turns it a million times faster than it changes."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from modelgen import simulate
from modelgen.runtime.trajectory import Outcome
from modelgen.scene import python_scenes as make
from tests.running import library_of, run

G, FRICTION, MASS, RADIUS, TURN = 9.81, 0.3, 0.5, 0.05, 2.0  # TURN: rad/s, of the force
YIELD = 3.5 * FRICTION * G  # m/s^2: friction acts on the slip of a solid ball with 1/m + r^2/I = 3.5/m


def slip_after(until: float, speed: float) -> np.ndarray:
    """Slip under a turning force that friction just balances, from its equations of speed and direction."""

    def rates(t: float, state: np.ndarray) -> list[float]:
        lag = TURN * t - state[1]
        return [-2 * YIELD * np.sin(lag / 2) ** 2, YIELD * np.sin(lag) / state[0]]

    start = [speed, -speed * TURN / YIELD]
    found = solve_ivp(rates, (0, until), start, "Radau", rtol=1e-11, atol=[1e-18, 1e-14])
    size, angle = found.y[:, -1]
    return np.array([size * np.cos(angle), size * np.sin(angle)])


@pytest.mark.parametrize("accuracy", ["balanced", "tight"])
@pytest.mark.parametrize("speed", [1e-4, 1e-5, 3e-6])
def test_slow_slip_of_a_ball_follows_its_own_equations_in_few_steps(speed: float, accuracy: str) -> None:
    angle = -speed * TURN / YIELD
    push = 3.5 * FRICTION * MASS * G
    ball = make.dynamic(
        "ball", make.sphere(RADIUS), mass=MASS, inertia=[0.4 * MASS * RADIUS**2] * 3, position=[0, 0, RADIUS],
        velocity=[float(speed * np.cos(angle)), float(speed * np.sin(angle)), 0.0],
    )  # fmt: skip
    force = [f"{push}*cos({TURN}*t)", f"{push}*sin({TURN}*t)", "0.0"]
    scene = make.scene(
        "creep", [make.fixed("table", make.plane()), ball], force=[{"body": "ball", "force": force}],
        contact=[{"between": ["ball", "table"], "friction": FRICTION}],
    )  # fmt: skip
    path = simulate(library_of(scene), until=0.5, accuracy=accuracy, samples=5, estimate=False)
    assert path.outcome is Outcome.DONE
    body = path.body_names.index("ball")
    slip = path.v[-1, body] + np.cross(path.w[-1, body], [0, 0, -RADIUS])
    off = {"balanced": 1e-9, "tight": 1e-11}[accuracy]
    assert np.abs(slip[:2] - slip_after(0.5, speed)).max() < off
    assert (
        path.steps < YIELD / speed * 0.5 / 20
    )  # of explicit steps, none is longer than six times speed / YIELD


def test_a_coin_that_runs_down_creeps_in_few_steps() -> None:
    """Its slip begins at 3.9465 s; explicit steps were 44,000 to 4 s and 242,000 to 4.2 s."""
    coarse, fine = (run("coin", name, until=4.1, samples=41) for name in ("balanced", "tight"))
    assert coarse.outcome is fine.outcome is Outcome.DONE
    assert not any(event.kind == "fallback-start" for event in coarse.events)
    assert coarse.steps < 10000
    assert np.abs(coarse.p - fine.p).max() < 1e-9
