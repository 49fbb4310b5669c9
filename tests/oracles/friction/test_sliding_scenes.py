"""Scenes that slip, against their references."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from modelgen import Accuracy
from modelgen.scene import python_scenes as make
from tests.oracles.friction.on_plane import P, T, V, W, rotation_of, slid_out, solid_ellipsoid, start
from tests.oracles.friction.sphere import SlideToRoll
from tests.oracles.pieces import TABLE, G, ball, imbalance, ran, times
from tests.running import run

ON_TABLE = ("ball", "table")
speeds = st.floats(-3, 3)


def test_a_ball_comes_to_roll_as_published() -> None:
    path = run("sphere_slide_to_roll", Accuracy.tight())
    thrown = SlideToRoll(0.1, 0.2, path.p[0, 1], path.v[0, 1], path.w[0, 1])
    assert times(path, "slip-stop") == [pytest.approx(thrown.rolls_at, abs=1e-12)]
    assert np.abs(path.p[:, 1] - thrown.path(path.t)).max() < 1e-12
    slides = path.t < thrown.rolls_at
    assert path.friction[slides, 0, 0] == pytest.approx(-0.2 * G, rel=1e-12)
    assert np.abs(path.friction[~slides]).max() < 1e-12
    assert imbalance(path) < 1e-14


@settings(max_examples=15, deadline=None)
@given(st.tuples(speeds, speeds), st.tuples(*[st.floats(-30, 30)] * 3), st.floats(0.05, 1.0))
def test_all_directions_are_alike(v: tuple[float, float], w: tuple[float, float, float], mu: float) -> None:
    thrown = SlideToRoll(0.1, mu, np.array([0, 0, 0.1]), np.array([*v, 0.0]), np.array(w))
    if not 1e-3 < thrown.rolls_at < 2:
        return
    moving = ball("ball", [0, 0, 0.1], velocity=[*v, 0.0], angular_velocity=list(w))
    path = ran([moving, TABLE], 2.0, [{"between": ON_TABLE, "friction": mu}])
    assert times(path, "slip-stop") == [pytest.approx(thrown.rolls_at, abs=1e-11)]
    assert np.abs(path.p[:, 0] - thrown.path(path.t)).max() < 1e-11


def test_slip_that_turns_while_it_dies_ends_where_it_does_in_slower_time() -> None:
    body = solid_ellipsoid([0.1, 0.07, 0.05], 1000, mu=0.3)
    end = slid_out(body, start(body, np.eye(3), [0, 0, 10], [1, 0.3, 0]), 1e-15)
    egg = make.dynamic(
        "egg", make.ellipsoid(0.1, 0.07, 0.05), density=1000.0, position=[0, 0, 0.05],
        velocity=[1.0, 0.3, 0.0], angular_velocity=[0, 0, 10.0],
    )  # fmt: skip
    dies, R = float(end[T]), rotation_of(end)
    path = ran([egg, TABLE], dies + 1e-6, [{"between": ("egg", "table"), "friction": 0.3}], samples=1)
    assert times(path, "slip-stop") == [pytest.approx(dies, abs=1e-12)]
    path = ran([egg, TABLE], dies, [{"between": ("egg", "table"), "friction": 0.3}], samples=1)
    assert path.p[-1, 0] == pytest.approx(end[P].astype(float), abs=1e-12)
    assert path.v[-1, 0] == pytest.approx((R @ end[V]).astype(float), abs=1e-11)
    assert path.w[-1, 0] == pytest.approx((R @ end[W]).astype(float), abs=1e-10)


def test_a_block_slips_when_it_is_pulled_hard_enough() -> None:
    path = run("block_on_incline", Accuracy.tight())
    down, press, mass = G * np.sin(0.3), G * np.cos(0.3), 1.0
    slips = (down + 0.5 * press) * mass / 16
    assert times(path, "slip-start") == [pytest.approx(slips, abs=1e-8)]
    after = path.t[path.t > slips] - slips
    exact = (0.5 - 0.4) * press * after**2 / 2 + 16 * after**3 / 6
    assert path.p[path.t > slips, 1, 0] == pytest.approx(-exact, abs=1e-7)
    held = path.t < slips
    assert np.abs(path.p[held, 1] - path.p[0, 1]).max() < 1e-12
    friction = path.patch_friction[:, 0]
    assert friction[held, 0] == pytest.approx(16 * path.t[held] - down, abs=1e-9)
    assert (np.linalg.norm(friction, axis=-1) <= 0.5 * path.patch_force[:, 0] + 1e-9).all()
    assert imbalance(path) < 1e-11
