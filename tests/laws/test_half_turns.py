"""Loads that read the quaternion of a body, which jumps where the body passes half a turn.

Against Euler's equations with a quaternion that is continuous, by scipy's DOP853 from half turn to half turn.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import cos
from random import Random

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from modelgen import Accuracy, derive, emit, require, sensitivity, simulate
from modelgen.codegen.library import Library
from modelgen.rotations import rotation_of
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene.read import read_text
from tests.running import compiled, library_of

ACCURACIES = ("fast", "balanced", "tight")
RESOLVED = 2e-11  # of the other integrator, relative
SLOW = 1e-2  # 1/s: rates of qw at half a turn below are too near to a graze
UNTIL = 4.0
MASS, INERTIA = 2.0, np.array([0.7, 1.0, 1.2])
QUATERNION = ("qw", "qx", "qy", "qz")

TURNING = """
gravity = [0.0, 0.0, 0.0]
[[body]]
name = "b"
mass = 2.0
inertia = [0.7, 1.0, 1.2]
quaternion = {turn}
angular_velocity = {spin}
[[torque]]
body = "b"
torque = {torque}
[[force]]
body = "b"
force = {force}
"""


def built(
    torque: Sequence[str], force: Sequence[str], turn: Sequence[float], spin: Sequence[float]
) -> Library:
    text = TURNING.format(torque=list(torque), force=list(force), turn=list(turn), spin=list(spin))
    return library_of(read_text(text, "scene.toml"))


def drawn(random: Random) -> str:
    """A sum of products of one to three entries."""
    terms = []
    for _ in range(random.randint(1, 3)):
        factors = [random.choice(QUATERNION) for _ in range(random.randint(1, 3))]
        terms.append("*".join([f"{random.uniform(-1, 1):.3f}", *factors]))
    return " + ".join(terms)


def half_turns_and_end(
    loads: Sequence[str], turn: Sequence[float], spin: Sequence[float]
) -> tuple[int, np.ndarray]:
    """Number of half turns up to the end, and there place, velocity, quaternion and spin in world axes."""
    codes = [compile(load, "load", "eval") for load in loads]
    state, t, count = np.array([0] * 6 + [*turn, *(rotation_of(turn).T @ np.array(spin))], float), 0.0, 0
    side = 1.0 if state[6] > 0 else -1.0

    def rate(t: float, state: np.ndarray) -> np.ndarray:
        w, v, spin = state[6], state[7:10], state[10:]
        values = dict(zip(QUATERNION, side * state[6:10], strict=True))
        given = np.array([eval(code, {"cos": cos}, values) for code in codes])
        unit = state[6:10] / np.linalg.norm(state[6:10])
        torque = rotation_of(tuple(unit)).T @ given[:3]
        turning = [-v @ spin / 2, *((w * spin + np.cross(v, spin)) / 2)]
        return np.array(
            [
                *state[3:6],
                *(given[3:] / MASS),
                *turning,
                *((torque - np.cross(spin, INERTIA * spin)) / INERTIA),
            ]
        )

    def half_turn(t: float, state: np.ndarray) -> float:
        return side * state[6]

    half_turn.terminal, half_turn.direction = True, -1  # type: ignore[attr-defined]
    while t < UNTIL:
        piece = solve_ivp(
            rate, (t, UNTIL), state, "DOP853", events=half_turn, rtol=3e-14, atol=1e-14, max_step=0.02
        )
        t, state = piece.t[-1], piece.y[:, -1]
        if piece.status == 1:
            if abs(rate(t, state)[6]) < SLOW:
                pytest.skip("the half turn is only touched")
            count, side = count + 1, -side
    w = rotation_of(tuple(state[6:10])) @ state[10:]
    return count, np.array([*state[:10], *w])


def run(library: Library, accuracy: str) -> Trajectory:
    return simulate(library, until=UNTIL, accuracy=getattr(Accuracy, accuracy)())


def unit(random: Random) -> list[float]:
    drawn = np.array([random.gauss(0, 1) for _ in range(4)])
    return list(map(float, drawn / np.linalg.norm(drawn)))


@pytest.mark.cases(5)
@pytest.mark.parametrize("seed", range(60))
def test_a_half_turn_is_an_event(seed: int) -> None:
    random = Random(seed)
    torque, force = ([drawn(random) for _ in range(3)] for _ in range(2))
    turn, spin = unit(random), [round(random.uniform(-2, 2), 3) for _ in range(3)]
    count, end = half_turns_and_end([*torque, *force], turn, spin)
    library = built(torque, force, turn, spin)
    for accuracy in ACCURACIES:
        path = run(library, accuracy)
        assert not path.doubts
        assert path.estimate is not None
        assert {event.kind for event in path.events} <= {"load-switch"}
        assert len({round(event.t, 6) for event in path.events}) == count
        known = RESOLVED * (1 + float(np.abs(end).max()))
        assert np.linalg.norm(path.p[-1, 0] - end[:3]) <= path.estimate.position[-1] + known
        assert np.linalg.norm(path.v[-1, 0] - end[3:6]) <= path.estimate.velocity[-1] + known
        assert np.linalg.norm(path.w[-1, 0] - end[10:]) <= path.estimate.spin[-1] + known


TURN, SPIN = (1.0, 0.0, 0.0, 0.0), (0.3, -0.2, 1.7)


@pytest.mark.parametrize("force", ["1 - 2*(qy**2 + qz**2)", "abs(qz)", "2*(qx*qy - qw*qz)", "cos(3*qw)"])
def test_a_load_that_is_the_same_with_both_quaternions_does_not_jump(force: str) -> None:
    """abs(qz) has its kinks where qz is zero."""
    count, end = half_turns_and_end(["0", "0", "0", force, "0", "0"], TURN, SPIN)
    path = run(built(["0", "0", "0"], [force, "0", "0"], TURN, SPIN), "balanced")
    assert count
    assert not path.doubts
    assert path.estimate is not None
    assert np.linalg.norm(path.p[-1, 0] - end[:3]) <= path.estimate.position[-1] + RESOLVED
    assert len(path.events) == (force == "abs(qz)")


def test_a_start_on_half_a_turn_takes_the_side_to_which_it_turns() -> None:
    """A turn by pi + 2 t is one by -pi + 2 t, of which qz is negative."""
    for sign in (1, -1):
        path = run(built(["0", "0", "0"], ["qz", "0", "0"], (0, 0, 0, 1), (0, 0, 0.7 * sign)), "balanced")
        assert not path.doubts
        assert np.all(sign * path.v[1:, 0, 0] < 0)


@pytest.mark.parametrize("force", ["qz", "qw*qx + qy", "sign(qz)"])
def test_derivatives_over_half_a_turn(force: str) -> None:
    def scene(spin: Sequence[float]) -> str:
        loads = {"torque": ["0", "0", "0"], "force": [force, "0", "0"]}
        return TURNING.format(turn=list(TURN), spin=[float(w) for w in spin], **loads)

    library = compiled(emit(derive(require(read_text(scene(SPIN)))), derivatives=True))
    found = sensitivity(library, UNTIL, of=["b.position"], by=["b.angular_velocity"], accuracy="tight")
    assert found.verdict
    for axis in range(3):
        step = 1e-4 * np.eye(3)[axis]
        ends = [
            run(library_of(read_text(scene(SPIN + sign * step))), "tight").p[-1, 0, 0] for sign in (1, -1)
        ]
        assert found.jacobian[-1, 0, axis] == pytest.approx((ends[0] - ends[1]) / 2e-4, rel=1e-5, abs=1e-6)
