"""Cost of the search for all closest points of one pair from nothing, beside that of another version.

    python -m tests.benchmarks.search_cost --against FOLDER [--poses 40]

FOLDER is a checkout of the other version, such as the last one that sampled the shapes (the parent of the
commit "Search closest points by trees of cells"). Each version starts a run of two free bodies at the same
random poses, of which those at which the bodies overlap or have no closest points are left out; nearly all of
a start is its search. `first` is the first start of a session, in which the cells or samples of the shapes
are made; `later` are starts at the next poses, which find them. Instructions are counted by valgrind's
callgrind, so that other work on the machine does not matter; ratios are to the other version. A C compiler
and the headers of valgrind are needed.
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
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

COUNTED_CPU = ("-march=x86-64-v2",)  # callgrind knows not all instructions of newer processors
COUNTED_CALL = Path(__file__).parent / "counted_call.c"
Array = np.ndarray[Any, Any]
TURN = "6.283185307179586"
WAVY = "0.35*(1 + 0.18*cos(3*u)*cos(2*v) + 0.1*sin(u + v))"
SHAPES = {
    "torus": 'kind = "torus", major = 1.0, minor = 0.3',
    "wavy torus": f'kind = "chart", x = "(1 + {WAVY}*cos(v))*cos(u)", y = "(1 + {WAVY}*cos(v))*sin(u)", '
    f'z = "{WAVY}*sin(v)", domain = [[0.0, {TURN}], [0.0, {TURN}]], periodic = [true, true]',
    "waist": 'kind = "revolution", r = "sin(t)*(1.2 + 0.5*cos(2*t))", z = "-1.2*cos(t)", '
    "domain = [0.0, 3.141592653589793]",
    "egg": 'kind = "ellipsoid", semi_axes = [1.0, 0.7, 0.4]',
    "hollow": 'kind = "ellipsoid", semi_axes = [3.0, 2.4, 2.0], cavity = true',
    "knot": 'kind = "curve", x = "(2 + cos(3*t))*cos(2*t)*0.4", y = "(2 + cos(3*t))*sin(2*t)*0.4", '
    f'z = "0.4*sin(3*t)", domain = [0.0, {TURN}]',
    "rod": 'kind = "cylinder", radius = 0.4',
    "bore": 'kind = "cylinder", radius = 1.6, cavity = true',
    "ring": 'kind = "circle", radius = 0.8',
}  # fmt: skip
PAIRS = (
    ("torus", "torus"), ("wavy torus", "egg"), ("wavy torus", "wavy torus"), ("waist", "torus"),
    ("waist", "egg"), ("hollow", "egg"), ("hollow", "waist"), ("torus", "knot"), ("knot", "ring"),
    ("torus", "rod"), ("rod", "rod"), ("bore", "torus"), ("bore", "ring"), ("bore", "egg"),
)  # fmt: skip


def scene_text(o: str, f: str) -> str:
    """Two free bodies of these shapes, whose centres of mass are their origins."""
    bodies = "".join(
        f'[[body]]\nname = "{name}"\nmass = 1.0\ninertia = [1.0, 1.0, 1.0]\nshape = {{ {SHAPES[key]} }}\n'
        for name, key in (("a", o), ("b", f))
    )
    return f'[run]\nuntil = 1.0\n{bodies}[[contact]]\nbetween = ["a", "b"]\n'


def poses(o: str, n: int) -> Array:
    """Positions and unit quaternions of the second body, (n, 7)."""
    rng = np.random.default_rng(0)
    spread = {"hollow": 0.5, "bore": 0.3}.get(o, 1.2)
    found = np.hstack([spread * rng.normal(size=(n, 3)), rng.normal(size=(n, 4))])
    found[:, 3:] /= np.linalg.norm(found[:, 3:], axis=1, keepdims=True)
    return found


def build_all(folder: Path) -> None:
    """Builds the library of each pair with the version that is imported."""
    from modelgen import build, derive, emit, require
    from modelgen.codegen import compiler
    from modelgen.scene.read import read_text

    compiler.NATIVE = COUNTED_CPU
    for k, (o, f) in enumerate(PAIRS):
        (folder / str(k)).mkdir()
        scene = read_text(scene_text(o, f), "pair.toml")
        build(emit(derive(require(scene))), folder=folder / str(k), tell=lambda _: None)


def start_all(folder: Path, n: int) -> list[list[int]]:
    """Starts of each pair: the first of a session at each pose, then all poses in one; their outcomes."""
    from modelgen import Accuracy
    from modelgen.codegen.library import Library

    module = "core_session" if find_spec("modelgen.runtime.core_session") else "session"  # its name before
    Session = import_module(f"modelgen.runtime.{module}").Session
    counted = ctypes.CDLL(str(folder / "counted_call.so")).counted_call
    outcomes = []
    for k, (o, _) in enumerate(PAIRS):
        library, at = Library.load(folder / str(k)), poses(o, n)
        vars(library.cdll)["mg_begin"] = partial(counted, library.cdll.mg_begin)
        found = [_start(Session(library, Accuracy()), pose) for pose in at]
        session = Session(library, Accuracy())
        found += [_start(session, pose) for pose in at]
        outcomes.append(found)
    return outcomes


def _start(session: Any, pose: Array) -> int:
    """The outcome of a start with the second body at a pose."""
    session.x[:] = 0
    session.x[3], session.x[7:14] = 1, pose
    session.feature_pair[:] = -1
    session.begin()
    return int(session.start_code)


def measured(version: Path, n: int) -> tuple[list[Array], list[Array]]:
    """Of each pair the instructions (2, n) of first and later starts, and their outcomes (n,)."""
    steady = {**os.environ, "PYTHONPATH": str(version), "OMP_NUM_THREADS": "1", "PYTHONHASHSEED": "0"}
    python = [sys.executable, str(Path(__file__).resolve()), "--poses", str(n)]
    with tempfile.TemporaryDirectory() as made:
        subprocess.run([*python, "--build", made], env=steady, cwd=version, check=True)
        shared = ["cc", "-O1", "-shared", "-fPIC", str(COUNTED_CALL), "-o", f"{made}/counted_call.so"]
        subprocess.run(shared, check=True)
        out = f"--callgrind-out-file={made}/count"
        tool = ["valgrind", "--tool=callgrind", "--instr-atstart=no", out]
        done = subprocess.run(
            [*tool, *python, "--start", made], env=steady, cwd=version, capture_output=True, text=True
        )
        assert done.returncode == 0, done.stderr
        outcomes = [np.array(each[:n]) for each in json.loads(done.stdout.splitlines()[-1])]
        dumps = [Path(made, f"count.{k + 1}").read_text() for k in range(2 * n * len(PAIRS))]
    counts = [int(line.split()[1]) for text in dumps for line in text.splitlines() if "totals:" in line]
    return [*np.reshape(counts, (len(PAIRS), 2, n))], outcomes


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--against", type=Path)
    parser.add_argument("--poses", type=int, default=40)
    parser.add_argument("--build", type=Path, metavar="FOLDER", help="build the libraries there alone")
    parser.add_argument("--start", type=Path, metavar="FOLDER", help="start those alone")
    given = parser.parse_args()
    if given.build:
        build_all(given.build)
        return
    if given.start:
        print(json.dumps(start_all(given.start, given.poses)))
        return
    if given.against is None:
        parser.error("--against FOLDER is needed")
    here, outcomes = measured(Path(__file__).resolve().parents[2], given.poses)
    there, _ = measured(given.against, given.poses)
    print("median instructions of each, thousands, and ratios\n")
    print("| pair | poses | first | there | ratio | later | there | ratio |\n" + "| --- " * 8 + "|")
    ratios: dict[str, list[float]] = {"first": [], "later": []}
    for (o, f), ours, theirs, codes in zip(PAIRS, here, there, outcomes, strict=True):
        allowed = codes == 0
        if not allowed.any():
            print(f"| {o}, {f} | 0 |")
            continue
        cells = [f"{allowed.sum()}"]
        for k, all_ratios in enumerate(ratios.values()):
            ratio = ours[k][allowed] / theirs[k][allowed]
            all_ratios += ratio.tolist()
            cells += [f"{median(each[k][allowed]) / 1e3:.0f}" for each in (ours, theirs)]
            cells += [f"{median(ratio):.2f}"]
        print(f"| {o}, {f} | {' | '.join(cells)} |")
    whole = {kind: f"{median(each):.2f}" for kind, each in ratios.items()}
    print(f"\nmedian ratio of all {len(ratios['first'])}: first {whole['first']}, later {whole['later']}")


if __name__ == "__main__":
    main()
