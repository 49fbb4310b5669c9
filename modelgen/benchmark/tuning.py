"""The setting that a demand asks for: picked from the measured front, refined, verified on a fresh run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from decimal import ROUND_CEILING, Context
from math import log
from pathlib import Path
from typing import Any

from modelgen.benchmark.knobs import Settings
from modelgen.benchmark.measurement import Measurement, Report, check_numbers, measure
from modelgen.benchmark.measurement_store import Store
from modelgen.benchmark.scene_under_measurement import applied
from modelgen.benchmark.setting_evaluation import Bench, point_of, scaled
from modelgen.benchmark.work_precision_front import Point, cheapest, finest, front, is_measured, place
from modelgen.errors import ModelgenError, expect, path_of
from modelgen.runtime.arguments import check_function, names_in
from modelgen.scene.scene_types import RunSettings, Scene

BAND = 0.2  # by which a verified cost may exceed a budget
HALVINGS = 3  # of the rung between two neighbours on a ladder
CANDIDATES = 4  # that are verified before a demand is refused
TRIALS = 3  # of a budget: something else may have held the machine up


@dataclass(frozen=True)
class Tuned:
    """A setting that met its demand on a fresh run."""

    point: Point  # as verified
    run: RunSettings  # of the scene, with it
    measurement: Measurement
    budget: float | None = None  # ns of CPU time per simulated second

    @property
    def over(self) -> float:
        """ns per simulated second by which the setting is over the budget, within BAND; 0 where it is not."""
        return 0.0 if self.budget is None else max((self.point.cost_ns_per_s or 0.0) - self.budget, 0.0)

    def as_json(self) -> dict[str, Any]:
        """The object that `tune --json` prints, less the file written."""
        return {
            "scene": self.measurement.subject.scene.name,
            "error": self.point.error,
            "cost_ns_per_s": self.point.cost_ns_per_s,
            "settings": dict(self.point.settings),
            "errors": self.point.errors,
            "reference_error": self.measurement.reference["error"],
            "horizon": self.measurement.reference["horizon"],
            "length": self.measurement.length,
            "interrupted": self.measurement.interrupted,
        }


@dataclass(frozen=True, slots=True)
class Demand:
    """An error over the characteristic length, or a cost in ns per simulated second."""

    error: float | None = None
    budget: float | None = None

    def pick(self, points: Sequence[Point]) -> Point | None:
        """Pick the most accurate point within the budget; if there is none, the cheapest within its band."""
        if self.error is not None:
            return cheapest(points, self.error)
        return finest(points, self.budget or 0.0) or next(filter(self.is_met, front(points)), None)

    def is_met(self, point: Point) -> bool:
        if not is_measured(point):
            return False
        cost, error = place(point)
        return error <= self.error if self.error is not None else cost <= (self.budget or 0.0) * (1 + BAND)


def tune(
    scene: Scene,
    *,
    error: float | None = None,
    budget: float | None = None,
    until: float | None = None,
    knobs: Sequence[str] | None = None,
    limit: float | None = None,
    parameters: Mapping[str, float] | None = None,
    root: str | Path = "generated",
    on_progress: Report | None = None,
) -> Tuned:
    """The cheapest setting that errs at most `error`, or the most accurate one within `budget`.

    Args:
        scene, until, knobs, limit, parameters, root, on_progress: as for `measure`.
        error: over the characteristic length.
        budget: ns of CPU time per simulated second; the fresh run may exceed it by 20 %.

    Raises ModelgenError, naming what can be reached, where the demand cannot be met, or not within `limit`.
    Ctrl-C raises KeyboardInterrupt; what was measured is remembered.
    """
    if (error is None) == (budget is None):
        given = "neither an error nor a budget" if error is None else "an error and a budget"
        raise ModelgenError("tune", given, "one of them: --error 1e-6 or --budget 20us", "say which counts")
    expect("tune", scene, Scene)
    check_numbers(error=error, budget=budget)
    check_function("on_progress", on_progress)
    root = path_of("tune", root)
    knobs = None if knobs is None else names_in("--knobs", knobs)
    demand = Demand(error, budget)
    report = on_progress or (lambda text: None)
    found = measure(
        scene, until=until, knobs=knobs, count=False, limit=limit, parameters=parameters, root=root,
        on_progress=on_progress,
    )  # fmt: skip
    if found.was_stopped:
        raise KeyboardInterrupt
    _refuse_beyond_horizon(found, demand)
    bench = Bench(
        found.subject, found.subject.space(tuple(knobs) if knobs else None), Store(root / scene.name)
    )
    points = list(found.points) if found.interrupted else _refined(bench, list(found.points), demand)
    report("verifying on a fresh run")
    return Tuned(*_verified(bench, points, demand, found), measurement=found, budget=budget)


def _refined(bench: Bench, points: list[Point], demand: Demand) -> list[Point]:
    """The points, and those that halve the rung between the pick and its neighbour beyond the demand."""
    for _ in range(HALVINGS):
        pick = demand.pick(points)
        middle = None if pick is None else _towards(bench, pick, points, demand)
        if middle is None:
            return points
        points = scaled([*points, point_of(bench, middle)])
    return points


def _towards(bench: Bench, pick: Point, points: Sequence[Point], demand: Demand) -> Settings | None:
    """Half-way to the nearest point that differs on the ladder alone and does not meet the demand."""
    halves = [
        (abs(_log_cost(point) - _log_cost(pick)), bench.space.between(pick.settings, point.settings))
        for point in points
        if is_measured(point) and demand.pick([point]) is None
    ]
    known = [dict(point.settings) for point in points]
    fresh = [(far, middle) for far, middle in halves if middle is not None and middle not in known]
    return min(fresh, key=lambda entry: entry[0])[1] if fresh else None


def _log_cost(point: Point) -> float:
    return log(place(point)[0])


def _verified(
    bench: Bench, points: list[Point], demand: Demand, found: Measurement
) -> tuple[Point, RunSettings]:
    """The first pick that a fresh run confirms, and the run settings with it."""
    again, slow = replace(bench, fresh=True), list[Point]()
    for _ in range(CANDIDATES):
        pick = demand.pick(points)
        if pick is None:
            break
        for _ in range(TRIALS if demand.error is None else 1):
            fresh = scaled([*points, point_of(again, pick.settings)])[-1]
            if demand.is_met(fresh):
                return fresh, applied(found.subject.scene.run, pick.settings)
            slow.append(fresh)
        points = [point for point in points if point.settings != pick.settings]
    raise _refusal(found, demand, slow)


def _refusal(found: Measurement, demand: Demand, slow: Sequence[Point]) -> ModelgenError:
    """`slow`: candidates as they were measured again."""
    known = front(found.points)
    if found.interrupted:
        return _time_up(known, demand)
    if not known:
        return ModelgenError(
            "tune", "no setting runs this scene to its end", "", "look at `modelgen simulate`"
        )
    if demand.error is not None:
        cost, error = place(known[-1])
        return ModelgenError(
            "--error",
            f"{demand.error:g} is not reached",
            f"the reachable error is {_up(error, 2)}, at {cost / 1e3:.3g} us per simulated second",
            "ask for that, or for less of the run (--until)",
        )
    cost, error = place((front(slow) or known)[0])
    return ModelgenError(
        "--budget",
        f"{(demand.budget or 0.0) / 1e3:g} us per simulated second is not enough",
        f"the cheapest setting takes {_up(cost / 1e3, 3)} us, with an error of {error:.2g}",
        "ask for that, or leave more --knobs to be turned",
    )


def _up(value: float, digits: int) -> str:
    """Rounded up, so that what is asked for by this number can be had."""
    return f"{float(Context(digits, ROUND_CEILING).create_decimal(repr(value))):g}"


def _time_up(known: Sequence[Point], demand: Demand) -> ModelgenError:
    """The refusal of a demand that more time may meet."""
    if demand.error is not None:
        wanted, best = f"an error of {demand.error:g} was reached", known[-1:]
    else:
        wanted = f"{(demand.budget or 0.0) / 1e3:g} us per simulated second was met"
        best = known[:1]
    told = [
        f"the best so far is {_up(error, 2)}, at {_up(cost / 1e3, 3)} us per simulated second"
        for cost, error in map(place, best)
    ]
    remedy = "the same command goes on from there, or give it more"
    return ModelgenError("--limit", f"the time was up before {wanted}", "".join(told), remedy)


def _refuse_beyond_horizon(found: Measurement, demand: Demand) -> None:
    """An error cannot be promised for a time that cannot be predicted."""
    horizon, until = found.reference["horizon"], found.subject.until
    if demand.error is None or horizon is None:
        return
    raise ModelgenError(
        "--error",
        f"the trajectory cannot be predicted to {until:g} s: {found.reference['reason']}",
        f"an error can be promised up to {horizon:g} s",
        f"give --until {horizon:g}, or a --budget",
    )
