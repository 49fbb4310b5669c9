"""The reference of a measurement, and its error bar: two forms, or two settings, as fine as can be."""

from __future__ import annotations

from copy import deepcopy
from dataclasses import dataclass, replace
from math import inf
from typing import Any

import numpy as np

from modelgen.benchmark.knobs import Space
from modelgen.benchmark.motion_errors import beyond, separation
from modelgen.benchmark.sampled_motion import Array, Bodies, Motion, motion_of
from modelgen.benchmark.scene_under_measurement import Subject
from modelgen.codegen.library import Library
from modelgen.errors import SimulationError
from modelgen.runtime.accuracy import Accuracy
from modelgen.runtime.trajectory import Trajectory

PREDICTABLE = (
    1e-6  # over the length: where one rounding of double precision has grown to this, prediction ends
)
ROUNDING = float(np.finfo(np.float64).eps)

SENSITIVE = f"a change of one rounding in double precision has grown to {PREDICTABLE:g} of the length there"
APART = (
    f"the two references differ by {PREDICTABLE:g} of the length there, though a rounding has not grown "
    "to it: their events fall otherwise"
)


@dataclass(frozen=True, slots=True)
class Reference:
    """A motion to measure against.

    `error` is its largest distance from the second one, up to the horizon, over the characteristic length;
    no less than the rounding of double precision, in which motions are compared.
    """

    motion: Motion
    path: Trajectory
    bodies: Bodies
    made_by: tuple[str, str]
    error: float
    horizon: float | None  # s; None: the whole span can be predicted
    reason: str  # of the horizon
    growth: float  # of a rounding up to the horizon
    end: float  # s, where the runs ended
    ending: str  # why, if before the end of the span
    spread: dict[str, float]  # beyond the horizon, between the two

    def facts(self) -> dict[str, Any]:
        """Facts for tables and JSON."""
        shown = ("made_by", "error", "horizon", "reason", "growth", "end", "ending", "spread")
        return {name: getattr(self, name) for name in shown}


def reference_of(subject: Subject, space: Space) -> Reference:
    """Two runs in long double, in two forms where the scene has them, and at two settings."""
    forms = list(space.facts.forms)
    first, second = _library(subject, forms[0]), _library(subject, forms[1] if len(forms) > 1 else forms[0])
    finest = Accuracy.finest()
    other = replace(finest, tolerance=10 * finest.tolerance, newton=1)
    settled = [subject.run(first, finest), subject.run(second, other)]
    bodies = subject.bodies(first)
    motions = [motion_of(path, bodies) for path in settled]
    ending = _common_end(settled)
    apart = separation(motions[0], motions[1], bodies)
    twin = motion_of(subject.run(nudged(first), finest), bodies)
    growth = separation(twin, motions[0], bodies) / ROUNDING
    horizon, n, reason = _horizon(motions[0].t, apart, growth)
    return Reference(
        motion=motions[0],
        path=settled[0],
        bodies=bodies,
        made_by=(_name(first, finest, forms[0]), _name(second, other, forms[-1 if len(forms) < 2 else 1])),
        error=float(apart[:n].max(initial=ROUNDING)),
        horizon=horizon,
        reason=reason,
        growth=float(growth[:n].max(initial=0.0)),
        end=min(path.t_end for path in settled),
        ending=ending,
        spread={} if horizon is None else beyond(motions[1], motions[0], bodies, n),
    )


def _library(subject: Subject, form: str) -> Library:
    return subject.built({"form": form, "real": "long double"}).library


def _name(library: Library, accuracy: Accuracy, form: str) -> str:
    kinds = [kind["form"] for kind in library.manifest.kinds["contact"]]
    form = "+".join(dict.fromkeys(kinds)) if form == "auto" else form
    settings = f"tolerance {accuracy.tolerance:g}, newton {accuracy.newton}"
    return ", ".join(filter(None, [form, library.real, settings]))


def _common_end(paths: list[Trajectory]) -> str:
    """Why the references end before the span does; refuses references that do not start."""
    for path in paths:
        if len(path.t) < 2:
            raise SimulationError(
                path.scene, f"the reference ends at once: {path.outcome.value}", "", "mend the scene"
            )
    early = [path for path in paths if not path.outcome.succeeded]
    return early[0].outcome.value if early else ""


def nudged(library: Library) -> Library:
    """The same scene with gravity changed by one rounding of double precision, in size and direction."""
    instance = deepcopy(library.manifest.instance)
    scales = instance["scales"]
    size = max(map(abs, instance["gravity"])) or scales["length"] / scales["time"] ** 2
    nudge = np.array([0.6, -0.5, 0.62]) * ROUNDING * size
    exact = np.array(instance["gravity"]) + nudge
    step = np.nextafter(instance["gravity"], inf)
    instance["gravity"] = np.where(exact == instance["gravity"], step, exact).tolist()
    return library.with_instance(instance)


def _horizon(t: Array, apart: Array, growth: Array) -> tuple[float | None, int, str]:
    """The last sample before prediction ends, how many there are up to it, and why; None: it never does."""
    n = min(len(apart), len(growth))
    grown = growth[:n] * ROUNDING > PREDICTABLE
    lost = np.flatnonzero((apart[:n] > PREDICTABLE) | grown)
    if lost.size == 0:
        return None, n, ""
    first = int(lost[0])
    return float(t[max(first - 1, 0)]), max(first, 1), SENSITIVE if grown[first] else APART
