"""The cost of a run at other values of a scene's parameters, against building the scene with these values.

    python -m tests.benchmarks.parameters [points]

Of each scene, points (1000) with random values of all its parameters, each within 2 % of the scene's own: the
time of reading the scene again and making the tables of the core, and with the run. Against it the same of
a scene file with these values: read, require, derive, emit and build with the compiler (in an empty folder,
with the core compiled before), and the same where a library of the same text is there. Medians; times of
this process and of the compiler's, which depend little on what else the machine does.
"""

from __future__ import annotations

import random
import resource
import sys
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory

from modelgen import build, derive, emit, require, simulate
from modelgen.codegen.library import Library
from modelgen.codegen.library_with_parameters import library_with
from modelgen.runtime.tables.library_tables import library_tables
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene.read import read_text

REBUILDS = 3
SPREAD = 0.02

EGG = """
[[body]]
name = "table"
motion = "fixed"
shape = { kind = "plane" }

[[body]]
name = "egg"
shape = { kind = "ellipsoid", semi_axes = ["axis", 0.09, 0.07] }
density = "density"
position = [0.0, 0.0, 0.1]
rpy = [0.3, 0.2, 0.0]
angular_velocity = [1.0, 2.0, 3.0]

[[contact]]
between = ["egg", "table"]
friction = "friction"
restitution = "restitution"
"""
PENDULUM = """
[[body]]
name = "arm"
mass = "mass"
inertia = ["mass*length**2/12", "mass*length**2/12", "mass*length**2/300"]
position = ["length/2", 0.0, 0.0]

[[joint]]
kind = "revolute"
name = "hinge"
between = ["world", "arm"]
rpy = ["pi/2", 0.0, 0.0]
stiffness = "stiffness"
damping = 0.01
limits = ["none", "limit"]
restitution = "restitution"
"""
BALLS = """
[[body]]
name = "bowl"
motion = "fixed"
shape = { kind = "sphere", radius = 0.5, cavity = true }
position = [0.0, 0.0, 0.5]

[[body]]
name = "ball"
shape = { kind = "sphere", radius = "radius" }
density = 2000.0
position = [0.1, 0.0, 0.12]

[[body]]
name = "bob"
shape = { kind = "sphere", radius = "radius" }
mass = "mass"
inertia = ["0.4*mass*radius**2", "0.4*mass*radius**2", "0.4*mass*radius**2"]
position = [-0.1, 0.02, 0.12]

[[contact]]
between = ["ball", "bowl"]
friction = "friction"
restitution = "restitution"

[[contact]]
between = ["bob", "bowl"]
friction = "friction"

[[contact]]
between = ["ball", "bob"]
restitution = "restitution"

[[spring]]
between = ["ball", "bob"]
stiffness = "stiffness"
rest_length = 0.2
"""
SCENES: Mapping[str, tuple[str, Mapping[str, float]]] = {
    "egg": (EGG, {"axis": 0.12, "density": 1000.0, "friction": 0.3, "restitution": 0.4}),
    "pendulum": (
        PENDULUM,
        {"mass": 1.1, "length": 0.4, "stiffness": 0.7, "limit": 1.2, "restitution": 0.6},
    ),
    "balls": (
        BALLS,
        {"radius": 0.03, "mass": 0.3, "friction": 0.2, "restitution": 0.5, "stiffness": 8.0},
    ),
}


def text_of(scene: str, values: Mapping[str, float]) -> str:
    """The file of a scene with these values, its nominal values those of SCENES."""
    text, nominal = SCENES[scene]
    tables = (
        f'[[parameter]]\nname = "{name}"\nvalue = {values[name]!r}\nnominal = {nominal[name]!r}\n'
        for name in nominal
    )
    return "\n".join((text, *tables))


def built(scene: str, values: Mapping[str, float], folder: Path) -> Library:
    """The library of a scene with these values, in a folder."""
    model = require(read_text(text_of(scene, values), f"{scene}.toml"))
    return build(emit(derive(model)), folder=folder)


def tables_with(library: Library, values: Mapping[str, float]) -> object:
    return library_tables(library_with(library, values))


def run_of(scene: str, values: Mapping[str, float], folder: Path) -> Trajectory:
    return simulate(built(scene, values, folder), estimate=False)


def cpu(call: Callable[[], object]) -> float:
    """CPU time of a call, s, with that of the processes that it starts."""

    def used() -> float:
        both = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
        return sum(each.ru_utime + each.ru_stime for each in both)

    before = used()
    call()
    return used() - before


def measure(scene: str, points: int, folder: Path) -> dict[str, float]:
    """Milliseconds of CPU time for each point, by what was done."""
    drawn = random.Random(1)
    nominal = SCENES[scene][1]
    library = built(scene, nominal, folder / "own")
    simulate(library, estimate=False)

    def values() -> dict[str, float]:
        return {name: value * drawn.uniform(1 - SPREAD, 1 + SPREAD) for name, value in nominal.items()}

    read, run, compiled, known = [], [], [], []
    library_with(library, values())
    for _ in range(points):
        point = values()
        read.append(cpu(partial(tables_with, library, point)))
        run.append(cpu(partial(simulate, library, parameters=point, estimate=False)))
    for k in range(REBUILDS):
        point = values()
        compiled.append(cpu(partial(run_of, scene, point, folder / str(k))))
        known.append(cpu(partial(run_of, scene, point, folder / "own")))
    medians = {"read": median(read), "run": median(run), "compiled": median(compiled), "known": median(known)}
    return {name: 1e3 * value for name, value in medians.items()}


def main(points: int) -> None:
    print(
        "| scene | read again, ms | and run | built and run | ratio | built, not compiled, and run | ratio |"
    )
    print("| --- | --- | --- | --- | --- | --- | --- |")
    for scene in SCENES:
        with TemporaryDirectory() as folder:
            found = measure(scene, points, Path(folder))
        each = found["read"] + found["run"]
        print(
            f"| `{scene}` | {found['read']:.2f} | {each:.2f} | {found['compiled']:.0f} "
            f"| {found['compiled'] / each:.0f} | {found['known']:.0f} | {found['known'] / each:.0f} |"
        )


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 1000)
