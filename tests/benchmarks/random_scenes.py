"""Random scenes that nobody chose: bodies of every shape dropped on a floor or into a box, event-driven.

    python -m tests.benchmarks.random_scenes --first 0 --count 200 --jobs 16 --out FOLDER
    python -m tests.benchmarks.random_scenes --replay FOLDER/17.toml

Each seed makes one scene file of 1 to 8 bodies, random friction, restitution, poses and velocities. A run
passes that is over in time, with finite numbers, no energy gained beyond what its warnings name, and no
penetration; one that ends early says why, and is counted apart. One line a seed, then a summary. The folder
keeps the lines (a seed that has one is not run again) and the files of those that do not pass. Of the
registered shapes only those without bound do not fall: plane, line, cone, paraboloid, helix, height field.
"""

from __future__ import annotations

import argparse
import json
import resource
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np

import modelgen
from modelgen.runtime.trajectory import Outcome, Trajectory

LIMIT_S = 120  # time of one core that a scene takes, its build included, whatever else the machine does
HANGS_S = 1800  # wall time after which a scene hangs
UNTIL = 5.0  # s
DEEPEST = 1e-4  # of the size of a body, penetration
GAIN = 1e-6  # of the energy at the start, above the floor
SIZE = 0.1  # m
WALLS = {
    "floor": ([0, 0, 0], [1, 0, 0], 0.0),
    "west": ([-6 * SIZE, 0, 0], [0, 1, 0], np.pi / 2),
    "east": ([6 * SIZE, 0, 0], [0, 1, 0], -np.pi / 2),
    "south": ([0, -6 * SIZE, 0], [1, 0, 0], -np.pi / 2),
    "north": ([0, 6 * SIZE, 0], [1, 0, 0], np.pi / 2),
}
TURN = [0.0, 6.283185307179586]
RING = [[0.07, 0.0, 0.0], [0.0, 0.06, 0.02], [-0.07, 0.0, 0.0], [0.0, -0.06, -0.02]]
SHAPES: dict[str, Callable[[Callable[[], float]], dict[str, Any]]] = {
    "sphere": lambda r: {"radius": r()},
    "ellipsoid": lambda r: {"semi_axes": [r(), r(), r()]},
    "superellipsoid": lambda r: {"semi_axes": [r(), r(), r()], "exponents": [2.0, 2.0]},
    "superellipsoid of order 3": lambda r: {"semi_axes": [r(), r(), r()], "exponents": [3.0, 3.0]},
    "torus": lambda r: {"major": 0.07, "minor": 0.02 + 0.2 * r()},
    "capsule": lambda r: {"radius": r() / 2, "length": r()},
    "cylinder": lambda r: {"radius": r(), "length": r()},
    "tube": lambda r: {"radius": r(), "bore": 0.03, "length": r()},
    "frustum": lambda r: {"radius_bottom": r(), "radius_top": r() / 2, "length": r()},
    "box": lambda r: {"size": [r(), r(), r()]},
    "disc": lambda r: {"radius": r()},
    "half_torus": lambda r: {"major": 0.07, "minor": 0.02 + 0.2 * r()},
    "polyhedron": lambda r: {"vertices": [[r(), 0, 0], [-r(), r(), 0], [-r(), -r(), 0], [0, 0, r()]]},
    "extrusion": lambda r: {"length": r(), "points": [[-r(), -r()], [r(), -r()], [0.0, r()]]},
    "extrusion of an oval": lambda r: {
        "length": r(), "x": f"{r():.4f} * cos(t)", "y": f"{r():.4f} * sin(t)", "domain": TURN,
    },
    "revolution": lambda r: {
        "r": f"{r():.4f} * sin(t) * (1.2 + 0.3 * cos(t))", "z": f"{-r():.4f} * cos(t)",
        "domain": [0.0, TURN[1] / 2],
    },
    "bspline": lambda r: {
        "points": [
            [[(0.07 + 0.03 * np.cos(v)) * np.cos(u), (0.07 + 0.03 * np.cos(v)) * np.sin(u), 0.03 * np.sin(v)]
             for v in np.arange(6) * np.pi / 3] for u in np.arange(8) * np.pi / 4
        ],
        "periodic": [True, True],
    },
    "circle": lambda r: {"radius": r()},
    "ellipse_curve": lambda r: {"semi_axes": [r(), r()]},
    "segment": lambda r: {"length": r()},
    "point": lambda r: {"at": [r(), 0.0, 0.0]},
    "curve": lambda r: {
        "x": f"{r():.4f} * cos(t)", "y": f"{r():.4f} * sin(t)", "z": f"{r() / 4:.4f} * cos(2 * t)",
        "domain": TURN, "periodic": True,
    },
    "bspline_curve": lambda r: {"points": RING, "periodic": True},
    "polyline": lambda r: {"points": RING, "radius": 0.01, "closed": True},
}  # fmt: skip
CONVEX = (
    "sphere",
    "ellipsoid",
    "capsule",
    "cylinder",
    "box",
    "polyhedron",
)  # those that also strike each other


def random_scene(seed: int) -> str:
    """The scene of a seed as TOML."""
    rng = np.random.default_rng(seed)
    walls = list(WALLS) if rng.random() < 0.4 else ["floor"]
    count = int(rng.integers(1, 4 if len(walls) > 1 else 9))
    lines = [f'[run]\nuntil = {UNTIL}\naccuracy = "{rng.choice(["fast", "balanced"])}"\nsamples = 500']
    lines += [_wall(name) for name in walls]
    cells = rng.permutation(27)[:count]
    names = [f"body{k}" for k in range(count)]
    kinds = [str(rng.choice(list(SHAPES))) for _ in names]
    bodies = zip(names, kinds, cells, strict=True)
    lines += [_body(rng, name, kind, int(cell)) for name, kind, cell in bodies]
    lines += [_contact(rng, name, wall) for name in names for wall in walls]
    lines += [_contact(rng, a, b) for a, b in _meeting(names, kinds)]
    return "\n\n".join(lines) + "\n"


def _meeting(names: list[str], kinds: list[str]) -> list[tuple[str, str]]:
    """The first pair of bodies that may strike each other, if there is one."""
    fit = [name for name, kind in zip(names, kinds, strict=True) if kind in CONVEX]
    return [(fit[0], fit[1])] if len(fit) > 1 else []


def _wall(name: str) -> str:
    place, axis, angle = WALLS[name]
    return (
        f'[[body]]\nname = "{name}"\nmotion = "fixed"\nposition = {_list(place)}\n'
        f'axis_angle = {{ axis = {_list(axis)}, angle = {angle!r} }}\nshape = {{ kind = "plane" }}'
    )


def _body(rng: np.random.Generator, name: str, kind: str, cell: int) -> str:
    keys = SHAPES[kind](lambda: round(float(rng.uniform(0.04, 0.09)), 4))
    shape = ", ".join(f"{key} = {_list(value)}" for key, value in keys.items())
    turn = rng.normal(size=4)
    x, y, z = ((cell // 3**k % 3 - 1) * 3.5 * SIZE for k in range(3))
    mass = rng.uniform(0.1, 3.0)
    inertia = mass * 0.004 * rng.uniform(0.8, 1.2, size=3)
    return (
        f'[[body]]\nname = "{name}"\nshape = {{ kind = "{kind.split()[0]}", {shape} }}\nmass = {mass:.6g}\n'
        f"inertia = {_list(inertia)}\nposition = {_list([x, y, z + 5.5 * SIZE])}\n"
        f"quaternion = {_list(turn / np.linalg.norm(turn))}\n"
        f"velocity = {_list(rng.normal(size=3))}\nangular_velocity = {_list(5 * rng.normal(size=3))}"
    )


def _contact(rng: np.random.Generator, body: str, wall: str) -> str:
    keys = [f'[[contact]]\nbetween = ["{body}", "{wall}"]']
    if rng.random() < 0.8:
        kinetic = rng.uniform(0, 1.2)
        keys.append(
            f"friction = {{ static = {kinetic * rng.choice([1.0, 1.2]):.4g}, kinetic = {kinetic:.4g} }}"
        )
    if rng.random() < 0.6:
        keys.append(f"restitution = {rng.uniform(0, 0.9):.3g}")
    return "\n".join(keys)


def _list(value: Any) -> str:
    """A value as TOML, numbers with a point."""
    if isinstance(value, str | bool):
        return json.dumps(value)
    if isinstance(value, float | int):
        return f"{float(value):.12g}" if float(value) % 1 else f"{float(value):.1f}"
    return (
        "["
        + ", ".join(_list(each if isinstance(each, list | str | bool) else float(each)) for each in value)
        + "]"
    )


def faults(path: Trajectory, held: set[str]) -> list[str]:
    """What is wrong with a run, in words; the centres of bodies that are `held` stay above the floor."""
    found = []
    if not all(np.isfinite(getattr(path, key)).all() for key in ("p", "v", "w", "force", "energy", "work")):
        found.append("numbers that are not finite")
    depth = -float(np.nanmin(path.gap, initial=0.0))
    if depth > DEEPEST * SIZE:
        contact = path.contact_names[int(np.nanargmin(path.gap) % path.gap.shape[1])]
        found.append(f"penetration of {depth:.2e} m of {contact}")
    if (path.p[:, :, 2] < -1e-9)[:, [name in held for name in path.body_names]].any():
        found.append(f"{path.body_names[int(path.p[:, :, 2].min(axis=0).argmin())]} is below the floor")
    gained = float((path.energy - path.energy[0]).max())
    if gained > GAIN * abs(float(path.energy[0])) and not any("made" in warning for warning in path.warnings):
        found.append(f"energy gained: {gained:.2e} J of {path.energy[0]:.2e}")
    if path.energy_drift > 1e-4:
        found.append(f"energy drift {path.energy_drift:.1e}")
    return found


def replay(file: Path, limit_s: int) -> int:
    """Builds and runs one file, killed when it has used the limit; prints its faults."""
    resource.setrlimit(resource.RLIMIT_CPU, (limit_s, limit_s))
    scene = modelgen.read(file)
    package = modelgen.emit(modelgen.derive(modelgen.require(scene)))
    with tempfile.TemporaryDirectory() as folder:
        path = modelgen.simulate(modelgen.build(package, folder=folder))
    held = {body.name for body in scene.bodies if all(shape.kind != "point" for shape in body.shapes)}
    found = faults(path, held)
    counts = f"{path.steps} steps, {len(path.events)} events, {time.process_time():.1f} s"
    end = (
        ""
        if path.outcome.succeeded
        else f"; {path.outcome.name} of {path.outcome_contact!r} at {path.t_end:.6g}"
    )
    print(f"{file.stem}: {counts}, drift {path.energy_drift:.0e}{end}")
    for line in (*found, *path.warnings):
        print(f"    {line}")
    return len(found)


def _judge(file: Path) -> str:
    """Runs a file in a process of its own: what it printed, in one line that begins with the verdict."""
    command = [sys.executable, "-m", "tests.benchmarks.random_scenes", "--replay", str(file.resolve())]
    command += ["--limit", str(LIMIT_S)]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=HANGS_S, check=False)
    except subprocess.TimeoutExpired:
        return f"FAILS {file.stem}: hangs for {HANGS_S} s"
    if done.returncode in (-signal.SIGXCPU, -signal.SIGKILL):
        return f"FAILS {file.stem}: beyond {LIMIT_S} s"
    said = " | ".join(line.strip() for line in done.stdout.splitlines())
    if not said:
        last = (done.stderr.strip().splitlines() or [f"ended with {done.returncode}"])[-1]
        return f"FAILS {file.stem}: {last}"
    early = any(outcome.name in said for outcome in Outcome if not outcome.succeeded)
    return f"{'FAILS' if done.returncode else 'ends early' if early else 'passes'} {said}"


def _run(seed: int, folder: Path) -> str:
    """The verdict on a seed: the one that the folder keeps, or that of a run."""
    kept, file = folder / f"{seed}.txt", folder / f"{seed}.toml"
    if kept.exists():
        return kept.read_text(encoding="utf-8").strip()
    file.write_text(random_scene(seed), encoding="utf-8")
    verdict = _judge(file)
    kept.write_text(verdict + "\n", encoding="utf-8")
    if not verdict.startswith("FAILS"):
        file.unlink()
    print(verdict, flush=True)
    return verdict


def main() -> None:
    """Runs the seeds; keeps the files of the failures."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--count", type=int, default=20)
    parser.add_argument("--jobs", type=int, default=1, help="scenes at a time")
    parser.add_argument("--out", type=Path, default=Path("random_scenes"))
    parser.add_argument("--replay", type=Path)
    parser.add_argument(
        "--limit", type=int, default=resource.RLIM_INFINITY, help="s of one core, of a replay"
    )
    given = parser.parse_args()
    if given.replay:
        sys.exit(min(replay(given.replay, given.limit), 100))
    given.out.mkdir(parents=True, exist_ok=True)
    seeds = range(given.first, given.first + given.count)
    with ThreadPoolExecutor(given.jobs) as pool:
        verdicts = list(pool.map(lambda seed: _run(seed, given.out), seeds))
    early = sum(verdict.startswith("ends early") for verdict in verdicts)
    failed = [seed for seed, verdict in zip(seeds, verdicts, strict=True) if verdict.startswith("FAILS")]
    fell = sum("fallback-start" in verdict for verdict in verdicts)
    whole = len(seeds) - len(failed) - early
    print(f"{whole} of {len(seeds)} pass, {early} end early and say why, fail: {failed}")
    print(f"{fell} fell back on time-stepping")
    sys.exit(bool(failed))


if __name__ == "__main__":
    main()
