"""This program as something to measure: from settings to a point, remembered where it was measured before."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass, field, replace
from functools import cached_property
from typing import Any

from modelgen.benchmark.callgrind_counts import instructions
from modelgen.benchmark.cost import YARD, cost_of
from modelgen.benchmark.knobs import Settings, Space
from modelgen.benchmark.measurement_store import Store
from modelgen.benchmark.motion_errors import errors, separation
from modelgen.benchmark.reference_solution import Reference, reference_of
from modelgen.benchmark.sampled_motion import Motion, motion_of
from modelgen.benchmark.scene_under_measurement import Built, Subject
from modelgen.benchmark.work_precision_front import Point
from modelgen.codegen.compiler import LEVEL
from modelgen.codegen.library import Library
from modelgen.errors import SimulationError
from modelgen.runtime.accuracy import Accuracy
from modelgen.runtime.cpu_time import core_time

PATIENCE_S = 5.0  # of CPU time for one run; a ladder goes no further than the first that takes longer
LATE = 1e-9  # s, relative: a run that comes as far as the reference has come to its end


@dataclass
class Bench:
    """A subject with its reference, what is remembered of it, and the yardstick of this machine."""

    subject: Subject
    space: Space
    store: Store
    fresh: bool = False  # nothing that was remembered is believed
    reused: int = 0  # points that were remembered
    yards: list[float] = field(default_factory=list)

    @cached_property
    def plain(self) -> Library:
        """The scene's library as it is built unasked."""
        return self.subject.built({}).library

    @cached_property
    def reference(self) -> Reference:
        """Runs on first use: a measurement that is remembered whole needs it not."""
        return reference_of(self.subject, self.space)

    @cached_property
    def reference_facts(self) -> dict[str, Any]:
        key = self.subject.key(self.plain, {"reference": asdict(Accuracy.finest())})
        return dict(self.recall(key, lambda: self.reference.facts()))

    def remembers(self, key: str) -> bool:
        return not self.fresh and self.store.get(key) is not None

    def recall(self, key: str, make: Callable[[], Any]) -> Any:
        """The stored value of a key; computed and stored if there is none."""
        if self.remembers(key):
            return self.store.get(key)
        made = make()
        self.store.put(key, made)
        return made

    def yard(self) -> float:
        """CPU seconds of a piece of work that is always the same."""
        return core_time(self.plain, Accuracy.balanced(), self.subject.until, YARD)

    def judged(self, motion: Motion) -> tuple[float, dict[str, Any]]:
        """The error that counts, and all errors, of a motion."""
        true = self.reference
        parts = errors(motion, true.motion, true.bodies, true.horizon)
        apart = separation(motion, true.motion, true.bodies)
        n = len(apart) if true.horizon is None else int((true.motion.t[: len(apart)] <= true.horizon).sum())
        return max(float(apart[:n].max(initial=0.0)), true.error), parts

    def came_as_far(self, t_end: float) -> bool:
        return t_end >= self.reference.end * (1 - LATE)


def point_of(bench: Bench, settings: Settings) -> Point:
    """The measured or stored point of one setting of this program."""
    built = bench.subject.built(settings)
    key = bench.subject.key(built.library, {"settings": dict(settings)})
    bench.reused += bench.remembers(key)
    known = bench.recall(key, lambda: _measured(bench, settings).as_json())
    return Point(**known)


def _compile_s(bench: Bench, built: Built) -> float | None:
    """CPU seconds of the compiler when this library was built; None if not measured."""
    key = bench.subject.key(built.library, {"compile": True})
    if built.compile_s is not None:
        bench.store.put(key, built.compile_s)
    return bench.store.get(key)  # type: ignore[no-any-return]


def _measured(bench: Bench, settings: Settings) -> Point:
    built = bench.subject.built(settings)
    library, accuracy = built.library, bench.subject.accuracy(settings)
    try:
        path = bench.subject.run(library, accuracy)
    except SimulationError as refused:
        return Point(settings, None, None, remark=str(refused))
    sizes = {"binary_bytes": library.path.stat().st_size, "compile_s": _compile_s(bench, built)}
    if not bench.came_as_far(path.t_end):
        ending = f"ended at {path.t_end:.6g} s: {path.outcome.value}"
        return Point(
            settings, None, None, costs=sizes | {"too_long": path.wall_s > PATIENCE_S}, remark=ending
        )
    error, parts = bench.judged(motion_of(path, bench.reference.bodies))
    end = bench.subject.until
    cost = cost_of(lambda: core_time(library, accuracy, end), bench.yard)
    bench.yards.append(cost.yard)
    return Point(
        settings=settings,
        error=error,
        cost_ns_per_s=cost.seconds / end * 1e9,
        errors=parts,
        costs={
            "noise": cost.noise,
            "yard_s": cost.yard,
            "steps": path.steps,
            "rhs_evals": path.rhs_evals,
            "too_long": cost.seconds > PATIENCE_S,
            **sizes,
        },
    )


def counted(bench: Bench, points: list[Point], at: int) -> None:
    """Puts the instructions per simulated second of one point, that was measured, among its costs."""
    settings = points[at].settings
    built, until = bench.subject.built(settings), bench.subject.until
    accuracy, level = bench.subject.accuracy(settings), str(settings.get("level", LEVEL))
    key = bench.subject.key(built.library, {"instructions": dict(settings)})
    found = bench.recall(key, lambda: [instructions(built.library, accuracy, until, level)])[0]
    costs = points[at].costs | {"instructions_per_s": None if found is None else found / until}
    points[at] = replace(points[at], costs=costs)


def scaled(points: list[Point]) -> list[Point]:
    """Costs as of the fastest moment of the machine: each by what the yardstick took beside it."""
    fastest = min((point.costs["yard_s"] for point in points if _timed(point)), default=0.0)
    return [_at_speed(point, fastest) if _timed(point) else point for point in points]


def _timed(point: Point) -> bool:
    return point.cost_ns_per_s is not None and bool(point.costs.get("yard_s"))


def _at_speed(point: Point, yard: float) -> Point:
    share = yard / point.costs["yard_s"]
    return replace(
        point, cost_ns_per_s=(point.cost_ns_per_s or 0.0) * share, costs=point.costs | {"yard_s": yard}
    )
