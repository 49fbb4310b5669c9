"""The work-precision front of a scene, measured against a reference of its own making."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from modelgen.benchmark.callgrind_counts import why_not_counted
from modelgen.benchmark.front_search import sweep
from modelgen.benchmark.knobs import KNOBS, Settings
from modelgen.benchmark.measurement_store import Store
from modelgen.benchmark.peers import PEERS, Peer, PeerPoints, peer_points
from modelgen.benchmark.scene_under_measurement import Subject
from modelgen.benchmark.setting_evaluation import Bench, counted, point_of, scaled
from modelgen.benchmark.work_precision_front import Point, front, place, spaced
from modelgen.errors import ModelgenError, expect, path_of
from modelgen.name_suggestions import nearest
from modelgen.runtime.arguments import (
    check_flag,
    check_function,
    check_positive,
    check_whole,
    names_in,
    values_by_name,
)
from modelgen.scene.parameter_rereading import scene_with
from modelgen.scene.scene_types import Scene

INTERRUPTED, TIME_UP = "interrupted", "the time was up"  # why a measurement stopped early
KEPT = "what was measured is kept, the same command{} goes on from there"
SHOWN = 1.5  # of the error between two rows of a table; `--json` has all
COUNTED_NS = 2e8  # of CPU time: longer runs are not counted, which takes fifty times as long

Report = Callable[[str], None]  # told what is measured next


@dataclass(frozen=True)
class Measurement:
    """Measurements of a scene. `interrupted` says why they are not complete, and how to continue."""

    subject: Subject
    knobs: dict[str, list[Any]]
    left_out: dict[str, str]
    reference: dict[str, Any]
    length: float  # m; errors are relative to it
    points: list[Point]
    peers: list[PeerPoints] = field(default_factory=list)
    interrupted: str = ""
    reused: int = 0  # points that were remembered

    @property
    def front(self) -> list[Point]:
        return front(self.points)

    def as_json(self) -> dict[str, Any]:
        """The object that `measure --json` prints."""
        return {
            "scene": self.subject.scene.name,
            "until": self.subject.until,
            "samples": self.subject.samples,
            "length": self.length,
            "knobs": self.knobs,
            "left_out": self.left_out,
            "reference": self.reference,
            "reference_error": self.reference["error"],
            "horizon": self.reference["horizon"],
            "noise": self.noise,
            "not_counted": why_not_counted(),
            "front": [point.as_json() for point in self.front],
            "points": [point.as_json() for point in self.points],
            "peers": {peer.name: peer.as_json(self.points) for peer in self.peers},
            "interrupted": self.interrupted,
            "reused": self.reused,
        }

    @property
    def was_stopped(self) -> bool:
        """Whether Ctrl-C ended it."""
        return self.interrupted.startswith(INTERRUPTED)

    @property
    def noise(self) -> float | None:
        """The median spread of repeated runs, relative: costs are known no better."""
        known = sorted(p.costs["noise"] for p in self.points if p.costs.get("noise") is not None)
        return known[len(known) // 2] if known else None


def measure(
    scene: Scene,
    *,
    until: float | None = None,
    samples: int | None = None,
    knobs: Sequence[str] | None = None,
    against: Sequence[str] = (),
    count: bool = True,
    limit: float | None = None,
    fresh: bool = False,
    parameters: Mapping[str, float] | None = None,
    root: str | Path = "generated",
    on_progress: Report | None = None,
) -> Measurement:
    """Sweep the knobs that matter for a scene; what was measured before is taken from `root`.

    Args:
        scene: what `read` returned.
        until, samples: span, s, and output intervals; the scene's own when None.
        knobs: names of the knobs to turn; all that matter when None.
        against: names of other simulators, of PEERS, in the same measurement.
        count: count the instructions of the settings that a table shows, where valgrind is installed.
        limit: wall time, s, after which no further setting is tried.
        fresh: measure again what was measured before.
        parameters: values of parameters of the scene by name; others keep the scene's own.
        root: the folder that generated libraries lie in.
        on_progress: called with the settings that are tried next.

    Ctrl-C keeps what was measured, once there is a reference. Raises ModelgenError for an unknown name
    or a simulator that is not installed, before anything is measured.
    """
    expect("measure", scene, Scene)
    check_numbers(until=until, limit=limit)
    if samples is not None:
        check_whole("samples", samples, "give the number of output intervals")
    for name, flag in (("count", count), ("fresh", fresh)):
        check_flag(name, flag)
    check_function("on_progress", on_progress)
    root = path_of("measure", root)
    scene = scene_with(scene, values_by_name("parameters", parameters))
    peers = [PEERS[name] for name in _known("--against", against, list(PEERS)) or ()]
    turned = [knob.name for table in (KNOBS, *(peer.knobs for peer in peers)) for knob in table]
    chosen = _known("--knobs", knobs, turned)
    for peer in peers:
        peer.find()
    bench = bench_of(scene, until, samples, chosen, fresh, root)
    facts = bench.reference_facts
    points, others = list[Point](), list[PeerPoints]()
    report = on_progress or (lambda text: None)
    stopped = _sweep_all(bench, points, peers, others, limit, report)
    if count and not stopped:
        stopped = _count_all(bench, points, report)
    return _measurement(bench, facts, points, others, stopped)


def check_numbers(**numbers: object) -> None:
    """Raises SimulationError unless each is a positive, finite number or None."""
    for name, value in numbers.items():
        if value is not None:
            check_positive(name, value, "leave it out, or give a number")


def _measurement(
    bench: Bench, reference: dict[str, Any], points: list[Point], peers: list[PeerPoints], stopped: str
) -> Measurement:
    space = bench.space
    turned = [knob for knob in space.knobs if _turns(bench, knob.name)]
    return Measurement(
        subject=bench.subject,
        knobs={knob.name: list(space.values(knob)) for knob in turned},
        left_out={knob.name: knob.trades for knob in KNOBS if knob not in turned},
        reference=reference,
        length=bench.plain.manifest.instance["scales"]["length"],
        points=points,
        peers=peers,
        interrupted=stopped and resumable(stopped, bench.fresh),
        reused=bench.reused,
    )


def _share_speed(points: list[Point], peers: list[PeerPoints]) -> None:
    """All costs as of the fastest moment of the machine, those of the peers too."""
    lists = [points, *(peer.points for peer in peers)]
    at_speed = iter(scaled([point for each in lists for point in each]))
    for each in lists:
        each[:] = [next(at_speed) for _ in each]


def bench_of(
    scene: Scene,
    until: float | None,
    samples: int | None,
    knobs: tuple[str, ...] | None,
    fresh: bool,
    root: Path,
) -> Bench:
    """A scene set up to be measured."""
    subject = Subject(scene, until or scene.run.until, samples or scene.run.samples, root)
    return Bench(subject, subject.space(knobs), Store(root / scene.name), fresh)


def _sweep_all(
    bench: Bench,
    points: list[Point],
    peers: list[Peer],
    others: list[PeerPoints],
    limit: float | None,
    report: Report,
) -> str:
    """Fills points and others, at one speed of the machine; INTERRUPTED, TIME_UP, or an empty text."""
    begun = time.monotonic()

    def left() -> bool:
        return limit is None or time.monotonic() - begun < limit

    def evaluate(settings: Settings) -> Point:
        report(described(settings))
        return point_of(bench, settings)

    try:
        points.extend(sweep(bench.space, evaluate, left))
        for peer in peers:
            others.append(PeerPoints(peer.name, [], []))
            peer_points(peer, bench, others[-1], left, report)
    except KeyboardInterrupt:
        return INTERRUPTED
    finally:
        _share_speed(points, others)
    return "" if left() else TIME_UP


def _count_all(bench: Bench, points: list[Point], report: Report) -> str:
    """Counts the instructions of the settings that a table shows; INTERRUPTED, or an empty text."""
    shown = spaced(front(points), SHOWN)
    try:
        for at, point in enumerate(points):
            if point in shown and place(point)[0] * bench.subject.until <= COUNTED_NS:
                report(f"instructions of {described(point.settings)}")
                counted(bench, points, at)
    except KeyboardInterrupt:
        return INTERRUPTED
    return ""


def resumable(stopped: str, fresh: bool = False) -> str:
    """The sentence on a measurement that stopped early; one that forgets goes on only if it remembers."""
    return f"{stopped}: {KEPT.format(' without --fresh' if fresh else '')}"


def described(settings: Settings) -> str:
    return ", ".join(f"{name} {value}" for name, value in settings.items())


def _turns(bench: Bench, name: str) -> bool:
    """Whether a knob has a place in some of the settings that are swept."""
    rungs = [rung for ladder in bench.space.ladders() for rung in ladder[:1]]
    forms = [bench.space.settled(rung | {"form": form}) for rung in rungs for form in bench.space.facts.forms]
    return any(name in settings for settings in forms)


def _known(option: str, names: Sequence[str] | None, allowed: list[str]) -> tuple[str, ...] | None:
    if names is None:
        return None
    for name in (chosen := names_in(option, names)):
        if name not in allowed:
            raise ModelgenError(
                option,
                f"no {name!r}",
                f"allowed: {', '.join(allowed)}",
                nearest(name, allowed) or "use one of these names",
            )
    return tuple(chosen)
