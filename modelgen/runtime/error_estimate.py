"""The companion of a run: a finer run from a start that differs by a few roundings, which gives the error
estimate.

Where steps decide, its error is by far the smaller one; where rounding does, it is another one. So how far it
goes from the run is the error of the run, whatever caused it.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Iterator, Mapping, Sequence
from itertools import chain
from typing import TYPE_CHECKING, Any

import numpy as np

from modelgen.runtime.accuracy import TENTH, Accuracy
from modelgen.runtime.error_statement import Estimate
from modelgen.runtime.event_matching import (
    BLOWS,
    BodiesByContact,
    Pairs,
    Subject,
    alone,
    in_pairs,
    modes_apart,
    subject_of,
    undecided,
    undecided_impacts,
)
from modelgen.runtime.run_distance import (
    APART,
    apart_of,
    columns_in_common,
    forces_between,
    gaps_between,
)
from modelgen.runtime.tables.ctypes_structures import Array
from modelgen.runtime.trajectory import FALLBACK_EVENTS, Event, Outcome, Trajectory
from modelgen.runtime.trust import steps_in_time, uncertified

if TYPE_CHECKING:
    from modelgen.runtime.order_of_impacts import Finer, OtherOrder

SAFE = 4.0  # times the difference of run and companion: for what the companion errs itself
ORDERED = 2.0  # times the difference in the time between two impacts: their order is told beyond that
EXTRAPOLATED = 2.0  # times the difference that is extrapolated to step zero
ORDERS = {"rk4": 4, "time-stepping": 1}  # of methods whose companion has a finer step, not a finer tolerance
ROUNDED = 8.0  # roundings of lengths, and of 1: no error below is claimed
BOUNCE = 100.0  # times the bound of rest: slower bounces end in one run and not in the other
SETTLING = 10.0  # times the time in which such a bounce comes to its top: how long it takes to settle
LEAST_STEPS = 100  # that every companion may take
UNKNOWN = {  # without a companion
    "gap": None, "force": None, "events": None, "events_unmatched": None, "events_doubt": "",
}  # fmt: skip
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
    finer: Finer | None = None,
    other_order: OtherOrder | None = None,
) -> Estimate:
    """The error of `path` from its companion's run `twin` at the same times.

    Args:
        path, accuracy: the run, and its record.
        twin: None where there is none; `missing` says why.
        instance: of the manifest.
        compared: what `motions_compared` gives of the two at the samples of `path`, where it is known.
        finer: makes a run still finer than the companion, to see which of two impacts comes first.
        other_order: makes a run in which they come in the other order, to see where that leads.
    """
    length, last = instance["scales"]["length"], len(path.t)
    errors = np.full((len(APART), last), np.inf)
    n, safe = 0 if twin is None else _common(path, twin), _safe(path, accuracy)
    slow = BOUNCE * accuracy.rest_speed * length / instance["scales"]["time"]
    brief = SETTLING * slow * instance["scales"]["time"] ** 2 / length
    predicted, reasons, other = 1, [*_reasons(path, twin, missing, brief)], dict[str, Any](UNKNOWN)
    if twin is not None:
        common = in_pairs(path.events, twin.events)
        if compared is None:
            compared = apart_of(path, twin, n, instance)
        compared = _without_blows(path, common, compared[:, :n], safe)
        errors[:, :n] = _errors(path, compared, safe, instance)
        told = _told(path.events, slow), _told(twin.events, slow)
        pairs, bodies = in_pairs(*told), BodiesByContact(instance)
        first = errors[:, : _predicted(errors, n, length, accuracy)]
        doubts, apart = _orders(path, twin, common, pairs, first, accuracy, instance, finer, other_order)
        if apart is not None:
            known = compared[: len(APART), : first.shape[1]]
            np.maximum(known, apart, out=known)
            errors[:, :n] = _errors(path, compared, safe, instance)
        predicted = _predicted(errors, n, length, accuracy)
        end, error = float(path.t[predicted - 1]), float(errors[0, predicted - 1])
        modes = modes_apart(path.events, twin.events, instance, end, _unloaded(path, twin))
        agreed = _agreed(common, bodies)
        times, unmatched = _events(pairs, alone(*told, pairs), modes, agreed, bodies, brief, error, end)
        other = _gaps_and_forces(path, twin, predicted, safe)
        other["events"] = None if times is None else safe * times + _resolution(path, accuracy)
        other["events_unmatched"] = len(unmatched) if path.events or twin.events else None
        other["events_doubt"] = _alone(unmatched)
        reasons += doubts
    position, rotation, velocity, spin = errors
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


def _without_blows(path: Trajectory, common: Pairs, compared: Array, safe: float) -> Array:
    """What `motions_compared` gives, without the differences of velocities at samples that fall on an impact
    within the error of its time: each run shows those before it or those after it."""
    far, found = compared[len(APART)].max(initial=0.0), compared.copy()
    rounding = ROUNDED * float(np.finfo(path.p.dtype).eps)
    likes = {id(event): like.t for event, like in common}
    blows = [
        (event.t, likes.get(id(event), event.t), event.speed) for event in path.events if event.speed > 0
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
    return SAFE if order is None else EXTRAPOLATED / (1 - TENTH**order)


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
        if event.kind in FALLBACK_EVENTS:
            is_stepping = event.kind == "fallback-start"
        else:
            told += is_stepping
    return path.fallback_step if told else 0.0


def _predicted(errors: Array, n: int, length: float, accuracy: Accuracy) -> int:
    """The number of leading samples whose estimated error is below `prediction_error_max`."""
    position, rotation = errors[0, :n] / length, errors[1, :n]
    lost = np.flatnonzero(~(np.maximum(position, rotation) <= accuracy.thresholds.prediction_error_max))
    return max(int(lost[0]) if lost.size else n, 1)


def _unloaded(*runs: Trajectory) -> set[str]:
    """The contacts that carry no force at any sample of runs."""
    found = (
        {name for name, force in zip(run.contact_names, run.force.T, strict=True) if not force.any()}
        for run in runs
    )
    return set.intersection(*found)


def _told(events: Sequence[Event], slow: float) -> list[Event]:
    """The events but for blows slower than `slow`, m/s, which a run of other thresholds has not."""
    return [event for event in events if not 0 < event.speed < slow]


def _gaps_and_forces(path: Trajectory, twin: Trajectory, n: int, safe: float) -> dict[str, Any]:
    """Errors in gaps and forces up to sample n."""
    mine, theirs = columns_in_common(path, twin)
    gap = gaps_between(mine, theirs, n)
    force = forces_between(mine["force"][:n], theirs["force"][:n])
    return {
        "gap": None if gap is None else safe * gap,
        "force": None if force is None else safe * force + path.force_rounding,
    }


def _agreed(pairs: Pairs, bodies: Mapping[str, Collection[int]]) -> dict[int, list[float]]:
    """s: when two runs have an event that both have, by the bodies of its contact."""
    found: dict[int, list[float]] = defaultdict(list)
    for a, b in pairs:
        for body in bodies.get(a.contact, ()):
            found[body].append(max(a.t, b.t))
    return found


def _events(
    pairs: Pairs,
    single: Sequence[Event],
    apart: Mapping[Subject, float],
    agreed: Mapping[int, Sequence[float]],
    bodies: Mapping[str, Collection[int]],
    brief: float,
    least: float,
    end: float,
) -> tuple[float | None, list[Event]]:
    """How far the times of events of two runs are apart, s, and those that only one of them has, up to `end`;
    where no event is told up to there, that of later ones.

    An event of one run that is no blow, and changes a mode in which the runs differ for no longer than
    `brief`, s, in all, is one whose time is off by as much. So is a blow, if the next event of its bodies
    that both have, at one of the times `agreed`, comes within `brief`, or before it has moved a body by
    `least`, m: what it changes in the motion after that shows where the runs are compared.
    """
    late, lasting = [abs(a.t - b.t) for a, b in pairs if a.t <= end], list[Event]()
    for event in single:
        if event.t > end:
            continue
        if event.kind in BLOWS and event.speed:
            times = chain.from_iterable(agreed[body] for body in bodies[event.contact])
            for_s = min((t for t in times if t > event.t), default=end) - event.t
            counts = for_s > brief and event.speed * for_s > least
        else:
            for_s = apart.get(subject_of(event), 0.0)
            counts = for_s > brief
        if counts:
            lasting.append(event)
        else:
            late.append(for_s)
    return max(late or [abs(a.t - b.t) for a, b in pairs], default=None), lasting


def _alone(unmatched: Sequence[Event]) -> str:
    """Why events are not certain; "" if they are."""
    if not unmatched:
        return ""
    first = min(unmatched, key=lambda event: event.t)
    what = f"the first is a {first.kind} at {first.contact} (t = {first.t:.6g} s)"
    return f"{len(unmatched)} events are in the run or in its companion only: {what}"


def _reasons(path: Trajectory, twin: Trajectory | None, missing: str, brief: float) -> Iterator[str]:
    """Reasons why the estimate may miss errors that both runs share, or why there is no estimate."""
    if twin is None:
        yield missing
    elif twin.outcome is Outcome.INTERRUPTED:
        yield f"the companion run was interrupted at {twin.t_end:.6g} s"
    elif twin.outcome is Outcome.TOO_COSTLY:
        taken, own = (each.steps + each.rejected for each in (twin, path))
        yield (
            f"the companion run was stopped at {twin.t_end:.6g} s: {taken} steps, for {own} of the run; a "
            "finer accuracy, or a larger companion_cost, may let it end"
        )
    elif twin.t_end < path.t_end:
        yield f"the companion run came to {twin.t_end:.6g} s only: {twin.outcome.name.lower()}"
    yield from uncertified(path, 0.0 if twin is None else brief)


def _orders(
    path: Trajectory,
    twin: Trajectory,
    common: Pairs,
    pairs: Pairs,
    errors: Array,
    accuracy: Accuracy,
    instance: Mapping[str, Any],
    finer: Finer | None,
    other_order: OtherOrder | None,
) -> tuple[list[str], Array | None]:
    """The doubts about the order of impacts, and how far the run is from those in which two of them come in
    the other order where that is no doubt, (4, n); None where none was made.

    `common` and `pairs`: the events that both runs have, all and without slow blows. `errors`: those stated
    in each of APART at the samples that are predicted, (4, n).
    """
    last = errors.shape[1] - 1
    ties = undecided_impacts(pairs, instance, ORDERED, float(errors[0, last]), float(path.t[last]))
    if not ties:
        return [], None
    from modelgen.runtime.order_of_impacts import led_elsewhere, ties_left  # few runs need it

    if finer is not None:
        ties = ties_left(common, twin, ties, finer, ORDERED)
    if not ties or other_order is None:
        return [undecided(*tie) for tie in ties[:1]], None
    return led_elsewhere(path, ties, errors, other_order, instance, accuracy.thresholds.order_error_max)
