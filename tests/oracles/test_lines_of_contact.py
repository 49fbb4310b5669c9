"""Bodies that lie on each other along a line, or almost so: held at both ends of it."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from modelgen import simulate
from modelgen.codegen.library import Library
from modelgen.runtime.trajectory import Outcome, Trajectory
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Body, Scene, Shape
from tests.benchmarks.groups import Ran, deepest
from tests.running import library_of

RADIUS, STEP, UNTIL = 0.05, 1e-3, 0.1  # m, s, s
WITHIN = 1e-10  # m
SHAPES = {
    "capsule": lambda length: make.capsule(RADIUS, length),
    "cylinder": lambda length: make.cylinder(RADIUS, length),
    "frustum": lambda length: make.frustum(RADIUS, 0.8 * RADIUS, length),
    "box": lambda length: make.box(2 * RADIUS, 2 * RADIUS, length),
}
PAIRS = [
    ("capsule", 0.08, "capsule", 0.08),
    ("box", 0.08, "cylinder", 0.1),  # reaches beyond the face at both ends
    ("frustum", 0.08, "frustum", 0.06),
    ("cylinder", 0.08, "capsule", 0.06),
    ("capsule", 0.08, "box", 0.1),
    ("cylinder", 0.08, "cylinder", 0.06),
    ("box", 0.08, "capsule", 0.1),
]
TILTS = [0.0, 1e-12, 1e-9, 1e-6, 1e-4, 1e-2]  # rad
YAWS = [0.0, 1e-9, 1e-5]  # rad
LEVEL = [pair for pair in PAIRS if pair[0] != "frustum"]  # whose lower body lies level on the floor


def slot(lower: Shape, upper: Shape, angle: float) -> tuple[Scene, list[Body]]:
    """Two bodies with level axes, one above the other, between a floor and two walls, and turned by about an
    angle in rad; they fall onto the floor and each other."""
    chance = np.random.default_rng(1)
    free = 1e-4 + 0.1 * angle
    walls = [
        make.fixed("floor", make.plane()),
        make.fixed("east", make.plane(), position=[RADIUS + free, 0, 0], rpy=[0, -np.pi / 2, 0]),
        make.fixed("west", make.plane(), position=[-RADIUS - free, 0, 0], rpy=[0, np.pi / 2, 0]),
    ]
    bodies = []
    for k, shape in enumerate((lower, upper)):
        turn = Rotation.from_rotvec(angle * chance.normal(size=3) * [0.5, 0, 0.1])
        rpy = [float(a) for a in (turn * Rotation.from_euler("x", np.pi / 2)).as_euler("xyz")]
        place = [0.0, 0.013 * k, RADIUS * (1 + 2 * k) + (1 + 3 * k) * free]
        bodies.append(make.dynamic(f"body{k}", shape, density=500.0 + 2000 * k, position=place, rpy=rpy))
    everything = [*walls, *bodies]
    contact = [
        {"between": [b.name, a.name], "friction": 0.3}
        for a, b in combinations(everything, 2)
        if b.motion == "dynamic"
    ]
    return make.scene("slot", everything, contact=contact), everything


def fall(pair: tuple[str, float, str, float], angle: float) -> tuple[Trajectory, float, Library]:
    """The motion in the slot, the deepest penetration in it by support functions in m, and the library."""
    scene, bodies = slot(SHAPES[pair[0]](pair[1]), SHAPES[pair[2]](pair[3]), angle)
    library = library_of(scene)
    centres = {body["name"]: np.array(body["centre_of_mass"]) for body in library.manifest.instance["bodies"]}
    path = simulate(library, until=UNTIL, samples=100, estimate=False, method="time-stepping", step=STEP)
    return path, deepest(Ran(path, 0.0, centres), bodies), library


@pytest.mark.cases(8)
@pytest.mark.parametrize("pair", PAIRS, ids=lambda pair: f"{pair[2]}_on_{pair[0]}")
@pytest.mark.parametrize("angle", [1e-1, 1e-3, 1e-4, 1e-5, 1e-6, 1e-8])
def test_neither_end_of_a_line_of_contact_penetrates(
    pair: tuple[str, float, str, float], angle: float
) -> None:
    path, depth, _ = fall(pair, angle)
    assert path.outcome.succeeded
    assert depth < WITHIN
    assert path.penetration_max < WITHIN


@pytest.mark.cases(3)
@pytest.mark.parametrize("pair", LEVEL, ids=lambda pair: f"{pair[2]}_on_{pair[0]}")
@pytest.mark.parametrize("angle", [1e-4, 1e-6])
def test_a_body_at_rest_on_a_line_is_carried_by_both_of_its_ends(
    pair: tuple[str, float, str, float], angle: float
) -> None:
    """The weight is in their middle: each carries as much as its lever says, and none lets go again."""
    path, _, library = fall(pair, angle)
    upper = path.body_names.index("body1")
    ends = [k for k, name in enumerate(path.contact_names) if name.startswith("body1-body0")]
    places, forces = path.points_f[-1, ends], path.force[-1, ends]
    weight = 9.81 * library.manifest.instance["bodies"][upper]["parameters"][0]
    np.testing.assert_allclose(forces.sum(), weight, rtol=1e-6)
    assert (forces > 0.05 * weight).sum() == 2
    moment = np.nansum(forces * (places[:, 1] - path.p[-1, upper, 1]))
    assert abs(moment) < 1e-6 * weight
    opened = [event for event in path.events if event.kind in ("lift-off", "vanish") and event.t > UNTIL / 2]
    assert not opened


def descent(lower: Shape, upper: Shape, tilt: float, yaw: float, friction: float) -> Trajectory:
    """The event-driven motion of a body that falls by 1 cm onto a fixed one, along whose level axis its own
    lies but for the angles in rad, or onto a floor."""
    along, on_floor = float(np.pi / 2), lower.kind == "plane"
    ground = make.fixed("ground", lower, rpy=[0.0 if on_floor else along, 0, 0])
    place = [0.0, 0.013, RADIUS * (1 if on_floor else 2) + 0.01]
    body = make.dynamic("body", upper, density=500.0, position=place, rpy=[along + tilt, 0.0, yaw])
    contact = [{"between": ["body", "ground"], **({"friction": friction} if friction else {})}]
    library = library_of(make.scene("descent", [ground, body], contact=contact))
    return simulate(library, until=0.2, samples=20, estimate=False)


@pytest.mark.cases(12)
@pytest.mark.parametrize("lower", ["capsule", "cylinder"])
@pytest.mark.parametrize("upper", ["capsule", "cylinder"])
@pytest.mark.parametrize("tilt", TILTS)
@pytest.mark.parametrize("yaw", YAWS)
@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_a_body_settles_on_a_line_as_on_a_floor(
    lower: str, upper: str, tilt: float, yaw: float, friction: float
) -> None:
    """Its two ends move in the plane of both axes, where a line and a floor are the same."""
    line = descent(SHAPES[lower](0.4), SHAPES[upper](0.1), tilt, yaw, friction)
    floor = descent(make.plane(), SHAPES[upper](0.1), tilt, 0.0, friction)
    touches, expected = (
        [each.t for each in path.events if each.kind == "touch-down"] for path in (line, floor)
    )
    assert line.outcome.succeeded
    assert len(line.events) <= 2 * len(floor.events) + 2
    np.testing.assert_allclose(touches, expected, atol=1e-7)
    assert line.penetration_max < WITHIN
    np.testing.assert_allclose(line.p[:, -1, 2] - RADIUS, floor.p[:, -1, 2], atol=1e-8)


@pytest.mark.cases(8)
@pytest.mark.parametrize("pair", LEVEL, ids=lambda pair: f"{pair[2]}_on_{pair[0]}")
@pytest.mark.parametrize("tilt", TILTS)
@pytest.mark.parametrize("yaw", YAWS)
def test_the_events_of_a_body_that_settles_across_the_end_of_a_line_are_few(
    pair: tuple[str, float, str, float], tilt: float, yaw: float
) -> None:
    path = descent(SHAPES[pair[0]](pair[1]), SHAPES[pair[2]](pair[3]), tilt, yaw, 0.3)
    assert path.outcome.succeeded
    assert len(path.events) < 200
    assert path.penetration_max < WITHIN


def chase(lower: Shape, upper: Shape, tilt: float, yaw: float) -> Scene:
    """A body that falls tilted onto a floor, and above it a level one, turned about the vertical; angles in
    rad. As the lower rocks, the closest points of both run from end to end."""
    along = float(np.pi / 2)
    low, up = (
        make.dynamic("low", lower, density=500.0, position=[0, 0, RADIUS + 0.002], rpy=[along - tilt, 0, 0]),
        make.dynamic(
            "up", upper, density=500.0, position=[0, 0.013, 3 * RADIUS + 0.004], rpy=[along, 0, yaw]
        ),
    )
    pairs = [("low", "floor"), ("up", "low"), ("up", "floor")]
    contact = [{"between": list(pair)} for pair in pairs]
    return make.scene("chase", [make.fixed("floor", make.plane()), low, up], contact=contact)


@pytest.mark.cases(22)
@pytest.mark.parametrize("yaw", [1e-6, 1e-5, 1e-4, 3e-4])
@pytest.mark.parametrize("lower", ["capsule", "cylinder"])
@pytest.mark.parametrize("upper", ["capsule", "cylinder"])
@pytest.mark.parametrize("ratio", [1.0, 0.3, 0.1, 0.03])
def test_a_body_is_not_lost_as_its_closest_points_run_from_end_to_end(
    yaw: float, lower: str, upper: str, ratio: float
) -> None:
    """They pass the line in less than 1e-8 s, between feature pairs none of which has a minimum then."""
    scene = chase(SHAPES[lower](0.08), SHAPES[upper](0.08), yaw / ratio, yaw)
    path = simulate(library_of(scene), until=0.05, samples=20, estimate=False)
    assert path.outcome.succeeded
    assert path.penetration_max < WITHIN
    assert any(each.kind == "touch-down" and each.contact.startswith("up-low") for each in path.events)


@pytest.mark.cases(16)
@pytest.mark.parametrize("lower", [0.08, 0.4, 0.1])
@pytest.mark.parametrize("tilt", [-2e-6, -3e-7, 3e-7, 2e-6])
@pytest.mark.parametrize("roll", [-7e-9, 7e-9])
@pytest.mark.parametrize("yaw", [-8e-9, 2e-9])
def test_a_box_that_falls_flush_onto_a_box_does_not_penetrate_it_unseen(
    lower: float, tilt: float, roll: float, yaw: float
) -> None:
    """Where its edges pass those of the lower box within nm, an open contact across is no cover for points
    that are deep below."""
    ground = make.fixed("ground", SHAPES["box"](lower), rpy=[float(np.pi / 2), 0, 0])
    rpy = [float(np.pi / 2) + tilt, roll, yaw]
    place = [0.0, 0.013, 2 * RADIUS + 0.005]
    body = make.dynamic("body", SHAPES["box"](0.08), density=500.0, position=place, rpy=rpy)
    library = library_of(make.scene("flush", [ground, body], contact=[{"between": ["body", "ground"]}]))
    path = simulate(library, until=0.06, samples=20, estimate=False)
    assert path.outcome is not Outcome.PENETRATED
    assert path.penetration_max < 1e-6 * RADIUS
