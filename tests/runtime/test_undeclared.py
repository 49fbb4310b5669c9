"""Bodies that pass through each other because no contact lists them are named, and no others."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from modelgen import closest_points, read, simulate
from modelgen.assembly import require
from modelgen.codegen.library import Library
from modelgen.codegen.manifest_unlisted_shapes import unlisted_of
from modelgen.rotations import rotation_of
from modelgen.runtime.passages import passages
from modelgen.runtime.poses import pose_matrices as matrices
from modelgen.runtime.thresholds import Thresholds
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene.read import read_text
from tests.running import NAMES, SCENES, library_of

GRAVITY = 9.81


def scene(bodies: str, *lines: str, gravity: float = 0.0) -> Library:
    head = (f"gravity = [0.0, 0.0, {-gravity}]", "run = { until = 1.0 }", f"body = [{bodies}]", *lines)
    return library_of(read_text("\n".join(head), "scene.toml"))


def body(name: str, shape: str, at: str, velocity: str = "[0.0, 0.0, 0.0]", spin: str = "[0, 0, 0]") -> str:
    return (
        f'{{ name = "{name}", mass = 1.0, inertia = [1.0, 1.0, 1.0], shape = {{ {shape} }}, position = {at}, '
        f"velocity = {velocity}, angular_velocity = {spin} }}"
    )


def fixed(name: str, shape: str) -> str:
    return f'{{ name = "{name}", motion = "fixed", shape = {{ {shape} }} }}'


def run(library: Library, samples: int = 20) -> Trajectory:
    return simulate(library, samples=samples, estimate=False)


def named(path: Trajectory) -> list[tuple[str, str]]:
    return [each.between for each in path.undeclared]


BALL = 'kind = "sphere", radius = 0.1'
PLANE = 'kind = "plane"'
SMALL = 'kind = "sphere", radius = 0.02'


@pytest.mark.parametrize("samples", [1, 7, 200])
def test_a_ball_that_falls_through_a_floor_is_named_with_the_time(samples: int) -> None:
    bodies = f"{fixed('floor', PLANE)}, {body('ball', BALL, '[0, 0, 1]')}"
    path = run(scene(bodies, gravity=GRAVITY), samples)
    (passage,) = path.undeclared
    assert passage.between == ("floor", "ball")
    touching = np.sqrt(2 * 0.9 / GRAVITY)
    assert touching <= passage.t <= touching + (1e-3 if samples > 1 else 1.0)
    assert [text for text in path.warnings if "floor and ball pass through each other" in text]
    assert path.summary()["undeclared"] == [{"between": ["floor", "ball"], "t": passage.t}]


@pytest.mark.parametrize("speed", [1.0, 30.0, 1000.0])
def test_a_passage_between_two_samples_is_seen(speed: float) -> None:
    """Within 10 samples a second: at 1000 m/s the bodies overlap for 4e-5 s."""
    start = -speed * 0.4321
    library = scene(
        f"{fixed('still', SMALL)}, {body('fast', SMALL, f'[{start}, 0.005, 0]', f'[{speed}, 0, 0]')}"
    )
    (passage,) = run(library, 10).undeclared
    touching = 0.4321 - np.sqrt(0.04**2 - 0.005**2) / speed
    assert touching <= passage.t <= touching + 0.01 / speed


ROD = 'kind = "cylinder", radius = 0.02, length = 2.0'
HOLLOW = '{{ name = "hollow", motion = "fixed", shape = [{{ {} }}, {{ {} }}] }}, {}'
APART = {
    "rods side by side": f"{fixed('a', ROD)}, {body('b', ROD, '[0.05, 0, 0]', spin='[0, 0, 3.0]')}",
    "a ball through a ring": "{}, {}".format(
        fixed("ring", 'kind = "torus", major = 0.3, minor = 0.05'),
        body("ball", 'kind = "sphere", radius = 0.24', "[0, 0, -1]", "[0, 0, 2]"),
    ),
    "a ball in a cavity": "{}, {}".format(
        fixed("shell", 'kind = "sphere", radius = 0.5, cavity = true'), body("ball", BALL, "[0.2, 0, 0]")
    ),
    "a ball in a bore": "{}, {}".format(
        fixed("pipe", 'kind = "tube", radius = 0.3, bore = 0.2, length = 1.0'),
        body("ball", 'kind = "sphere", radius = 0.19', "[0, 0, -1]", "[0, 0, 2]"),
    ),
    "a ball over a bowl": "{}, {}".format(
        fixed("bowl", 'kind = "paraboloid", radii = [0.5, 0.5]'), body("ball", BALL, "[0, 0, 0.11]")
    ),
    "boxes that touch": "{}, {}".format(
        fixed("table", 'kind = "box", size = [1.0, 1.0, 0.2]'),
        body("box", 'kind = "box", size = [0.2, 0.2, 0.2]', "[-0.3, 0.01, 0.2]", "[0.5, 0, 0]"),
    ),
    "a ball in a hollow body": HOLLOW.format(
        'name = "outside", kind = "sphere", radius = 0.6',
        'name = "inside", kind = "sphere", radius = 0.5, cavity = true',
        body("ball", BALL, "[0.2, 0, 0]", "[-0.3, 0, 0]"),
    ),
}  # fmt: skip


@pytest.mark.parametrize("bodies", APART.values(), ids=APART)
def test_bodies_whose_balls_alone_overlap_are_not_named(bodies: str) -> None:
    assert not run(scene(bodies)).undeclared


ACROSS = {
    "crossed rods": f"{fixed('a', ROD)}, "
    + body("b", 'kind = "box", size = [3.0, 0.01, 0.01]', "[0.7, -1, 0.3]", "[0, 2, 0]"),
    "a ball out of a cavity": "{}, {}".format(
        fixed("a", 'kind = "sphere", radius = 0.5, cavity = true'),
        body("b", BALL, "[0.2, 0, 0]", "[1, 0, 0]"),
    ),
    "a ball against a ring": "{}, {}".format(
        fixed("a", 'kind = "torus", major = 0.3, minor = 0.05'),
        body("b", 'kind = "sphere", radius = 0.255', "[0, 0, -1]", "[0, 0, 2]"),
    ),
    "a wire through a ball": "{}, {}".format(
        fixed("a", BALL), body("b", 'kind = "circle", radius = 0.5', "[0.5, 0.0, -1]", "[0, 0, 2]")
    ),
    "a revolution through a prism": "{}, {}".format(
        fixed("a", 'kind = "extrusion", points = [[0, 0], [1, 0], [0, 1]], length = 0.2'),
        body("b", 'kind = "revolution", r = "0.2*sin(t)", z = "-0.3*cos(t)", domain = [0.0, "pi"]',
             "[0.2, 0.2, -1]", "[0, 0, 2]"),
    ),
    "a ball through a height field": "{}, {}".format(
        fixed("a", 'kind = "height_field", x = [-1.0, 0.0, 1.0, 2.0], y = [-1.0, 0.0, 1.0, 2.0], '
                   "heights = [[0, 0.1, 0, 0.1], [0.1, 0, 0.1, 0], [0, 0.1, 0, 0.1], [0, 0, 0, 0]]"),
        body("b", BALL, "[0.3, 0.2, 1]", "[0, 0, -2]"),
    ),
}  # fmt: skip


@pytest.mark.parametrize("bodies", ACROSS.values(), ids=ACROSS)
def test_bodies_that_pass_through_each_other_are_named_once(bodies: str) -> None:
    path = run(scene(bodies))
    assert named(path) == [("a", "b")]
    assert 0 < path.undeclared[0].t < 1


def test_what_overlaps_from_the_start_says_so() -> None:
    path = run(scene(f"{fixed('a', BALL)}, {body('b', BALL, '[0.1, 0, 0]')}"))
    assert path.undeclared[0].t == 0.0
    assert any("a and b overlap, first seen at the start" in text for text in path.warnings)


def test_joined_and_listed_pairs_are_not_named_but_their_neighbours_are() -> None:
    bodies = ", ".join(
        [
            fixed("wall", BALL),
            body("arm", ROD, "[0, 0, 0.5]"),
            body("stone", BALL, "[1, 0, 0.3]", "[-1, 0, 0]"),
        ]
    )
    joint = 'joint = [{ kind = "spherical", between = ["wall", "arm"] }]'
    contact = 'contact = [{ between = ["stone", "wall"] }]'
    assert named(run(scene(bodies, joint, contact))) == [("arm", "stone")]


def test_a_shape_that_is_not_listed_is_named_with_its_body() -> None:
    dumbbell = (
        '{ name = "dumbbell", mass = 1.0, inertia = [1, 1, 1], position = [0, 0, 0.5], shape = ['
        '{ name = "left", kind = "sphere", radius = 0.1, position = [-0.3, 0, 0] }, '
        '{ name = "right", kind = "sphere", radius = 0.1, position = [0.3, 0, 0] }] }'
    )
    floor = '{ name = "floor", motion = "fixed", shape = { kind = "plane" } }'
    contact = 'contact = [{ between = ["dumbbell/left", "floor"] }]'
    path = run(scene(f"{floor}, {dumbbell}", contact, gravity=GRAVITY))
    assert named(path) == [("floor", "dumbbell/right")]


@pytest.mark.cases(15)
@pytest.mark.parametrize("name", NAMES)
def test_shipped_scenes_name_nothing_and_keep_no_shapes_where_all_pairs_are_listed(name: str) -> None:
    table = unlisted_of(require(read(SCENES / f"{name}.toml")))
    assert bool(table["shapes"]) == (name in ("gripper", "newton_cradle"))


@pytest.mark.parametrize("name", ["gripper", "newton_cradle"])
def test_shipped_scenes_whose_pairs_are_not_all_listed_pass_through_nothing(name: str) -> None:
    assert not simulate(library_of(read(SCENES / f"{name}.toml")), estimate=False).undeclared


TOUCHING = (
    *("ball_in_torus", "coin_in_bowl", "disc_on_rim", "ellipsoid_in_cavity", "spinning_egg", "tippe_top"),
    *("bouncing_ellipsoid", "cube_toss", "newton_cradle", "linked_rings", "helix_on_cylinder"),
)


@pytest.mark.cases(4)
@pytest.mark.parametrize(
    "name", [*TOUCHING, *(pytest.param(n, marks=pytest.mark.slow) for n in NAMES if n not in TOUCHING)]
)
def test_bodies_that_roll_slide_and_bounce_on_each_other_do_not_overlap(name: str) -> None:
    """Each shipped scene, whose contacts hold, as if none of them were listed: between samples, too."""
    scene = read(SCENES / f"{name}.toml")
    unlisted = unlisted_of(require(replace(scene, contacts=(), observe=())))
    library = library_of(scene)
    path = simulate(library, samples=40, estimate=False)
    apart = library.with_instance({**library.manifest.instance, "unlisted": unlisted})
    assert not passages(path, apart, Thresholds().overlap_depth)


def poses(path: Trajectory, k: int) -> Any:
    """(n, 12) the poses of one body at the samples, as the core takes them."""
    turned = [rotation_of(tuple(q)).ravel(order="F") for q in path.quaternion[:, k]]
    return np.hstack([path.p[:, k], np.array(turned)])


@pytest.mark.slow
def test_ellipsoids_are_named_where_their_certified_distance_is_negative() -> None:
    """Against the closest points of the same pair, listed, at 1000 poses of each of 16 random flights."""
    random = np.random.default_rng(5)
    shape = 'kind = "ellipsoid", semi_axes = [{:.3f}, {:.3f}, {:.3f}]'
    outcomes = []
    for _ in range(16):
        shapes = [shape.format(*random.uniform(0.1, 0.5, 3)) for _ in range(2)]
        place, spin = random.uniform(-0.6, 0.6, 2), random.uniform(-3, 3, 3)
        start = f"[-1.0, {place[0]:.4f}, {place[1]:.4f}]"
        turning = f"[{spin[0]:.4f}, {spin[1]:.4f}, {spin[2]:.4f}]"
        bodies = f"{fixed('a', shapes[0])}, {body('b', shapes[1], start, '[2.0, 0.1, 0.2]', turning)}"
        path = run(scene(bodies), 1000)
        listed = scene(bodies, 'contact = [{ between = ["a", "b"] }]')
        d = closest_points(listed, "a-b", matrices(poses(path, 0)), matrices(poses(path, 1))).d.min()
        coarse = run(scene(bodies), 25)
        outcomes.append((float(d), bool(coarse.undeclared)))
    assert not [d for d, is_named in outcomes if is_named and d > 0]
    assert not [d for d, is_named in outcomes if not is_named and d < -0.01]
    assert {is_named for _, is_named in outcomes} == {True, False}
