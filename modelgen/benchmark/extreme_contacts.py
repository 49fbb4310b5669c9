"""Contacts at their ends: coefficients of friction and restitution, and many contacts of one body."""

from __future__ import annotations

from functools import partial
from math import pi, sqrt

import numpy as np

from modelgen.benchmark.extreme_trials import Extreme, G, Trial, decades, tried_run
from modelgen.benchmark.libraries_by_kinds import LibrariesByKinds
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene.python_scenes import dynamic, fixed, plane, point, scene, sphere
from modelgen.scene.scene_types import Scene

# ---- friction and restitution ----


def _bowled(friction: float) -> Scene:
    """A ball that slides until it rolls, at 2 v/(7 mu g)."""
    ball = dynamic(
        "ball", sphere(0.1), mass=1.0, inertia=[4e-3] * 3, position=[0.0, 0.0, 0.1], velocity=[3.0, 0.0, 0.0]
    )
    pairs = [{"between": ["ball", "table"], "friction": friction}]
    until = 1.0 if friction == 0 else 1.5 * 6 / (7 * friction * G)
    return scene("extreme_bowls", [fixed("table", plane()), ball], contact=pairs, run={"until": until})


def _bowled_error(friction: float, path: Trajectory) -> float:
    """Error of the final speed, 5/7 of the first, and of the time at which rolling begins."""
    v = path.v[-1, path.body_names.index("ball"), 0]
    if friction == 0:
        return float(abs(v / 3 - 1))
    times = [event.t for event in path.events if event.kind == "slip-stop"]
    late = abs(times[0] * 7 * friction * G / 6 - 1) if times else 1.0
    return max(float(abs(v * 7 / 15 - 1)), late)


def _try_friction(friction: float, libraries: LibrariesByKinds) -> Trial:
    return tried_run(partial(_bowled, friction), libraries, partial(_bowled_error, friction))


def _bouncing(e: float) -> Scene:
    """A ball dropped from 0.2 m, for so long as it takes to fall ten times."""
    ball = dynamic("ball", sphere(0.1), mass=1.0, inertia=[4e-3] * 3, position=[0.0, 0.0, 0.3])
    pairs = [{"between": ["ball", "table"], "restitution": e}]
    return scene(
        "extreme_drop", [fixed("table", plane()), ball], contact=pairs, run={"until": 10 * sqrt(0.4 / G)}
    )


def _height(e: float, t: float) -> float:
    """Height of the lowest point in closed form: bounces with flights of (2 e^k) t_1."""
    fall = sqrt(0.4 / G)
    t, bounce = t - fall, 2 * fall * e
    if t < 0:
        return 0.2 - G * (t + fall) ** 2 / 2
    while t > bounce:
        t, bounce = t - bounce, bounce * e
        if bounce < 1e-12:
            return 0.0
    return G * t * (bounce - t) / 2


def _bounce_error(e: float, path: Trajectory) -> float:
    at = path.body_names.index("ball")
    heights = [_height(e, float(t)) for t in path.t]
    return float(np.abs(path.p[:, at, 2] - 0.1 - heights).max()) / 0.1


def _try_restitution(e: float, libraries: LibrariesByKinds) -> Trial:
    return tried_run(partial(_bouncing, e), libraries, partial(_bounce_error, e))


# ---- numbers of contacts ----


def _table_on_feet(n: float) -> Scene:
    """A round top on n points along its rim."""
    angles = 2 * pi * np.arange(int(n)) / int(n)
    feet = [
        point(0.5 * float(np.cos(a)), 0.5 * float(np.sin(a)), -0.5, name=f"f{k}")
        for k, a in enumerate(angles)
    ]
    top = dynamic("top", *feet, mass=10.0, inertia=[1.0, 1.0, 2.0], position=[0.0, 0.0, 0.5])
    pairs = [{"between": [f"top/f{k}", "floor"]} for k in range(int(n))]
    return scene("extreme_feet", [fixed("floor", plane()), top], contact=pairs, run={"until": 0.1})


def _feet_error(path: Trajectory) -> float:
    """Error of the weight that the feet carry, and of the height."""
    weight = np.abs(path.force.sum(axis=1) / (10 * G) - 1).max()
    return float(max(weight, np.abs(path.p[:, path.body_names.index("top"), 2] / 0.5 - 1).max()))


def _try_feet(n: float, libraries: LibrariesByKinds) -> Trial:
    return tried_run(partial(_table_on_feet, n), libraries, _feet_error, samples=2)


CONTACTS = (
    Extreme(
        "friction", "coefficient of a ball that slides until it rolls",
        (0.0, *decades(-3, 2)), (0.0, 1e-3, 1e2),
        "rounding", lambda x: 1e-12, "speed at the end and time of rolling, against the closed form",
        _try_friction,
    ),
    Extreme(
        "restitution", "coefficient of a dropped ball", (0.0, 0.1, 0.5, 0.9, 0.99, 0.999, 1 - 1e-6, 1.0),
        (0.0, 0.5, 1.0), "tolerance", lambda x: 1e-11, "height over the radius, against the bounces",
        _try_restitution,
    ),
    Extreme(
        "redundant feet", "points under one body", (3.0, 10.0, 100.0, 300.0, 1000.0), (3.0, 100.0),
        "rounding", lambda x: 1e-13, "sum of the forces over the weight, height", _try_feet, warned=4.0,
    ),
)  # fmt: skip
