"""Driven runs as environments of Gymnasium (extra `rl`): actions are inputs, observations are sensors."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, TypedDict, Unpack

import casadi as ca
import numpy as np

from modelgen.codegen.library import Library
from modelgen.codegen.sensor_expressions_function import expressions_function
from modelgen.errors import ModelgenError, install
from modelgen.name_suggestions import nearest
from modelgen.runtime.accuracy import Accuracy
from modelgen.runtime.arguments import check_span, checked_starts, numbers_in, shown
from modelgen.runtime.inputs import is_beyond
from modelgen.runtime.stepped_simulations import start_many
from modelgen.scene.scene_types import Scene

try:
    import gymnasium
    from gymnasium.utils import seeding
    from gymnasium.vector import AutoresetMode
    from gymnasium.vector.utils import batch_space
except ImportError:
    raise ModelgenError("modelgen.gym", "no package 'gymnasium'", "", install("rl")) from None

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
    return RunEnv(_Runs(scene, 1, reward, {"parameters": parameters, "accuracy": accuracy}, **task))


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

    `parameters` may have one value for each run, as long as the ranges of the inputs are the same in all. A
    run whose episode has ended is reset in the next step (`AutoresetMode.NEXT_STEP`). Seeds, infos and the
    option "reset_mask" are those of `SyncVectorEnv` of n environments of `make`.
    """
    start = {"parameters": parameters, "accuracy": accuracy, "threads": threads}
    return RunVectorEnv(_Runs(scene, n, reward, start, **task))


class _Runs:
    """The runs of an environment, and what they have in common: spaces, reward, end of an episode.

    Attributes:
        many: the runs.
        begun: (n,) whether an episode of the run has begun, so that it can step.
    """

    def __init__(
        self,
        scene: Library | Scene | str | Path,
        n: int,
        reward: str,
        start: Mapping[str, Any],  # keywords of `start_many`
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
        for each in self.inputs:
            for key in ("minimum", "maximum"):
                _check_end(each, key)
        self.many = start_many(self.library, n, **start)
        low, high = self.many.inputs.bounds[0].T
        for each, bounds in zip(self.inputs, self.many.inputs.bounds.swapaxes(0, 1), strict=True):
            _check_equal(each["name"], bounds)
        self.action_space = gymnasium.spaces.Box(low, high, dtype=np.float64)
        self.begun = np.zeros(n, dtype=bool)

    def act(self, actions: object, shape: tuple[int, ...], lanes: Array) -> None:
        """Set the inputs of lanes by actions, one number for each input, in an array of a shape whose last
        axis is that of the inputs; those with hold = "linear" reach theirs at the end of the step.

        The actions of other lanes are not used.

        Raises ModelgenError, with all inputs as they were, where a run has not been reset, the shape is
        another, or a number of the lanes is not finite or beyond the range of its input.
        """
        if not self.begun.all():
            lane = int(np.flatnonzero(~self.begun)[0])
            where = "step" if len(shape) == 1 else f"step: run {lane}"
            raise ModelgenError(where, "no episode is under way", "", "call reset first")
        inputs, columns = self.many.inputs, self._checked_actions(actions, shape, lanes).T
        for each, values in zip(self.inputs, columns, strict=True):
            if each["hold"] == "linear":
                rates = np.zeros(self.many.n)
                rates[lanes] = (values - inputs[each["name"]][lanes]) / self.every
                inputs.ramp(each["name"], rates, lanes)
            else:
                inputs[each["name"]][lanes] = values

    def _checked_actions(self, actions: object, shape: tuple[int, ...], lanes: Array) -> Array:
        """The actions of lanes, (lanes, number of inputs), within the ranges of the inputs.

        A number of a coarser type than float64, as policies have, may exceed a bound by the rounding of that
        type, and is the bound then. Raises ModelgenError as `act`.
        """
        names = [each["name"] for each in self.inputs]
        allowed = f"an array of numbers of shape {shape}, one for each input: {', '.join(names) or 'none'}"
        given = numbers_in("step: action", actions, allowed)
        if given.shape != shape:
            raise ModelgenError("step: action", f"an array of shape {given.shape}", allowed, "")
        low, high = self.action_space.low, self.action_space.high
        kind = np.asarray(actions).dtype
        with np.errstate(over="ignore"):
            least, largest = (each.astype(kind if kind.kind == "f" else float) for each in (low, high))
        rows = given.reshape(self.many.n, len(names))[lanes]
        refused = is_beyond(rows, least, largest)
        if refused.any():
            at, k = (int(each[0]) for each in np.nonzero(refused))
            run = "" if len(shape) == 1 else f" of run {lanes[at]}"
            raise ModelgenError(
                f"step: action{run} for input {names[k]!r}",
                f"{rows[at, k]:g}",
                f"a number from {low[k]:g} to {high[k]:g}",
                "keep actions within action_space, as gymnasium.wrappers.ClipAction does",
            )
        return np.asarray(np.clip(rows, low, high))

    def shown(self) -> tuple[Array, Array, Array]:
        """Observations (n, k), rewards (n,) and whether episodes terminate (n,)."""
        many, sensors = self.many, self.many.sensors
        columns = {name: values.reshape(many.n, -1) for name, values in sensors.items()}
        inputs = [many.inputs[each["name"]].reshape(many.n, 1) for each in self.inputs]
        given = [many.t.reshape(many.n, 1), *(columns[name] for name, _ in self.sensors), *inputs]
        found = self._values.call([ca.DM(np.ascontiguousarray(each.T)) for each in given])
        reward, terminated = (np.asarray(each, dtype=float).ravel() for each in found)
        observation = [columns[name] for name in self.observed]
        return np.concatenate([np.zeros((many.n, 0)), *observation], axis=1), reward, terminated > 0

    def reset(self, lanes: Array, randoms: Sequence[np.random.Generator]) -> None:
        """Put lanes at the start of an episode, their inputs at their defaults; randoms are by lane.

        Raises ModelgenError where what `draw` returns is no start, or the start is refused.
        """
        many = self.many
        self.begun[lanes] = False
        q = u = None
        if self.draw is not None:
            n_q, n_u = (self.library.manifest.instance[key] for key in ("n_q", "n_u"))
            q, u = np.zeros((many.n, n_q)), np.zeros((many.n, n_u))
            for lane in lanes.tolist():
                drawn = self.draw(randoms[lane])
                if not isinstance(drawn, tuple | list) or len(drawn) != 2:
                    raise ModelgenError("draw", f"a {type(drawn).__name__}", "a start: q, u", "return both")
                q[lane] = checked_starts("draw: q", drawn[0], n_q, 1)[0]
                u[lane] = checked_starts("draw: u", drawn[1], n_u, 1)[0]
        for each, defaults in zip(self.inputs, many.inputs.defaults.T, strict=True):
            if each["hold"] == "linear":
                many.inputs.ramp(each["name"], 0.0, lanes)
            many.inputs[each["name"]][lanes] = defaults[lanes]
        many.reset(lanes, q, u)
        self.begun[lanes] = True

    def is_over(self) -> Array:
        """(n,) whether episodes have reached their horizon."""
        return np.asarray(self.many.t > self.horizon - self.every / 2)

    def info(self, lane: int) -> dict[str, Any]:
        """What is to be known of a run whose episode has ended: why it failed, and the doubts of its
        figures."""
        failure = {"outcome": str(self.many.outcomes[lane])} if self.many.ended[lane] else {}
        doubts = self.many.doubts[lane]
        return failure | ({"doubts": ", ".join(doubts)} if doubts else {})


class RunEnv(gymnasium.Env[Array, Array]):
    """An environment of one run (`make`)."""

    metadata = {"render_modes": []}  # noqa: RUF012  as Gymnasium declares it

    def __init__(self, runs: _Runs) -> None:
        self._runs = runs
        self.observation_space, self.action_space = runs.observation_space, runs.action_space

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Array, dict[str, Any]]:
        """The first observation of an episode, and no info.

        There are no options. Raises ModelgenError where one is given, or a start is refused.
        """
        _check_options(options, ())
        super().reset(seed=seed)
        self._runs.reset(np.array([0]), [self.np_random])
        return self._runs.shown()[0][0], {}

    def step(self, action: Array) -> tuple[Array, float, bool, bool, dict[str, Any]]:
        """Observation, reward, terminated, truncated, info after one step with the action, a number for each
        input.

        Raises ModelgenError where no episode is under way, because there was no reset or the episode has
        ended, and where the action is not in the action space.
        """
        runs = self._runs
        runs.act(action, (len(runs.inputs),), np.array([0]))
        runs.many.step(runs.every)
        observation, reward, terminated = runs.shown()
        truncated = bool(runs.many.ended[0]) or bool(runs.is_over()[0])
        runs.begun[0] = not (truncated or terminated[0])
        info = {} if runs.begun[0] else runs.info(0)
        return observation[0], float(reward[0]), bool(terminated[0]), truncated, info


class RunVectorEnv(gymnasium.vector.VectorEnv[Array, Array, Array]):
    """An environment of many runs (`make_vec`)."""

    metadata = {"render_modes": [], "autoreset_mode": AutoresetMode.NEXT_STEP}  # noqa: RUF012

    def __init__(self, runs: _Runs) -> None:
        self._runs = runs
        self.num_envs = n = runs.many.n
        self.single_observation_space, self.single_action_space = runs.observation_space, runs.action_space
        self.observation_space = batch_space(runs.observation_space, n)
        self.action_space = batch_space(runs.action_space, n)
        self._over = np.zeros(n, dtype=bool)  # runs to be reset in the next step
        self._randoms = [np.random.default_rng() for _ in range(n)]

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Array, dict[str, Any]]:
        """The first observations of episodes, and no infos.

        Args:
            seed: one for each run, or that of the first run, the next ones counting up from it; a run
                without one goes on drawing.
            options: of the key "reset_mask", (n,) of bool: the runs that are reset; all without it.

        Raises ModelgenError where a seed, an option, a mask or a start is refused.
        """
        _check_options(options, ("reset_mask",))
        chosen = np.flatnonzero(_mask(options, self.num_envs))
        for lane, one in enumerate(_seeds(seed, self.num_envs)):
            if one is not None and lane in chosen:
                self._randoms[lane] = seeding.np_random(one)[0]
        self._runs.reset(chosen, self._randoms)
        self._over[chosen] = False
        return self._runs.shown()[0], {}

    def step(self, actions: Array) -> tuple[Array, Array, Array, Array, dict[str, Any]]:
        """Observations, rewards, terminated, truncated, infos after one step of each run with its action,
        (n, number of inputs). The actions of runs that are reset in this step are not used.

        Raises ModelgenError where a run was never reset, and where actions are not in the action space.
        """
        runs, over = self._runs, self._over.copy()
        runs.act(actions, (self.num_envs, len(runs.inputs)), np.flatnonzero(~over))
        if over.any():
            runs.reset(np.flatnonzero(over), self._randoms)
        runs.many.step(runs.every, ~over)
        observation, reward, terminated = runs.shown()
        truncated = runs.many.ended | runs.is_over()
        reward[over], terminated[over], truncated[over] = 0.0, False, False
        self._over = terminated | truncated
        infos: dict[str, Any] = {}
        for lane in np.flatnonzero(self._over).tolist():
            self._add_info(infos, runs.info(lane), lane)
        return observation, reward, terminated, truncated, infos


def _check_options(options: object, known: Sequence[str]) -> None:
    """Raises ModelgenError unless the options of a reset are a mapping from known names, or None."""
    if options is None:
        return
    allowed = f"options: {', '.join(known)}" if known else "there are no options"
    if not isinstance(options, Mapping):
        raise ModelgenError("reset: options", f"a {type(options).__name__}", allowed, "give a dictionary")
    for name in options:
        if name not in known:
            remedy = nearest(str(name), known) or "leave it out; `draw` of make chooses starts"
            raise ModelgenError("reset: options", f"no option {name!r}", allowed, remedy)


def _seeds(seed: int | Sequence[int | None] | None, n: int) -> Sequence[int | None]:
    """Of each run; raises ModelgenError if there are not as many."""
    if seed is None:
        return [None] * n
    if isinstance(seed, int | np.integer):
        return [int(seed) + lane for lane in range(n)]
    if not isinstance(seed, Sequence | np.ndarray):
        raise ModelgenError("seed", shown(seed), "a whole number, or one for each run", "")
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


def _check_end(each: Mapping[str, Any], key: str) -> None:
    """Raises ModelgenError if the range of an input has no such end."""
    if each[key] is None:
        raise ModelgenError(
            f"input {each['name']!r}", f"no {key}", "an action needs a range", f"add {key} to the [[input]]"
        )


def _check_equal(name: str, bounds: Array) -> None:
    """Raises ModelgenError unless the range of an input, (n, 2), is the same in all runs."""
    other = np.flatnonzero((bounds != bounds[0]).any(axis=1))
    if len(other):
        (a, b), (c, d) = bounds[0], bounds[other[0]]
        raise ModelgenError(
            f"input {name!r}",
            f"a range from {a:g} to {b:g} in run 0, from {c:g} to {d:g} in run {other[0]}",
            "the actions of all runs have one range",
            "give all runs the same value of the parameter on which it depends, or make one for each value",
        )
