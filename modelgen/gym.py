"""Driven runs as environments of Gymnasium (extra `rl`): actions are inputs, observations are sensors."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, TypedDict, Unpack

import casadi as ca
import numpy as np

from modelgen.codegen.library import Library
from modelgen.codegen.sensor_expressions_function import expressions_function
from modelgen.errors import ModelgenError
from modelgen.name_suggestions import nearest
from modelgen.runtime.accuracy import Accuracy
from modelgen.runtime.arguments import check_span
from modelgen.runtime.stepped_simulations import Simulations, start_many
from modelgen.scene.scene_types import Scene

try:
    import gymnasium
    from gymnasium.utils import seeding
    from gymnasium.vector import AutoresetMode
    from gymnasium.vector.utils import batch_space
except ImportError:
    raise ModelgenError(
        "modelgen.gym", "no package 'gymnasium'", "", 'run: pip install "modelgen[rl]"'
    ) from None

Array = np.ndarray[Any, Any]
Draw = Callable[[np.random.Generator], tuple[Array, Array]]  # a start: q (n_q,), u (n_u,)


class Task(TypedDict, total=False):
    """What `make` and `make_vec` take beside the reward."""

    terminated: str
    observe: Sequence[str] | None
    every: float
    horizon: float
    draw: Draw | None


def make(
    scene: Library | Scene | str | Path,
    *,
    reward: str,
    parameters: Mapping[str, float] | None = None,
    accuracy: Accuracy | str | None = None,
    **task: Unpack[Task],
) -> RunEnv:
    """An environment of one run.

    Args:
        scene: a library, a scene, or the path of a scene file.
        reward, terminated: expressions of t, inputs and components of sensors, at the end of each step; the
            episode terminates where the second is positive, never unless it is given.
        observe: names of the sensors that are observed; all when None.
        every: time of a step, s; 0.02 unless given.
        horizon: time after which an episode is truncated, s; 10 unless given.
        draw: draws the start of an episode; None: the scene's own.
        parameters: values of parameters of the scene.
        accuracy: as for `start`.

    The actions are values of all inputs of the scene, in order, within their ranges. They hold during the
    step, or, of inputs with hold = "linear", are reached at its end. Observations and rewards are taken
    there. A run that fails ends its episode as truncated, with `outcome` in the info. When an episode ends,
    `doubts` in the info names what the run's own figures speak against (DOUBT_KINDS), if there is anything.

    Raises:
        ModelgenError: an argument is not what it says, or an input has no range.
    """
    facts = _Facts(scene, 1, reward, **task)
    return RunEnv(facts, start_many(facts.library, 1, parameters=parameters, accuracy=accuracy))


def make_vec(
    scene: Library | Scene | str | Path,
    n: int,
    *,
    reward: str,
    parameters: Mapping[str, Any] | None = None,
    accuracy: Accuracy | str | None = None,
    threads: int = 1,
    **task: Unpack[Task],
) -> RunVectorEnv:
    """An environment of n runs that go on together; arguments are those of `make`.

    `parameters` may have one value for each run. A run whose episode has ended is reset in the next step
    (`AutoresetMode.NEXT_STEP`). Seeds, infos and the option "reset_mask" are those of `SyncVectorEnv` of n
    environments of `make`.
    """
    facts = _Facts(scene, n, reward, **task)
    many = start_many(facts.library, n, parameters=parameters, accuracy=accuracy, threads=threads)
    return RunVectorEnv(facts, many)


class _Facts:
    """What the runs of an environment have in common: spaces, reward, end of an episode."""

    def __init__(
        self,
        scene: Library | Scene | str | Path,
        n: int,
        reward: str,
        terminated: str = "-1",
        observe: Sequence[str] | None = None,
        every: float = 0.02,
        horizon: float = 10.0,
        draw: Draw | None = None,
    ) -> None:
        check_span("every", every, "give the time of a step, s")
        check_span("horizon", horizon, "give the longest time of an episode, s")
        self.library, self.every, self.horizon, self.draw = _library(scene), every, horizon, draw
        instance = self.library.manifest.instance
        self.sensors = [(str(name), int(size)) for name, size in instance["sensors"]["names"]]
        self.observed = _observed(observe, [name for name, _ in self.sensors])
        self.inputs = instance["inputs"]
        slots = [*self.sensors, *((each["name"], 1) for each in self.inputs)]
        texts = {"reward": reward, "terminated": terminated}
        self._values = expressions_function(texts, slots, "modelgen.gym").map(n)  # of all runs at once
        sizes = dict(self.sensors)
        count = sum(sizes[name] for name in self.observed)
        self.observation_space = gymnasium.spaces.Box(-np.inf, np.inf, (count,), np.float64)
        low, high = (np.array([_end(each, key) for each in self.inputs]) for key in ("minimum", "maximum"))
        self.action_space = gymnasium.spaces.Box(low, high, dtype=np.float64)

    def act(self, many: Simulations, actions: Array, lanes: Array) -> None:
        """Set the inputs of lanes by actions (n, number of inputs); those with hold = "linear" reach theirs
        at the end of the step."""
        for k, each in enumerate(self.inputs):
            values, inputs = np.clip(actions[:, k], each["minimum"], each["maximum"]), many.inputs
            if each["hold"] == "linear":
                inputs.ramp(each["name"], (values - inputs[each["name"]]) / self.every, lanes)
            else:
                inputs[each["name"]][lanes] = values[lanes]

    def shown(self, many: Simulations) -> tuple[Array, Array, Array]:
        """Observations (n, k), rewards (n,) and whether episodes terminate (n,)."""
        sensors = many.sensors
        columns = {name: values.reshape(many.n, -1) for name, values in sensors.items()}
        inputs = [many.inputs[each["name"]].reshape(many.n, 1) for each in self.inputs]
        given = [many.t.reshape(many.n, 1), *(columns[name] for name, _ in self.sensors), *inputs]
        found = self._values.call([ca.DM(np.ascontiguousarray(each.T)) for each in given])
        reward, terminated = (np.asarray(each, dtype=float).ravel() for each in found)
        observation = [columns[name] for name in self.observed]
        return np.concatenate([np.zeros((many.n, 0)), *observation], axis=1), reward, terminated > 0

    def reset(self, many: Simulations, lanes: Sequence[int], randoms: Sequence[np.random.Generator]) -> None:
        """Put lanes at the start of an episode, their inputs at their defaults; randoms are by lane."""
        n_q, n_u = (self.library.manifest.instance[key] for key in ("n_q", "n_u"))
        q = u = None
        if self.draw is not None:
            q, u = np.zeros((many.n, n_q)), np.zeros((many.n, n_u))
            for lane in lanes:
                q[lane], u[lane] = self.draw(randoms[lane])
        for each in self.inputs:
            if each["hold"] == "linear":
                many.inputs.ramp(each["name"], 0.0, list(lanes))
            many.inputs[each["name"]][list(lanes)] = each["default"]
        many.reset(list(lanes), q, u)


class RunEnv(gymnasium.Env[Array, Array]):
    """An environment of one run (`make`)."""

    metadata = {"render_modes": []}  # noqa: RUF012  as Gymnasium declares it

    def __init__(self, facts: _Facts, many: Simulations) -> None:
        self._facts, self._many = facts, many
        self.observation_space, self.action_space = facts.observation_space, facts.action_space

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Array, dict[str, Any]]:
        """The first observation of an episode, and no info; raises ModelgenError where a start is refused."""
        super().reset(seed=seed)
        self._facts.reset(self._many, [0], [self.np_random])
        return self._facts.shown(self._many)[0][0], {}

    def step(self, action: Array) -> tuple[Array, float, bool, bool, dict[str, Any]]:
        """Observation, reward, terminated, truncated, info after one step with the action."""
        self._facts.act(self._many, np.asarray(action, dtype=float).reshape(1, -1), np.array([0]))
        self._many.step(self._facts.every)
        observation, reward, terminated = self._facts.shown(self._many)
        failed = bool(self._many.ended[0])
        truncated = failed or _is_over(self._many.t, self._facts)[0]
        info = _info(self._many, 0) if failed or truncated or terminated[0] else {}
        return observation[0], float(reward[0]), bool(terminated[0]), bool(truncated), info


class RunVectorEnv(gymnasium.vector.VectorEnv[Array, Array, Array]):
    """An environment of many runs (`make_vec`)."""

    metadata = {"render_modes": [], "autoreset_mode": AutoresetMode.NEXT_STEP}  # noqa: RUF012

    def __init__(self, facts: _Facts, many: Simulations) -> None:
        self._facts, self._many = facts, many
        self.num_envs = many.n
        self.single_observation_space, self.single_action_space = facts.observation_space, facts.action_space
        self.observation_space = batch_space(facts.observation_space, many.n)
        self.action_space = batch_space(facts.action_space, many.n)
        self._over = np.zeros(many.n, dtype=bool)  # runs to be reset in the next step
        self._randoms = [np.random.default_rng() for _ in range(many.n)]

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Array, dict[str, Any]]:
        """The first observations of episodes, and no infos.

        Args:
            seed: one for each run, or that of the first run, the next ones counting up from it; a run
                without one goes on drawing.
            options: of the key "reset_mask", (n,) of bool: the runs that are reset; all without it.

        Raises ModelgenError where a seed, a mask or a start is refused.
        """
        chosen = np.flatnonzero(_mask(options, self.num_envs))
        for lane, one in enumerate(_seeds(seed, self.num_envs)):
            if one is not None and lane in chosen:
                self._randoms[lane] = seeding.np_random(one)[0]
        self._facts.reset(self._many, chosen.tolist(), self._randoms)
        self._over[chosen] = False
        return self._facts.shown(self._many)[0], {}

    def step(self, actions: Array) -> tuple[Array, Array, Array, Array, dict[str, Any]]:
        """Observations, rewards, terminated, truncated, infos after one step of each run."""
        over = np.flatnonzero(self._over)
        if len(over):
            self._facts.reset(self._many, over.tolist(), self._randoms)
        self._facts.act(self._many, np.asarray(actions, dtype=float), np.flatnonzero(~self._over))
        self._many.step(self._facts.every, ~self._over)
        observation, reward, terminated = self._facts.shown(self._many)
        truncated = self._many.ended | _is_over(self._many.t, self._facts)
        reward[over], terminated[over], truncated[over] = 0.0, False, False
        self._over = terminated | truncated
        infos: dict[str, Any] = {}
        for lane in np.flatnonzero(self._over).tolist():
            self._add_info(infos, _info(self._many, lane), lane)
        return observation, reward, terminated, truncated, infos


def _info(many: Simulations, lane: int) -> dict[str, Any]:
    """What is to be known of a run whose episode has ended: why it failed, and the doubts of its figures."""
    failure = {"outcome": str(many.outcomes[lane])} if many.ended[lane] else {}
    doubts = many.doubts[lane]
    return failure | ({"doubts": ", ".join(doubts)} if doubts else {})


def _seeds(seed: int | Sequence[int | None] | None, n: int) -> Sequence[int | None]:
    """Of each run; raises ModelgenError if there are not as many."""
    if seed is None:
        return [None] * n
    if isinstance(seed, int | np.integer):
        return [int(seed) + lane for lane in range(n)]
    if len(seed) != n:
        raise ModelgenError("seed", f"{len(seed)} seeds", f"{n}", "give one for each run, or one number")
    return seed


def _mask(options: Mapping[str, Any] | None, n: int) -> Array:
    """Which runs are to be reset; raises ModelgenError where the option is no mask of them."""
    mask = np.asarray((options or {}).get("reset_mask", np.ones(n, dtype=bool)))
    if mask.shape != (n,) or mask.dtype != bool:
        found = f"an array of shape {mask.shape} and type {mask.dtype}"
        raise ModelgenError("reset_mask", found, f"({n},) of bool", "give True for each run to be reset")
    return mask


def _is_over(t: Array, facts: _Facts) -> Array:
    """Whether the episodes have reached their horizon."""
    return np.asarray(t > facts.horizon - facts.every / 2)


def _library(scene: Library | Scene | str | Path) -> Library:
    if isinstance(scene, Library):
        return scene
    from modelgen import build, derive, emit, read, require

    return build(emit(derive(require(scene if isinstance(scene, Scene) else read(scene)))))


def _observed(names: Sequence[str] | None, known: Sequence[str]) -> list[str]:
    for name in names or ():
        if name not in known:
            allowed = "sensors: " + ", ".join(known)
            raise ModelgenError("observe", f"no sensor named {name!r}", allowed, nearest(name, known))
    return list(known if names is None else names)


def _end(each: Mapping[str, Any], key: str) -> float:
    """An end of the range of an input; raises ModelgenError if there is none."""
    if each[key] is None:
        raise ModelgenError(
            f"input {each['name']!r}", f"no {key}", "an action needs a range", f"add {key} to the [[input]]"
        )
    return float(each[key])
