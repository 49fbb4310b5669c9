"""A body slides over the seam of two level plates as over one.

Walls, posts and steps beside the plates are struck, and their blows are not doubted.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pytest

from modelgen import Accuracy, require, simulate
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Body, Scene, Shape
from tests.running import library_of

SEAM = 0.0  # m, where the second plate begins
SPEED = 2.0
SLIDERS = {
    "box": make.box(0.3, 0.2, 0.1),
    "puck": make.cylinder(0.15, 0.1),
    "wedge": make.extrusion(length=0.1, points=[[-0.1, -0.1], [0.15, -0.05], [0.0, 0.12]]),
}
CORNERED = {
    "wedge": SLIDERS["wedge"],
    "pyramid": make.polyhedron([[-0.1, -0.1, -0.05], [0.2, -0.1, -0.05], [0.1, 0.15, -0.05], [0, 0, 0.15]]),
}
LEFT = make.fixed("left", make.box(2.0, 2.0, 2.0), position=[-1.0, 0.0, -1.0])


def plate(height: float = 0.0, width: float = 2.0) -> Body:
    return make.fixed("right", make.box(2.0, width, 2.0), position=[1.0, 0.0, height - 1.0])


def slide(
    shape: Shape,
    ground: Sequence[Body],
    yaw: float = 0.0,
    joints: Sequence[Mapping[str, Any]] = (),
    flush_height: float = Accuracy().flush_height,
    spin: float = 0.0,
) -> Scene:
    """A body that slides without friction along x, 0.5 m before the seam at the start."""
    body = make.dynamic(
        "slider", shape, mass=1.0, inertia=[0.01, 0.01, 0.01], position=[-0.5, 0.0, 0.05], rpy=[0, 0, yaw],
        velocity=[SPEED, 0.0, 0.0], angular_velocity=[0.0, 0.0, spin],
    )  # fmt: skip
    contact = [{"between": ["slider", each.name]} for each in ground]
    run = {"flush_height": flush_height}
    return make.scene("seam", [*ground, body], contact=contact, joint=list(joints), run=run)


def slid(*where: Any, **how: Any) -> Trajectory:
    """Its event-driven run."""
    return simulate(library_of(slide(*where, **how)), until=0.4, samples=2, estimate=False)


def is_stopped(path: Trajectory) -> bool:
    return bool(np.abs(path.v[-1, -1] - [SPEED, 0.0, 0.0]).max() > 1e-9)


@pytest.mark.parametrize("width", [2.0, 0.1])
@pytest.mark.parametrize("name", SLIDERS)
def test_a_slider_is_not_stopped_by_a_seam(name: str, width: float) -> None:
    random = np.random.default_rng(len(name))
    for height in (0.0, 1e-13):
        path = slid(SLIDERS[name], [LEFT, plate(height, width)], random.uniform(-np.pi, np.pi))
        assert path.is_trusted, path.doubts
        assert not is_stopped(path), (height, path.events)


@pytest.mark.parametrize("name", CORNERED)
def test_steps_of_a_slider_over_a_seam_leave_its_velocities(name: str) -> None:
    """A corner that leaves one plate is on the other one after the same step."""
    for seed in range(4):
        random = np.random.default_rng([len(name), seed])
        yaw, step, spin = random.uniform(-np.pi, np.pi), random.uniform(5e-4, 3e-3), random.uniform(-3, 3)
        right = plate(random.choice([0.0, 1e-13, -1e-10]), random.uniform(0.5, 1.0))
        scene = slide(CORNERED[name], [LEFT, right], yaw, spin=spin)
        steps = Accuracy.balanced().time_stepping(step)
        path = simulate(library_of(scene), until=0.4, samples=40, accuracy=steps, estimate=False)
        np.testing.assert_allclose(path.v[:, -1], [[SPEED, 0.0, 0.0]] * len(path.t), atol=1e-9)
        np.testing.assert_allclose(path.w[:, -1], [[0.0, 0.0, spin]] * len(path.t), atol=1e-9)


@pytest.mark.parametrize("flush", [1e-12, 1e-8, 1e-5])
def test_a_step_is_slid_over_up_to_the_flush_height_of_the_scene_and_struck_above(flush: float) -> None:
    """The characteristic length is the radius of the box."""
    length = float(np.hypot(np.hypot(0.15, 0.1), 0.05))
    for part in (0.5, 0.999, 1.001, 2.0):
        path = slid(SLIDERS["box"], [LEFT, plate(part * flush * length)], 0.3, flush_height=flush)
        assert path.is_trusted, (part, path.doubts)
        assert is_stopped(path) == (part > 1), (part, path.events)


def test_a_round_plug_in_a_plane_joins_it_by_finite_numbers() -> None:
    """Faces of a cylinder are unbounded but for their conditions."""
    plane = make.fixed("floor", make.plane())
    plug = make.fixed("plug", make.cylinder(0.2, 0.5), position=[0.2, 0.0, -0.25])
    body = make.dynamic("slider", SLIDERS["puck"], mass=1.0, inertia=[0.01] * 3, position=[-0.5, 0.0, 0.05])
    contact = [{"between": ["slider", each]} for each in ("floor", "plug")]
    with np.errstate(all="raise"):
        joined = require(make.scene("plug", [plane, plug, body], contact=contact)).joined
    assert len(joined) == 1


def test_plates_that_are_flush_with_a_first_one_are_level_with_each_other() -> None:
    """One is above it and one below; they are moved to its level."""
    middle = make.fixed("middle", make.box(0.1, 2.0, 2.0), position=[0.05, 0.0, -1.0 + 9e-10])
    last = make.fixed("last", make.box(2.0, 2.0, 2.0), position=[1.1, 0.0, -1.0 - 9e-10])
    for shape in SLIDERS.values():
        path = slid(shape, [LEFT, middle, last], 0.3)
        assert path.is_trusted, path.doubts
        assert not is_stopped(path), path.events


@pytest.mark.parametrize("height", [1e-9, -1e-9])
def test_the_far_edge_of_a_plate_is_at_the_level_of_its_face(height: float) -> None:
    """A box that slides off the second plate, and tips, does not penetrate its edge."""
    right = make.fixed("right", make.box(0.2, 2.0, 2.0), position=[0.1, 0.0, height - 1.0])
    path = slid(SLIDERS["box"], [LEFT, right], 0.3)
    assert "tipping" in [event.kind for event in path.events]
    assert path.penetration_max < 1e-12


@pytest.mark.parametrize("thickness", [0.1, 0.5, 3.0])
def test_a_face_rests_on_plates_of_different_thickness(thickness: float) -> None:
    """They are fixed bodies with axes at different heights."""
    right = make.fixed("right", make.box(2.0, 2.0, thickness), position=[1.0, 0.0, -thickness / 2])
    path = slid(SLIDERS["box"], [LEFT, right])
    assert [event.kind for event in path.events] == ["face-contact"]
    assert path.is_trusted
    assert not is_stopped(path)


@pytest.mark.parametrize("name", ["box", "wedge"])
def test_plates_that_are_welded_are_one_floor(name: str) -> None:
    """One of them in axes of its own, turned about the seam's direction and upside down, held by its weld."""
    right = make.dynamic(
        "right", make.box(2.0, 2.0, 2.0, position=[0.0, 0.0, 0.5]), density=500.0,
        position=[1.0, 0.0, -0.5], rpy=[float(np.pi), 0.0, float(np.pi / 2)],
    )  # fmt: skip
    path = slid(SLIDERS[name], [LEFT, right], 0.3, [{"kind": "weld", "between": ["left", "right"]}])
    assert path.is_trusted, path.doubts
    assert not is_stopped(path), path.events


@pytest.mark.parametrize("name", SLIDERS)
@pytest.mark.parametrize("height", [1e-7, 1e-3])
def test_a_step_is_struck(name: str, height: float) -> None:
    path = slid(SLIDERS[name], [LEFT, plate(height)], 0.3)
    assert is_stopped(path)
    assert not path.flush_contact


@pytest.mark.parametrize(("yaw", "width"), [(0.0, 0.05), (0.3, 2.0)])
@pytest.mark.parametrize("name", SLIDERS)
def test_a_wall_that_stands_on_the_plate_is_struck(name: str, yaw: float, width: float) -> None:
    floor = make.fixed("floor", make.box(4.0, 2.0, 2.0), position=[0.0, 0.0, -1.0])
    wall = make.fixed("wall", make.box(0.2, width, 1.0), position=[0.1, 0.0, 0.5])
    path = slid(SLIDERS[name], [floor, wall], yaw)
    assert is_stopped(path)
    assert not path.flush_contact


@pytest.mark.parametrize("aside", [-0.06, 0.0, 0.03])
@pytest.mark.parametrize("sunk", [0.0, 0.3])
def test_the_upright_edge_of_a_post_is_struck_by_a_low_edge(aside: float, sunk: float) -> None:
    """The sides of a pyramid lean back: its base strikes the post, where the post leaves the floor."""
    floor = make.fixed("floor", make.box(4.0, 2.0, 2.0), position=[0.0, 0.0, -1.0])
    half, turned = 0.05, [0.0, 0.0, np.pi / 4]
    post = make.fixed(
        "post", make.box(2 * half, 2 * half, 1.0), position=[0.1, aside, 0.5 - sunk], rpy=turned
    )
    base = [[x, y, -0.05] for x in (-0.1, 0.1) for y in (-0.1, 0.1)]
    path = slid(make.polyhedron([*base, [0.0, 0.0, 0.1]]), [floor, post])
    blow = next(each for each in path.events if each.kind == "touch-down")
    assert blow.t == pytest.approx((0.1 - half * np.sqrt(2) + 0.5 - 0.1) / SPEED, abs=1e-9)
    assert is_stopped(path)


@pytest.mark.parametrize("name", SLIDERS)
def test_the_wall_of_a_tray_is_struck(name: str) -> None:
    points = [[-2.0, -1.0], [1.0, -1.0], [1.0, 1.0], [0.0, 1.0], [0.0, 0.0], [-2.0, 0.0]]
    tray = make.fixed("tray", make.extrusion(length=2.0, points=points), rpy=[np.pi / 2, 0.0, 0.0])
    path = slid(SLIDERS[name], [tray], 0.3)
    assert is_stopped(path)
    assert not path.flush_contact


def test_friction_on_a_plug_in_a_plane_is_that_of_the_plane() -> None:
    """The face of the plug lies in that of the plane, which counts alone, under a frustum that spins."""
    plane = make.fixed("floor", make.plane())
    plug = make.fixed("plug", make.cylinder(0.15, 0.5), position=[0.2, 0.0, -0.25])
    body = make.dynamic(
        "slider", make.frustum(0.2, 0.1, 0.1), mass=1.0, inertia=[0.01] * 3, position=[-0.1, 0.05, 0.05],
        velocity=[SPEED, 0.0, 0.0], angular_velocity=[0.0, 0.0, 2.0],
    )  # fmt: skip
    alone, plugged = (
        simulate(
            library_of(
                make.scene(
                    "plug",
                    [*ground, body],
                    contact=[{"between": ["slider", each.name], "friction": 0.2} for each in ground],
                )
            ),
            until=0.2,
        )
        for ground in ([plane], [plane, plug])
    )
    assert [event.kind for event in plugged.events] == ["face-contact"]
    np.testing.assert_allclose(plugged.p[-1, -1], alone.p[-1, -1], atol=1e-12)
