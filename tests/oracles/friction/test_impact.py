"""The references of impacts: laws obeyed, integration of the impulse, published outcomes."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from tests.oracles.friction.impact import Planar, at_once, chained, inverse_mass, newton, quarter_swing

RNG = np.random.default_rng(5)


def blows(count: int) -> list[tuple[np.ndarray, np.ndarray]]:
    out = []
    for _ in range(count):
        inertia = np.diag(RNG.uniform(0.5, 1.0, 3)) * 1e-2
        turned = np.linalg.qr(RNG.normal(size=(3, 3)))[0]
        G = inverse_mass(1.5, inertia, turned, RNG.normal(size=3) * 0.05)
        u = np.array([*RNG.normal(size=2), -RNG.uniform(0.2, 2)])
        out.append((G, u))
    return out


@pytest.mark.cases(2)
@pytest.mark.parametrize("mu", [0.0, 0.1, 0.3, 1.0])
def test_a_blow_in_space_obeys_newton_and_coulomb(mu: float) -> None:
    for G, u in blows(40):
        found = newton(G, u, 0.5, mu)
        assert len(found) == 1 or mu == 1
        for impulse, after in found:
            assert after == pytest.approx(u + G @ impulse, abs=1e-12)
            assert after[2] == pytest.approx(-0.5 * u[2], abs=1e-12)
            speed = np.hypot(*after[:2])
            assert np.hypot(*impulse[:2]) <= mu * impulse[2] * (1 + 1e-12)
            if speed > 1e-12:
                assert impulse[:2] == pytest.approx(-mu * impulse[2] * after[:2] / speed, abs=1e-10)


def test_a_rod_whose_tip_strikes_has_its_inverse_mass() -> None:
    # rod of length 2, mass 3, at 45 degrees: 1/m + l^2 cos^2 / I along the normal
    G = inverse_mass(3.0, np.eye(3), np.eye(3), np.array([-np.sqrt(0.5), 0, -np.sqrt(0.5)]))
    assert G[2, 2] == pytest.approx(1 / 3 + 0.5)
    assert G[0, 2] == pytest.approx(-0.5)


def integrated(blow: Planar, normal: float, steps: int = 40000) -> tuple[float, float, float, float]:
    """The same by small steps of the normal impulse."""
    tangential, u_t, u_n, work, h = 0.0, blow.u_t, blow.u_n, 0.0, normal / steps
    for _ in range(steps):
        # implicit friction: sticks where it can
        share = np.clip(-(u_t / h + blow.b) / blow.a, -blow.mu, blow.mu)
        u_t += (blow.b + blow.a * share) * h
        work += (u_n + (blow.c + blow.b * share) * h / 2) * h
        u_n += (blow.c + blow.b * share) * h
        tangential += share * h
    return tangential, u_t, u_n, work


BLOWS = {
    "slips on": Planar(1.4, 0.3, 1.1, 0.2, 3.0, -1.0),
    "comes to stick": Planar(1.4, 0.3, 1.1, 0.6, 0.2, -1.0),
    "reverses": Planar(1.4, -0.9, 1.6, 0.3, 0.1, -1.0),
    "starts at rest and slips": Planar(1.4, 0.9, 1.6, 0.3, 0.0, -1.0),
}


@pytest.mark.cases(2)
@pytest.mark.parametrize("name", BLOWS)
def test_a_blow_in_the_plane_is_the_sum_of_small_ones(name: str) -> None:
    blow = BLOWS[name]
    end = blow.poisson(0.5)
    assert blow.at(end) == pytest.approx(integrated(blow, end), abs=2e-4)
    slip = blow.at(end)[1]
    sticks = name == "comes to stick"
    assert np.sign(slip if abs(slip) > 1e-14 else 0) == (0 if sticks else -1 if name == "reverses" else 1)


@pytest.mark.parametrize("e", [0.0, 0.3, 0.8, 1.0])
@pytest.mark.parametrize("name", BLOWS)
def test_the_three_laws_are_what_they_say_and_stronges_takes_energy(name: str, e: float) -> None:
    blow = BLOWS[name]
    least = blow.compression
    assert blow.at(least)[2] == pytest.approx(0, abs=1e-15)
    assert blow.poisson(e) - least == pytest.approx(e * least, abs=1e-15)
    assert blow.at(blow.newton(e))[2] == pytest.approx(-e * blow.u_n, abs=1e-14)
    end = blow.stronge(e)
    back = blow.at(end)[3] - blow.at(least)[3]
    assert back == pytest.approx(-e * e * blow.at(least)[3], abs=1e-14)
    G, before = np.array([[blow.a, blow.b], [blow.b, blow.c]]), np.array([blow.u_t, blow.u_n])
    tangential, u_t, u_n, _ = blow.at(end)
    gained = np.array([tangential, end]) @ (before + np.array([u_t, u_n])) / 2
    assert before + G @ [tangential, end] == pytest.approx([u_t, u_n], abs=1e-14)
    assert gained <= 1e-14


def test_newtons_law_gives_energy_to_slip_that_reverses() -> None:
    # slip that reverses: Newton's law with e = 1 gives energy, Stronge's does not (Stronge 1990)
    blow = Planar(1.4, -1.25, 1.6, 0.5, 0.8, -1.0)
    gains = {}
    for law in ("newton", "poisson", "stronge"):
        end = getattr(blow, law)(1.0)
        tangential, u_t, u_n, _ = blow.at(end)
        gains[law] = (tangential * (blow.u_t + u_t) + end * (blow.u_n + u_n)) / 2
    assert gains["newton"] > 1e-3
    assert gains["stronge"] <= 0


def test_without_slip_at_the_start_and_coupling_all_laws_agree() -> None:
    blow = Planar(1.4, 0.0, 1.1, 0.3, 0.5, -1.0)
    assert blow.newton(0.6) == pytest.approx(blow.poisson(0.6)) == pytest.approx(blow.stronge(0.6))


def test_a_cradle_passes_its_speeds_on_and_a_simultaneous_law_does_not() -> None:
    masses = np.ones(5)
    assert chained(np.array([1.0, 1, 0, 0, 0]), masses, 1.0) == pytest.approx([0, 0, 0, 1, 1])
    assert at_once(np.array([1.0, 0, 0]), np.ones(3), 1.0) == pytest.approx([-1 / 3, 2 / 3, 2 / 3])


@settings(max_examples=25, deadline=None)
@given(st.lists(st.floats(-2, 2), min_size=3, max_size=5), st.sampled_from([0.0, 0.5, 0.9, 1.0]))
def test_blows_in_a_line_keep_momentum_and_gain_no_energy(v: list[float], e: float) -> None:
    speeds, masses = np.array(v), np.linspace(1, 2, len(v))
    for after in ([chained(speeds, masses, e)] if e > 0.4 else []) + [at_once(speeds, masses, e)]:
        assert masses @ after == pytest.approx(masses @ speeds, abs=1e-10)
        assert masses @ after**2 <= masses @ speeds**2 + 1e-10


def test_a_ball_of_a_cradle_comes_down_in_a_quarter_of_its_period() -> None:
    down = lambda _, y: [y[1], -9.81 / 0.3 * np.sin(y[0])]  # noqa: E731
    bottom = lambda _, y: y[0]  # noqa: E731
    bottom.terminal = True
    ran = solve_ivp(down, (0, 1), [0.7, 0.0], "DOP853", events=[bottom], rtol=1e-13, atol=1e-14)
    assert ran.t[-1] == pytest.approx(quarter_swing(0.7, 0.3), abs=1e-12)
