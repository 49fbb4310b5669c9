"""Other simulators in the same measurement. Each is an extra, imported when it is asked for."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from modelgen.measure.front import Point, advantage, front
from modelgen.measure.knobs import Knob, Settings, Space
from modelgen.measure.motion import Motion
from modelgen.measure.mujoco import KNOBS as MUJOCO
from modelgen.measure.mujoco import MujocoScene
from modelgen.measure.program import Bench
from modelgen.measure.search import sweep

SLOW = 1.0  # s of CPU time per simulated second; a ladder goes no further than the first that takes longer
Run = Callable[[Settings], tuple[Motion | None, float, str]]  # motion, CPU seconds, why there is none


@dataclass(frozen=True, slots=True)
class Peer:
    """A simulator: its knobs, what it cannot represent of a scene, and how it is run."""

    name: str
    knobs: tuple[Knob, ...]
    scene: Callable[[Bench], Any]  # has `cannot` (sentences), `version` and `run` (a Run)


@dataclass(slots=True)
class PeerPoints:
    """What was measured of a peer; nothing, with the reasons, where it cannot represent the scene."""

    name: str
    cannot: list[str]
    points: list[Point]
    differs: list[str] = field(default_factory=list)  # what it represents otherwise

    @property
    def front(self) -> list[Point]:
        return front(self.points)

    def advantage(self, ours: Sequence[Point]) -> dict[str, float] | None:
        """Of our points over the peer's best within SLOW."""
        return advantage(ours, self.points, SLOW * 1e9)

    def as_json(self, ours: Sequence[Point]) -> dict[str, Any]:
        return {
            "cannot": self.cannot,
            "differs": self.differs,
            "advantage": self.advantage(ours),
            "front": [point.as_json() for point in self.front],
            "points": [point.as_json() for point in self.points],
        }


PEERS: Mapping[str, Peer] = {"mujoco": Peer("mujoco", MUJOCO, MujocoScene.of)}


def peer_points(
    peer: Peer, bench: Bench, into: PeerPoints, left: Callable[[], bool], report: Callable[[str], None]
) -> None:
    """Sweeps a peer's knobs; the points go `into` as they are measured."""
    theirs = peer.scene(bench)
    into.cannot += theirs.cannot
    into.differs += theirs.differs
    if theirs.cannot:
        return

    def evaluate(settings: Settings) -> Point:
        report(f"{peer.name}: " + ", ".join(f"{name} {value}" for name, value in settings.items()))
        what = {"peer": peer.name, "version": theirs.version, "settings": dict(settings)}
        key = bench.subject.key(bench.plain, what)
        return Point(**bench.recall(key, lambda: _judged(bench, theirs.run, settings).as_json()))

    for point in sweep(Space(peer.knobs, bench.space.facts, bench.space.free), evaluate, left):
        into.points.append(point)


def _judged(bench: Bench, run: Run, settings: Settings) -> Point:
    motion, seconds, remark = run(settings)
    costs = {"noise": None, "too_long": seconds > SLOW * bench.subject.until}
    if motion is None:
        return Point(settings, None, None, costs=costs, remark=remark)
    error, parts = bench.judged(motion)
    return Point(settings, error, seconds / bench.subject.until * 1e9, parts, costs)
