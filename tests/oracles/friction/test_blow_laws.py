"""Restitution by Newton, Poisson and Stronge along the blow, several contacts in turn, forces left open."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from modelgen import Accuracy, simulate
from modelgen.codegen.library import Library
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene import python_scenes as make
from modelgen.scene.read import read_text
from tests.oracles.friction.impact import Planar, at_once, chained, inverse_mass
from tests.oracles.friction.painleve import INDETERMINATE, PARTS, Rod
from tests.oracles.pieces import TABLE, imbalance, ran, times
from tests.running import SCENES, library_of

LAWS = ("newton", "poisson", "stronge")
TURNS = replace(Accuracy.tight(), impacts="sequential")
INERTIA = np.array([0.01, 1 / 12, 1 / 12])
ASIDE, ABOUT = [0.02, 0.01, -0.02], (4e-3, 3e-3, 1.5e-3)


def rod_struck(law: str, e: float, mu: float, angle: float, spin: float) -> tuple[Trajectory, Planar, Any]:
    """A rod whose end strikes the table at t = 0, its blow in the plane, and its rows over vx, vz, spin."""
    arm = 0.5 * np.array([np.cos(angle), -np.sin(angle)])
    rod = make.dynamic(
        "rod", make.point(0.5, 0.0, 0.0), mass=1.0, inertia=list(INERTIA), rpy=[0, angle, 0],
        position=[-arm[0], 0, -arm[1]], velocity=[0.0, 0.0, -1.0], angular_velocity=[0, spin, 0],
    )  # fmt: skip
    contact = {"between": ["rod", "table"], "friction": mu, "restitution": {"law": law, "value": e}}
    path = ran([rod, TABLE], 1e-3, [contact], TURNS, samples=1, gravity=[0, 0, 0])
    rows = np.array([[1, 0, arm[1]], [0, 1, -arm[0]]])
    G = rows @ np.diag([1, 1, 1 / INERTIA[1]]) @ rows.T
    u = rows @ [0.0, -1.0, spin]
    return path, Planar(G[0, 0], G[0, 1], G[1, 1], mu, u[0], u[1]), rows


BLOWS = [
    (0.6, 0.1, 0.8, -1.5), (0.6, 0.9, 0.8, 0.4), (0.6, 0.5, 0.5, 1.0), (0.9, 0.7, 0.8, 3.0),
    (0.0, 0.4, 1.2, 1.0),
]  # fmt: skip


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize(("e", "mu", "angle", "spin"), BLOWS)
def test_a_rod_leaves_a_blow_as_its_law_says(
    law: str, e: float, mu: float, angle: float, spin: float
) -> None:
    path, blow, rows = rod_struck(law, e, mu, angle, spin)
    normal = getattr(blow, law)(e)
    tangential, u_t, u_n, _ = blow.at(normal)
    after = np.array([0.0, -1.0, spin]) + np.diag([1, 1, 1 / INERTIA[1]]) @ rows.T @ [tangential, normal]
    found = [path.v[-1, 0, 0], path.v[-1, 0, 2], path.w[-1, 0, 1]]
    if u_n > 1e-9:
        assert found == pytest.approx(after, abs=1e-12)
    gain = (tangential * (blow.u_t + u_t) + normal * (blow.u_n + u_n)) / 2
    assert any("made" in warning for warning in path.warnings) == (gain > 1e-12)
    assert imbalance(path) < 1e-12


def swept(G: Any, u: Any, e: float, mu: float) -> Any:
    """The impulse (t1, t2, n) of Stronge's law, the blow integrated by a library, to where slip has died."""

    def share(u: Any, held: Any) -> Any:
        slip = np.hypot(u[0], u[1])
        return held if held is not None else -mu * u[:2] / slip

    def slope(p: float, y: Any, held: Any) -> Any:
        push = np.array([*share(y, held), 1.0])
        return [*(G @ push), *push[:2], y[2]]

    def dies(p: float, y: Any, held: Any) -> float:
        return float(np.hypot(y[0], y[1]) - 1e-9) if held is None else 1.0

    y, p, held, worst = np.array([*u, 0.0, 0.0, 0.0]), 0.0, None, None
    while True:
        aim = worst

        def over(p: float, y: Any, held: Any, aim: Any = aim) -> float:
            return float(y[2] if aim is None else y[5] - (1 - e * e) * aim)

        over.terminal, over.direction = True, 1.0  # type: ignore[attr-defined]
        dies.terminal = True  # type: ignore[attr-defined]
        found = solve_ivp(
            slope, (p, p + 20), y, "DOP853", args=(held,), events=(over, dies), rtol=1e-13, atol=1e-15
        )
        y, p = found.y[:, -1], float(found.t[-1])
        if len(found.t_events[1]):
            held = np.linalg.solve(G[:2, :2], -G[:2, 2])
            assert np.hypot(*held) <= mu
            y[:2] = 0
        elif worst is None:
            worst = y[5]
        else:
            return np.array([y[3], y[4], p])


@pytest.mark.parametrize(("mu", "sticks"), [(0.05, False), (1.5, True)])
def test_slip_that_turns_during_a_blow_is_followed_round(mu: float, sticks: bool) -> None:
    axes, inertia, turn = (
        np.array([0.1, 0.07, 0.05]),
        [2e-3, 3e-3, 4e-3],
        Rotation.from_euler("xyz", [0.4, 0.7, 0.2]),
    )
    R = turn.as_matrix()
    height = float(np.linalg.norm(axes * R[2]))
    velocity, spin = [0.5, -0.3, -2.0], [6.0, 9.0, -4.0]
    egg = make.dynamic(
        "egg", make.ellipsoid(*axes), mass=1.0, inertia=inertia, position=[0, 0, height],
        quaternion=list(np.roll(turn.as_quat(), 1)), velocity=velocity, angular_velocity=spin,
    )  # fmt: skip
    contact = {"between": ["egg", "table"], "friction": mu, "restitution": {"law": "stronge", "value": 0.7}}
    path = ran([egg, TABLE], 1e-6, [contact], samples=1, gravity=[0, 0, 0])
    arm = -R @ (axes**2 * R[2]) / height
    impulse = swept(inverse_mass(1.0, np.diag(inertia), R, arm), velocity + np.cross(spin, arm), 0.7, mu)
    assert path.v[-1, 0] - velocity == pytest.approx(impulse, rel=1e-8)
    slip = path.v[-1, 0] + np.cross(path.w[-1, 0], arm)
    assert bool(np.hypot(*slip[:2]) < 1e-4) == sticks
    assert path.work[-1] < -0.1
    assert imbalance(path) < 1e-12


def off_centre(velocity: list[float], law: str, real: str) -> Trajectory:
    """A ball strikes the table at t = 0, under a centre of mass that lies beside its own."""
    shape = make.sphere(0.05, position=ASIDE)
    inertia = list(ABOUT)
    hit = make.dynamic(
        "ball", shape, mass=1.0, inertia=inertia, position=[0, 0, 0.05 - ASIDE[2]], velocity=velocity
    )
    contact = {"between": ["ball", "table"], "friction": 0.3, "restitution": {"law": law, "value": 0.6}}
    scene = make.scene("aside", [hit, TABLE], contact=[contact], gravity=[0, 0, 0])
    return simulate(library_of(scene, real), accuracy=Accuracy.tight(), until=1e-6, samples=1, estimate=False)


@pytest.mark.cases(1)
@pytest.mark.parametrize("seed", range(6))
def test_a_blow_is_followed_to_rounding(seed: int) -> None:
    """In the real type of the run; the library's integration ends slip at 1e-9 m/s."""
    angle = np.random.default_rng(seed).uniform(0, 2 * np.pi)
    velocity = [1.2 * np.cos(angle), 1.2 * np.sin(angle), -1.0]
    for law in ("poisson", "stronge"):
        path, finer = (off_centre(velocity, law, real) for real in ("double", "long double"))
        assert np.abs(path.v[-1, 0] - finer.v[-1, 0]).max() < 1e-14
        assert np.abs(path.w[-1, 0] - finer.w[-1, 0]).max() < 2e-13
    arm = np.array([*ASIDE[:2], ASIDE[2] - 0.05])
    impulse = swept(inverse_mass(1.0, np.diag(ABOUT), np.eye(3), arm), np.array(velocity), 0.6, 0.3)
    slip = np.hypot(*(path.v[-1, 0] + np.cross(path.w[-1, 0], arm))[:2])
    assert np.abs(path.v[-1, 0] - velocity - impulse).max() < (1e-14 if slip > 1e-3 else 1e-8)


@cache
def cradle() -> Library:
    """The shipped cradle with its balls touching."""
    text = (SCENES / "newton_cradle.toml").read_text(encoding="utf-8").replace("0.0401", "0.04")
    return library_of(read_text(text, "cradle.toml"))


def test_touching_balls_pass_a_blow_on_in_turn_and_share_it_at_once() -> None:
    passed = simulate(cradle(), until=0.3, accuracy=TURNS, samples=3000)
    shared = simulate(cradle(), until=0.3, samples=3000)
    assert [event.kind for event in passed.events] == ["impact"] * 4
    (struck,) = times(shared, "impact")
    k = int(np.searchsorted(shared.t, struck))
    ones = np.ones(5)
    for path, law in ((passed, chained), (shared, at_once)):
        balls = [path.body_names.index(f"ball_{k}") for k in range(5)]
        before, after = path.v[k - 1, balls, 0], path.v[k, balls, 0]
        assert after == pytest.approx(law(before, ones, 1.0), abs=2e-3)
        assert path.energy_drift < 1e-9
    assert passed.warnings == ()
    assert any("reached ball_" in warning for warning in shared.warnings)


LANDS = (np.hypot(0.2, np.sqrt(2 * 9.81 * 0.02)) - 0.2) / 9.81


def fallen_flat(law: str, e: float, until: float, **keys: object) -> Trajectory:
    """A cube that meets the table with its whole face."""
    cube = make.dynamic("cube", make.box(0.1, 0.1, 0.1), density=700.0, position=[0, 0, 0.05 + 0.02])
    rests = {"between": ["cube", "table"], "restitution": {"law": law, "value": e}, **keys}
    body = replace(cube, velocity=(0.0, 0.0, -0.2))
    return ran([body, TABLE], until, [rests], TURNS, samples=1)


def struck_in_turn(speed: float, e: float, rest: float) -> np.ndarray:
    """(vz, wx, wy) after its corners were struck one by one, the fastest first."""
    rows = np.array([[1.0, y, -x] for x in (-0.05, 0.05) for y in (-0.05, 0.05)])
    answer = np.diag([1, 6 / 0.01, 6 / 0.01]) / 0.7
    u = np.array([-speed, 0.0, 0.0])
    while (rates := rows @ u).min() < -rest:
        row = rows[int(np.argmin(rates))]
        u += answer @ row * -(1 + (e if -e * rates.min() > rest else 0)) * rates.min() / (row @ answer @ row)
    return u


@pytest.mark.parametrize("e", [0.0, 0.3, 0.8, 1.0])
@pytest.mark.parametrize("law", LAWS)
def test_a_face_struck_corner_by_corner_keeps_what_the_blows_leave(law: str, e: float) -> None:
    """What a blow elsewhere pushes off parts: it is not held by a contact that it has only just met."""
    path = fallen_flat(law, e, until=LANDS + 1e-8)
    wanted = struck_in_turn(0.2 + 9.81 * LANDS, e, 1e-6)
    assert path.v[-1, 0, 2] == pytest.approx(wanted[0], abs=1e-6)
    assert np.sort(np.abs(path.w[-1, 0, :2])) == pytest.approx(np.sort(np.abs(wanted[1:])), abs=2e-5)


@pytest.mark.cases(5)
@pytest.mark.parametrize("mu", [0.0, 0.5])
@pytest.mark.parametrize("e", [0.3, 0.8])
@pytest.mark.parametrize("law", LAWS)
def test_a_face_struck_corner_by_corner_keeps_its_energy_and_order(law: str, e: float, mu: float) -> None:
    path = fallen_flat(law, e, until=0.5, **({"friction": mu} if mu else {}))
    assert imbalance(path) < 1e-9
    assert all(event.speed >= 0 and 0 <= event.t <= path.t_end for event in path.events)
    assert path.energy[-1] < path.energy[0]


@pytest.mark.parametrize("wanted", [INDETERMINATE, PARTS])
def test_a_rod_that_might_slip_on_or_part_is_not_trusted(wanted: str) -> None:
    """Painleve: where Coulomb's law has two solutions the motion is one of several, and the run says so."""
    random, found = np.random.default_rng(3), 0
    while found < 12:
        theta, mu, rate = random.uniform(0.2, 1.4), random.uniform(0.3, 3.0), random.uniform(5.0, 12.0)
        if Rod().outcome(theta, rate, mu) != wanted:
            continue
        found += 1
        c, s = 0.5 * np.cos(theta), 0.5 * np.sin(theta)
        rod = make.dynamic(
            "rod", make.point(-0.5, 0.0, 0.0), mass=1.0, inertia=[1e-4, 1 / 12, 1 / 12], rpy=[0, -theta, 0],
            position=[c, 0, s], velocity=[-4.0 - rate * s, 0, rate * c], angular_velocity=[0, -rate, 0],
        )  # fmt: skip
        path = ran([rod, TABLE], 1e-3, [{"between": ["rod", "table"], "friction": mu}])
        assert path.is_trusted == (wanted == PARTS), path.doubts
        assert path.indeterminate_t == (0.0 if wanted == INDETERMINATE else None)
        assert any("one of several" in reason for reason in path.doubts) == (wanted == INDETERMINATE)


@pytest.mark.parametrize("e", [0.9, 1.0])
def test_a_blow_that_gains_energy_is_not_trusted(e: float) -> None:
    """Newton's restitution with friction may add energy (Kane's rod); Stronge's does not."""
    gained = set()
    for angle in np.linspace(0.3, 1.2, 4):
        for spin in np.linspace(-3.0, 3.0, 5):
            for law in LAWS:
                path, _, _ = rod_struck(law, e, 0.6, angle, spin)
                before = 0.5 + INERTIA[1] * spin**2 / 2
                made = path.energy[-1] - before
                told = any("made" in reason for reason in path.doubts)
                assert told == (made > 1e-6 * path.energy.max()), (law, angle, spin, made)
                gained |= {law} if told else set()
    assert gained == {"newton"}


def test_time_stepping_says_that_it_follows_newtons_law() -> None:
    ball = make.dynamic("ball", make.sphere(0.1), mass=1.0, inertia=[4e-3] * 3, position=[0, 0, 0.2])
    contact = {"between": ["ball", "table"], "restitution": {"law": "stronge", "value": 0.5}}
    path = ran([ball, TABLE], 0.01, [contact], Accuracy.fast().time_stepping(1e-3))
    assert any("Newton's law of impact" in warning for warning in path.warnings)
