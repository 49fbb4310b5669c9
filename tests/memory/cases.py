"""Scenes on which memory is studied: shipped ones, those of `scenes/`, many bodies, a body of every shape,
random ones, runs that end by an error, and scenes that are differentiated.

Horizons are short, and such that what is asked of memory happens in them: bodies strike, stick, slip, come to
rest on faces, change their features, are searched for.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from tests.benchmarks.random_scenes import CONVEX, SHAPES, random_scene
from tests.running import FILES
from tests.sensitivity.families import FAMILIES, member

FOUND = Path(__file__).parent / "scenes"
GRAVITY = -9.81  # m/s^2
EDGE, RADIUS, SPACING = 0.1, 0.05, 0.13  # m, of a cube, of a sphere, and of the bodies of a heap
FLOOR = '[[body]]\nname = "floor"\nmotion = "fixed"\nshape = { kind = "plane" }\n'
HEAPED = {
    "sphere": f"radius = {RADIUS}",
    "ellipsoid": "semi_axes = [0.06, 0.05, 0.04]",
    "capsule": "radius = 0.03, length = 0.06",
    "box": "size = [0.07, 0.07, 0.07]",
}


@dataclass(frozen=True)
class Case:
    """A scene, and how much of it is run."""

    group: str
    file: Path
    seconds: float
    steps: int

    @property
    def words(self) -> tuple[str, ...]:
        """Options of `tests.memory.digests`."""
        return ("--derivatives",) if self.group == "derivatives" else ("--steps", str(self.steps))


def _run(seconds: float, **keys: object) -> str:
    told = "".join(f"{key} = {value!r}\n".replace("'", '"') for key, value in keys.items())
    return f"[run]\nuntil = {seconds}\n{told}"


def _body(name: str, shape: str, position: Iterable[float], turn: Iterable[float] = (0.0, 0.0, 0.0)) -> str:
    at, rpy = [float(x) for x in position], [float(a) for a in turn]
    return (
        f'[[body]]\nname = "{name}"\nshape = {{ {shape} }}\ndensity = 1000.0\nposition = {at}\nrpy = {rpy}\n'
    )


def _all_touch(friction: float) -> str:
    return f'[contacts]\nbetween = "all"\nfriction = {friction}\n'


def _stepping(step: float) -> str:
    return _run(60.0, method="time-stepping", step=step, accuracy="fast")


def stack(boxes: int, gap: float = 0.0, stepping: bool = True) -> str:
    """Cubes on each other, or above each other."""
    cubes = (
        _body(f"b{k}", f'kind = "box", size = [{EDGE}, {EDGE}, {EDGE}]', (0, 0, EDGE * (k + 0.5) + gap * k))
        for k in range(boxes)
    )
    return (_stepping(0.002) if stepping else _run(60.0)) + FLOOR + "".join(cubes) + _all_touch(0.5)


def heap(count: int, kind: str, stepping: bool = True) -> str:
    """Bodies that fall between four walls."""
    random, side = np.random.default_rng(0), max(2, round((count / 2) ** (1 / 3)))
    half, turn = side * SPACING / 2 + 0.01, float(np.pi / 2)
    walls = "".join(
        f'[[body]]\nname = "w{k}"\nmotion = "fixed"\nshape = {{ kind = "plane" }}\n'
        f"position = {[s * half if k < 2 else 0.0, s * half if k > 1 else 0.0, 0.0]}\n"
        f"rpy = {[s * turn if k > 1 else 0.0, -s * turn if k < 2 else 0.0, 0.0]}\n"
        for k, s in enumerate((-1, 1, -1, 1))
    )
    bodies = []
    for k in range(count):
        layer, place = divmod(k, side * side)
        at = [
            SPACING * (n - (side - 1) / 2) + random.uniform(-0.004, 0.004)
            for n in (place % side, place // side)
        ]
        turned = (0, 0, 0) if kind == "sphere" else random.uniform(-0.6, 0.6, 3)
        bodies.append(
            _body(f"s{k}", f'kind = "{kind}", {HEAPED[kind]}', (*at, 0.07 + SPACING * layer), turned)
        )
    return (_stepping(0.01) if stepping else _run(60.0)) + FLOOR + walls + "".join(bodies) + _all_touch(0.5)


def dominoes(count: int) -> str:
    """A row of them, of which a ball strikes the first."""
    row = (_body(f"d{k}", 'kind = "box", size = [0.02, 0.1, 0.2]', (0.1 * k, 0, 0.1)) for k in range(count))
    ball = _body("ball", 'kind = "sphere", radius = 0.03', (-0.06, 0, 0.17)) + "velocity = [2.0, 0.0, 0.0]\n"
    return _stepping(0.002) + FLOOR + "".join(row) + ball + _all_touch(0.5)


def many() -> Mapping[str, tuple[str, float, int]]:
    """Texts, horizons and steps of scenes of many bodies."""
    return {
        "stack5": (stack(5), 1.0, 10),
        "stack10": (stack(10), 1.0, 4),
        "dropped4": (stack(4, 0.002, stepping=False), 0.1, 60),
        "spheres20": (heap(20, "sphere"), 1.0, 30),
        "spheres20_by_events": (heap(20, "sphere", stepping=False), 0.2, 40),
        "ellipsoids20": (heap(20, "ellipsoid"), 1.0, 8),
        "capsules20": (heap(20, "capsule"), 1.0, 6),
        "boxes8": (heap(8, "box"), 1.0, 5),
        "dominoes8": (dominoes(8), 1.0, 8),
        "spheres50": (heap(50, "sphere"), 1.0, 12),
        "spheres100": (heap(100, "sphere"), 1.0, 8),
        "spheres200": (heap(200, "sphere"), 1.0, 3),
    }


def _ball(name: str, height: float, at: float = 0.0) -> str:
    return _body(name, f'kind = "sphere", radius = {RADIUS}', (at, 0, height))


def _pushed(force: str) -> str:
    return (
        _run(0.2)
        + FLOOR
        + _ball("a", RADIUS)
        + _touch("a", "floor")
        + f'[[force]]\nbody = "a"\nforce = ["{force}", "0", "0"]\n'
    )


def _touch(a: str, b: str, keys: str = "friction = 0.4") -> str:
    return f'[[contact]]\nbetween = ["{a}", "{b}"]\n{keys}\n'


def errors() -> Mapping[str, str]:
    """Starts that are refused, and runs that end early."""
    hinge = '[[joint]]\nname = "j"\nkind = "distance"\nbetween = ["a", "b"]\n'
    two = _ball("a", 0.3) + _ball("b", 0.3, 0.2)
    return {
        "overlapping": _run(0.2) + _ball("a", 0.3) + _ball("b", 0.33) + _touch("a", "b"),
        "sunk": _run(0.2) + FLOOR + _ball("a", 0.02) + _touch("a", "floor"),
        "joint_apart": _run(0.2) + two + hinge + "distance = 0.3\n",
        "pole": _pushed("1/(t - 0.05)"),
        "root": _pushed("sqrt(0.05 - t)"),
        "strong_pole": _pushed("1/(t - 0.05)**2"),
        "path_that_ends": _run(0.2)
        + FLOOR
        + '[[body]]\nname = "hand"\nmotion = "driven"\nshape = { kind = "sphere", radius = 0.05 }\n'
        + 'position = [0, 0, 0.2]\npath = { position = ["log(0.1 - t)", "0", "0"] }\n'
        + _ball("a", RADIUS)
        + _touch("a", "hand")
        + _touch("a", "floor"),
        "pressed": _run(0.2, method="time-stepping", step=0.01)
        + FLOOR
        + '[[body]]\nname = "hand"\nmotion = "driven"\nshape = { kind = "sphere", radius = 0.05 }\n'
        + 'position = [0, 0, 0.16]\npath = { position = ["0", "0", "-0.5*t"] }\n'
        + _ball("a", RADIUS)
        + _touch("a", "hand")
        + _touch("a", "floor"),
        "chatter": _run(1.0)
        + FLOOR
        + _ball("a", 0.06)
        + _touch("a", "floor", "restitution = 0.999999\nfriction = 1.0"),
    }


def _one_of(kind: str) -> str:
    """A body of a kind dropped on a floor, and a ball on the body or beside it."""
    random = np.random.default_rng(len(kind))
    keys = SHAPES[kind](lambda: round(float(random.uniform(0.04, 0.09)), 4))
    shape = "".join(f", {key} = {json.dumps(value)}" for key, value in keys.items())
    ball = _ball("ball", 0.3) + "velocity = [0.0, 0.0, -2.0]\n"
    below = "body" if kind in CONVEX else "floor"
    return (
        _run(0.4, accuracy="fast")
        + FLOOR
        + f'[[body]]\nname = "body"\nshape = {{ kind = "{kind.split()[0]}"{shape} }}\nmass = 1.0\n'
        + "inertia = [0.004, 0.0045, 0.005]\nposition = [0.0, 0.0, 0.12]\nrpy = [0.3, 0.2, 0.1]\n"
        + "angular_velocity = [3.0, 1.0, -2.0]\n"
        + ball
        + _touch("body", "floor")
        + _touch("ball", below)
    )


def _texts() -> Iterator[tuple[str, str, str, float, int]]:
    """Group, name, text, horizon and steps of the scenes that are made."""
    for name, (text, seconds, steps) in many().items():
        yield "many", name, text, seconds, steps
    for kind in SHAPES:
        yield "shapes", "one_" + kind.replace(" ", "_"), _one_of(kind), 0.4, 120
    for seed in range(12):
        yield "random", f"random{seed}", random_scene(seed), 0.6, 120
    for name, text in errors().items():
        yield "errors", name, text, 0.3, 120
    for family in FAMILIES:
        for seed in range(2):
            yield "derivatives", f"{family}{seed}", member(family, seed).text, 0.25, 0


def cases(folder: Path) -> list[Case]:
    """All of them; those that are made are written into the folder."""
    folder.mkdir(parents=True, exist_ok=True)
    found = [Case("shipped", file, 0.2, 120) for file in FILES]
    found += [Case("found", file, 0.3, 120) for file in sorted(FOUND.glob("*.toml"))]
    for group, name, text, seconds, steps in _texts():
        file = folder / f"{name}.toml"
        file.write_text(text, encoding="utf-8")
        found.append(Case(group, file, seconds, steps))
    return found
