"""Derivatives of runs by differences of runs: an independent route."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from modelgen import derive, emit, read, require
from modelgen.codegen.library import Library
from modelgen.runtime.arguments import with_parameters
from modelgen.runtime.core_session import CONTINUE, FULL, Session
from modelgen.runtime.sensitivity import TangentRun
from modelgen.runtime.sensitivity_directions import Direction, direction_arrays, directions_of, extrapolated
from modelgen.runtime.settings import accuracy_of
from modelgen.runtime.start import begin
from modelgen.runtime.tables.ctypes_structures import Array
from modelgen.scene.scene_types import Scene
from tests.running import SCENES, compiled

STEP, LEVELS = 2e-4, 3  # of a direction, relative to the size of its number; of the extrapolation
MANY = 1_000_000  # steps


def differentiable(scene: Scene) -> Library:
    """The library of a scene with derivatives."""
    return compiled(emit(derive(require(scene)), derivatives=True))


@cache
def shipped(name: str) -> Library:
    """That of a shipped scene."""
    return differentiable(read(SCENES / f"{name}.toml"))


@dataclass(frozen=True)
class Difference:
    """A derivative by differences, and what two step sizes differ by."""

    value: Array
    noise: float


def starts_along(library: Library, direction: Direction) -> Array:
    """The change of the state at the start that the constraints there permit, (n_x,)."""
    session = Session(library, accuracy_of(library.manifest.instance, "tight", {}))
    run = TangentRun(session, direction_arrays(library, [direction]), 1)
    return run.state_derivatives()[0].copy()


def state_at(library: Library, t: float, change: Array | None = None) -> Array:
    """The state at a time of a run at `tight`, from a changed start."""
    session = Session(library, accuracy_of(library.manifest.instance, "tight", {}))
    if change is not None:
        session.x[:] += change
        for body in library.manifest.instance["bodies"]:
            if body["motion"] == "free":
                quaternion = session.x[body["q"] + 3 : body["q"] + 7]
                quaternion /= np.linalg.norm(quaternion)
    begin(session)
    record = session.tables.Record()
    while session.advance(t, MANY, record) in (CONTINUE, FULL):
        session.drain_events()
    return session.x.copy()


def by_differences(library: Library, name: str, t: float) -> list[Difference]:
    """Derivatives of the state at a time by each direction of that name."""
    return [
        _by_differences(library, direction, t)
        for direction in directions_of(library.manifest.instance, [name])
    ]


def _by_differences(library: Library, direction: Direction, t: float) -> Difference:
    if direction.kind == "parameter":
        entries: Sequence[Mapping[str, float]] = library.manifest.instance["parameters"]
        value = next(float(entry["value"]) for entry in entries if entry["name"] == direction.owner)
        step = STEP * (abs(value) or 1.0)

        def state(change: float) -> Array:
            return state_at(with_parameters(library, {direction.owner: value + change}), t)

    else:
        step, along = STEP, starts_along(library, direction)

        def state(change: float) -> Array:
            return state_at(library, t, change * along)

    coarse, fine = (extrapolated(state, size, LEVELS) for size in (step, step / 2))
    return Difference(fine, float(np.max(np.abs(fine - coarse))))
