"""Driven runs as environments of Gymnasium."""

from __future__ import annotations

import resource
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

pytest.importorskip("gymnasium")

import gymnasium
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode, SyncVectorEnv, VectorEnv

from modelgen import ModelgenError
from modelgen.codegen.library import Library
from modelgen.gym import make, make_vec
from tests.running import scene_of

from .test_driven_runs import LIFT, PUCK, library

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


RISE = """
[[sensor]]
name = "rise"
of = "table.velocity"
[[sensor]]
name = "ball"
of = "ball.position"
"""
LID = """
[[body]]
name = "lid"
motion = "fixed"
shape = { kind = "plane" }
position = [0, 0, 1.25]
rpy = ["pi", 0, 0]
[[contact]]
between = ["lid", "ball"]
"""
RANGE = 'hold = "linear"\nminimum = -0.1\nmaximum = 0.3'
PRESS = LIFT.replace("HEIGHT", "height").replace('hold = "linear"', RANGE) + RISE + LID
FREE = PUCK.replace('[[input]]\nname = "push"\nminimum = -50\nmaximum = 50\n', "").replace('"push"', '"1"')
FAMILY: dict[str, Any] = {
    "wheel": ("balancing_wheel", BALANCE),
    "wheel with drawn starts": ("balancing_wheel", BALANCE | {"draw": tilted}),
    "input that jumps": (PUCK, {"reward": "place_x - push", "horizon": 0.3}),
    "input on a line, runs that fail": (PRESS, {"reward": "ball_z", "every": 0.1, "horizon": 2.0}),
    "no input": (FREE, {"reward": "1", "observe": ["gap", "place"], "horizon": 0.1}),
    "no sensor": (PUCK, {"reward": "push", "observe": [], "horizon": 0.1}),
}


def model(name: str) -> Library:
    text = FAMILY[name][0]
    return library(text) if "[[" in text else scene_of(text)


class AsOne(gymnasium.Env[Any, Any]):
    """A vectorised environment whose batch is taken for one observation, as the check of Gymnasium, which
    takes single environments only, can see it."""

    def __init__(self, vector: VectorEnv[Any, Any, Any]) -> None:
        self.vector = vector
        self.observation_space, self.action_space = vector.observation_space, vector.action_space

    def reset(self, *, seed: int | None = None, options: Any = None) -> Any:
        super().reset(seed=seed)
        return self.vector.reset(seed=seed, options=options)

    def step(self, action: Any) -> Any:
        seen, reward, terminated, truncated, infos = self.vector.step(action)
        return seen, float(reward.sum()), bool(terminated.all()), bool(truncated.all()), infos


@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize("name", FAMILY)
def test_environments_pass_the_check_of_gymnasium(name: str) -> None:
    check_env(make(model(name), **FAMILY[name][1]))
    check_env(AsOne(make_vec(model(name), 3, **FAMILY[name][1])))


def test_an_episode_is_the_run_under_its_actions() -> None:
    env = make(library(PUCK), reward="place_x", observe=["speed"], every=0.1, horizon=0.3)
    first, _ = env.reset(seed=0)
    assert first == pytest.approx([0.0, 0.0, 0.0])
    v = x = 0.0
    for k, push in enumerate((4.0, -2.0, 50.0)):
        seen, reward, terminated, truncated, _ = env.step(np.array([push]))
        a = push / 2
        x, v = x + v * 0.1 + a / 2 * 0.01, v + a * 0.1
        assert seen == pytest.approx([v, 0.0, 0.0], abs=1e-9)
        assert reward == pytest.approx(x, abs=1e-9)
        assert (terminated, truncated) == (False, k == 2)


@pytest.mark.parametrize("name", FAMILY)
def test_a_vector_does_what_that_of_gymnasium_does_with_single_environments(name: str) -> None:
    """Bit for bit, over resets of episodes that ended: the contract of vectorised environments."""
    n, task = 3, FAMILY[name][1]
    ours = make_vec(model(name), n, threads=2, **task)
    theirs: VectorEnv[Any, Any, Any] = SyncVectorEnv([lambda: make(model(name), **task)] * n)
    assert ours.metadata["autoreset_mode"] == theirs.metadata["autoreset_mode"] == AutoresetMode.NEXT_STEP
    for space in ("observation_space", "action_space", "single_observation_space", "single_action_space"):
        assert getattr(ours, space) == getattr(theirs, space)
    ours.action_space.seed(5)
    over = 0
    for seed, mask in ((7, None), ([1, None, 4], None), (None, None), (3, [True, False, True])):
        masks = {} if mask is None else {"reset_mask": np.array(mask)}
        firsts = [each.reset(seed=seed, options=dict(masks)) for each in (ours, theirs)]
        assert_same(*firsts)
        assert ours.observation_space.contains(firsts[0][0])
        for _ in range(25):
            action = ours.action_space.sample()
            mine, its = ours.step(action), theirs.step(action)
            assert_same(mine, its)
            over += int((mine[2] | mine[3]).sum())
    assert over > n
    if name.endswith("fail"):
        assert set(mine[4]) == {"outcome", "_outcome", "doubts", "_doubts"}


def assert_same(mine: Any, its: Any) -> None:
    """What two environments return: arrays of equal types and values, and equal infos."""
    for one, other in zip((*mine[:-1], *mine[-1].values()), (*its[:-1], *its[-1].values()), strict=True):
        assert (one.dtype, one.shape) == (other.dtype, other.shape)
        assert np.array_equal(one, other)
    assert list(mine[-1]) == list(its[-1])


def test_an_input_on_a_line_reaches_its_action_at_the_end_of_the_step_and_begins_at_rest() -> None:
    env = make(library(PRESS.replace(LID, "")), reward="height", every=0.1)
    for _ in range(2):
        first, _ = env.reset(seed=1)
        assert first == pytest.approx([0, 0, 0, 0, 0, 0.5])
        seen, height, *_ = env.step(np.array([0.1]))
        assert (seen[2], height) == (pytest.approx(1.0), pytest.approx(0.1))
        for action in (0.3, 0.3):
            assert env.step(np.array([action]))[1] == pytest.approx(0.3)


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


def test_wrong_seeds_and_masks_are_named() -> None:
    vector = make_vec(library(PUCK), 2, reward="1")
    with pytest.raises(ModelgenError, match="seed: 3 seeds; 2; give one for each run"):
        vector.reset(seed=[1, 2, 3])
    with pytest.raises(ModelgenError, match=r"seed: 1.5; a whole number"):
        vector.reset(seed=1.5)
    with pytest.raises(ModelgenError, match=r"reset_mask: an array of shape \(2,\) and type int"):
        vector.reset(options={"reset_mask": np.array([0, 1])})


WRONG: dict[str, Callable[[Any], Any]] = {
    "one axis too many": lambda action: action[None],
    "an axis too few": lambda action: action.ravel()[0] if action.ndim == 1 else action.ravel(),
    "one number too many": lambda action: np.concatenate([action, action[..., :1]], axis=-1),
    "no numbers": lambda action: action[..., :0],
    "not finite": lambda action: np.full_like(action, np.nan),
    "infinite": lambda action: np.full_like(action, -np.inf),
    "above": lambda action: action + 1e6,
    "below": lambda action: np.full_like(action, -50.000001),
    "text": lambda action: action.astype(str),
    "none": lambda _: None,
    "complex": lambda action: action + 1j,
}


@pytest.mark.parametrize("mistake", WRONG)
@pytest.mark.parametrize("name", ["wheel", "input that jumps", "input on a line, runs that fail"])
def test_a_refused_action_changes_nothing(name: str, mistake: str) -> None:
    """An environment that refused an action, or the options of a reset, goes on as one that was not asked."""
    task = FAMILY[name][1]
    for pair in (
        [make(model(name), **task) for _ in range(2)],
        [make_vec(model(name), 2, **task) for _ in range(2)],
    ):
        asked, other = pair
        asked.action_space.seed(2)
        assert_same(asked.reset(seed=1), other.reset(seed=1))
        for _ in range(3):
            action = asked.action_space.sample()
            with pytest.raises(ModelgenError, match="step: action"):
                asked.step(WRONG[mistake](action))
            with pytest.raises(ModelgenError, match="reset: options: no option 'reset_maks'"):
                asked.reset(seed=5, options={"reset_maks": np.array([True, False])})
            assert_same(*((*map(np.asarray, each.step(action)[:-1]), {}) for each in pair))


def test_the_numbers_of_other_types_are_those_of_the_range_too() -> None:
    """A policy in single precision that cuts its actions off at a bound gives the bound, as it rounds it."""
    env = make(library(PUCK.replace("-50", "-0.1").replace("50", "0.1")), reward="push", every=0.1)
    env.reset()
    for kind in (np.float16, np.float32, np.float64):
        for bound in env.action_space.low, env.action_space.high:
            action = bound.astype(kind)
            assert env.step(action)[1] == np.clip(float(action[0]), -0.1, 0.1)
    assert env.step(np.array([0]))[1] == 0.0
    for kind in (np.float32, np.float64):
        with pytest.raises(
            ModelgenError, match=r"input 'push': 0.1; a number from -0.1 to 0.1; keep actions"
        ):
            env.step(np.nextafter(env.action_space.high.astype(kind), kind(1)))


def test_a_step_belongs_to_an_episode() -> None:
    """Of one run: between a reset and the end of the episode. Of many: after a reset of each."""
    env = make(library(PUCK), reward="place_x", every=0.1, horizon=0.2)
    for _ in range(2):
        with pytest.raises(ModelgenError, match="step: no episode is under way; call reset first"):
            env.step(np.array([1.0]))
        env.reset()
        assert [env.step(np.array([1.0]))[3] for _ in range(2)] == [False, True]
    vector = make_vec(library(PUCK), 3, reward="place_x", every=0.1, horizon=0.2)
    for lane, unset in ((1, 0), (0, 2)):
        vector.reset(options={"reset_mask": np.arange(3) == lane})
        with pytest.raises(ModelgenError, match=f"step: run {unset}: no episode is under way; call reset"):
            vector.step(np.ones((3, 1)))
    vector.reset(options={"reset_mask": np.arange(3) == 2})
    assert [bool(vector.step(np.ones((3, 1)))[3].any()) for _ in range(4)] == [False, True, False, False]


@pytest.mark.parametrize("options", [{"q": [0.0]}, ["reset_mask"], {1: 2}])
def test_unknown_options_are_refused(options: Any) -> None:
    env, vector = make(library(PUCK), reward="1"), make_vec(library(PUCK), 2, reward="1")
    for each in (env, vector):
        with pytest.raises(ModelgenError, match="reset: options: "):
            each.reset(options=options)
        each.reset(options={})
    with pytest.raises(ModelgenError, match=r"no option 'reset_mask'; there are no options"):
        env.reset(options={"reset_mask": np.array([True])})


def test_ranges_and_defaults_are_those_of_the_parameters_given() -> None:
    """The environment of a scene with other parameters is that of the scene in which they stand."""
    text = PUCK.replace("-50", '"-most"').replace("50", '"most"\ndefault = "most/2"')
    text += '\n[[parameter]]\nname = "most"\nvalue = 50\n'
    given = make(library(text), reward="push", parameters={"most": 8.0})
    written = make(library(text.replace("value = 50", "value = 8")), reward="push")
    assert given.action_space == written.action_space == gymnasium.spaces.Box(-8.0, 8.0, (1,), np.float64)
    for env in (given, written):
        env.reset()
        assert env.unwrapped._runs.many.inputs["push"] == 4.0  # type: ignore[attr-defined]
    ends = [tuple(map(np.asarray, env.step(np.array([8.0]))[:-1])) for env in (given, written)]
    assert_same(*((*end, {}) for end in ends))
    with pytest.raises(ModelgenError, match=r"from -8 to 8 in run 0, from -9 to 9 in run 1"):
        make_vec(library(text), 2, reward="push", parameters={"most": [8.0, 9.0]})


@pytest.mark.parametrize(
    "draw", [lambda _: None, lambda _: (0.0, 0.0), lambda _: (np.zeros(7), np.full(6, np.nan))]
)
def test_a_drawn_start_has_the_numbers_of_a_start(draw: Any) -> None:
    env = make(library(PUCK), reward="1", draw=draw)
    with pytest.raises(ModelgenError, match="draw"):
        env.reset()
    with pytest.raises(ModelgenError, match="no episode is under way"):
        env.step(np.array([0.0]))


@pytest.mark.slow
@pytest.mark.parametrize("name", ["wheel with drawn starts", "input that jumps"])
def test_a_million_steps_do_not_grow(name: str) -> None:
    vector = make_vec(model(name), 100, **FAMILY[name][1])
    vector.action_space.seed(0)
    vector.reset(seed=0)

    def largest(steps: int) -> int:
        """Of the resident memory so far, kB, after so many steps more."""
        for _ in range(steps):
            vector.step(vector.action_space.sample())
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss

    assert -largest(500) + largest(9500) < 2048
