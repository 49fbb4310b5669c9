"""The companion of a run: a finer run from a start that differs by a few roundings, which gives the error
estimate.

Where steps decide, its error is by far the smaller one; where rounding does, it is another one. So how far it
goes from the run is the error of the run, whatever caused it.
"""

from __future__ import annotations

from bisect import bisect
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from modelgen.runtime.accuracy import TENTH, Accuracy
from modelgen.runtime.error_statement import Estimate
from modelgen.runtime.run_distance import (
    APART,
    events_between,
    forces_between,
    gaps_between,
    motions_compared,
    times_by_kind,
)
from modelgen.runtime.tables.ctypes_structures import Array
from modelgen.runtime.trajectory import Event, Outcome, Trajectory
from modelgen.runtime.trust import steps_in_time, uncertified
from modelgen.runtime.warnings.impact_order import undecided_impacts

SAFE = 2.0  # times the error that the difference shows: for what the companion errs itself
ORDERS = {"rk4": 4, "time-stepping": 1}  # of methods whose companion has a finer step, not a finer tolerance
ROUNDED = 8.0  # roundings of lengths, and of 1: no error below is claimed
BOUNCE = 10.0  # times the bound of rest: slower bounces end in one run and not in the other
MOTION = ("p", "quaternion", "v", "w")  # columns
TimesByKind = Mapping[tuple[str, str], Sequence[float]]
LEAST_STEPS = 100  # that every companion may take
NUDGE = 2.0  # roundings by which each number of the start differs, at most


def nudge(x: Array, instance: Mapping[str, Any]) -> None:
    """Changes each number of a start (n_x,), or of several (n, n_x), that is not 0 by a few roundings."""
    epsilon = float(np.finfo(x.dtype).eps)
    n = instance["n_q"] + instance["n_u"]
    x[..., :n] *= 1 + NUDGE * epsilon * np.cos(2.4 * np.arange(n) + 1)


def steps_max(accuracy: Accuracy, steps: int, rejected: int) -> int:
    """Steps, with rejected ones, after which the companion of a run stops that took so many: where they
    explode, as where its thresholds let contacts chatter, it costs far more than it tells."""
    return LEAST_STEPS + int(accuracy.thresholds.companion_cost * (steps + rejected))


def estimate_of(
    path: Trajectory,
    twin: Trajectory | None,
    accuracy: Accuracy,
    instance: Mapping[str, Any],
    missing: str = "",
    compared: Array | None = None,
) -> Estimate:
    """The error of `path` from its companion's run `twin` at the same times.

    Args:
        path, accuracy: the run, and its record.
        twin: None where there is none; `missing` says why.
        instance: of the manifest.
        compared: what `motions_compared` gives of the two at the samples of `path`, where it is known.
    """
    length, last = instance["scales"]["length"], len(path.t)
    errors = np.full((len(APART), last), np.inf)
    n, safe = 0 if twin is None else _common(path, twin), _safe(path, accuracy)
    if twin is not None:
        if compared is None:
            mine, theirs = ({key: getattr(run, key)[:n] for key in MOTION} for run in (path, twin))
            compared = motions_compared(mine, theirs, instance)
        errors[:, :n] = _errors(path, _without_blows(path, twin, compared[:, :n], safe), safe, instance)
    position, rotation, velocity, spin = errors
    predicted = _predicted(position / length, rotation, n, accuracy.thresholds.prediction_error_max)
    slow = BOUNCE * accuracy.rest_speed * length / instance["scales"]["time"]
    other = _other(path, twin, predicted, slow, safe, _resolution(path, accuracy))
    reasons = [*_reasons(path, twin, missing)]
    if other["events_unmatched"]:
        reasons.append(f"events that one of the two runs has alone: {other['events_unmatched']}")
    if twin is not None:
        reasons += _order(path, twin, float(position[predicted - 1]), float(path.t[predicted - 1]), instance)
    return Estimate(
        position=position,
        rotation=rotation,
        velocity=velocity,
        spin=spin,
        **other,
        predicted=predicted,
        horizon=float(path.t[predicted - 1]) if predicted < n else None,
        uncertified=tuple(reasons),
        rhs_evals=0 if twin is None else twin.rhs_evals,
        interrupted=twin is not None and twin.interrupted,
    )


def _without_blows(path: Trajectory, twin: Trajectory, compared: Array, safe: float) -> Array:
    """What `motions_compared` gives, without the differences of velocities at samples that fall on an impact
    within the error of its time: each run shows those before it or those after it."""
    far, found = compared[len(APART)].max(initial=0.0), compared.copy()
    rounding = ROUNDED * float(np.finfo(path.p.dtype).eps)
    mine, theirs = (times_by_kind(run.events, np.inf) for run in (path, twin))
    blows = [
        (event.t, _partner(mine, theirs, event), event.speed) for event in path.events if event.speed > 0
    ]
    t, like, speed = np.array(blows).reshape(-1, 3).T
    reach = safe * np.abs(t - like) + rounding * (path.t_end + far / speed)
    times = path.t[: compared.shape[1]]
    first, end = np.searchsorted(times, t - reach), np.searchsorted(times, t + reach, side="right")
    for k in np.flatnonzero(first < end):
        found[APART.index("velocity") : len(APART), first[k] : end[k]] = 0
    return found


def _common(path: Trajectory, twin: Trajectory) -> int:
    """The number of common samples; the last sample of a run that ended early is left out."""
    n = min(len(path.t), len(twin.t))
    return n - 1 if n and twin.t[n - 1] != path.t[n - 1] else n


def _safe(path: Trajectory, accuracy: Accuracy) -> float:
    """The factor from the difference of two runs to the error; the companion's error is TENTH**order of the
    run's."""
    order = ORDERS.get("time-stepping" if steps_in_time(path) else accuracy.method)
    return SAFE if order is None else SAFE / (1 - TENTH**order)


def _errors(path: Trajectory, compared: Array, safe: float, instance: Mapping[str, Any]) -> Array:
    """(4, n) m, rad, m/s and rad/s: `safe` times the largest differences up to each sample, and what rounding
    alone makes.

    A step rounds each number by up to half a unit in its last place. As independent errors, N of them have
    walked sqrt(N) times as far, and that of a velocity has moved the body by its integral, t / sqrt(3) times
    as much (statistical theory of rounding: P. Henrici, Discrete Variable Methods, 1962). How far they grow
    by the motion is in the difference of the two runs.
    """
    epsilon, scales, n = float(np.finfo(path.p.dtype).eps), instance["scales"], compared.shape[1]
    far, speed, spin = compared[len(APART) :].max(axis=1, initial=0.0).tolist()
    turns = float(any(body["motion"] == "free" for body in instance["bodies"]))
    size, fast = max(scales["length"], far), max(scales["length"] / scales["time"], speed)
    once = size, turns, fast, turns * max(1 / scales["time"], spin)
    at_start, growth = (far, turns, speed, turns * spin), (speed, turns * spin, 0.0, 0.0)
    tiny, start, rate = np.array([once, at_start, growth])[..., None]
    walk = epsilon / 2 * np.sqrt(path.steps * path.t[:n] / (path.t_end or 1.0))
    rounding = ROUNDED * epsilon * tiny + walk * (start + rate * (path.t[:n] / np.sqrt(3)))
    found: Array = safe * np.maximum.accumulate(compared[: len(APART)], axis=1) + rounding
    return found


def _resolution(path: Trajectory, accuracy: Accuracy) -> float:
    """s: the step at whose end time-stepping tells events; 0 where none is told by it."""
    if accuracy.method == "time-stepping":
        return accuracy.step or 0.0
    is_stepping, told = False, 0
    for event in path.events:
        if event.kind in ("fallback-start", "fallback-end"):
            is_stepping = event.kind == "fallback-start"
        else:
            told += is_stepping
    return path.fallback_step if told else 0.0


def _partner(mine: TimesByKind, theirs: TimesByKind, event: Event) -> float:
    """The time of an event in the other run: the nearest of its kind, if the event is the nearest to that in
    turn; else its own."""
    kind = event.kind, event.contact
    like = _nearest(theirs.get(kind, ()), event.t)
    return like if _nearest(mine[kind], like) == event.t else event.t


def _nearest(times: Sequence[float], t: float) -> float:
    """The one of increasing times that is nearest to t; t itself where there is none."""
    at = bisect(times, t)
    return min(times[max(at - 1, 0) : at + 1], key=lambda each: abs(each - t), default=t)


def _predicted(position: Array, rotation: Array, n: int, predictable: float) -> int:
    """The number of leading samples whose estimated error is below `prediction_error_max`."""
    lost = np.flatnonzero(~(np.maximum(position, rotation)[:n] <= predictable))
    return max(int(lost[0]) if lost.size else n, 1)


def _other(
    path: Trajectory, twin: Trajectory | None, n: int, slow: float, safe: float, resolution: float
) -> dict[str, Any]:
    """Errors in gaps, forces and event times up to sample n, but of bounces slower than `slow`, m/s; where no
    event is told up to there, in the times of later ones."""
    if twin is None:
        return {"gap": None, "force": None, "events": None, "events_unmatched": None}
    end = float(path.t[n - 1])
    gap, force = gaps_between(path, twin, n), forces_between(path.force[:n], twin.force[:n])
    told = [[event for event in run.events if not 0 < event.speed < slow] for run in (path, twin)]
    times = events_between(told[0], told[1], end)
    worst = times["events"]
    if worst is None and told[0]:
        worst = events_between(told[0], told[1], min(path.t_end, twin.t_end))["events"]
    return {
        "gap": None if gap is None else safe * gap,
        "force": None if force is None else safe * force + path.force_rounding,
        "events": None if worst is None else safe * worst + resolution,
        "events_unmatched": times["events_unmatched"],
    }


def _reasons(path: Trajectory, twin: Trajectory | None, missing: str) -> Iterator[str]:
    """Reasons why the estimate may miss errors that both runs share, or why there is no estimate."""
    if twin is None:
        yield missing
    elif twin.outcome is Outcome.INTERRUPTED:
        yield f"the companion run was interrupted at {twin.t_end:.6g} s"
    elif twin.outcome is Outcome.TOO_COSTLY:
        taken, own = (each.steps + each.rejected for each in (twin, path))
        yield f"the companion run was stopped at {twin.t_end:.6g} s: {taken} steps, for {own} of the run"
    elif twin.t_end < path.t_end:
        yield f"the companion run came to {twin.t_end:.6g} s only: {twin.outcome.name.lower()}"
    yield from uncertified(path)


def _order(
    path: Trajectory, twin: Trajectory, error: float, end: float, instance: Mapping[str, Any]
) -> Iterator[str]:
    found = undecided_impacts(path.events, twin.events, instance, SAFE, error, end)
    if found is not None:
        names = f"{found[0].contact} and {found[1].contact}"
        yield f"which of the impacts at {names} (t = {found[1].t:.6g} s) comes first is within the error"
