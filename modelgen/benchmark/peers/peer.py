"""Other simulators in the same measurement: one interface, swept and judged as this program is."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np

from modelgen.benchmark.cost import Cost, cost_of
from modelgen.benchmark.front_search import sweep
from modelgen.benchmark.knobs import Knob, Settings, Space
from modelgen.benchmark.peers.scene_description import Setup
from modelgen.benchmark.sampled_motion import Array, Motion
from modelgen.benchmark.setting_evaluation import Bench
from modelgen.benchmark.work_precision_front import Point, advantage, compared, front
from modelgen.errors import ModelgenError, install

PATIENCE = 4.0  # s of CPU time per simulated second, after which a run is given up
SLOW = 1.0  # s of CPU time per simulated second; a ladder goes no further than the first that takes longer

Run = Callable[[], tuple[Array, float]]  # (samples + 1, nb, 10) of p, quaternion, v; CPU seconds


class Adapter(Protocol):
    """A scene as a simulator has it."""

    @property
    def cannot(self) -> list[str]:
        """Sentences: what of the scene it cannot represent; then it is not run."""

    @property
    def differs(self) -> list[str]:
        """Sentences: what it represents otherwise."""

    @property
    def version(self) -> str: ...

    @property
    def knobs(self) -> tuple[Knob, ...]:
        """Those that matter here."""

    def prepare(self, settings: Settings) -> Run:
        """A function that runs the scene from its start; raises PeerError where it does not get through."""


class PeerError(Exception):
    """Why a simulator did not come to the end; finer settings need not be tried where it took too long."""

    def __init__(self, why: str, too_long: bool = False) -> None:
        super().__init__(why)
        self.too_long = too_long


@dataclass(frozen=True, slots=True)
class Peer:
    """A simulator: all its knobs, and how a scene is put to it."""

    name: str
    knobs: tuple[Knob, ...]
    adapter: Callable[[Setup], Adapter]
    find: Callable[[], object]  # raises ModelgenError where the simulator is not installed


@dataclass(slots=True)
class PeerPoints:
    """Measurements of a peer; none, with the reasons, if it cannot represent the scene."""

    name: str
    cannot: list[str]
    points: list[Point]
    differs: list[str] = field(default_factory=list)  # what it represents otherwise
    version: str = ""
    turned: list[str] = field(default_factory=list)  # its knobs that are varied
    left: list[str] = field(default_factory=list)  # its knobs if --knobs names none of them

    @property
    def front(self) -> list[Point]:
        return front(self.points)

    def advantage(self, ours: Sequence[Point]) -> dict[str, float] | None:
        """Ratio of cost of our points to the peer's best within SLOW; None where --knobs names none of its
        knobs."""
        return None if self.left else advantage(ours, self.points, SLOW * 1e9)

    def cited(self, ours: Sequence[Point]) -> tuple[Point, ...]:
        """The points that `advantage` is about."""
        return () if self.left else compared(ours, self.points, SLOW * 1e9) or ()

    def as_json(self, ours: Sequence[Point]) -> dict[str, Any]:
        return {
            "version": self.version,
            "cannot": self.cannot,
            "differs": self.differs,
            "knobs": self.turned,
            "advantage": self.advantage(ours),
            "front": [point.as_json() for point in self.front],
            "points": [point.as_json() for point in self.points],
        }


def peer_points(
    peer: Peer, bench: Bench, into: PeerPoints, left: Callable[[], bool], report: Callable[[str], None]
) -> None:
    """Sweeps a peer's knobs; the points go `into` as they are measured."""
    theirs = peer.adapter(Setup.of(bench))
    into.version = theirs.version
    into.cannot += theirs.cannot
    into.differs += theirs.differs
    if theirs.cannot:
        return

    free = bench.space.free
    into.turned += [knob.name for knob in theirs.knobs if free is None or knob.ladder or knob.name in free]
    if free is not None and not any(knob.name in free for knob in theirs.knobs):
        into.left += [knob.name for knob in theirs.knobs]
    first = {k.name: k.values(bench.space.facts)[0] for k in theirs.knobs if not k.ladder}

    def evaluate(settings: Settings) -> Point:
        report(f"{peer.name}: " + ", ".join(f"{name} {value}" for name, value in settings.items()))
        what = {"peer": peer.name, "version": theirs.version, "settings": dict(settings)}
        key = bench.subject.key(bench.plain, what)
        return Point(**bench.recall(key, lambda: _measured(bench, theirs, settings, first).as_json()))

    for point in sweep(Space(theirs.knobs, bench.space.facts, bench.space.free), evaluate, left):
        into.points.append(point)


def _measured(bench: Bench, theirs: Adapter, settings: Settings, first: Settings) -> Point:
    """A point; the knobs that are not turned stand at their first values."""
    try:
        states, cost = _timed(bench, theirs.prepare({**first, **settings}))
    except PeerError as failure:
        return Point(settings, None, None, costs={"too_long": failure.too_long}, remark=str(failure))
    until = bench.subject.until
    costs = {"noise": cost.noise, "yard_s": cost.yard, "too_long": cost.seconds > SLOW * until}
    if not np.isfinite(states).all():
        return Point(settings, None, None, costs=costs, remark="its state became infinite")
    t = np.linspace(0.0, until, len(states))
    motion = Motion(t, states[..., :3], states[..., 3:7], states[..., 7:10], None, None, {})
    error, parts = bench.judged(motion)
    return Point(settings, error, cost.seconds / until * 1e9, parts, costs)


def _timed(bench: Bench, run: Run) -> tuple[Array, Cost]:
    """The states of the last run, and what it costs: measured as this program's own runs are."""
    states: list[Array] = []

    def once() -> float:
        found, seconds = run()
        states[:] = [found]
        return seconds

    cost = cost_of(once, bench.yard)
    return states[0], cost


def sampled(
    setup: Setup, advance: Callable[[int, float], None], read: Callable[[], Array]
) -> tuple[Array, float]:
    """Values of `read` at the start and after each `advance(sample, t)`, and CPU seconds of `advance`."""
    rows, spent = [read()], 0.0
    for sample, t in enumerate(setup.times[1:]):
        begun = time.process_time()
        advance(sample, float(t))
        spent += time.process_time() - begun
        rows.append(read())
        if spent > PATIENCE * setup.until:
            raise PeerError(f"{spent:.3g} s of CPU time up to {t:.6g} s", too_long=True)
    return np.array(rows), spent


def missing(name: str, extra: str) -> ModelgenError:
    """The error of a simulator that is asked for and not installed; the extra brings it."""
    return ModelgenError("--against", f"{name} is not installed", "", install(extra))
