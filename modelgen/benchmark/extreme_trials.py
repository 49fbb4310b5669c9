"""Extremes of double precision: each with its decades and the law by which accuracy is lost."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import inf, isnan
from typing import Any, Literal

import numpy as np

from modelgen.benchmark.libraries_by_kinds import LibrariesByKinds
from modelgen.benchmark.motion_errors import separation
from modelgen.benchmark.sampled_motion import Bodies, motion_of, uninterrupted
from modelgen.codegen.library import Library
from modelgen.errors import ModelgenError
from modelgen.runtime.accuracy import Accuracy
from modelgen.runtime.simulate import simulate
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene.scene_types import Scene

EPS = float(np.finfo(float).eps)
G = 9.81  # m/s^2, of a scene that names none

RUN = "body points over the length, forces over the largest, against long double"

Verdict = Literal["safe", "warned", "refused"]


@dataclass(frozen=True, slots=True)
class Trial:
    """Result for one value: the error, and the message that the user gets."""

    error: float | None  # None: there is no result
    told: tuple[str, ...] = ()
    verdict: Verdict = "safe"


@dataclass(frozen=True, slots=True)
class Extreme:
    """A number of a scene that is driven to its end.

    Attributes:
        name, of: what is driven, and which number that is.
        values: from easy to hard; `quick` is a choice of them.
        law, allowed: the error that is expected, in words and as a bound at each value.
        measured: which error that is.
        attempt: runs it at a value.
        warned, refused: the values from which on the user is warned, or there is no result; None: never.
        switched, switch: the value from which on another model takes over, and which; it is safe again.
    """

    name: str
    of: str
    values: tuple[float, ...]
    quick: tuple[float, ...]
    law: str
    allowed: Callable[[float], float]
    measured: str
    attempt: Callable[[float, LibrariesByKinds], Trial]
    warned: float | None = None
    refused: float | None = None
    switched: float | None = None
    switch: str = ""

    def expected(self, value: float) -> Verdict:
        """The expected outcome by the thresholds."""
        if self._is_beyond(value, self.switched):
            return "safe"
        if self._is_beyond(value, self.refused):
            return "refused"
        return "warned" if self._is_beyond(value, self.warned) else "safe"

    def _is_beyond(self, value: float, threshold: float | None) -> bool:
        if threshold is None:
            return False
        return value >= threshold if self.values[-1] > self.values[0] else value <= threshold


@dataclass(frozen=True, slots=True)
class Found:
    """A trial beside what was expected of it."""

    extreme: Extreme
    value: float
    trial: Trial

    @property
    def allowed(self) -> float:
        return self.extreme.allowed(self.value)

    @property
    def holds(self) -> bool:
        """The verdict is the expected one, and an error that is given is within its law."""
        if self.trial.verdict != self.extreme.expected(self.value):
            return False
        if self.trial.verdict == "refused":
            return bool(self.trial.told)
        error = self.trial.error
        return error is not None and not isnan(error) and error <= self.allowed

    def as_json(self) -> dict[str, Any]:
        return {
            "value": self.value,
            "error": self.trial.error,
            "allowed": self.allowed,
            "verdict": self.trial.verdict,
            "expected": self.extreme.expected(self.value),
            "told": list(self.trial.told),
            "holds": self.holds,
        }


def tried(
    extremes: Sequence[Extreme],
    libraries: LibrariesByKinds,
    quick: bool,
    report: Callable[[str], None],
    found: list[Found],
) -> None:
    """Adds every value of every extreme, or the quick ones, as they come."""
    for extreme in extremes:
        for value in extreme.quick if quick else extreme.values:
            report(f"{extreme.name}: {value:g}")
            found.append(Found(extreme, value, extreme.attempt(value, libraries)))


def run_of(library: Library, accuracy: Accuracy, samples: int) -> Trajectory:
    """A run to the scene's own end, and no companion; an interruption stays one."""
    return uninterrupted(simulate(library, accuracy=accuracy, samples=samples, estimate=False))


def tried_run(
    make: Callable[[], Scene],
    libraries: LibrariesByKinds,
    error: Callable[[Trajectory], float],
    *,
    accuracy: Accuracy | None = None,
    real: str = "double",
    samples: int = 50,
) -> Trial:
    """A run of a scene, judged where it comes to its end; what the scene or the start is refused for else."""
    try:
        what = make()
        library = libraries.library(what, real)
        path = run_of(library, accuracy or Accuracy.tight(), samples)
    except ModelgenError as refused:
        return Trial(None, (str(refused),), "refused")
    told = tuple(path.warnings)
    if not path.outcome.succeeded:
        return Trial(None, (path.outcome.value, *told), "refused")
    return Trial(float(error(path)), told, "warned" if told else "safe")


def against(
    libraries: LibrariesByKinds, make: Callable[[], Scene], samples: int = 50
) -> Callable[[Trajectory], float]:
    """The largest distance of body points, over the length, and of forces, over the largest, from a run in
    long double as fine as can be."""

    def error(path: Trajectory) -> float:
        library = libraries.library(make(), "long double")
        true = run_of(library, Accuracy.finest(), samples)
        if not true.outcome.succeeded:
            return inf
        bodies = Bodies.of(library.manifest.instance)
        apart = float(separation(motion_of(path, bodies), motion_of(true, bodies), bodies).max())
        largest = float(np.abs(true.force).max(initial=0.0))
        return max(apart, float(np.abs(path.force - true.force).max()) / largest) if largest else apart

    return error


def decades(first: int, last: int, step: int = 1) -> tuple[float, ...]:
    """10**first, .., 10**last."""
    way = step if last >= first else -step
    return tuple(float(f"1e{k}") for k in range(first, last + (1 if way > 0 else -1), way))
