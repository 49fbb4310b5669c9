"""Seeded scenes of shapes that are not convex, with clearances by decades, judged by an independent distance.

    python -m tests.benchmarks.non_convex_scenes --first 0 --count 1000 --limit 60 --out FILE

Each seed draws two or three bodies: solids that fly at each other, fall on each other, or move in a
hollow, in a tube or on a post with a clearance of 1e-5 to 0.3 of their size. Dense points of the faces
and edges of each body, refined where they are deepest, are put into the signed distance of the other. A
run fails if it is `done` and trusted, and penetrates by more than its own `gap_error_max` and what rounding
and interpolation between its steps add, TOLERANCE. One line for each seed that
fails or is not trusted, then a summary: how many are trusted, wrong, and not trusted for which reason.

Each seed is run in a process of its own, which ends at `--limit` seconds of CPU time. With `--out`, each
verdict is appended to FILE (JSON lines); a seed that is there is not run again, unless it was stopped at a
lower limit. FILE is to be deleted when the core has changed. `--seeds 3 7 12` judges these.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import re
import resource
import sys
import time
from collections import Counter
from dataclasses import asdict, dataclass
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import numpy as np

from modelgen import Accuracy, ModelgenError, simulate
from modelgen.rotations import rotation_of
from modelgen.runtime.trajectory import Outcome, Trajectory
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Scene
from tests.benchmarks.measured_solids import (
    TURN,
    Solid,
    depth,
    ellipsoid,
    floor,
    random_solid,
    torus,
    tube,
    turned,
    unit,
)
from tests.running import library_of, pool

Array = np.ndarray[Any, Any]
TOLERANCE = 1e-8  # of the characteristic length


@dataclass(frozen=True)
class Drawn:
    """A scene and the solids of its bodies."""

    scene: Scene
    solids: dict[str, Solid]
    kind: str
    clearance: float  # of the size


def _moving(name: str, solid: Solid, rng: np.random.Generator, at: Array, v: float, w: float) -> Any:
    mass = 1.0
    inertia = mass * solid.size**2 * rng.uniform(0.3, 0.4, size=3)
    return make.dynamic(
        name, solid.shape, mass=mass, inertia=[*map(float, inertia)], position=[*map(float, at)],
        quaternion=[*map(float, unit(rng.normal(size=4)))],
        velocity=[*map(float, v * rng.normal(size=3))],
        angular_velocity=[*map(float, w * rng.normal(size=3))],
    )  # fmt: skip


@dataclass(frozen=True)
class Setting:
    """What all scenes have."""

    seed: int
    rng: np.random.Generator
    size: float  # m
    clearance: float  # of the size

    @property
    def speed(self) -> float:
        return float(np.sqrt(9.81 * self.size))

    @property
    def spin(self) -> float:
        return self.speed / self.size


Bodies = dict[str, tuple[Any, Solid]]  # the body of a scene, and its solid, by name


def _fall(at: Setting) -> Bodies:
    """Two solids above each other fall on a floor."""
    a, b = random_solid(at.rng, at.size), random_solid(at.rng, at.size)
    heights = {"a": (a, 1.3 * a.size), "b": (b, 2.6 * a.size + 1.4 * b.size)}
    return {
        "floor": (make.fixed("floor", floor().shape), floor()),
        **{
            name: (_moving(name, solid, at.rng, np.array([0, 0, z]), at.speed / 3, at.spin), solid)
            for name, (solid, z) in heights.items()
        },
    }


def _flight(at: Setting) -> Bodies:
    """A solid flies at another."""
    a, b = random_solid(at.rng, at.size), random_solid(at.rng, at.size)
    away = unit(at.rng.normal(size=3)) * (a.size + b.size) * 1.1
    target = _moving("a", a, at.rng, np.zeros(3), 0.1 * at.speed, at.spin)
    flying = make.dynamic(
        "b", b.shape, mass=1.0, inertia=[0.35 * b.size**2] * 3, position=[*map(float, away)],
        velocity=[*map(float, -away / np.linalg.norm(away) * 2 * at.speed)],
        angular_velocity=[*map(float, at.spin * at.rng.normal(size=3))],
    )  # fmt: skip
    return {"a": (target, a), "b": (flying, b)}


def _hollow(at: Setting) -> Bodies:
    """A solid moves in a hollow, whose inner ball it just fits."""
    size, rng = at.size, at.rng
    if rng.random() < 0.5:
        x, y, z = map(float, size * rng.uniform(1, 2, size=3))
        b = ellipsoid(x, y, z, cavity=True)
    else:
        b = turned(size, size * rng.uniform(0.8, 1.5), rng.uniform(0.1, 0.4), rng.uniform(-0.05, 0.05), True)
    a = _fitting(at.seed, b.inner * (1 - at.clearance))
    moving = _moving("a", a, rng, np.zeros(3), at.speed, at.spin)
    return {"b": (make.fixed("b", b.shape), b), "a": (moving, a)}


def _peg(at: Setting) -> Bodies:
    """A peg in a tube, tilted within the clearance."""
    size, rng = at.size, at.rng
    bore = size * rng.uniform(0.5, 1)
    b = tube(bore * 1.4, bore, 4 * size)
    half = size * rng.uniform(0.3, 1)
    a = tube(bore * (1 - at.clearance), 0.0, 2 * half)
    lean, way = rng.uniform(0, 0.4) * at.clearance * bore / half, rng.uniform(0, TURN)
    tilt = {"axis": [float(np.cos(way)), float(np.sin(way)), 0.0], "angle": float(lean)}
    peg = _loose(at, a, at.clearance * bore * at.spin, half, axis_angle=tilt)
    return {"b": (make.fixed("b", b.shape), b), "a": (peg, a)}


def _post(at: Setting) -> Bodies:
    """A ring or a tube on a post."""
    size, rng = at.size, at.rng
    if rng.random() < 0.5:
        ring = torus(size, size * rng.uniform(0.1, 0.4))
    else:
        ring = tube(size * 1.3, size * rng.uniform(0.4, 0.9), size * rng.uniform(0.2, 0.6))
    post = tube(ring.extra["hole"] * (1 - at.clearance), 0.0, 6 * size)
    loose = _loose(at, ring, at.clearance * size * at.spin, size)
    return {"b": (make.fixed("b", post.shape), post), "a": (loose, ring)}


def _loose(at: Setting, solid: Solid, drift: float, arm: float, **pose: Any) -> Any:
    """A body that drifts across its clearance and leans as slowly, and spins about its axis."""
    return make.dynamic(
        "a", solid.shape, mass=1.0, inertia=[0.3 * solid.size**2] * 3, **pose,
        velocity=[*map(float, drift * at.rng.normal(size=2)), 0.0],
        angular_velocity=[*map(float, at.rng.normal(size=3) * [*[0.3 * drift / arm] * 2, at.spin])],
    )  # fmt: skip


KINDS = {"fall": _fall, "flight": _flight, "hollow": _hollow, "peg": _peg, "post": _post}
PAIRS = {"fall": [("a", "floor"), ("b", "floor"), ("a", "b")]}  # otherwise a with b


def draw(seed: int) -> Drawn:
    """The scene of a seed."""
    rng = np.random.default_rng(seed)
    kind = list(KINDS)[seed % len(KINDS)]
    at = Setting(seed, rng, float(10 ** rng.uniform(-2, 1)), float(10 ** rng.uniform(-5, -0.5)))
    contact = {"restitution": float(rng.choice([0.0, 0.5, 0.8])), "friction": float(rng.choice([0.0, 0.3]))}
    bodies = KINDS[kind](at)
    scene = make.scene(
        f"seed_{seed}", [body for body, _ in bodies.values()],
        gravity=[0.0, 0.0, -9.81] if kind in ("fall", "hollow") else [0.0, 0.0, 0.0],
        contact=[{"between": list(pair), **contact} for pair in PAIRS.get(kind, [("a", "b")])],
        run={"until": 3.0 / at.spin, "accuracy": str(rng.choice(["fast", "balanced", "tight"]))},
    )  # fmt: skip
    return Drawn(scene, {name: solid for name, (_, solid) in bodies.items()}, kind, at.clearance)


def _fitting(seed: int, size: float) -> Solid:
    """A random solid that fits into a ball of this radius."""
    first = random_solid(np.random.default_rng(seed + 10**6), 1.0)
    again = random_solid(np.random.default_rng(seed + 10**6), size / first.size)
    return again if again.size <= size * (1 + 1e-9) else ellipsoid(size, size * 0.7, size * 0.5)


def penetration(drawn: Drawn, path: Trajectory) -> tuple[float, float]:
    """Deepest penetration over the samples of all pairs (m), and its time."""
    names = path.body_names
    rotations = {
        name: [rotation_of((w, x, y, z)) for w, x, y, z in path.quaternion[:, names.index(name)].tolist()]
        for name in names
    }
    worst = (-np.inf, 0.0)
    for pair in drawn.scene.contacts:
        first, second = (each[0] for each in pair.between)
        for points, other in ((first, second), (second, first)):
            solid, into = drawn.solids[points], drawn.solids[other]
            for k, t in enumerate(path.t):
                Ro, Rp = rotations[other][k], rotations[points][k]
                p = Ro.T @ (path.p[k, names.index(points)] - path.p[k, names.index(other)])
                if np.linalg.norm(p) > solid.size + into.size and into.size and not into.cavity:
                    continue
                found = depth(solid, into, p, Ro.T @ Rp, worst[0])
                if found > worst[0]:
                    worst = (found, float(t))
    return worst


@dataclass(frozen=True)
class Verdict:
    """What became of a seed."""

    seed: int
    kind: str
    clearance: float
    outcome: str
    doubts: tuple[str, ...]
    allowed: float  # of the characteristic length: `gap_error_max`
    deepest: float  # of the characteristic length
    at: float  # s
    told: float  # of the characteristic length: what the run says of itself
    cost: float  # s
    steps: int

    @property
    def is_trusted(self) -> bool:
        return self.outcome == Outcome.DONE.name and not self.doubts

    @property
    def fails(self) -> bool:
        return self.is_trusted and not self.deepest <= self.allowed + TOLERANCE

    def __str__(self) -> str:
        state = "FAILS" if self.fails else "trusted" if self.is_trusted else "told"
        return (
            f"{state} {self.seed} {self.kind} clearance {self.clearance:.0e} {self.outcome} "
            f"deepest {self.deepest:.1e} at {self.at:.4g} s, told {self.told:.1e}, {self.steps} steps, "
            f"{self.cost:.1f} s {'; '.join(self.doubts)}"
        )


def judge(seed: int, samples: int = 40) -> Verdict:
    """Runs and judges one seed."""
    drawn = draw(seed)
    begun = time.process_time()
    try:
        library = library_of(drawn.scene)
        length = library.manifest.instance["scales"]["length"]
        path = simulate(library, samples=samples, estimate=False)
    except ModelgenError as refused:
        return Verdict(seed, drawn.kind, drawn.clearance, "REFUSED", (str(refused),), 0, 0, 0, 0, 0, 0)
    cost = time.process_time() - begun
    deepest, at = penetration(drawn, path)
    allowed = Accuracy.of_run(library.manifest.instance["run"]).thresholds.gap_error_max
    return Verdict(
        seed, drawn.kind, drawn.clearance, path.outcome.name, path.doubts, allowed, deepest / length, at,
        path.penetration_max / length, cost, path.steps,
    )  # fmt: skip


def _send_verdict(seed: int, limit: int, out: Connection) -> None:
    """Judges a seed with at most `limit` seconds of CPU time from now."""
    used = sum(resource.getrusage(resource.RUSAGE_SELF)[:2])
    resource.setrlimit(resource.RLIMIT_CPU, (int(used) + limit, int(used) + limit + 1))
    out.send(judge(seed))


def judged_apart(seed: int, limit: int) -> Verdict:
    """The verdict of a process of its own; STOPPED where it needs more than `limit` seconds of CPU time."""
    fork = multiprocessing.get_context("fork")
    receiver, sender = fork.Pipe(duplex=False)
    process = fork.Process(target=_send_verdict, args=(seed, limit, sender))
    process.start()
    sender.close()
    try:
        verdict: Verdict = receiver.recv()
    except EOFError:
        process.join()
        drawn = draw(seed)
        verdict = Verdict(seed, drawn.kind, drawn.clearance, "STOPPED", (), 0, 0, 0, 0, limit, 0)
    process.join()
    return verdict


def read_verdicts(file: Path | None) -> dict[int, Verdict]:
    """The last verdict of each seed in a file of JSON lines."""
    if file is None or not file.exists():
        return {}
    lines = [json.loads(line) for line in file.read_text().splitlines()]
    return {line["seed"]: Verdict(**{**line, "doubts": tuple(line["doubts"])}) for line in lines}


def cause(verdict: Verdict) -> str:
    """The first reason why a run is not trusted, without its figures."""
    if verdict.outcome not in (Outcome.DONE.name, "REFUSED"):
        return verdict.outcome.lower()
    return re.sub(r"[-+]?\d[\d.]*(e[-+]?\d+)?|\(.*?\)", "..", verdict.doubts[0])[:110]


def summary(verdicts: list[Verdict]) -> str:
    """Lines that count the verdicts."""
    failed = [each.seed for each in verdicts if each.fails]
    trusted, costs = sum(each.is_trusted for each in verdicts), [each.cost for each in verdicts]
    lines = [
        f"{len(verdicts)} scenes, {trusted} trusted ({trusted / len(verdicts):.1%}), "
        f"{len(failed)} of them penetrate: {failed}",
        f"cost of a run: median {np.median(costs):.2f} s, 99 % {np.quantile(costs, 0.99):.1f} s, "
        f"largest {max(costs):.1f} s",
    ]
    causes: dict[str, list[int]] = {}
    for each in verdicts:
        if not each.is_trusted:
            causes.setdefault(cause(each), []).append(each.seed)
    for reason, seeds in sorted(causes.items(), key=lambda item: -len(item[1])):
        kinds = Counter(each.kind for each in verdicts if each.seed in seeds)
        lines.append(
            f"{len(seeds)} not trusted ({', '.join(f'{k} {n}' for k, n in kinds.items())}): {reason}"
        )
        lines.append(f"    {seeds}")
    return "\n".join(lines)


def main() -> None:
    """Judges the seeds."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--seeds", type=int, nargs="+", help="these, in place of `count` from `first` on")
    parser.add_argument("--limit", type=int, default=60, help="seconds of CPU time for each seed")
    parser.add_argument("--out", type=Path, help="file of verdicts, with which an earlier study goes on")
    parser.add_argument("--all", action="store_true", help="a line for each seed")
    given = parser.parse_args()
    pool().mkdir(parents=True, exist_ok=True)
    seeds = given.seeds or range(given.first, given.first + given.count)
    known = read_verdicts(given.out)
    verdicts = []
    for seed in seeds:
        verdict = known.get(seed)
        if verdict is None or (verdict.outcome == "STOPPED" and verdict.cost < given.limit):
            verdict = judged_apart(seed, given.limit)
            if given.out:
                with given.out.open("a") as file:
                    file.write(json.dumps(asdict(verdict)) + "\n")
        verdicts.append(verdict)
        if given.all or not verdict.is_trusted or verdict.fails:
            print(verdict, flush=True)
    print(summary(verdicts))
    sys.exit(any(each.fails for each in verdicts))


if __name__ == "__main__":
    main()
