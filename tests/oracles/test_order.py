"""What must not matter: the order of a pair, the frame, how a body or a number is written."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from modelgen.runtime.trajectory import Trajectory
from modelgen.scene import python_scenes as make
from tests.oracles.pieces import TABLE, ball, imbalance, ran, rotations, solid

AXES = (0.12, 0.09, 0.07)
STARTED = {"position": [0.0, 0.0, 0.16], "rpy": [0.3, -0.2, 0.5], "angular_velocity": [1.0, 3.0, -2.0]}
BOUNCING = [{"between": ["egg", "rock"], "restitution": 0.5}]


def written(turn: Rotation) -> list[float]:
    return turn.as_quat()[[3, 0, 1, 2]].tolist()


def same_motion(a: Trajectory, b: Trajectory, body: str, tolerance: float = 1e-9) -> None:
    """Same events, places and turns of a body of that name."""
    assert [e.kind for e in a.events] == [e.kind for e in b.events]
    assert np.allclose([e.t for e in a.events], [e.t for e in b.events], atol=tolerance, rtol=0)
    i, j = a.body_names.index(body), b.body_names.index(body)
    assert np.abs(a.p[:, i] - b.p[:, j]).max() < tolerance
    assert np.abs(rotations(a, i) - rotations(b, j)).max() < 10 * tolerance


@pytest.mark.cases(1)
@pytest.mark.parametrize(
    "shape",
    [
        make.plane(position=[0, 0, 0.02]),
        make.ellipsoid(0.5, 0.4, 0.06),
        make.torus(0.2, 0.05, position=[0.17, 0, 0]),
    ],
)
def test_the_order_of_a_pair_does_not_matter(shape) -> None:
    rock, egg = make.fixed("rock", shape), solid("egg", AXES, **STARTED)
    one = ran([rock, egg], 0.5, BOUNCING)
    two = ran([egg, rock], 0.5, [{"between": ["rock", "egg"], "restitution": 0.5}])
    assert one.events
    same_motion(one, two, "egg")
    assert np.abs(one.force - two.force).max() < 1e-5 * (1 + np.abs(one.force).max())


def test_moving_the_whole_world_changes_nothing() -> None:
    turn, shift = Rotation.from_rotvec([0.7, -1.1, 0.4]), np.array([3.0, -2.0, 5.0])
    rock, egg = make.ellipsoid(0.5, 0.4, 0.06), solid("egg", AXES, **STARTED)
    here = ran([make.fixed("rock", rock), egg], 0.5, BOUNCING)
    placed = make.fixed("rock", rock, position=shift.tolist(), quaternion=written(turn))
    moved = solid(
        "egg",
        AXES,
        position=(shift + turn.apply(STARTED["position"])).tolist(),
        quaternion=written(turn * Rotation.from_euler("xyz", STARTED["rpy"])),
        angular_velocity=turn.apply(STARTED["angular_velocity"]).tolist(),
    )
    there = ran([placed, moved], 0.5, BOUNCING, gravity=turn.apply([0, 0, -9.81]).tolist())
    assert [e.kind for e in here.events] == [e.kind for e in there.events] != []
    assert np.abs(shift + turn.apply(here.p[:, 1]) - there.p[:, 1]).max() < 1e-9
    assert np.abs(turn.as_matrix() @ rotations(here, 1) - rotations(there, 1)).max() < 1e-8
    assert np.abs(here.force - there.force).max() < 1e-5


def test_an_ellipsoid_slides_down_a_tilted_plane_as_on_a_level_one_under_tilted_gravity() -> None:
    turn = Rotation.from_rotvec([0.2, 0.3, 0.1])
    spin, height = (
        np.array([0.5, 1.0, 2.0]),
        float(np.linalg.norm(AXES * Rotation.from_euler("xyz", [0.2, 0.1, 0]).as_matrix()[2])),
    )
    contact = [{"between": ["egg", "rock"]}]
    egg = solid("egg", AXES, position=[0, 0, height], rpy=[0.2, 0.1, 0], angular_velocity=spin.tolist())
    gravity = turn.inv().apply([0, 0, -9.81]).tolist()
    level = ran([make.fixed("rock", make.plane()), egg], 0.5, contact, gravity=gravity)
    tilted = make.fixed("rock", make.plane(), quaternion=written(turn), position=[0, 0, 1.0])
    start = np.add(turn.apply([0, 0, height]), [0, 0, 1.0]).tolist()
    egg = solid(
        "egg",
        AXES,
        position=start,
        quaternion=written(turn * Rotation.from_euler("xyz", [0.2, 0.1, 0])),
        angular_velocity=turn.apply(spin).tolist(),
    )
    down = ran([tilted, egg], 0.5, contact)
    assert np.abs(turn.apply(level.p[:, 1]) - down.p[:, 1] + np.array([0, 0, 1.0])).max() < 1e-10
    assert np.abs(level.force - down.force).max() < 1e-8


def test_full_inertia_is_the_same_body_in_its_principal_axes() -> None:
    moments, skewed = np.array([0.00312, 0.004632, 0.0054]), Rotation.from_rotvec([0.4, 0.9, -0.6])
    attitude, spin = Rotation.from_euler("xyz", [0.3, -0.2, 0.5]), [1.0, 3.0, -2.0]
    rock = make.fixed("rock", make.ellipsoid(0.5, 0.4, 0.06))
    keys = {"mass": 1.2, "position": [0, 0, 0.16], "angular_velocity": spin}
    principal = make.dynamic(
        "egg", make.ellipsoid(*AXES), inertia=moments.tolist(), quaternion=written(attitude), **keys
    )
    R = skewed.as_matrix()
    full = make.dynamic(
        "egg",
        make.ellipsoid(*AXES, quaternion=written(skewed)),
        inertia=(R @ np.diag(moments) @ R.T).tolist(),
        quaternion=written(attitude * skewed.inv()),
        **keys,
    )
    a, b = ran([rock, principal], 0.5, BOUNCING), ran([rock, full], 0.5, BOUNCING)
    assert np.abs(a.p[:, 1] - b.p[:, 1]).max() < 1e-9
    assert np.abs(rotations(a, 1) - rotations(b, 1) @ R).max() < 1e-8
    assert np.abs(a.energy - b.energy).max() < 1e-11


def test_a_body_frame_off_the_centre_of_mass_is_only_another_way_to_write() -> None:
    arm, frame = np.array([0.05, -0.02, 0.03]), Rotation.from_rotvec([0.3, 0.2, -0.5])
    attitude = Rotation.from_euler("xyz", [0.3, -0.2, 0.5])
    centre = np.array([0.01, 0.02, -0.015])  # of mass, in the ellipsoid's axes
    inertia = np.array([[0.0031, 0.0002, 0.0], [0.0002, 0.0046, -0.0001], [0.0, -0.0001, 0.0054]])
    rock = make.fixed("rock", make.ellipsoid(0.5, 0.4, 0.06))
    origin = np.array([0.0, 0.0, 0.16])
    keys = {"mass": 1.2, "angular_velocity": [1.0, 3.0, -2.0], "velocity": [0.1, 0.0, 0.2]}
    plain = make.dynamic(
        "egg",
        make.ellipsoid(*AXES),
        center_of_mass=centre.tolist(),
        inertia=inertia.tolist(),
        position=origin.tolist(),
        quaternion=written(attitude),
        **keys,
    )
    R = frame.as_matrix()
    other = make.dynamic(
        "egg",
        make.ellipsoid(*AXES, position=arm.tolist(), quaternion=written(frame)),
        center_of_mass=(arm + R @ centre).tolist(),
        inertia=(R @ inertia @ R.T).tolist(),
        quaternion=written(attitude * frame.inv()),
        position=(origin - (attitude * frame.inv()).apply(arm)).tolist(),
        **keys,
    )
    a, b = ran([rock, plain], 0.5, BOUNCING), ran([rock, other], 0.5, BOUNCING)
    assert a.events
    assert np.abs(a.p[:, 1] - b.p[:, 1]).max() < 1e-9
    assert np.abs(rotations(a, 1) - rotations(b, 1) @ R).max() < 1e-8
    assert imbalance(b) < 1e-10


def test_density_of_a_users_ellipsoid_is_that_of_the_catalogue() -> None:
    shape = make.chart(
        "0.02 + 0.12*cos(u)*cos(v)", "0.09*sin(u)*cos(v)", "0.07*sin(v)",
        domain=[(0, "2*pi"), ("-pi/2", "pi/2")], periodic=[True, False],
    )  # fmt: skip
    keys = {"density": 900.0, "rpy": [0.3, -0.2, 0.5], "angular_velocity": [1.0, 3.0, -2.0]}
    rock = make.fixed("rock", make.ellipsoid(0.5, 0.4, 0.06))
    at = Rotation.from_euler("xyz", [0.3, -0.2, 0.5]).apply([0.02, 0, 0])
    mine = make.dynamic("egg", shape, position=(np.array([0, 0, 0.16]) - at).tolist(), **keys)
    theirs = make.dynamic("egg", make.ellipsoid(*AXES), position=[0, 0, 0.16], **keys)
    a, b = ran([rock, mine], 0.15, BOUNCING), ran([rock, theirs], 0.15, BOUNCING)
    assert a.events
    same_motion(a, b, "egg", 1e-8)
    assert a.energy[0] == pytest.approx(b.energy[0], rel=1e-11)


def test_folding_numbers_into_the_code_changes_nothing() -> None:
    bodies = [
        make.fixed("rock", make.ellipsoid(0.5, 0.4, 0.06)),
        solid("egg", AXES, **STARTED),
        ball("b", [0.05, 0, 0.5]),
    ]
    contact = [*BOUNCING, {"between": ["egg", "b"], "restitution": 1.0}]
    plain, folded = (ran(bodies, 0.5, contact, fold=fold) for fold in (False, True))
    assert len({e.contact for e in plain.events}) == 2
    same_motion(plain, folded, "egg")
    same_motion(plain, folded, "b")


@pytest.mark.cases(2)
@pytest.mark.parametrize("seen", ["a.position", "a.velocity", "b.orientation", "a.angular_velocity"])
def test_what_is_observed_never_depends_on_what_else_is(seen: str) -> None:
    turned = {"rpy": [0.1, 0.2, 0.3], "angular_velocity": [3.0, 1.0, 2.0]}
    bodies = [TABLE, ball("a", [0, 0, 0.3], **turned), ball("b", [0.05, 0, 0.6], rpy=[0.4, 0.0, 0.2])]
    contact = [{"between": [one, "table"], "restitution": 0.8} for one in "ab"]
    contact += [{"between": ["a", "b"], "restitution": 0.8}]
    whole = ran(bodies, 0.6, contact)
    part = ran(bodies, 0.6, contact, observe=[seen])
    column = {"position": "p", "velocity": "v", "orientation": "quaternion", "angular_velocity": "w"}
    body, quantity = seen.split(".")
    index = whole.body_names.index(body)
    one, two = (getattr(path, column[quantity])[:, index] for path in (whole, part))
    assert np.abs(one - two).max() < 1e-9
    assert [e.kind for e in whole.events] == [e.kind for e in part.events] != []
