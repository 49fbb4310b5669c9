"""Other units change nothing but the units.

Units that are powers of two only move exponents: every number of a run is then the same but for its exponent,
down to the last bit, unless some tolerance has a unit of its own. Powers of ten round, so that runs differ by
what rounding grows to.
"""

from __future__ import annotations

import numpy as np
import pytest

from modelgen import read, require, simulate
from modelgen.benchmark.libraries_by_kinds import LibrariesByKinds
from modelgen.benchmark.unit_conversion import Units, in_units
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene.python_scenes import chart, dynamic, fixed, plane, scene
from modelgen.scene.scene_types import Scene
from tests.running import NAMES, SCENES, folder

SMALL, LARGE = 2.0**-20, 2.0**20  # about 1e-6, 1e6
EXACT = [Units(**{name: size}) for name in ("length", "mass", "time") for size in (SMALL, LARGE)]
DECIMAL = [Units(**{name: 10.0**k}) for name in ("length", "mass", "time") for k in (-6, -3, 3, 6)]
QUICK = ("box_dropped", "peg_in_hole")
ROUNDED = {
    "helix_on_cylinder",
    "peg_in_hole",
    "user_surface",
}  # pivots are chosen by size, radians beside metres
LIBRARIES = LibrariesByKinds(folder() / "units")


def run(what: Scene, until: float | None = None, accuracy: str = "balanced") -> Trajectory:
    return simulate(LIBRARIES.library(what), accuracy=accuracy, samples=20, until=until)


def difference(found: Trajectory, true: Trajectory, units: Units) -> float:
    """The largest of positions, rotations, forces and event times, each over its largest."""
    pairs = [
        (found.p / units.length, true.p),
        (found.quaternion, true.quaternion),
        (found.v / units.speed, true.v),
        (found.force / units.force, true.force),
        (np.array([event.t for event in found.events]) / units.time, np.array([e.t for e in true.events])),
    ]
    sizes = [max(float(np.abs(b).max(initial=0.0)), 1e-300) for _, b in pairs]
    apart = [float(np.abs(a - b).max(initial=0.0)) for a, b in pairs]
    return max(part / size for part, size in zip(apart, sizes, strict=True))


def check(what: Scene, units: Units, true: Trajectory, until: float | None, within: float) -> None:
    found = run(in_units(what, units), None if until is None else until * units.time)
    assert found.outcome == true.outcome
    assert [(e.kind, e.contact) for e in found.events] == [(e.kind, e.contact) for e in true.events]
    assert found.steps == true.steps
    assert difference(found, true, units) <= within


@pytest.mark.cases(1)
@pytest.mark.parametrize("name", QUICK)
def test_units_of_powers_of_two_change_no_bit(name: str) -> None:
    what = read(SCENES / f"{name}.toml")
    until = min(what.run.until, 0.5)
    true = run(what, until)
    for units in EXACT:
        check(what, units, true, until, 1e-12 if name in ROUNDED else 0.0)


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(set(NAMES) - set(QUICK)))
def test_every_scene_is_the_same_in_every_unit(name: str) -> None:
    what = read(SCENES / f"{name}.toml")
    true = run(what)
    for units in EXACT:
        check(what, units, true, None, 1e-9 if name in ROUNDED else 0.0)


def test_units_of_powers_of_ten_change_what_rounding_does() -> None:
    what = read(SCENES / "ellipsoid_on_plane.toml")
    until = min(what.run.until, 1.0)
    true = run(what, until)
    for units in DECIMAL:
        found = run(in_units(what, units), until * units.time)
        assert [e.kind for e in found.events] == [e.kind for e in true.events]
        assert difference(found, true, units) < 1e-10


def pebble(unit: float) -> Scene:
    """A dome of the user's own on a table; the coordinates of its chart are lengths in the unit."""
    dome = chart(
        "u", "v", "-k*(u**2 + 2*v**2)/2", domain=[(-0.1 * unit, 0.1 * unit)] * 2, parameters={"k": 8 / unit}
    )
    body = dynamic(
        "dome", dome, mass=1.0, inertia=[4e-4 * unit**2] * 3, position=[0.0, 0.0, 0.0],
        axis_angle={"axis": [1.0, 0.0, 0.0], "angle": "pi"}, center_of_mass=[0.0, 0.0, -0.02 * unit],
        angular_velocity=[0.3, 0.2, 0.0],
    )  # fmt: skip
    gravity = [0.0, 0.0, -9.81 * unit]
    pairs = [{"between": ["dome", "table"], "form": "block"}]
    return scene(
        "pebble", [fixed("table", plane()), body], gravity=gravity, contact=pairs, run={"until": 0.2}
    )


def test_coordinates_of_charts_have_units_too() -> None:
    """They may be lengths: what they are measured against follows their domain."""
    true = run(pebble(1.0), accuracy="tight")
    assert true.outcome.succeeded
    for unit in (SMALL, LARGE):
        found = run(pebble(unit), accuracy="tight")
        assert difference(found, true, Units(length=unit)) <= 1e-13


def test_a_scene_without_gravity_takes_its_time_from_what_moves_it() -> None:
    what = read(SCENES / "brake_shoe.toml")
    scales = require(what).scales
    for units in EXACT:
        other = require(in_units(what, units)).scales
        assert (other.time, other.length) == (scales.time * units.time, scales.length * units.length)
