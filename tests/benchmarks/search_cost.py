"""Cost of the search for all closest points of one pair from nothing, beside that of another version.

    python -m tests.benchmarks.search_cost --against FOLDER [--poses 40]

FOLDER is a checkout of the other version, such as the last one that sampled the shapes (the parent of the
commit "Search closest points by trees of cells"). Each version starts a run of two free bodies at the same
random poses, of which those at which the bodies overlap or have no closest points are left out; nearly all of
a start is its search. `first` is the first start of a session, in
which the cells or samples of the shapes are made; `later` are starts at the next poses, which find them. The
times are CPU times, the least of several rounds in turn with the other version; ratios are to that version.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

ROUNDS, REPEATS = 3, 3
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


def poses(o: str, n: int) -> np.ndarray[Any, Any]:
    """Positions and unit quaternions of the second body, (n, 7)."""
    rng = np.random.default_rng(0)
    spread = {"hollow": 0.5, "bore": 0.3}.get(o, 1.2)
    found = np.hstack([spread * rng.normal(size=(n, 3)), rng.normal(size=(n, 4))])
    found[:, 3:] /= np.linalg.norm(found[:, 3:], axis=1, keepdims=True)
    return found


def measured(n: int) -> dict[str, Any]:
    """CPU seconds of the first start of a session and of later ones, of the version that is imported."""
    from modelgen import Accuracy, build, derive, emit, require
    from modelgen.runtime.session import Session
    from modelgen.scene.read import read_text

    found = {}
    for o, f in PAIRS:
        scene = read_text(scene_text(o, f), "pair.toml")
        with tempfile.TemporaryDirectory() as folder:
            library = build(emit(derive(require(scene))), folder=folder, tell=lambda _: None)
        at = poses(o, n)
        first = [_start(Session(library, Accuracy()), pose) for pose in at]
        session = Session(library, Accuracy())
        later = [min(_start(session, pose) for _ in range(REPEATS)) for pose in at]
        codes = [_start(session, pose) and int(session.start_code) for pose in at]
        found[f"{o}, {f}"] = {"first": first, "later": later, "refused": codes}
    return found


def _start(session: Any, pose: np.ndarray[Any, Any]) -> float:
    """CPU seconds of one start with the second body at a pose."""
    session.x[:] = 0
    session.x[3], session.x[7:14] = 1, pose
    session.feature_pair[:] = -1
    begun = time.process_time()
    session.begin()
    return time.process_time() - begun


def run(folder: Path, n: int) -> dict[str, Any]:
    """What `measured` finds with the version in a folder."""
    path = {**os.environ, "PYTHONPATH": str(folder), "OMP_NUM_THREADS": "1"}
    command = [sys.executable, str(Path(__file__).resolve()), "--measure", "--poses", str(n)]
    done = subprocess.run(command, env=path, cwd=folder, capture_output=True, text=True, check=True)
    return dict(json.loads(done.stdout.splitlines()[-1]))


def least(rounds: list[dict[str, Any]]) -> dict[str, dict[str, np.ndarray[Any, Any]]]:
    """The least times over the rounds."""
    return {
        pair: {kind: np.min([each[pair][kind] for each in rounds], axis=0) for kind in ("first", "later")}
        for pair in rounds[0]
    }


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--against", type=Path)
    parser.add_argument("--poses", type=int, default=40)
    parser.add_argument("--measure", action="store_true", help="print the times of one round as JSON")
    given = parser.parse_args()
    if given.measure:
        print(json.dumps(measured(given.poses)))
        return
    if given.against is None:
        parser.error("--against FOLDER is needed")
    folders = (Path(__file__).resolve().parents[2], given.against)
    rounds = [[run(folder, given.poses) for folder in folders] for _ in range(ROUNDS)]
    here, there = (least([each[k] for each in rounds]) for k in range(2))
    print("median of each, µs, and ratios\n")
    print("| pair | poses | first | there | ratio | later | there | ratio |\n" + "| --- " * 8 + "|")
    ratios: dict[str, list[float]] = {"first": [], "later": []}
    for pair in here:
        allowed = np.array(rounds[0][0][pair]["refused"]) == 0
        cells = [f"{allowed.sum()}"]
        for kind, all_ratios in ratios.items():
            ours, theirs = here[pair][kind][allowed], there[pair][kind][allowed]
            all_ratios += (ours / theirs).tolist()
            cells += [
                f"{median(ours) * 1e6:.0f}",
                f"{median(theirs) * 1e6:.0f}",
                f"{median(ours / theirs):.2f}",
            ]
        print(f"| {pair} | {' | '.join(cells)} |")
    whole = {kind: median(each) for kind, each in ratios.items()}
    print(f"\nmedian ratio of all: first {whole['first']:.2f}, later {whole['later']:.2f}")


if __name__ == "__main__":
    main()
