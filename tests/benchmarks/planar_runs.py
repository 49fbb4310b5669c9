"""Random bodies with flat faces, dropped, thrown or pushed on a plane, a box or a can: which runs end early.

    python -m tests.benchmarks.planar_runs --seeds 0:120 --jobs 4

prints a line a seed: the body, what it lies on, how it starts and ends; then how many have a fault: an
outcome other than DONE, a passage by time-stepping, an energy drift above 1e-8, a gap below -1e-9 m, edges
that lie in the other body where no contact sees it, numbers that are not finite. Each seed runs in a process
of its own, stopped after `--limit` seconds, so that a fault of one is none of the others.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
from collections import Counter
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from math import cos, pi, sin
from pathlib import Path

import numpy as np

from modelgen import build, derive, emit, require, simulate
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Body, Scene, Shape
from tests.planar.sinking import deepest

SIZE = 0.1  # m, of the bodies
SPINS = [0.3, 0.32, 0.25]  # moments of inertia over mass and SIZE^2
DRIFT, DEPTH, SUNK = 1e-8, 1e-9, 1e-6  # depths in m; the last of what lies between points of edges


def prism(rng: np.random.Generator) -> tuple[str, Shape, float]:
    """A body of one of seven kinds, its name and its height."""
    kind, height = rng.integers(0, 7), SIZE * rng.uniform(0.4, 2.5)
    if kind == 0:
        return "box", make.box(SIZE * rng.uniform(0.5, 2), SIZE * rng.uniform(0.5, 2), height), height
    if kind == 1:
        return "can", make.cylinder(SIZE * rng.uniform(0.4, 1), height), height
    if kind == 2:
        bottom, top = SIZE * rng.uniform(0.4, 1), SIZE * rng.uniform(0.4, 1)
        if abs(bottom - top) < 0.01 * SIZE:
            top = 0.9 * bottom
        return "frustum", make.frustum(bottom, top, height), height
    if kind == 3:
        a, b = SIZE * rng.uniform(0.2, 0.5), SIZE * rng.uniform(0.8, 1.4)
        corners = np.array([[0, 0], [b, 0], [b, a], [a, a], [a, b], [0, b]]) - 0.8 * a
        return "L", make.extrusion(height, points=corners.tolist()), height
    if kind == 4:
        n, r = int(rng.integers(3, 8)), SIZE * rng.uniform(0.4, 1)
        points = [[r * cos(2 * pi * i / n), r * sin(2 * pi * i / n)] for i in range(n)]
        return f"polygon of {n}", make.extrusion(height, points=points), height
    if kind == 5:
        a, b = SIZE * rng.uniform(0.4, 1), SIZE * rng.uniform(0.4, 1)
        return "ellipse", outlined(height, "a*cos(t)", "b*sin(t)", a=a, b=b), height
    a = 0.6 * SIZE
    support = f"({a}+{0.05 * a}*cos(2*t)+{0.03 * a}*cos(3*t))"
    slope = f"(-{0.1 * a}*sin(2*t)-{0.09 * a}*sin(3*t))"
    x, y = f"{support}*cos(t)-{slope}*sin(t)", f"{support}*sin(t)+{slope}*cos(t)"
    return "outline", outlined(height, x, y), height


def outlined(height: float, x: str, y: str, **numbers: float) -> Shape:
    return make.extrusion(height, x=x, y=y, domain=(0.0, 2 * pi), parameters=numbers)


def start_of(rng: np.random.Generator, height: float) -> tuple[int, float, float, float]:
    """How it starts (0 flat, 1 flat above, 2 nearly flat, 3 tilted), its tilt, azimuth and height."""
    start = int(rng.integers(0, 4))
    small, large = 10 ** rng.uniform(-8, -1), rng.uniform(0.05, 1.2)
    tilt, azimuth = (0.0, 0.0, small, large)[start], rng.uniform(0, 2 * pi)
    rise, reach = (0.0, 0.02, 0.08, 0.15)[start], 2.5 * SIZE * sin(tilt)
    if start == 2:
        return start, tilt, azimuth, height / 2 + 0.02 + reach
    return start, tilt, azimuth, height / 2 + rise + (0.6 * reach if tilt >= 0.05 else 0.0)


def thrown(rng: np.random.Generator, shape: Shape, height: float) -> tuple[int, float, float, Body]:
    """Its start, tilt and mass, and the body."""
    start, tilt, azimuth, z = start_of(rng, height)
    mass = float(rng.uniform(0.1, 2))
    spin = rng.normal(size=3) * np.array([1, 1, 3])
    if start == 0:
        spin = np.array([0, 0, rng.normal() * 3])
    velocity = rng.normal(size=3) * 0.2
    if start == 0:
        velocity[2] = 0
    body = make.dynamic(
        "body", shape, mass=mass, inertia=[mass * SIZE**2 * each for each in SPINS],
        position=[float(rng.uniform(-0.05, 0.05)), float(rng.uniform(-0.05, 0.05)), float(z)],
        velocity=velocity.tolist(), angular_velocity=spin.tolist(),
        axis_angle={"axis": [-sin(azimuth), cos(azimuth), 0.0], "angle": float(tilt)},
    )  # fmt: skip
    return start, tilt, mass, body


def table_of(kind: int) -> Body:
    box = make.box(0.5, 0.4, 0.1, position=[0, 0, -0.05])
    can = make.cylinder(0.25, 0.1, position=[0, 0, -0.05])
    return make.fixed("table", (make.plane(), box, can)[kind])


def push_of(rng: np.random.Generator, weight: float, height: float) -> dict[str, object]:
    terms = [
        f"{weight * rng.uniform(-0.6, 0.6)!r}*sin({rng.uniform(3, 9)!r}*t{shift})" for shift in ("", "+1")
    ]
    return {"body": "body", "force": [*terms, "0"], "point": [0, 0, height * rng.uniform(-0.3, 0.5)]}


def scene_of(seed: int) -> tuple[Scene, str]:
    """The scene of a seed, and what it is."""
    rng = np.random.default_rng(seed)
    name, shape, height = prism(rng)
    under = int(rng.integers(0, 3))
    restitution = (0.0, 0.0, 0.4, 0.8)[rng.integers(0, 4)]
    start, tilt, mass, body = thrown(rng, shape, height)
    loads = [push_of(rng, 9.81 * mass, height)] if rng.random() < 0.5 else []
    gravity = np.array([0, 0, -9.81])
    if rng.random() < 0.4:
        a, b = rng.uniform(0, 0.4), rng.uniform(0, 2 * pi)
        gravity = 9.81 * np.array([sin(a) * cos(b), sin(a) * sin(b), -cos(a)])
    scene = make.scene(
        "planar_run", [table_of(under), body], gravity=gravity.tolist(), force=loads,
        contact=[{"between": ["body", "table"], "restitution": restitution}],
    )  # fmt: skip
    pushed = " pushed" if loads else ""
    where = ("plane", "box", "can")[under]
    return scene, f"{name} on {where}, start {start}, tilt {tilt:.2g}, e {restitution}{pushed}"


def faults_of(scene: Scene, path: Trajectory) -> list[str]:
    gaps = path.gap[np.isfinite(path.gap)]
    known = {
        path.outcome.name: path.outcome.name != "DONE",
        "fallback-start": any(event.kind == "fallback-start" for event in path.events),
        "drift": path.energy_drift > DRIFT,
        "gap": bool((gaps < -DEPTH).any()),
        "sunk": deepest(scene, path).max() > SUNK,
        "not finite": not np.isfinite(path.p).all(),
    }
    return [fault for fault, holds in known.items() if holds]


def run(seed: int, until: float, accuracy: str, folder: Path) -> str:
    """The line of one seed."""
    scene, label = scene_of(seed)
    library = build(emit(derive(require(scene))), folder=folder, level="O1")
    path = simulate(library, until=until, accuracy=accuracy, estimate=False)
    kinds = ", ".join(f"{kind} {n}" for kind, n in Counter(event.kind for event in path.events).items())
    least = float(np.nanmin(path.gap)) if np.isfinite(path.gap).any() else 0.0
    faults = "".join(f" FAULT {fault}" for fault in faults_of(scene, path))
    numbers = f"to {path.t_end:.6f} s, {path.steps} steps, drift {path.energy_drift:.1e}, gap {least:.1e}"
    return f"{seed:4d} {label}: {numbers}; {kinds}{faults}"


def alone(seed: int, options: argparse.Namespace) -> str:
    """The line of one seed, from a process of its own."""
    command = [
        sys.executable, "-m", "tests.benchmarks.planar_runs", "--one", str(seed),
        "--until", str(options.until), "--accuracy", options.accuracy, "--folder", str(options.folder),
    ]  # fmt: skip
    try:
        answer = subprocess.run(command, capture_output=True, text=True, check=False, timeout=options.limit)
    except subprocess.TimeoutExpired:
        return f"{seed:4d} FAULT longer than {options.limit} s"
    if answer.returncode == 0:
        return answer.stdout.strip()
    last = answer.stderr.strip().splitlines()[-1:] or [f"exit {answer.returncode}"]
    return f"{seed:4d} FAULT {last[0][:200]}"


def seeds_of(text: str) -> list[int]:
    """ "7" or "3,5,9" or "0:120", and several of these, apart by commas."""
    found: list[int] = []
    for part in text.split(","):
        first, _, end = part.partition(":")
        found += range(int(first), int(end)) if end else [int(first)]
    return found


def main(arguments: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--seeds", type=seeds_of, default=seeds_of("0:20"), help="such as 0:120 or 3,17")
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--until", type=float, default=1.5, help="s")
    parser.add_argument("--accuracy", default="balanced")
    parser.add_argument("--limit", type=float, default=300.0, help="s for one seed, with its build")
    parser.add_argument("--folder", type=Path, default=Path("generated/planar_run"), help="of what is built")
    parser.add_argument("--one", type=int, help=argparse.SUPPRESS)
    options = parser.parse_args(arguments)
    if options.one is not None:
        print(run(options.one, options.until, options.accuracy, options.folder))
        return
    with ThreadPoolExecutor(options.jobs) as pool:
        lines = []
        for line in pool.map(lambda seed: alone(seed, options), options.seeds):
            lines.append(line)
            print(line, flush=True)
    bad = [line for line in lines if "FAULT" in line]
    print(f"{len(bad)} of {len(lines)} with a fault")


if __name__ == "__main__":
    main()
