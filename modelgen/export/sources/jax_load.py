"""The runs of this folder as JAX functions; needs JAX and nothing else.

import jax
jax.config.update("jax_enable_x64", True)
from load import load

scene = load()
run = scene.run([0.1, 0.2])
print(run(scene.q, scene.u, scene.inputs(2)))
"""

from __future__ import annotations

import ctypes
import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np


class Run(NamedTuple):
    """What a run shows at the n times that were asked for; NaN from where it ended early."""

    sensors: jax.Array  # (n, n_sensor) components of the sensors of the scene, SI
    q: jax.Array  # (n, n_q) of each body p (m) and its quaternion (w, x, y, z)
    u: jax.Array  # (n, n_u) of each body v in world axes (m/s) and w in body axes (rad/s)
    outcome: jax.Array  # () int32: 0 done, else why it ended or did not begin (`Scene.outcomes`)


class Verdict(NamedTuple):
    """How far a gradient can be trusted."""

    outcome: jax.Array  # () int32, as that of Run
    verdict: jax.Array  # () int32: 0 differentiable, 1 one-sided, 2 undecided
    reason: jax.Array  # () int32, of the first cause (`Scene.reasons`)
    t: jax.Array  # () s, of that cause


class Scene:
    """A scene with the numbers of its file."""

    def __init__(self, folder: Path) -> None:
        if not jax.config.jax_enable_x64:
            raise RuntimeError(
                'JAX works in single precision: jax.config.update("jax_enable_x64", True) first'
            )
        facts = json.loads((folder / "functions.json").read_text(encoding="utf-8"))
        self.name: str = facts["name"]
        self.sensors: list[str] = facts["sensors"]
        self.input_names: list[str] = facts["inputs"]  # with the values of those that are linear their rates
        self.input_ranges: list[list[float | None]] = facts["input_ranges"]  # least and largest value
        self.bodies: dict[str, dict[str, int]] = facts["bodies"]  # where each is in q and u
        self.outcomes: dict[str, str] = facts["outcomes"]
        self.reasons: dict[str, str] = facts["reasons"]
        self.q, self.u = np.array(facts["q"]), np.array(facts["u"])
        self._defaults = np.array(facts["input_defaults"])
        self._least = np.array([-np.inf if low is None else low for low, _ in self.input_ranges])
        self._largest = np.array([np.inf if high is None else high for _, high in self.input_ranges])
        library = ctypes.CDLL(str(folder / facts["library"]))
        self._names = {}
        for role in ("run", "gradient", "verdict"):
            self._names[role] = f"modelgen_{facts['hash']}_{role}"
            handler = jax.ffi.pycapsule(getattr(library, f"scene_jax_{role}"))
            jax.ffi.register_ffi_target(self._names[role], handler, platform="cpu")

    def inputs(self, n: int) -> np.ndarray:
        """(n, n_input) the defaults of the inputs in n intervals; zero rates of those that are linear."""
        return np.tile(self._defaults, (n, 1))

    def run(self, t: Sequence[float]) -> Callable[[jax.Array, jax.Array, jax.Array], Run]:
        """A function (q, u, inputs) -> Run of runs from t = 0 over the ascending times `t` (n,), s.

        `inputs` (n, n_input) holds over the interval up to each time. It can be transformed by jit, vmap and
        grad; gradients go backwards over steps, events and impacts. Of a run that ends early they are NaN.

        Raises ValueError where an input is not finite or beyond its range. In a function that JAX transforms,
        where the numbers are not known, such a run has the outcome -2 and shows NaN.
        """
        times = _times(t)

        def plain(q: jax.Array, u: jax.Array, inputs: jax.Array) -> Run:
            return self._run(q, u, inputs, times)

        def forward(q: jax.Array, u: jax.Array, inputs: jax.Array) -> tuple[Run, tuple[jax.Array, ...]]:
            return plain(q, u, inputs), (q, u, inputs)

        def backward(given: tuple[jax.Array, ...], bar: Run) -> tuple[jax.Array, ...]:
            results = [jax.ShapeDtypeStruct(each.shape, jnp.float64) for each in given]
            states = jnp.concatenate([bar.q, bar.u], axis=-1)
            return tuple(self._call("gradient", results)(*given, times, bar.sensors, states))

        run = jax.custom_vjp(plain)
        run.defvjp(forward, backward)
        return lambda q, u, inputs: run(*self._checked(q, u, inputs, len(times)))

    def verdict(self, t: Sequence[float]) -> Callable[[jax.Array, jax.Array, jax.Array], Verdict]:
        """A function (q, u, inputs) -> Verdict on the gradients of that run."""
        times = _times(t)
        results = [jax.ShapeDtypeStruct((3,), jnp.int32), jax.ShapeDtypeStruct((), jnp.float64)]

        def verdict(q: jax.Array, u: jax.Array, inputs: jax.Array) -> Verdict:
            told, when = self._call("verdict", results)(*self._checked(q, u, inputs, len(times)), times)
            return Verdict(told[..., 0], told[..., 1], told[..., 2], when)

        return verdict

    def _run(self, q: jax.Array, u: jax.Array, inputs: jax.Array, times: np.ndarray) -> Run:
        n, n_q = len(times), len(self.q)
        results = [
            jax.ShapeDtypeStruct((n, len(self.sensors)), jnp.float64),
            jax.ShapeDtypeStruct((n, n_q + len(self.u)), jnp.float64),
            jax.ShapeDtypeStruct((), jnp.int32),
        ]
        sensors, states, outcome = self._call("run", results)(q, u, inputs, times)
        return Run(sensors, states[..., :n_q], states[..., n_q:], outcome)

    def _call(self, role: str, results: list[jax.ShapeDtypeStruct]) -> Callable[..., list[jax.Array]]:
        call: Callable[..., list[jax.Array]] = jax.ffi.ffi_call(
            self._names[role], results, vmap_method="broadcast_all"
        )
        return call

    def _checked(self, q: jax.Array, u: jax.Array, inputs: jax.Array, n: int) -> list[jax.Array]:
        shapes = {"q": (len(self.q),), "u": (len(self.u),), "inputs": (n, len(self.input_names))}
        found = [jnp.asarray(each, dtype=jnp.float64) for each in (q, u, inputs)]
        for (name, shape), each in zip(shapes.items(), found, strict=True):
            if each.shape != shape:
                raise ValueError(f"{name}: an array {each.shape}; {shape} is needed")
        if not isinstance(found[2], jax.core.Tracer):
            self._check_inputs(np.asarray(found[2]))
        return found

    def _check_inputs(self, inputs: np.ndarray) -> None:
        """Raises ValueError where a value or rate (n, n_input) is not finite or beyond its range."""
        refused = ~(np.isfinite(inputs) & (self._least <= inputs) & (inputs <= self._largest))
        for k, row in np.argwhere(refused.T)[:1]:
            needed = f"a finite number from {self._least[k]:g} to {self._largest[k]:g} is needed"
            raise ValueError(f"inputs[{row}]: {self.input_names[k]!r} is {inputs[row, k]:g}; {needed}")


def _times(t: Sequence[float]) -> np.ndarray:
    times = np.array(t, dtype=float)
    if (
        times.ndim != 1
        or not len(times)
        or not (np.diff(times, prepend=0.0) >= 0).all()
        or times[-1] == np.inf
    ):
        raise ValueError(f"t: {t!r}; ascending, finite times from 0 on are needed")
    return times


def load(folder: Path = Path(__file__).parent) -> Scene:
    """The scene of a folder."""
    return Scene(Path(folder))


if __name__ == "__main__":
    jax.config.update("jax_enable_x64", True)
    scene = load()
    print(f"{scene.name}: q {len(scene.q)}, u {len(scene.u)}")
    print(f"inputs {scene.input_names}, sensors {scene.sensors}")
