"""What verdicts are worth: random scenes of nine classes, each beside twins that must move as it does.

    python -m tests.benchmarks.verdicts [--count 60] [--classes "tossed solids,.."] [--part I/N] [--out FILE]

A scene is run at `balanced`, and so are its twins: turned with the world, mirrored, scaled, written in
another order, and with gravity and velocities that differ by TILT of themselves, so that impacts of which
both could be first come in both orders; one twin is run at `tight`. A twin agrees if the bodies are where
those of the scene are at each sample up to which both predict, within the sum of both stated errors (of a
tilted twin, and TILT_MAY; one that is farther away agrees if the distance is proportional to the tilt, as
where motions part fast). Told for each class: runs that are trusted, those that are done and not trusted,
those that ended early, took longer than LIMIT_S or were refused; of those whose twins agree, and of those
of which one does not, how many are trusted; and how often each reason is met. Exits with 1 if a run is
trusted with which a twin disagrees.
"""

from __future__ import annotations

import argparse
import json
import re
import signal
from collections import Counter, defaultdict
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from modelgen import ModelgenError, simulate
from modelgen.runtime.trajectory import Outcome, Trajectory
from modelgen.scene.scene_from_tables import scene_from_tables
from tests.benchmarks.scene_twins import Twin, mirrored, reordered, rotated, scaled, tilted
from tests.benchmarks.verdict_scenes import CLASSES, Tables, drawn
from tests.running import library_of

LIMIT_S = 60.0  # CPU time of a run with its companion
TILT, TILT_MAY = 1e-12, 1e-8  # by how much a tilted twin differs at its start, and in m and rad later
LINEAR = (
    0.5  # relative; a distance that is so nearly proportional to the tilt is that of other data, no error
)
ROUNDED = 1e-12  # m, rad: nearer than that, twins agree
NUMBER = re.compile(r"[-+]?\d+\.?\d*(?:e[-+]?\d+)?(?: of)?")
TWINS: Mapping[str, Callable[[Tables, int], Twin]] = {
    "turned": lambda tables, seed: rotated(tables, Rotation.random(random_state=seed)),
    "mirrored": lambda tables, _: mirrored(tables),
    "scaled": lambda tables, _: scaled(tables, 3.0),
    "reordered": lambda tables, _: reordered(tables),
    "tilted": lambda tables, seed: tilted(tables, TILT, seed),
    "tight": lambda tables, _: Twin(tables, lambda p: p, lambda q: q),
}


@dataclass(frozen=True)
class Row:
    """What was found of a scene."""

    name: str  # of its class
    seed: int
    verdict: str  # trusted, not trusted, early, beyond limit, refused
    doubts: tuple[str, ...]
    apart: Mapping[str, float]  # by twin: the largest distance over what is allowed


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--count", type=int, default=60)
    parser.add_argument("--classes", default=",".join(CLASSES))
    parser.add_argument("--part", default="1/1", help="I/N: every Nth scene, from the Ith on")
    parser.add_argument("--only", type=int, help="the scene of this number")
    parser.add_argument("--twins", default=",".join(TWINS))
    parser.add_argument("--out", type=Path, help="a file of all rows, JSON")
    given = parser.parse_args()
    first, parts = map(int, given.part.split("/"))
    seeds = range(first - 1, given.count, parts) if given.only is None else [given.only]
    rows: list[Row] = []
    for name in given.classes.split(","):
        for seed in seeds:
            rows.append(judged(name, seed, [each for each in TWINS if each in given.twins.split(",")]))
            _tell(rows[-1])
            if given.out:
                given.out.write_text(json.dumps([asdict(each) for each in rows], indent=1))
    return _summary(rows)


def judged(name: str, seed: int, twins: list[str]) -> Row:
    tables = drawn(name, seed)
    path = _run(tables)
    if isinstance(path, str):
        return Row(name, seed, path, (), {})
    if path.outcome is not Outcome.DONE:
        return Row(name, seed, f"early: {path.outcome.name.lower()}", path.doubts, {})
    apart = {each: _ratio(path, each, TWINS[each](tables, seed)) for each in twins}
    if apart.get("tilted", 0.0) > 1:
        tenth = _ratio(path, "tilted", tilted(tables, TILT / 10, seed))
        if abs(10 * tenth / apart["tilted"] - 1) < LINEAR:
            apart["tilted"] = min(tenth, 1.0)
    return Row(name, seed, "trusted" if path.is_trusted else "not trusted", path.doubts, apart)


def _ratio(path: Trajectory, each: str, twin: Twin) -> float:
    """How far a twin is from a run, over what is allowed; NaN if it does not run."""
    other = _run(twin.tables, "tight" if each == "tight" else "balanced")
    return (
        float("nan")
        if isinstance(other, str)
        else _apart(path, other, twin, TILT_MAY if each == "tilted" else ROUNDED)
    )


def _run(tables: Tables, accuracy: str = "balanced") -> Trajectory | str:
    """A run, or in words why there is none."""
    try:
        library = library_of(scene_from_tables("drawn", tables, "<drawn>"))
        with _limited(LIMIT_S):
            path = simulate(library, accuracy=accuracy)
    except ModelgenError as error:
        return f"refused: {error}"
    except KeyboardInterrupt:
        return "beyond limit"
    return "beyond limit" if path.interrupted or (path.estimate and path.estimate.interrupted) else path


@contextmanager
def _limited(seconds: float) -> Iterator[None]:
    """Interrupts what runs within after so much CPU time, as Ctrl-C does."""
    before = signal.signal(signal.SIGPROF, lambda *_: signal.raise_signal(signal.SIGINT))
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)


def _apart(path: Trajectory, other: Trajectory, twin: Twin, slack: float) -> float:
    """The largest distance of a body from where a twin has it, over the sum of the stated errors, up to the
    last sample to which both predict; infinite if the twin has ended before."""
    assert path.estimate is not None
    assert other.estimate is not None
    n = min(path.estimate.predicted, other.estimate.predicted)
    if len(other.t) < path.estimate.predicted and other.outcome is not Outcome.DONE:
        return float("inf")
    names = [name for name in path.body_names if name != "world"]
    mine, order = ([run.body_names.index(name) for name in names] for run in (path, other))
    size = float(np.linalg.norm(twin.positions(np.array([[1.0, 0.0, 0.0]]))))
    away = np.linalg.norm(twin.positions(path.p[:n, mine]) - other.p[:n, order], axis=-1).max(axis=1)
    chord = twin.quaternions(path.quaternion[:n, mine])
    turn = np.minimum(*(np.linalg.norm(chord + s * other.quaternion[:n, order], axis=-1) for s in (1, -1)))
    allowed = size * path.estimate.position[:n] + other.estimate.position[:n]
    turn_allowed = path.estimate.rotation[:n] + other.estimate.rotation[:n]
    ratios = [away / (allowed + slack * size), 2 * turn.max(axis=1) / (turn_allowed + slack)]
    return float(np.max(ratios, initial=0.0))


def reason(doubt: str) -> Iterator[str]:
    """The kinds of reasons in a doubt, without their numbers and names."""
    for each in doubt.removeprefix("uncertified: ").split("; "):
        yield NUMBER.sub("..", each)[:70]


def _tell(row: Row) -> None:
    apart = {key: f"{value:.2g}" for key, value in row.apart.items() if not value <= 1}
    if row.verdict != "trusted" or apart:
        print(
            f"{row.name} {row.seed}: {row.verdict[:150]}; {'; '.join(row.doubts)[:200]} {apart or ''}",
            flush=True,
        )


def _summary(rows: list[Row]) -> int:
    table: defaultdict[str, Counter[str]] = defaultdict(Counter)
    reasons: defaultdict[str, Counter[str]] = defaultdict(Counter)
    agree, differ = Counter[bool](), Counter[bool]()
    for row in rows:
        table[row.name][row.verdict.split(":")[0]] += 1
        reasons[row.name].update({each for doubt in row.doubts for each in reason(doubt)})
        known = [each for each in row.apart.values() if not np.isnan(each)]
        if known:
            (agree if max(known) <= 1 else differ)[row.verdict == "trusted"] += 1
    for name, counts in table.items():
        print(f"{name:24}", "; ".join(f"{n} {verdict}" for verdict, n in sorted(counts.items())))
        for each, n in reasons[name].most_common():
            print(f"    {n:3} {each}")
    print(f"twins agree: {agree[True]} trusted, {agree[False]} not")
    print(f"a twin differs: {differ[True]} trusted, {differ[False]} not")
    return int(differ[True] > 0)


if __name__ == "__main__":
    raise SystemExit(main())
