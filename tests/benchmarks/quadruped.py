"""A four-footed robot that trots over rough ground: what a step on a height field of many cells costs.

Run with `python -m tests.benchmarks.quadruped`, or with the numbers of grid points along a side. Hips turn
by a prescribed motion, knees are springs with dampers, feet are spheres with friction.
"""

from __future__ import annotations

import sys
from tempfile import TemporaryDirectory
from time import process_time

import numpy as np

from modelgen import build, derive, emit, require, simulate
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Scene, Shape

UNTIL = 1.0  # s
SIDE = 4.0  # m, of the ground
ROUGHNESS = 0.02  # m, amplitude of each wave of the ground
THIGH = SHANK = 0.2  # m
BEND = 0.5  # rad, of the thighs forward and the shanks backward at the start
FOOT = 0.03  # m, radius
STIFFNESS, DAMPING = 100.0, 3.0  # of a knee, N m/rad and N m s/rad
PRELOAD = 0.04  # rad, of its spring at the start: holds about a quarter of the weight
HIPS = {"fl": (0.25, 0.15), "fr": (0.25, -0.15), "rl": (-0.25, 0.15), "rr": (-0.25, -0.15)}  # m
PHASE = {"fl": 0, "rr": 0, "fr": 1, "rl": 1}  # half turns: diagonal legs move together
ALONG_Y = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]  # axes of a joint about y
TITLES = (
    *("grid", "cells", "scene to model (CPU s)", "derive, emit, build (CPU s)"),
    *("CPU s per simulated s", "steps", "evaluations", "touch-downs", "penetration (m)", "energy drift"),
)


def height(x: float, y: float) -> float:
    """m: waves of several lengths."""
    return float(
        ROUGHNESS * (np.sin(2.1 * x + 0.3) + np.sin(3.7 * y - 0.4 * x) + 0.5 * np.sin(7.3 * x + 5.1 * y))
    )


def ground(points: int) -> Shape:
    at = [float(value) for value in np.linspace(-SIDE / 2, SIDE / 2, points)]
    return make.height_field(at, at, [[height(x, y) for y in at] for x in at])


def quadruped(points: int) -> Scene:
    """The robot above a height field of points x points heights."""
    clear = 0.005  # m, of the lowest foot at the start
    ahead, down = THIGH * float(np.sin(BEND)), THIGH * float(np.cos(BEND))
    top = max(height(x, y) for x, y in HIPS.values()) + 2 * down + FOOT + clear
    bodies = [
        make.fixed("ground", ground(points)),
        make.dynamic("trunk", mass=10.0, inertia=[0.1, 0.25, 0.3], position=[0.0, 0.0, top]),
    ]
    joints, contacts = [], []
    for leg, (x, y) in HIPS.items():
        thigh, shank = f"{leg}_thigh", f"{leg}_shank"
        foot = make.sphere(FOOT, name="foot", position=[0.0, 0.0, -SHANK / 2])
        rod = {"inertia": [0.002, 0.002, 0.0002]}
        bodies += [
            make.dynamic(
                thigh, mass=0.8, position=[x + ahead / 2, y, top - down / 2], rpy=[0.0, -BEND, 0.0], **rod
            ),
            make.dynamic(
                shank,
                foot,
                mass=0.4,
                position=[x + ahead / 2, y, top - 1.5 * down],
                rpy=[0.0, BEND, 0.0],
                **rod,
            ),
        ]
        sign = "-" if PHASE[leg] else ""
        joints += [
            {
                "name": f"{leg}_hip", "kind": "revolute", "between": ["trunk", thigh],
                "position": [x, y, top], "rotation": ALONG_Y,
                "motion": f"{sign}0.3*sin(4*pi*t)*(1 - exp(-(5*t)**2))",
            },
            {
                "name": f"{leg}_knee", "kind": "revolute", "between": [thigh, shank],
                "position": [x + ahead, y, top - down], "rotation": ALONG_Y,
                "stiffness": STIFFNESS, "damping": DAMPING, "rest": PRELOAD,
            },
        ]  # fmt: skip
        contacts.append({"between": ["ground", f"{shank}/foot"], "friction": 0.7})
    return make.scene("quadruped", bodies, joint=joints, contact=contacts)


def row(points: int, folder: str) -> str:
    begun = process_time()
    model = require(quadruped(points))
    modelled = process_time()
    library = build(emit(derive(model)), folder=f"{folder}/{points}")
    built = process_time()
    path = simulate(library, until=UNTIL, samples=50, estimate=False)
    spent = process_time() - built
    landings = sum(event.kind in ("touch-down", "impact") for event in path.events)
    cells = (
        *(
            f"{points} x {points}",
            f"{(points - 3) ** 2}",
            f"{modelled - begun:.2f}",
            f"{built - modelled:.2f}",
        ),
        *(f"{spent / path.t_end:.2f}", f"{path.steps}", f"{path.rhs_evals}", f"{landings}"),
        *(f"{path.penetration_max:.1e}", f"{path.energy_drift:.1e}"),
    )
    return f"| {' | '.join(cells)} |" + ("" if path.outcome.succeeded else f" {path.outcome.name}")


def main() -> None:
    print(f"| {' | '.join(TITLES)} |")
    print("|---" * len(TITLES) + "|", flush=True)
    with TemporaryDirectory() as folder:
        for points in [int(text) for text in sys.argv[1:]] or (10, 20, 50):
            print(row(points, folder), flush=True)


if __name__ == "__main__":
    main()
