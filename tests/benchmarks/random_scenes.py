"""Random scenes that nobody chose: bodies of every shape dropped on a floor or into a box, event-driven.

    python -m tests.benchmarks.random_scenes --first 0 --count 20 --out FOLDER
    python -m tests.benchmarks.random_scenes --replay FOLDER/17.toml

Each seed makes one scene file of 1 to 8 bodies, random friction, restitution, poses and velocities. A run
passes that ends where it should, in time, with finite numbers, no energy gained beyond what its warnings
name, and no penetration. The files of those that do not pass stay in the folder.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np

import modelgen
from modelgen.runtime.trajectory import Trajectory

LIMIT_S = 120  # wall time of a scene, its build included
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
SHAPES = {
    "sphere": lambda r: {"radius": r()},
    "ellipsoid": lambda r: {"semi_axes": [r(), r(), r()]},
    "superellipsoid": lambda r: {"semi_axes": [r(), r(), r()], "exponents": [2.0, 2.0]},
    "torus": lambda r: {"major": 0.07, "minor": 0.02 + 0.2 * r()},
    "capsule": lambda r: {"radius": r() / 2, "length": r()},
    "cylinder": lambda r: {"radius": r(), "length": r()},
    "frustum": lambda r: {"radius_bottom": r(), "radius_top": r() / 2, "length": r()},
    "box": lambda r: {"size": [r(), r(), r()]},
    "disc": lambda r: {"radius": r()},
    "half_torus": lambda r: {"major": 0.07, "minor": 0.02 + 0.2 * r()},
    "polyhedron": lambda r: {"vertices": [[r(), 0, 0], [-r(), r(), 0], [-r(), -r(), 0], [0, 0, r()]]},
    "extrusion": lambda r: {"length": r(), "points": [[-r(), -r()], [r(), -r()], [0.0, r()]]},
}  # fmt: skip


def random_scene(seed: int) -> str:
    """The scene of a seed as TOML."""
    rng = np.random.default_rng(seed)
    walls = list(WALLS) if rng.random() < 0.4 else ["floor"]
    count = int(rng.integers(1, 4 if len(walls) > 1 else 9))
    lines = [f'[run]\nuntil = {UNTIL}\naccuracy = "{rng.choice(["fast", "balanced"])}"\nsamples = 500']
    lines += [_wall(name) for name in walls]
    cells = rng.permutation(27)[:count]
    names = [f"body{k}" for k in range(count)]
    lines += [_body(rng, name, int(cell)) for name, cell in zip(names, cells, strict=True)]
    lines += [_contact(rng, name, wall) for name in names for wall in walls]
    return "\n\n".join(lines) + "\n"


def _wall(name: str) -> str:
    place, axis, angle = WALLS[name]
    return (
        f'[[body]]\nname = "{name}"\nmotion = "fixed"\nposition = {_list(place)}\n'
        f'axis_angle = {{ axis = {_list(axis)}, angle = {angle!r} }}\nshape = {{ kind = "plane" }}'
    )


def _body(rng: np.random.Generator, name: str, cell: int) -> str:
    kind = str(rng.choice(list(SHAPES)))
    keys = SHAPES[kind](lambda: round(float(rng.uniform(0.04, 0.09)), 4))
    shape = ", ".join(f"{key} = {_list(value)}" for key, value in keys.items())
    turn = rng.normal(size=4)
    x, y, z = ((cell // 3**k % 3 - 1) * 3.5 * SIZE for k in range(3))
    mass = rng.uniform(0.1, 3.0)
    inertia = mass * 0.004 * rng.uniform(0.8, 1.2, size=3)
    return (
        f'[[body]]\nname = "{name}"\nshape = {{ kind = "{kind}", {shape} }}\nmass = {mass:.6g}\n'
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


def _list(values: Any) -> str:
    if isinstance(values, float | int):
        return f"{float(values):.12g}" if float(values) % 1 else f"{float(values):.1f}"
    return (
        "[" + ", ".join(_list(value if isinstance(value, list) else float(value)) for value in values) + "]"
    )


def faults(path: Trajectory) -> list[str]:
    """What is wrong with a run, in words."""
    found = (
        []
        if path.outcome.succeeded
        else [f"{path.outcome.name} of {path.outcome_contact!r} at {path.t_end:.6g}"]
    )
    if not all(np.isfinite(getattr(path, key)).all() for key in ("p", "v", "w", "force", "energy", "work")):
        found.append("numbers that are not finite")
    depth = -float(np.nanmin(path.gap, initial=0.0))
    if depth > DEEPEST * SIZE:
        contact = path.contact_names[int(np.nanargmin(path.gap) % path.gap.shape[1])]
        found.append(f"penetration of {depth:.2e} m of {contact}")
    if path.p[:, :, 2].min() < -1e-9:
        found.append(f"{path.body_names[int(path.p[:, :, 2].min(axis=0).argmin())]} is below the floor")
    gained = float((path.energy - path.energy[0]).max())
    if gained > GAIN * abs(float(path.energy[0])) and not any("made" in warning for warning in path.warnings):
        found.append(f"energy gained: {gained:.2e} J of {path.energy[0]:.2e}")
    if path.energy_drift > 1e-4:
        found.append(f"energy drift {path.energy_drift:.1e}")
    return found


def replay(file: Path) -> int:
    """Builds and runs one file; prints its faults."""
    path = modelgen.simulate(
        modelgen.build(modelgen.emit(modelgen.derive(modelgen.require(modelgen.read(file)))))
    )
    found = faults(path)
    counts = f"{path.steps} steps, {len(path.events)} events, {path.wall_s:.2f} s"
    print(f"{file.stem}: {counts}, drift {path.energy_drift:.0e}")
    for line in (*found, *path.warnings):
        print(f"    {line}")
    return len(found)


def _judge(file: Path) -> str:
    command = [sys.executable, "-m", "tests.benchmarks.random_scenes", "--replay", str(file)]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=LIMIT_S, check=False)
    except subprocess.TimeoutExpired:
        return f"{file.stem}: HANGS beyond {LIMIT_S} s"
    last = done.stderr.strip().splitlines()[-1:] if done.returncode and not done.stdout else []
    verdict = "passes" if done.returncode == 0 else f"FAILS ({done.returncode})"
    return "\n".join([f"{verdict} {done.stdout.strip() or file.stem}", *last])


def main() -> None:
    """Runs the seeds; keeps the files of the failures."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--count", type=int, default=20)
    parser.add_argument("--out", type=Path, default=Path("random_scenes"))
    parser.add_argument("--replay", type=Path)
    given = parser.parse_args()
    if given.replay:
        sys.exit(min(replay(given.replay), 100))
    given.out.mkdir(parents=True, exist_ok=True)
    failed = 0
    for seed in range(given.first, given.first + given.count):
        file = given.out / f"{seed}.toml"
        file.write_text(random_scene(seed), encoding="utf-8")
        verdict = _judge(file)
        print(verdict, flush=True)
        if verdict.startswith("passes"):
            file.unlink()
        else:
            failed += 1
    print(f"{given.count - failed} of {given.count} pass")


if __name__ == "__main__":
    main()
