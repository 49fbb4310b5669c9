"""Scales and spins at the ends of double precision: units, distances, ratios of masses, rad/s."""

from __future__ import annotations

from functools import partial
from math import cos, log10, sin, sqrt

import numpy as np

from modelgen.benchmark.extreme_trials import EPS, RUN, Extreme, G, Trial, against, decades, run_of, tried_run
from modelgen.benchmark.libraries_by_kinds import LibrariesByKinds
from modelgen.benchmark.tilted_spheroid import tilted_spheroid
from modelgen.benchmark.unit_conversion import Units, in_units
from modelgen.runtime.accuracy import Accuracy
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene.python_scenes import dynamic, ellipsoid, fixed, plane, scene, sphere
from modelgen.scene.scene_types import Scene

# ---- units and places ----


def rocking_egg(x: float = 0.0) -> Scene:
    """A tilted egg that rocks and slides on a table, its middle x metres from the origin."""
    axes, turned = (0.05, 0.04, 0.03), 0.4
    height = sqrt((axes[1] * np.sin(turned)) ** 2 + (axes[2] * np.cos(turned)) ** 2)
    egg = dynamic(
        "egg",
        ellipsoid(*axes),
        density=1000.0,
        position=[x, 0.0, height],
        rpy=[turned, 0.0, 0.0],
        velocity=[0.1, 0.0, 0.0],
        angular_velocity=[0.0, 0.0, 3.0],
    )
    return scene(
        "extreme_egg",
        [fixed("table", plane()), egg],
        contact=[{"between": ["egg", "table"]}],
        run={"until": 0.5},
    )


def _try_units(name: str, x: float, libraries: LibrariesByKinds) -> Trial:
    """The same egg with its unit of length, mass or time worth x new ones."""
    units = Units(**{name: x})
    true = run_of(libraries.library(rocking_egg()), Accuracy.tight(), samples=50)

    def error(path: Trajectory) -> float:
        lengths = float(np.abs(path.p / units.length - true.p).max()) / 0.05
        forces = float(np.abs(path.force / units.force - true.force).max() / true.force.max())
        return max(lengths, forces, float(np.abs(path.quaternion - true.quaternion).max()))

    return tried_run(lambda: in_units(rocking_egg(), units), libraries, error)


def _try_far(x: float, libraries: LibrariesByKinds) -> Trial:
    make = partial(rocking_egg, x)
    return tried_run(make, libraries, against(libraries, make))


# ---- masses ----


def _stack(ratio: float) -> Scene:
    """A ball of `ratio` kg on one of 1 kg on a table."""
    balls = [
        dynamic(name, sphere(0.1), mass=mass, inertia=[4e-3 * mass] * 3, position=[0.0, 0.0, height])
        for name, mass, height in (("low", 1.0, 0.1), ("high", ratio, 0.3))
    ]
    pairs = [{"between": ["low", "table"]}, {"between": ["high", "low"]}]
    return scene("extreme_stack", [fixed("table", plane()), *balls], contact=pairs, run={"until": 0.1})


def _stack_error(ratio: float, path: Trajectory) -> float:
    true = G * np.array([1 + ratio, ratio])
    return float(np.abs(path.force[0] / true - 1).max())


def _try_stack(ratio: float, libraries: LibrariesByKinds) -> Trial:
    return tried_run(partial(_stack, ratio), libraries, partial(_stack_error, ratio))


def _billiards(ratio: float) -> Scene:
    """A ball of `ratio` kg meets one of 1 kg at rest, head-on, elastically."""
    balls = [
        dynamic(
            name,
            sphere(0.1),
            mass=mass,
            inertia=[4e-3 * mass] * 3,
            position=[x, 0.0, 0.0],
            velocity=[v, 0, 0],
        )
        for name, mass, x, v in (("one", ratio, 0.0, 1.0), ("two", 1.0, 0.3, 0.0))
    ]
    return scene(
        "extreme_billiards",
        balls,
        contact=[{"between": ["one", "two"], "restitution": 1.0}],
        gravity=[0.0, 0.0, 0.0],
        run={"until": 0.2},
    )


def _billiards_error(ratio: float, path: Trajectory) -> float:
    """Relative errors of both velocities after the impact, (m - 1)/(m + 1) and 2 m/(m + 1)."""
    true = np.array([(ratio - 1) / (ratio + 1), 2 * ratio / (ratio + 1)])
    return float((np.abs(path.v[-1, :, 0] - true) / np.maximum(np.abs(true), 1e-12)).max())


def _try_billiards(ratio: float, libraries: LibrariesByKinds) -> Trial:
    return tried_run(partial(_billiards, ratio), libraries, partial(_billiards_error, ratio))


# ---- spins ----


def _spinning(spin: float) -> Scene:
    """A body that no force turns, spun near its second axis, which it leaves."""
    body = dynamic(
        "top",
        ellipsoid(0.1, 0.07, 0.05),
        mass=1.0,
        inertia=[1e-3, 2e-3, 3e-3],
        position=[0.0, 0.0, 0.0],
        angular_velocity=[0.1 * spin, spin, 0.05 * spin],
    )
    return scene("extreme_spin", [body], gravity=[0.0, 0.0, 0.0], run={"until": 1.0})


def _try_spin(spin: float, libraries: LibrariesByKinds) -> Trial:
    make = partial(_spinning, spin)
    return tried_run(make, libraries, against(libraries, make))


def _sleeping(spin: float) -> Scene:
    """A spheroid that sleeps upright on a table, leaning by 0.1 rad."""
    turned = 0.1
    egg = tilted_spheroid(0.04, 0.06, turned, [0.0, -spin * sin(turned), spin * cos(turned)])
    return scene(
        "extreme_sleeper",
        [fixed("table", plane()), egg],
        contact=[{"between": ["egg", "table"]}],
        run={"until": 0.1},
    )


def _try_sleeping(spin: float, libraries: LibrariesByKinds) -> Trial:
    make = partial(_sleeping, spin)
    return tried_run(make, libraries, against(libraries, make))


def _units(name: str, what: str) -> Extreme:
    values = tuple(sorted((*decades(-9, -1), *decades(1, 9)), key=lambda x: abs(log10(x))))
    return Extreme(
        f"unit of {name}", f"new units of {what} in an old one", values, (1e-9, 1e6),
        "none", lambda x: 1e-13, "places, rotations, forces, against the old unit", partial(_try_units, name),
    )  # fmt: skip


SCALES_AND_SPINS = (
    _units("length", "length"),
    _units("mass", "mass"),
    _units("time", "time"),
    Extreme(
        "far from the origin", "distance of an egg of 0.05 m; m", decades(0, 12), (1.0, 1e6),
        "tolerance + 40 eps x over the length", lambda x: 1e-11 + 40 * EPS * x / 0.05,
        RUN, _try_far, warned=2e4,
    ),
    Extreme(
        "heavy above light", "ratio of masses, stacked", decades(-10, 10), (1e-10, 1e4, 1e10),
        "rounding + eps x", lambda x: 1e-12 + 10 * EPS * x, "forces, each by its size", _try_stack,
    ),
    Extreme(
        "heavy strikes light", "ratio of masses, head-on", decades(-10, 10), (1e-10, 1e10),
        "rounding", lambda x: 1e-14, "speeds after it, against the closed form", _try_billiards,
    ),
    Extreme(
        "free spin", "rad/s for 1 s, about an unstable axis", decades(0, 5), (1.0, 1e3),
        "(tolerance + eps x) x", lambda x: 1e-12 + (1e-12 + 2 * EPS * x) * x,
        "body points over the length, against long double", _try_spin,
    ),
    Extreme(
        "spin in contact", "rad/s of a spheroid on its tip for 0.1 s", decades(0, 5), (1.0, 1e3),
        "tolerance + 10 eps x", lambda x: 1e-12 + 100 * EPS * x,
        RUN, _try_sleeping,
    ),
)  # fmt: skip
