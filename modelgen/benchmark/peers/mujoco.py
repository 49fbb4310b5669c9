"""The same scene in MuJoCo (extra `peers`): its knobs, and how it is run."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from modelgen.benchmark.knobs import Facts, Knob, Settings
from modelgen.benchmark.peers.mjcf import Mjcf, different, is_ringed, motors, unlike
from modelgen.benchmark.peers.peer import Peer, PeerError, Run, missing, sampled
from modelgen.benchmark.peers.scene_description import Setup, tabulated
from modelgen.benchmark.sampled_motion import Array


def _steps(facts: Facts) -> list[float]:
    return [2e-3, 1e-3, 5e-4, 2e-4, 1e-4, 5e-5, 2e-5, 1e-5, 5e-6, 2e-6]


def _touch(facts: Facts, settings: Settings) -> bool:
    return facts.contacts


BASIC: tuple[Knob, ...] = (
    Knob("integrator", "order 4 or 1", lambda f: ("RK4", "implicitfast", "Euler"), lambda f, s: True),
    Knob("timestep", "s", _steps, lambda f, s: True, ladder=True),
    Knob(
        "contact",
        "hard, its time constant two steps, or as by default",
        lambda f: ("tied", "default"),
        _touch,
    ),
    Knob("solver", "tolerance of its solver", lambda f: (1e-12, 1e-8, 1e-15), _touch),
    Knob("collider", "its convex collider", lambda f: ("native", "libccd"), _touch),
    Knob("ccd", "tolerance of the collider", lambda f: (1e-6, 1e-12, 1e-15), _touch),
)
ROUGH: tuple[Knob, ...] = (
    Knob("cone", "of friction", lambda f: ("elliptic", "pyramidal"), _touch),
    Knob("impratio", "friction against normal impedance", lambda f: (1.0, 100.0, 10000.0), _touch),
    Knob("noslip", "sweeps against creep", lambda f: (0, 20), _touch),
)
RINGS: tuple[Knob, ...] = (
    Knob("segments", "capsules of a circle", lambda f: (128, 64, 256, 512), _touch),
    Knob("tube", "their radius over the length", lambda f: (1e-2, 3e-3, 1e-3), _touch),
)


@dataclass(frozen=True, slots=True)
class MujocoScene:
    """A scene as MuJoCo has it."""

    setup: Setup
    cannot: list[str]
    differs: list[str]
    knobs: tuple[Knob, ...]
    version: str = field(default_factory=lambda: str(_module().__version__))

    @classmethod
    def of(cls, setup: Setup) -> MujocoScene:
        pairs = setup.scene.contacts
        rough = ROUGH if any(pair.friction for pair in pairs) else ()
        rings = RINGS if any(is_ringed(setup.scene, pair) for pair in pairs) else ()
        return cls(setup, unlike(setup.scene), different(setup.scene), (*BASIC, *rough, *rings))

    def prepare(self, settings: Settings) -> Run:
        mujoco, setup = _module(), self.setup
        per_sample = setup.per_sample(float(settings["timestep"]))
        try:
            text = Mjcf(setup, settings, setup.until / setup.samples / per_sample).text()
            model = mujoco.MjModel.from_xml_string(text)
        except ValueError as refused:
            raise PeerError(str(refused)) from None
        control = self._control(per_sample)
        return lambda: self._run(model, per_sample, control)

    def _control(self, per_sample: int) -> Array | None:
        """(steps, 3 loads): the loads in the middle of each step; None where there are none."""
        loads = motors(self.setup.scene)
        if not loads:
            return None
        middles = self.setup.middles(per_sample)
        return np.hstack([tabulated(load.components, middles) for load in loads])

    def _run(self, model: Any, per_sample: int, control: Array | None) -> tuple[Array, float]:
        mujoco = _module()
        data = mujoco.MjData(model)
        for k, solid in enumerate(self.setup.moving):
            rotation = np.zeros(9)
            mujoco.mju_quat2Mat(rotation, solid.quaternion)
            turning = rotation.reshape(3, 3).T @ solid.w
            data.qpos[7 * k : 7 * k + 7] = [*solid.p, *solid.quaternion]
            data.qvel[6 * k : 6 * k + 6] = [*solid.v, *turning]
        advance = _advance(model, data, per_sample, control)
        return sampled(self.setup, advance, lambda: _bodies(data))


def _advance(model: Any, data: Any, per_sample: int, control: Array | None) -> Callable[[int, float], None]:
    """What runs the steps of one output interval in C."""
    mujoco = _module()
    if control is None:
        return lambda sample, t: mujoco.mj_step(model, data, nstep=per_sample)
    from mujoco import rollout

    kind = mujoco.mjtState.mjSTATE_FULLPHYSICS
    state = np.zeros((1, mujoco.mj_stateSize(model, kind)))
    mujoco.mj_getState(model, data, state[0], kind)

    def advance(sample: int, t: float) -> None:
        held = control[None, sample * per_sample : (sample + 1) * per_sample]
        state[0] = rollout.rollout(model, data, state, held)[0][0, -1]

    return advance


def _bodies(data: Any) -> Array:
    """(nb, 10) from qpos and qvel."""
    q, v = data.qpos.reshape(-1, 7), data.qvel.reshape(-1, 6)
    return np.concatenate([q, v[:, :3]], axis=1)


def _module() -> Any:
    try:
        import mujoco
    except ImportError:
        raise missing("mujoco", "peers") from None
    return mujoco


MUJOCO = Peer("mujoco", (*BASIC, *ROUGH, *RINGS), MujocoScene.of, _module)
