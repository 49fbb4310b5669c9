"""Scenes of many contacts and of robots at `coarse`, beside MuJoCo and Bullet at their defaults.

    python -m tests.benchmarks.many_contacts_peers [--out FILE] [SCENE ..]

prints the tables of the manual, of all SCENES or those named, as in `heap:sphere:20 stack:10 cards:53 gripper
hopper`. Each scene runs in a process of its own; FILE, of a JSON object a scene, keeps what is done, and a
second run goes on from it. The picture of cost over penetration is drawn by `python -m
tests.benchmarks.pictures many_contacts`. Needs the extra `peers`, gymnasium for the robots, and pybullet
for Bullet, which is left out where it is not installed.

Each program runs once while a referee of its own geometry (`tests.benchmarks.penetration`) measures how deep
bodies are in each other, at each step of modelgen and every 10 ms of the others. Then all run in turn without
it, in CPU time of one thread, the shortest of up to five runs; set-up and start are told apart. A run of
more than LONG is not repeated, and its time is that beside the referee.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time
from typing import Any

import numpy as np

from modelgen.errors import ModelgenError
from modelgen.runtime.settings import Stepping
from tests.benchmarks.contact_programs import (
    Bullet,
    Modelgen,
    Mujoco,
    NotInProgram,
    Run,
    library_of,
    programs,
)
from tests.benchmarks.contact_tasks import ROBOTS, Task, task_of
from tests.benchmarks.many_contacts import STONES
from tests.benchmarks.penetration import Referee

SCENES = (
    *(f"stack:{n}" for n in (5, 10, 20, 50)),
    *("pyramid:5", "pyramid:10", "dominoes:10", "dominoes:50"),
    *(f"heap:sphere:{n}" for n in (20, 50, 100, 200, 500)),
    *(f"heap:{kind}:{n}" for kind in STONES if kind != "sphere" for n in (20, 100)),
    *("cards:53", "gripper"),
    *(spec for name in ROBOTS for spec in (name, f"{name}:file")),
)
SLOPE_OF = tuple(f"heap:sphere:{n}" for n in (20, 50, 100, 200, 500))
RUNS, ENOUGH, LONG, LIMIT = 5, 4.0, 20.0, 3600.0  # most runs; CPU s; CPU s; wall s of a scene
PROGRAMS = ("modelgen", "MuJoCo", "Bullet")
Makes = Callable[[], Run]
Row = dict[str, Any]

FRONTS = ("stack:10", "pyramid:5", "dominoes:10", "heap:sphere:20", "heap:box:20")


def timed(make: Makes) -> float:
    """CPU s of a run."""
    run = make()
    begun = process_time()
    run.go(None)
    return process_time() - begun


def watched(task: Task, make: Makes) -> Row:
    """A run under the referee, with its CPU time but for what the referee took."""
    referee, begun = Referee(task.scene), process_time()
    run = make()
    started = process_time() - begun
    names = [body.name for body in task.scene.bodies]
    depths, contacts, times, places, looked = [], [], [], [run.poses()[0]], 0.0
    times.append(run.t)

    def look() -> None:
        nonlocal looked
        begun = process_time()
        p, turned = run.poses()
        depths.append(referee.depth(p, turned))
        contacts.append(run.contacts())
        places.append(p)
        times.append(run.t)
        looked += process_time() - begun

    begun = process_time()
    run.go(look)
    spent = process_time() - begun - looked
    at = {name: np.array(places)[:, k] for k, name in enumerate(names)}
    return {
        "start": started, "spent": spent, "t": run.t, "steps": run.steps, "failure": run.failure,
        "deepest": max(depths), "contacts": float(np.mean(contacts)),
        "drift": task.drift(np.array(times), at) if task.drift else None,
    }  # fmt: skip


def compared(task: Task, made: dict[str, Makes]) -> dict[str, Row]:
    """A row for each program that has the task: the start and the run in CPU s, and what the referee says."""
    rows: dict[str, Row] = {}
    for name, make in made.items():
        with suppress(NotInProgram):
            rows[name] = watched(task, make)
    spent: dict[str, list[float]] = {name: [] for name, row in rows.items() if row["spent"] < LONG}
    for _ in range(RUNS):
        for name, times in spent.items():
            times.append(timed(made[name]))
        if sum(map(sum, spent.values())) > ENOUGH:
            break
    for name, row in rows.items():
        row["cpu"] = min(spent.get(name, [row["spent"]])) / row["t"]
    return rows


def measured(spec: str) -> Row:
    """What the tables need of a scene."""
    begun = process_time()
    task = task_of(spec)
    described = process_time() - begun
    with TemporaryDirectory() as folder:
        library, built = library_of(task, folder)
        rows = compared(task, programs(library, task, find_spec("pybullet") is not None))
    return {"spec": spec, "title": task.title, "described": described, "built": built, "programs": rows}


def front(spec: str) -> Row:
    """A scene in several steps and accuracies of each program."""
    task = task_of(spec)
    with TemporaryDirectory() as folder:
        library, _ = library_of(task, folder)
        made: dict[str, Makes] = {}
        for accuracy in ("coarse", "fast"):
            for step in (0.01, 0.005, 0.002):
                stepping: Stepping = {"method": "time-stepping", "step": step}
                made[f"modelgen, {accuracy}, {step} s"] = partial(Modelgen, task, library, accuracy, stepping)
        for kind in ("defaults", "tied"):
            for step in (0.005, 0.002, 0.001, 0.0005, 0.0002):
                made[f"MuJoCo, {kind}, {step} s"] = partial(Mujoco, task, step, kind == "tied")
        for rate in (240, 500, 1000, 2000) if find_spec("pybullet") else ():
            made[f"Bullet, 1/{rate} s"] = partial(Bullet, task, 1 / rate)
        return {"spec": spec, "title": task.title, "programs": compared(task, made)}


def metres(row: Row | None, key: str) -> str:
    if row is None or row[key] is None:
        return ""
    return f"{row[key]:.1e} m".replace("e-0", "e-").replace("e+00", "")


def ratio(ours: Row, other: Row | None) -> str:
    return "" if other is None else f"{other['cpu']:.3g} ({ours['cpu'] / other['cpu']:.2g})"


def tables(found: list[Row]) -> Iterator[str]:
    """The lines of the tables of the manual."""
    yield "| scene | contacts | `coarse` | MuJoCo | Bullet | start-up of `coarse` |"
    yield "| --- " * 6 + "|"
    for row in found:
        ours, theirs, bullet = (row["programs"].get(name) for name in PROGRAMS)
        start = row["described"] + row["built"] + ours["start"]
        cells = (
            *(row["title"], f"{ours['contacts']:.0f}", f"{ours['cpu']:.3g}"),
            *(ratio(ours, theirs), ratio(ours, bullet), f"{start:.1f} s"),
        )
        ends = [
            f"{name} ended at {run['t']:.3g} s: {run['failure']}"
            for name, run in row["programs"].items()
            if run["failure"]
        ]
        yield f"| {' | '.join(cells)} | {'; '.join(ends)}".rstrip()
    of_defaults = [row["programs"] for row in found if not row["spec"].endswith(":file")]
    ratios = np.array([runs["modelgen"]["cpu"] / runs["MuJoCo"]["cpu"] for runs in of_defaults])
    yield f"\nratios to MuJoCo at its defaults: median {np.median(ratios):.2g}, worst {ratios.max():.3g}\n"
    yield "| scene | penetration: `coarse` | MuJoCo | Bullet | drift: `coarse` | MuJoCo | Bullet |"
    yield "| --- " * 7 + "|"
    for row in found:
        runs = [row["programs"].get(name) for name in PROGRAMS]
        depths = [metres(run, key) for key in ("deepest", "drift") for run in runs]
        yield f"| {' | '.join([row['title'], *depths])} |"


def slopes(found: list[Row]) -> Iterator[str]:
    """Cost a contact and step of heaps of spheres, and the slope of the cost of a step over contacts."""
    chosen = [row for row in found if row["spec"] in SLOPE_OF]
    if len(chosen) < 2:
        return
    yield "\n| " + " | ".join(["us a contact and step", *(row["title"] for row in chosen), "slope"]) + " |"
    yield "| --- " * (len(chosen) + 2) + "|"
    for name in PROGRAMS:
        rows = [row["programs"][name] for row in chosen if name in row["programs"]]
        if len(rows) < 2:
            continue
        contacts = np.array([each["contacts"] for each in rows])
        a_step = np.array([each["cpu"] * each["t"] / each["steps"] for each in rows])
        slope = np.polyfit(np.log(contacts), np.log(a_step), 1)[0]
        costs = [f"{1e6 * cost:.2f}" for cost in a_step / contacts]
        yield f"| {' | '.join([name, *costs, f'{slope:.2f}'])} |"


def kept(path: Path | None) -> dict[str, Row]:
    if path is None or not path.exists():
        return {}
    return {row["spec"]: row for row in map(json.loads, path.read_text().splitlines())}


def collected(what: str, specs: list[str], out: Path | None) -> list[Row]:
    """The rows of scenes, each in a process of its own, but for those that `out` has."""
    known, found = kept(out), []
    for spec in specs:
        if spec not in known:
            call = [sys.executable, "-m", "tests.benchmarks.many_contacts_peers", what, spec]
            done = subprocess.run(call, capture_output=True, text=True, timeout=LIMIT, check=False)
            if done.returncode:
                last = done.stderr.strip().splitlines()[-1:] or [""]
                print(f"{spec}: exit {done.returncode}: {last[0]}", flush=True)
                continue
            known[spec] = json.loads(done.stdout.splitlines()[-1])
            if out:
                with out.open("a") as file:
                    file.write(json.dumps(known[spec]) + "\n")
            print(f"{spec}: {sum(row['cpu'] for row in known[spec]['programs'].values()):.3g} s", flush=True)
        found.append(known[spec])
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenes", nargs="*", help="of SCENES; default: all")
    parser.add_argument("--out", type=Path, help="file of results, a JSON object a line")
    given = parser.parse_args()
    what, *rest = given.scenes or [""]
    if what in ("scene", "front"):  # in a process of its own
        try:
            print(json.dumps((measured if what == "scene" else front)(rest[0])))
        except ModelgenError as refused:
            sys.exit(str(refused))
    else:
        found = collected("scene", given.scenes or [*SCENES], given.out)
        print("\n".join([*tables(found), *slopes(found)]))


if __name__ == "__main__":
    main()
