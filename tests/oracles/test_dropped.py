"""A box and a cylinder dropped on a face, an edge, a vertex, the rim and the side, exact or tilted a little.

Which features touch is known from the pose alone. All forces are vertical: the centre of mass stays above one
point, and the angular momentum about the vertical stays zero. A solid that hits without bouncing ends at rest
on a face that carries it.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from modelgen.codegen.library import Library
from modelgen.runtime.trajectory import Trajectory
from tests.oracles.dropped import (
    BOX,
    CAN,
    DROP,
    HALF,
    LENGTH,
    RADIUS,
    TIGHT,
    Solid,
    heights_when,
    run_until,
    touching,
)
from tests.oracles.pieces import G, rotations
from tests.running import run

TILTS = (0.0, *(10.0**-k for k in range(12, 1, -1)))
TOUCHES = ("impact", "touch-down", "lift-off")
NEAR = 1e-10  # m: what touches; 1/10 of it in the core's own measure
OUT = HALF / np.linalg.norm(HALF)  # to the vertex top_back_right
STARTS = {  # the solid, the axis and the angle that put the feature lowest with the centre above it; how long
    "box on a face": (BOX, (1.0, 0.2, 0.0), 0.0, 1.0),
    "box on an edge": (BOX, (1.0, 0.0, 0.0), float(np.arctan2(HALF[1], HALF[2])), 6.0),
    "box on a vertex": (BOX, tuple(np.cross(OUT, [0, 0, -1.0])), float(np.arccos(-OUT[2])), 6.0),
    "can on an end": (CAN, (1.0, 0.2, 0.0), 0.0, 1.0),
    "can on its side": (CAN, (1.0, 0.2, 0.0), np.pi / 2, 1.0),
    "can on its rim": (CAN, (1.0, 0.2, 0.0), float(np.arctan2(RADIUS, LENGTH / 2)), 6.0),
}
ENDS_ON_A_RIM = ("can on an end", "can on its rim")  # rattle between a rim and three points of it
EVERY_START = pytest.mark.parametrize("start", STARTS)
EVERY_TILT = pytest.mark.parametrize(
    "tilt", [pytest.param(tilt, marks=pytest.mark.slow if k % 2 else ()) for k, tilt in enumerate(TILTS)]
)


def slack(start: str) -> float:
    """How far three points of a rim may be above its lowest, m."""
    return RADIUS * TIGHT.thresholds.flat_angle if start in ENDS_ON_A_RIM else 0.0


@cache
def dropped(start: str, tilt: float) -> tuple[Solid, Library, Trajectory]:
    solid, axis, angle, until = STARTS[start]
    library = solid.above_the_table(axis, angle + tilt)
    return solid, library, run_until(library, until, 200)


def lowest(heights: dict[str, float], within: float) -> set[str]:
    return {name for name, z in heights.items() if z < min(heights.values()) + within}


@pytest.mark.cases(8)
@EVERY_TILT
@EVERY_START
def test_the_run_goes_on_to_rest_on_a_face(start: str, tilt: float) -> None:
    solid, _, path = dropped(start, tilt)
    rest = (np.abs(path.v[-1, 1]).max(), np.abs(path.w[-1, 1]).max(), path.p[-1, 1, 2])
    assert path.outcome.name == "DONE"
    assert max(rest[:2]) < 1e-6
    face = np.abs(rotations(path, 1)[-1, 2])
    if solid is BOX:
        assert face.max() == pytest.approx(1.0, abs=1e-12)
        assert rest[2] == pytest.approx(HALF[face.argmax()], abs=1e-12)
    else:
        stands = face[2] > 0.5
        assert face[2] == pytest.approx(float(stands), abs=1e-12)
        assert rest[2] == pytest.approx(LENGTH / 2 if stands else RADIUS, abs=1e-12)


@EVERY_TILT
@EVERY_START
def test_what_carries_the_solid_at_the_end_is_a_face_or_its_side(start: str, tilt: float) -> None:
    solid, _, path = dropped(start, tilt)
    beneath = {name for name, z in solid.at(path, -1).items() if abs(z) < NEAR and "." not in name}
    weight = path.energy[0] / path.p[0, 1, 2]
    if solid is CAN and len(beneath) == 2:
        assert touching(path, -1, NEAR) == beneath
        assert path.force[-1].min() >= -1e-13 * weight
        assert path.force[-1].sum() == pytest.approx(weight, rel=1e-9)
        return
    assert touching(path, -1, NEAR) == set()
    face = path.patch_names[path.patch[-1, 0]].split(":")[1]
    assert all(face in name.split("_") for name in beneath)
    assert len(beneath) == (4 if solid is BOX else 1)
    assert path.patch_force[-1, 0] == pytest.approx(weight, rel=1e-9)
    assert path.patch_point[-1, 0] == pytest.approx([*path.p[-1, 1, :2], 0.0], abs=1e-9)


@EVERY_TILT
@EVERY_START
def test_the_first_to_touch_are_the_lowest_features(start: str, tilt: float) -> None:
    solid, _, path = dropped(start, tilt)
    first = path.events[0]
    assert first.t == pytest.approx(np.sqrt(2 * DROP / G), abs=1e-11 + slack(start))
    named = {event.features for event in path.events if event.t == first.t and event.kind == "touch-down"}
    heights = {name: z - G * first.t**2 / 2 for name, z in solid.at(path, 0).items()}  # no turning
    candidates = {name: z for name, z in heights.items() if "." in name} or heights
    assert named <= lowest(candidates, NEAR)
    assert named >= lowest(candidates, NEAR / 100)


@pytest.mark.parametrize("tilt", TILTS[::2])
@EVERY_START
def test_at_every_event_the_named_feature_is_on_the_table_and_none_below(start: str, tilt: float) -> None:
    solid, library, path = dropped(start, tilt)
    for t in sorted({event.t for event in path.events}):
        heights = heights_when(solid, library, t)
        assert min(heights.values()) > -1e-11 - slack(start)
        for event in path.events:
            if event.t == t and event.kind in TOUCHES:
                assert abs(heights[event.features]) < NEAR + slack(start)
                assert event.contact.endswith(event.features)


@EVERY_TILT
@EVERY_START
def test_no_corner_and_no_rim_is_ever_below_the_table(start: str, tilt: float) -> None:
    solid, _, path = dropped(start, tilt)
    assert min(min(solid.at(path, k).values()) for k in range(len(path.t))) > -1e-11 - slack(start)


@EVERY_TILT
@EVERY_START
def test_vertical_forces_neither_push_aside_nor_spin_about_the_vertical(start: str, tilt: float) -> None:
    _, library, path = dropped(start, tilt)
    mass, *inertia = library.manifest.instance["bodies"][1]["parameters"]
    spins = np.einsum("nji,nj->ni", rotations(path, 1), path.w[:, 1]) * inertia
    about = np.einsum("nij,nj->ni", rotations(path, 1), spins)[:, 2]
    assert np.abs(path.p[:, 1, :2]).max() < 1e-12
    assert np.abs(about).max() < (1e-7 if slack(start) else 1e-12) * mass * LENGTH**2


@EVERY_TILT
@EVERY_START
def test_what_impacts_take_is_booked(start: str, tilt: float) -> None:
    _, _, path = dropped(start, tilt)
    assert np.ptp(path.energy - path.work) < 1e-9 * path.energy[0]
    assert path.energy_drift < 1e-8


@EVERY_TILT
def test_the_ends_of_a_level_edge_share_the_load(tilt: float) -> None:
    """The motion stays in one plane: mirror images carry the same, touch and leave at the same times."""
    _, _, path = dropped("box on an edge", tilt)
    left = [name.endswith("left") for name in path.feature_pair_names]
    force = path.force[:, left], path.force[:, np.invert(left)]
    assert np.abs(force[0].sum(axis=1) - force[1].sum(axis=1)).max() < 1e-6 * np.abs(force).max()
    assert np.abs(path.w[:, 1, 1:]).max() < 1e-9


def test_an_edge_tilts_to_the_side_it_is_tilted_to() -> None:
    _, axis, balanced, until = STARTS["box on an edge"]
    for tilt in (-1e-2, -1e-6, 1e-6, 1e-2):
        path = run_until(BOX.above_the_table(axis, balanced + tilt), until, 2)
        assert path.p[-1, 1, 2] == pytest.approx(HALF[1] if tilt > 0 else HALF[2], abs=1e-12)


def test_a_shipped_box_falls_on_the_corner_that_is_lowest() -> None:
    path = run("box_dropped", TIGHT)
    assert path.events[0].features == min(BOX.at(path, 0), key=lambda name: BOX.at(path, 0)[name])
    assert path.events[0].t == pytest.approx(np.sqrt(2 * min(BOX.at(path, 0).values()) / G), abs=1e-11)
    assert path.patch_names[path.patch[-1, 0]] == "box-table:bottom"
    assert path.p[-1, 1, 2] == pytest.approx(HALF[2], abs=1e-12)


def test_a_shipped_cylinder_topples_from_one_rim_onto_both() -> None:
    """Between the touches it turns in a plane over a sliding point: energy gives the speed at the second."""
    path = run("cylinder_dropped", TIGHT)
    first, second = (event for event in path.events if event.kind == "touch-down")
    heights = CAN.at(path, 0)
    assert first.features == min(heights, key=lambda name: heights[name])
    assert {first.features, second.features} == {"rim_top", "rim_bottom"}
    assert first.t == pytest.approx(np.sqrt(2 * min(heights.values()) / G), abs=1e-11)
    inertia = (3 * RADIUS**2 + LENGTH**2) / 12  # about a diameter, of mass 1
    arm = np.hypot(RADIUS, LENGTH / 2)

    def height(angle: float) -> tuple[float, float]:
        """Of the centre above the table with the axis at `angle` to the vertical, and its slope."""
        lean = angle - np.arctan2(RADIUS, LENGTH / 2)
        return float(arm * np.cos(lean)), float(-arm * np.sin(lean))

    start, slope = height(0.8)
    blow = -np.sqrt(2 * G * min(heights.values())) * slope / (inertia + slope**2)
    end, last = height(np.pi / 2)
    squared = ((inertia + slope**2) * blow**2 + 2 * G * (start - end)) / (inertia + last**2)
    assert second.speed == pytest.approx(LENGTH * np.sqrt(squared), rel=1e-9)
