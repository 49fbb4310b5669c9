"""Solids of all kinds tossed on a floor: no companion ends where its run does not, and what companions cost.

Run with `python -m tests.benchmarks.companions [--count 24] [--kinds box,torus]`. Each of 13 kinds of solid,
of random size, pose and twist, falls on a plane with friction 0.4 and restitution 0.3, and is followed for
4 s. Told are how the runs and their companions end, and the evaluations of the right-hand side of
the companions over those of the runs: median and largest.
"""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from modelgen import derive, emit, require, simulate
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene.scene_from_tables import scene_from_tables
from tests.running import compiled

Draw = Callable[[], float]
KINDS: dict[str, Callable[[Draw], dict[str, Any]]] = {
    "box": lambda r: {"size": [r(), r(), r()]},
    "capsule": lambda r: {"radius": r() / 2, "length": r()},
    "cylinder": lambda r: {"radius": r(), "length": r()},
    "dome": lambda r: {"radius": r(), "length": r() / 2},
    "ellipsoid": lambda r: {"semi_axes": [r(), r(), r()]},
    "extrusion": lambda r: {"length": r(), "points": [[-r(), -r()], [r(), -r()], [0.0, r()]]},
    "frustum": lambda r: {"radius_bottom": r(), "radius_top": r() / 2, "length": r()},
    "polyhedron": lambda r: {"vertices": [[r(), 0, 0], [-r(), r(), 0], [-r(), -r(), 0], [0, 0, r()]]},
    "revolution": lambda r: {
        "r": f"{r():.4f} * sin(t) * (1.2 + 0.3 * cos(t))",
        "z": f"{-r():.4f} * cos(t)",
        "domain": [0.0, float(np.pi)],
    },
    "sphere": lambda r: {"radius": r()},
    "superellipsoid": lambda r: {"semi_axes": [r(), r(), r()], "exponents": [2.0, 2.0]},
    "torus": lambda r: {"major": 0.07, "minor": 0.02 + 0.2 * r()},
    "tube": lambda r: {"radius": r(), "bore": 0.03, "length": r()},
}  # of a draw of a length, m
SMALLEST, LARGEST, UNTIL = 0.04, 0.1, 4.0  # m, m, s


@dataclass(frozen=True)
class Toss:
    """A run with its companion: how far and at what cost the companion came."""

    path: Trajectory
    stopped: tuple[str, ...]  # why the companion did not come as far as the run; none if it did
    cost: float  # evaluations of the companion over those of the run


def toss(kind: str, seed: int) -> Toss:
    """A random solid of a kind, tossed."""
    rng = np.random.default_rng([seed, *kind.encode()])
    shape = {"kind": kind, **KINDS[kind](lambda: float(rng.uniform(SMALLEST, LARGEST)))}
    solid = {
        "name": "solid",
        "shape": shape,
        "density": 800.0,
        "position": [0.0, 0.0, 0.4],
        "rotation": Rotation.from_quat(rng.normal(size=4)).as_matrix().tolist(),
        "velocity": (rng.normal(size=3) * [0.7, 0.7, 0.3]).tolist(),
        "angular_velocity": (6 * rng.normal(size=3)).tolist(),
    }
    floor = {"name": "floor", "motion": "fixed", "shape": {"kind": "plane"}}
    contact = {"between": ["solid", "floor"], "friction": 0.4, "restitution": 0.3}
    written = {"gravity": [0.0, 0.0, -9.81], "body": [floor, solid], "contact": [contact]}
    scene = scene_from_tables("toss", written, "toss")
    path = simulate(compiled(emit(derive(require(scene)))), until=UNTIL, samples=100)
    assert path.estimate is not None
    told = tuple(each for each in path.estimate.uncertified if each.startswith("the companion run"))
    return Toss(path, told, path.estimate.rhs_evals / path.rhs_evals)


def tosses(kinds: list[str], count: int) -> Iterator[tuple[str, int, Toss]]:
    for kind in kinds:
        for seed in range(count):
            yield kind, seed, toss(kind, seed)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=24, help="of each kind")
    parser.add_argument("--kinds", default=",".join(KINDS))
    given = parser.parse_args()
    ends: Counter[str] = Counter()
    costs: dict[str, list[float]] = {}
    for kind, seed, each in tosses(given.kinds.split(","), given.count):
        ends[each.path.outcome.name.lower()] += 1
        ends["companion ends before its run"] += bool(each.stopped)
        costs.setdefault(kind, []).append(each.cost)
        if each.stopped:
            print(kind, seed, *each.stopped)
    for kind, values in costs.items():
        print(f"{kind}: cost of companions {np.median(values):.2f}, at most {max(values):.2f}")
    print(f"{dict(ends)}; cost of companions {np.median(np.concatenate([*costs.values()])):.2f}")


if __name__ == "__main__":
    main()
