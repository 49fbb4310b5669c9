"""Instructions of searches for closest points over the number of knots of splines.

    python -m tests.benchmarks.knots [--knots 16 64 256] [--pairs wheel_on_rail ...] [--poses 4]

Pairs of bodies whose splines have as many nodes, pieces or patches as told: a wheel on a rail, both through
nodes, and an ellipsoid near each kind of spline. `cold` is the first search of a session, in which the
cells of the shapes are made, the median over some poses; `warm` the mean of searches at these poses once
each has been searched. All minima within 0.05 m (on the rail, 3 mm) are sought. Instructions are counted
by callgrind, so that other work on the machine does not matter. A C compiler and the headers of valgrind
are needed.
"""

from __future__ import annotations

import argparse
import ctypes
import json
import os
import subprocess
import sys
import tempfile
from functools import partial
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Scene, Shape
from tests.importing.profiles import rail_head, wheel_tread

COUNTED_CPU = ("-march=x86-64-v2",)  # callgrind knows not all instructions of newer processors
COUNTED_CALL = Path(__file__).parent / "counted_call.c"
KNOTS = (16, 64, 256)
REACH = 0.05  # m
ON_RAIL = 3e-3  # m
Array = np.ndarray[Any, Any]


def nodes(n: int) -> tuple[Array, Array]:
    """A wavy line, (n,) each."""
    t = np.linspace(0, 1, n)
    return t - 0.5, 0.03 * np.sin(5 * t) + 0.004 * np.cos(17 * t)


def outline(n: int) -> Array:
    """A wavy closed outline (n, 2) m."""
    angle = 2 * np.pi * np.arange(n) / n
    radius = 0.3 * (1 + 0.1 * np.cos(3 * angle) + 0.02 * np.sin(7 * angle))
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)


def grid(patches: int) -> tuple[Array, Array, Array]:
    """x (n,), y (n,) and heights (n, n) for splines of about so many patches."""
    x = np.linspace(-0.5, 0.5, round(patches**0.5) + 3)
    return x, x, 0.03 * np.sin(5 * x[:, None] + 1) * np.cos(4 * x)


def net(patches: int) -> Array:
    """A control net (n, n, 3) of as many."""
    x, y, heights = grid(patches)
    return np.stack([*np.meshgrid(x, y, indexing="ij"), heights], axis=-1)


def spline_shape(kind: str, n: int) -> Shape:
    along, height = nodes(n)
    if kind == "profile_wall":
        return make.profile_wall(np.stack([along[::-1], height], axis=1).tolist(), 2.0)
    if kind == "revolution":
        return make.shape("revolution", points=np.stack([0.3 + height, along], axis=1).tolist())
    if kind == "extrusion":
        return make.extrusion(0.5, points=outline(n).tolist(), smooth=True)
    if kind == "bspline_curve":
        return make.bspline_curve(
            np.stack([*nodes(n + 3), 0.1 * np.sin(3 * np.linspace(0, 1, n + 3))], axis=1).tolist()
        )
    if kind == "height_field":
        return make.height_field(*(each.tolist() for each in grid(n)))
    return make.bspline(net(n).tolist())


def wheel_on_rail(n: int) -> Scene:
    rail, wheel = rail_head(n), wheel_tread(n)
    bodies = [
        make.fixed("a", make.profile_wall(rail.tolist(), 4.0, quaternion=[0.5, 0.5, 0.5, 0.5])),
        make.dynamic(
            "b", make.shape("revolution", points=wheel.tolist()), mass=400.0, inertia=[25.0, 25.0, 45.0],
            position=[0.0, 0.0, 2.0],
        ),
    ]  # fmt: skip
    return make.scene("knots", bodies, contact=[{"between": ["a", "b"]}])


def scene_of(kind: str, n: int) -> Scene:
    """The scene of a pair: body `b` is the one that is moved."""
    if kind == "wheel_on_rail":
        return wheel_on_rail(n)
    egg = make.dynamic(
        "b", make.ellipsoid(0.1, 0.08, 0.06), mass=1.0, inertia=[1.0, 1.0, 1.0], position=[0, 0, 3]
    )
    return make.scene(
        "knots", [make.fixed("a", spline_shape(kind, n)), egg], contact=[{"between": ["a", "b"]}]
    )


PLACES = {  # ranges of the middle of the ellipsoid, m
    "profile_wall": ((-0.4, 0.4), (0.12, 0.12), (-0.5, 0.5)),
    "revolution": ((0.41, 0.41), (0, 0), (-0.4, 0.4)),
    "extrusion": ((0.41, 0.41), (0, 0), (-0.2, 0.2)),
    "bspline_curve": ((-0.4, 0.4), (0.11, 0.11), (0, 0)),
    "height_field": ((-0.4, 0.4), (-0.4, 0.4), (0.11, 0.11)),
    "bspline": ((-0.4, 0.4), (-0.4, 0.4), (0.11, 0.11)),
}
KINDS = ("wheel_on_rail", *PLACES)


def poses(kind: str, count: int) -> Array:
    """(count, 12) of body b."""
    rng = np.random.default_rng(0)
    if kind != "wheel_on_rail":
        low, high = np.transpose(PLACES[kind])
        turns = Rotation.random(count, random_state=0)
        return np.array(
            [np.append(rng.uniform(low, high), turn.as_matrix().T.ravel()) for turn in turns], dtype=float
        )
    found = []
    for shift, yaw, roll in rng.uniform([-1.5e-3, 0, 0], [9e-3, 0.02, 5e-3], (count, 3)):
        turn = Rotation.from_euler("ZX", [yaw, roll]) * Rotation.from_euler("x", -np.pi / 2)
        found.append(np.append([0.0, shift, 0.4605], turn.as_matrix().T.ravel()))
    return np.array(found)


def build_all(folder: Path, kinds: list[str], knots: list[int]) -> None:
    """Builds the library of each pair."""
    from modelgen import build, derive, emit, require
    from modelgen.codegen import compiler

    compiler.NATIVE = COUNTED_CPU
    for kind in kinds:
        for n in knots:
            (folder / f"{kind}-{n}").mkdir()
            scene = scene_of(kind, n)
            build(emit(derive(require(scene))), folder=folder / f"{kind}-{n}", tell=lambda _: None)


def search_all(folder: Path, kinds: list[str], knots: list[int], count: int) -> list[list[float]]:
    """Searches of each pair: at each pose by itself, at all poses in one session, and at all poses twice in
    one session. Returns the minima found, sorted by pose."""
    from modelgen import distance_minima
    from modelgen.codegen.library import Library
    from modelgen.runtime.poses import pose_matrices

    counted = ctypes.CDLL(str(folder / "counted_call.so")).counted_call
    here, found = np.eye(3, 4), []
    for kind in kinds:
        reach = ON_RAIL if kind == "wheel_on_rail" else REACH
        at = pose_matrices(poses(kind, count))
        for n in knots:
            library = Library.load(folder / f"{kind}-{n}")
            vars(library.cdll)["mg_find_minima"] = partial(counted, library.cdll.mg_find_minima)
            search = partial(distance_minima, library, "a-b", here, gap=reach, depth=reach)
            alone = [search(pose) for pose in at]
            together, twice = search(at), search(np.concatenate([at, at]))
            assert together.complete.all()
            assert len(twice.d) == 2 * len(together.d) == 2 * sum(len(each.d) for each in alone)
            found.append(together.d.tolist())
    return found


def measured(kinds: list[str], knots: list[int], count: int) -> tuple[Array, list[list[float]]]:
    """Instructions (kinds, knots, poses + 2) of searches at each pose by itself, at all, and at all twice;
    the minima found."""
    steady = {**os.environ, "OMP_NUM_THREADS": "1", "PYTHONHASHSEED": "0"}
    given = ["--knots", *map(str, knots), "--pairs", *kinds, "--poses", str(count)]
    python = [sys.executable, "-m", "tests.benchmarks.knots", *given]
    with tempfile.TemporaryDirectory() as made:
        subprocess.run([*python, "--build", made], env=steady, check=True)
        shared = ["cc", "-O1", "-shared", "-fPIC", str(COUNTED_CALL), "-o", f"{made}/counted_call.so"]
        subprocess.run(shared, check=True)
        tool = ["valgrind", "--tool=callgrind", "--instr-atstart=no", f"--callgrind-out-file={made}/count"]
        done = subprocess.run([*tool, *python, "--search", made], env=steady, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        searches = (count + 2) * len(kinds) * len(knots)
        dumps = [Path(made, f"count.{k + 1}").read_text() for k in range(searches)]
    counts = [int(line.split()[1]) for text in dumps for line in text.splitlines() if "totals:" in line]
    return np.reshape(counts, (len(kinds), len(knots), count + 2)), json.loads(done.stdout.splitlines()[-1])


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--knots", type=int, nargs="+", default=list(KNOTS))
    parser.add_argument("--pairs", nargs="+", choices=KINDS, default=list(KINDS))
    parser.add_argument("--poses", type=int, default=4)
    parser.add_argument("--build", type=Path, metavar="FOLDER", help="build the libraries there alone")
    parser.add_argument("--search", type=Path, metavar="FOLDER", help="search with those alone")
    given = parser.parse_args()
    if given.build:
        build_all(given.build, given.pairs, given.knots)
        return
    if given.search:
        print(json.dumps(search_all(given.search, given.pairs, given.knots, given.poses)))
        return
    counts, minima = measured(given.pairs, given.knots, given.poses)
    print(f"instructions of a search, thousands, cold / warm, of {given.poses} poses\n")
    columns = [*(f"{n} knots" for n in given.knots), "last / first", "minima"]
    print(f"| pair | {' | '.join(columns)} |\n" + "| --- " * (len(columns) + 1) + "|")
    for k, kind in enumerate(given.pairs):
        cold = [median(each[:-2].tolist()) for each in counts[k]]
        warm = [(each[-1] - each[-2]) / given.poses for each in counts[k]]
        cells = [f"{a / 1e3:.0f} / {b / 1e3:.0f}" for a, b in zip(cold, warm, strict=True)]
        cells.append(f"{cold[-1] / cold[0]:.1f} / {warm[-1] / warm[0]:.1f}")
        numbers = [len(each) for each in minima[k * len(given.knots) : (k + 1) * len(given.knots)]]
        print(f"| {kind} | {' | '.join(cells)} | {min(numbers)} to {max(numbers)} |")


if __name__ == "__main__":
    main()
