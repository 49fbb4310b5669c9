"""Driven runs as environments of Gymnasium."""

from __future__ import annotations

import resource
from typing import Any

import numpy as np
import pytest

pytest.importorskip("gymnasium")

from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode

from modelgen import ModelgenError
from modelgen.gym import make, make_vec
from tests.running import scene_of

from .test_driven_runs import PUCK, library

BALANCE: dict[str, Any] = {
    "reward": "1 - lean*lean - 0.001*torque*torque",
    "terminated": "abs(lean) - 0.3",
    "every": 0.02,
    "horizon": 0.2,
}


def tilted(random: np.random.Generator) -> tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]:
    """The start of the scene, with the pole turning at random."""
    instance = scene_of("balancing_wheel").manifest.instance
    q, u = np.array(instance["initial_q"]), np.array(instance["initial_u"])
    pole = next(body for body in instance["bodies"] if body["name"] == "pole")
    u[pole["u"] + 4] = random.uniform(-0.1, 0.1)
    return q, u


@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize("draw", [None, tilted])
def test_an_environment_passes_the_check_of_gymnasium(draw: Any) -> None:
    check_env(make(scene_of("balancing_wheel"), draw=draw, **BALANCE))


def test_an_episode_is_the_run_under_its_actions() -> None:
    env = make(library(PUCK), reward="place_x", observe=["speed"], every=0.1, horizon=0.3)
    first, _ = env.reset(seed=0)
    assert first == pytest.approx([0.0, 0.0, 0.0])
    v = x = 0.0
    for k, push in enumerate((4.0, -2.0, 100.0)):  # the last is beyond the range, and cut off
        seen, reward, terminated, truncated, _ = env.step(np.array([push]))
        a = min(push, 50.0) / 2
        x, v = x + v * 0.1 + a / 2 * 0.01, v + a * 0.1
        assert seen == pytest.approx([v, 0.0, 0.0], abs=1e-9)
        assert reward == pytest.approx(x, abs=1e-9)
        assert (terminated, truncated) == (False, k == 2)


def test_runs_of_a_vector_are_runs_of_their_own_and_are_reset_in_the_step_after_their_end() -> None:
    n, steps = 3, 14
    vector = make_vec(scene_of("balancing_wheel"), n, threads=2, **BALANCE)
    assert vector.metadata["autoreset_mode"] == AutoresetMode.NEXT_STEP
    singles = [make(scene_of("balancing_wheel"), **BALANCE) for _ in range(n)]
    seen, _ = vector.reset(seed=1)
    assert vector.observation_space.contains(seen)
    shown = [single.reset()[0] for single in singles]
    over = [False] * n
    for k in range(steps):
        actions = np.array([[(-1) ** lane * (lane + k)] for lane in range(n)], dtype=float)
        seen, reward, terminated, truncated, _ = vector.step(actions)
        for lane, single in enumerate(singles):
            if over[lane]:
                shown[lane], over[lane] = single.reset()[0], False
                assert (reward[lane], terminated[lane], truncated[lane]) == (0.0, False, False)
            else:
                shown[lane], gain, ends, cut, _ = single.step(actions[lane])
                assert (reward[lane], terminated[lane], truncated[lane]) == (gain, ends, cut)
                over[lane] = ends or cut
            assert np.array_equal(seen[lane], shown[lane])
    assert any(over) or vector.step(actions)[2].any()


def test_episodes_of_one_seed_are_equal() -> None:
    def episode(seed: int) -> np.ndarray[Any, Any]:
        vector = make_vec(scene_of("balancing_wheel"), 2, draw=tilted, **BALANCE)
        vector.reset(seed=seed)
        return np.array([vector.step(np.zeros((2, 1)))[0] for _ in range(5)])

    assert np.array_equal(episode(3), episode(3))
    assert not np.array_equal(episode(3), episode(4))


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"reward": "leen"}, "unknown name 'leen'"),
        ({"observe": ["leen"]}, "did you mean 'lean'"),
        ({"every": 0.0}, "a positive time"),
        ({"horizon": -1.0}, "a positive time"),
    ],
)
def test_mistakes(keys: dict[str, Any], words: str) -> None:
    with pytest.raises(ModelgenError, match=words):
        make(scene_of("balancing_wheel"), **(BALANCE | keys))


def test_an_action_needs_a_range() -> None:
    with pytest.raises(ModelgenError, match=r"input 'push': no maximum; an action needs a range"):
        make(library(PUCK.replace("maximum = 50\n", "")), reward="1")


@pytest.mark.slow
def test_a_million_steps_do_not_grow() -> None:
    vector = make_vec(library(PUCK), 100, reward="place_x", every=0.02, horizon=1.0)
    vector.reset(seed=0)
    actions = np.zeros((100, 1))
    for _ in range(500):
        vector.step(actions)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    for _ in range(9500):
        vector.step(actions)
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 2048  # kB
