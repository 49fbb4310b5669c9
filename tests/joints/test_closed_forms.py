"""Joints whose motion is known in closed form."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest

from modelgen import Accuracy, simulate
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Body, Shape
from tests.running import library_of

G = 9.81
CLOSE = 1e-11


def block(
    name: str = "block", mass: float = 2.0, inertia: tuple[float, ...] = (0.1, 0.2, 0.3), **keys
) -> Body:
    return make.dynamic(name, mass=mass, inertia=list(inertia), **keys)


def joined(
    bodies: list[Body], joints: list[Mapping[str, object]], until: float = 1.0, samples: int = 20, **keys
) -> Trajectory:
    scene = make.scene("joined", bodies, joint=joints, **keys)
    return simulate(library_of(scene), until=until, accuracy=Accuracy.tight(), samples=samples)


def coordinate(path: Trajectory, name: str) -> np.ndarray:
    return path.coordinates[:, path.coordinate_names.index(name)]


def test_a_nut_falls_on_a_screw_with_the_inertia_of_its_turning() -> None:
    lead = 0.05
    path = joined(
        [block()], [{"name": "thread", "kind": "screw", "between": ["world", "block"], "lead": lead}]
    )
    fall = -G / (1 + 0.3 * (2 * np.pi / lead) ** 2 / 2.0) * path.t**2 / 2
    assert np.abs(coordinate(path, "thread.displacement") - fall).max() < CLOSE
    assert np.abs(coordinate(path, "thread.angle") - fall * 2 * np.pi / lead).max() < 1e-9
    assert path.energy_drift < 1e-12


def test_a_screw_turned_at_a_given_rate_carries_its_nut_through_many_turns() -> None:
    thread = {
        "name": "thread",
        "kind": "screw",
        "between": ["world", "block"],
        "lead": 0.02,
        "motion": "0.1*t",
    }
    path = joined(
        [block(velocity=[0, 0, 0.1], angular_velocity=[0, 0, "10*pi"])], [thread], until=3.0, samples=60
    )
    assert np.abs(coordinate(path, "thread.angle") - 10 * np.pi * path.t).max() < 1e-9
    assert np.abs(path.work - 2.0 * G * 0.1 * path.t).max() < 1e-10


def test_two_wheels_in_mesh_turn_as_their_teeth_say_with_the_reduced_inertia() -> None:
    wheels = [
        block("small", inertia=(0.1, 0.1, 0.02)),
        block("large", inertia=(0.3, 0.3, 0.5), position=[1, 0, 0]),
    ]
    path = joined(
        wheels,
        [
            {"name": "a", "kind": "revolute", "between": ["world", "small"]},
            {"name": "b", "kind": "revolute", "between": ["world", "large"], "position": [1, 0, 0]},
            {"kind": "gear", "between": ["small", "large"], "teeth": [17, 40]},
        ],
        torque=[{"body": "small", "torque": ["0.0", "0.0", "2.0"]}],
        until=2.0,
    )
    turn = 2.0 / (0.02 + 0.5 * (17 / 40) ** 2) * path.t**2 / 2
    assert turn[-1] > 2 * np.pi
    assert np.abs(coordinate(path, "a.angle") - turn).max() < 1e-10
    assert np.abs(coordinate(path, "b.angle") + turn * 17 / 40).max() < 1e-10


@pytest.mark.parametrize("damping", [0.0, 0.4])
def test_a_spring_on_a_hinge_is_an_oscillator(damping: float) -> None:
    stiffness, rest = 3.0, 0.5
    hinge = {"name": "hinge", "kind": "revolute", "between": ["world", "block"]}
    hinge |= {"stiffness": stiffness, "damping": damping, "rest": rest}
    path = joined([block()], [hinge], until=3.0)
    decay = damping / (2 * 0.3)
    omega = np.sqrt(stiffness / 0.3 - decay**2)
    swing = np.cos(omega * path.t) + decay / omega * np.sin(omega * path.t)
    assert (
        np.abs(coordinate(path, "hinge.angle") - rest * (1 - np.exp(-decay * path.t) * swing)).max() < CLOSE
    )


def test_a_given_motion_does_the_work_that_the_energy_gains() -> None:
    slide = {"name": "lift", "kind": "prismatic", "between": ["world", "block"], "motion": "0.2*sin(3*t)"}
    path = joined([block(velocity=[0.0, 0.0, 0.6])], [slide], until=2.0)
    rise, rate, accel = 0.2 * np.sin(3 * path.t), 0.6 * np.cos(3 * path.t), -1.8 * np.sin(3 * path.t)
    assert np.abs(coordinate(path, "lift.displacement") - rise).max() < 1e-13
    assert np.abs(path.joint_force[:, 0, 2] - 2.0 * (G + accel)).max() < 1e-10
    assert np.abs(path.work - (rate**2 - 0.36 + 2.0 * G * rise)).max() < CLOSE


def test_a_cardan_shaft_transmits_with_its_known_unevenness() -> None:
    """tan(out) = tan(in) cos(bend), where the arm of the input starts across the plane of the shafts."""
    bend, speed = 0.5, 2.0
    out = [-np.sin(bend), 0.0, np.cos(bend)]
    tilted = {"axis_angle": {"axis": [0.0, 1.0, 0.0], "angle": -bend}}
    fork = [[0, np.cos(bend), -np.sin(bend)], [-1, 0, 0], [0, np.sin(bend), np.cos(bend)]]
    path = joined(
        [
            block("input", angular_velocity=[0, 0, speed], position=[0, 0, -1]),
            block("output", inertia=(0.2, 0.2, 0.3), position=out, axis_angle=tilted["axis_angle"]),
        ],
        [
            {"kind": "revolute", "between": ["world", "input"], "motion": f"{speed}*t"},
            {"name": "out", "kind": "revolute", "between": ["world", "output"], **tilted},
            {"kind": "universal", "between": ["input", "output"], "rotation": fork},
        ],
        gravity=[0, 0, 0],
        until=3.0,
        samples=60,
    )
    turn = coordinate(path, "out.angle")
    given = speed * path.t
    slip = np.sin(turn) * np.cos(given) - np.sin(given) * np.cos(turn) * np.cos(bend)
    assert np.abs(slip).max() < 1e-12
    assert turn[-1] == pytest.approx(given[-1], abs=0.3)


def test_a_weld_makes_one_body_of_two() -> None:
    halves = [block("left", position=[-0.5, 0, 0]), block("right", position=[0.5, 0, 0], velocity=[0, 1, 0],
              angular_velocity=[0, 0, 1.0])]  # fmt: skip
    path = joined(halves, [{"kind": "weld", "between": ["left", "right"]}], until=2.0)
    assert path.energy_drift < 1e-12
    assert np.abs(np.linalg.norm(path.p[:, 1] - path.p[:, 0], axis=1) - 1.0).max() < 1e-12
    assert np.abs(path.p[:, 1, 2] + G * path.t**2 / 2).max() < CLOSE
    spin = path.w[:, 0]
    assert np.abs(spin - path.w[:, 1]).max() < 1e-13
    assert np.abs(spin - [0, 0, spin[0, 2]]).max() < 1e-13


def test_a_ball_joint_holds_a_heavy_top_whose_momenta_about_its_axes_stay() -> None:
    top = block("top", inertia=(0.3, 0.3, 0.1), position=[0.3, 0.0, 0.4], rpy=[0.0, 0.6435011087932844, 0.0],
                angular_velocity=[3.0, 0.0, 4.0])  # fmt: skip
    path = joined([top], [{"kind": "spherical", "between": ["world", "top"]}], until=2.0)
    body = path.body_names.index("top")
    p, v, w = path.p[:, body], path.v[:, body], path.w[:, body]
    axis = p / 0.5
    own = np.einsum("ni,ni->n", axis, w) * 0.1
    angular = (
        2.0 * np.cross(p, v)[:, 2] + 0.3 * w[:, 2] + (own - 0.3 * np.einsum("ni,ni->n", axis, w)) * axis[:, 2]
    )
    assert np.ptp(own) < 1e-12
    assert np.ptp(angular) < 1e-12
    assert np.abs(np.linalg.norm(p, axis=1) - 0.5).max() < 1e-12
    assert path.energy_drift < 1e-12


def test_a_cylindrical_joint_lets_a_body_fall_and_spin() -> None:
    sleeve = {"name": "sleeve", "kind": "cylindrical", "between": ["world", "block"]}
    path = joined([block(angular_velocity=[0, 0, 7.0])], [sleeve])
    assert np.abs(coordinate(path, "sleeve.displacement") + G * path.t**2 / 2).max() < CLOSE
    assert np.abs(coordinate(path, "sleeve.angle") - 7.0 * path.t).max() < CLOSE


def test_a_planar_joint_carries_the_weight_across_its_plane() -> None:
    slab = {"name": "floor", "kind": "planar", "between": ["world", "block"]}
    path = joined([block(velocity=[1.0, -2.0, 0.0], angular_velocity=[0, 0, 3.0])], [slab])
    for name, rate in (("x", 1.0), ("y", -2.0), ("angle", 3.0)):
        assert np.abs(coordinate(path, f"floor.{name}") - rate * path.t).max() < 1e-12
    assert np.abs(path.joint_force[:, 0] - [0, 0, 2.0 * G]).max() < 1e-12


def test_a_rod_of_constant_length_is_a_conical_pendulum() -> None:
    radius, height = 0.3, 0.4
    spin = np.sqrt(G / height)
    bob = block(position=[radius, 0, -height], velocity=[0, radius * spin, 0])
    rod = {"name": "rod", "kind": "distance", "between": ["world", "block"], "distance": 0.5}
    rod["frames"] = [{}, {}]
    path = joined([bob], [rod], until=2.0)
    circle = radius * np.stack([np.cos(spin * path.t), np.sin(spin * path.t)], axis=1)
    assert np.abs(path.p[:, 0, :2] - circle).max() < CLOSE
    assert np.abs(np.linalg.norm(path.joint_force[:, 0], axis=1) - 2.0 * G * 0.5 / height).max() < 1e-10


def test_a_rope_lets_a_body_fall_freely_until_it_is_taut() -> None:
    rope = {"name": "rope", "kind": "rope", "between": ["world", "block"], "limits": ["none", 0.5]}
    rope |= {"restitution": 0.5, "frames": [{}, {}]}
    path = joined([block(position=[0.0, 0.0, -0.1])], [rope], until=0.4)
    (struck,) = [event for event in path.events if event.kind == "impact"]
    assert struck.contact == "rope:max"
    assert struck.t == pytest.approx(np.sqrt(2 * 0.4 / G), abs=1e-12)
    assert struck.speed == pytest.approx(np.sqrt(2 * 0.4 * G), abs=1e-11)
    late = path.t > struck.t
    left = path.t[late] - struck.t
    assert np.abs(path.p[late, 0, 2] - (-0.5 + 0.5 * struck.speed * left - G * left**2 / 2)).max() < CLOSE


def test_a_limit_counts_whole_turns() -> None:
    hinge = {"name": "hinge", "kind": "revolute", "between": ["world", "block"], "limits": ["none", 20.0]}
    hinge["restitution"] = 1.0
    path = joined([block(angular_velocity=[0, 0, 10.0])], [hinge], until=3.0, samples=60)
    wanted = np.where(path.t < 2.0, 10.0 * path.t, 20.0 - 10.0 * (path.t - 2.0))
    assert np.abs(coordinate(path, "hinge.angle") - wanted).max() < 1e-10


@pytest.mark.parametrize("shape", [make.cylinder(0.1, 0.2), make.circle(0.1), make.sphere(0.1)])
def test_the_limit_of_a_hinge_does_not_know_the_shapes_of_other_bodies(shape: Shape) -> None:
    hinge = {"name": "hinge", "kind": "revolute", "between": ["world", "block"], "limits": [0.0, 0.5]}
    bodies = [
        make.dynamic("near", shape, mass=1.0, inertia=[1, 1, 1], position=[5, 0, 0]),
        make.fixed("far", shape, position=[9, 0, 0], rpy=[1.0, 0, 0]),
        block(angular_velocity=[0, 0, 1.0]),
    ]
    path = joined(
        bodies, [{**hinge, "restitution": 1.0, "frames": [{}, {}]}], until=0.9, gravity=[0, 0, 0],
        contact=[{"between": ["near", "far"]}],
    )  # fmt: skip
    assert coordinate(path, "hinge.angle")[-1] == pytest.approx(0.1, abs=1e-12)


def test_a_slide_rests_on_its_limit_with_its_weight() -> None:
    slide = {"name": "slide", "kind": "prismatic", "between": ["world", "block"], "limits": [-0.2, "none"]}
    path = joined([block()], [slide], until=1.0)
    assert [event.kind for event in path.events] == ["touch-down"]
    assert coordinate(path, "slide.displacement")[-1] == pytest.approx(-0.2, abs=1e-13)
    assert path.force[-1, path.contact_names.index("slide:min")] == pytest.approx(2.0 * G, rel=1e-12)


def test_a_planar_joint_bounces_within_its_box() -> None:
    """Without gravity each coordinate runs to and fro by itself; angles are free."""
    frame = {"name": "floor", "kind": "planar", "between": ["world", "block"], "restitution": 1.0}
    frame |= {"limits": [-0.3, 0.5], "limits_y": ["none", 0.2]}
    puck = block(velocity=[1.0, 0.5, 0.0], angular_velocity=[0, 0, 3.0])
    path = joined([puck], [frame], gravity=[0, 0, 0], until=2.0, samples=40)

    def folded(x: np.ndarray, low: float, high: float) -> np.ndarray:
        within = np.mod(x - low, 2 * (high - low))
        return low + np.minimum(within, 2 * (high - low) - within)

    assert np.abs(coordinate(path, "floor.x") - folded(path.t, -0.3, 0.5)).max() < CLOSE
    y = 0.5 * path.t
    assert np.abs(coordinate(path, "floor.y") - np.where(y < 0.2, y, 0.4 - y)).max() < CLOSE
    assert np.abs(coordinate(path, "floor.angle") - 3.0 * path.t).max() < CLOSE
    names = [(event.kind, event.contact) for event in path.events]
    assert names == [("impact", f"floor:{end}") for end in ("y_max", "max", "min")]


@pytest.mark.parametrize("restitution", [0.0, 0.6])
def test_the_cone_of_a_ball_joint_is_struck_as_the_limits_of_a_hinge(restitution: float) -> None:
    """A pendulum swings in one plane: the tilt of its axis is the angle of a hinge across the plane."""
    start = 0.4
    bob = {
        "position": [0.5 * np.sin(start), 0.0, -0.5 * np.cos(start)],
        "rpy": [0.0, -start, 0.0], "angular_velocity": [0.0, 3.0, 0.0],
        "velocity": [-1.5 * np.cos(start), 0, -1.5 * np.sin(start)],
    }  # fmt: skip
    ball = {"name": "ball", "kind": "spherical", "limits": ["none", 0.9], "restitution": restitution}
    ball |= {"between": ["world", "block"], "frames": [{}, {"position": [0, 0, 0.5]}]}
    hinge = {"name": "ball", "kind": "revolute", "limits": [-0.9, 0.9], "restitution": restitution}
    turned = {"axis_angle": {"axis": [1, 0, 0], "angle": "-pi/2"}}
    hinge |= {"between": ["world", "block"], "frames": [turned, {"position": [0, 0, 0.5], **turned}]}
    free, held = (joined([block(**bob)], [joint], until=2.0, samples=80) for joint in (ball, hinge))
    assert [event.kind for event in free.events][:2] == [event.kind for event in held.events][:2]
    assert len(free.events) >= 2
    assert np.abs(free.p - held.p).max() < 1e-10
    assert np.abs(coordinate(free, "ball.tilt") - np.abs(coordinate(held, "ball.angle"))).max() < 1e-9
    assert coordinate(free, "ball.tilt").max() < 0.9 + 1e-10


def test_a_cone_turns_a_body_back_whatever_it_spins() -> None:
    """At a blow on the cone energy and the momenta about the vertical and about the body's own axis stay."""
    top = block("top", inertia=(0.3, 0.3, 0.1), position=[0, 0, 0.5], angular_velocity=[1.0, 0.4, 6.0],
                velocity=[0.2, -0.5, 0.0])  # fmt: skip
    ball = {"kind": "spherical", "between": ["world", "top"], "name": "foot", "limits": ["none", 0.5]}
    ball |= {"restitution": 1.0, "frames": [{}, {"position": [0, 0, -0.5]}]}
    path = joined([top], [ball], until=1.5, samples=60)
    body = path.body_names.index("top")
    p, v, w = path.p[:, body], path.v[:, body], path.w[:, body]
    axis = p / 0.5
    own = np.einsum("ni,ni->n", axis, w)
    angular = 2.0 * np.cross(p, v) + 0.3 * w + (0.1 - 0.3) * own[:, None] * axis
    assert len(path.events) >= 2
    assert np.ptp(own) < 1e-11
    assert np.ptp(angular[:, 2]) < 1e-11
    assert path.energy_drift < 1e-11
    assert coordinate(path, "foot.tilt").max() <= 0.5 + 1e-10


def test_a_rod_whose_length_is_given_keeps_the_momentum_about_the_vertical() -> None:
    """A bob hauled in: |r| is as given, its moment about the vertical stays, the work is its gain."""
    start, rate = 0.5, 0.1
    spin = np.sqrt(G / 0.4)
    bob = block(position=[0.3, 0, -0.4], velocity=[-rate * 0.6, 0.3 * spin, rate * 0.8])
    rod = {"name": "rod", "kind": "distance", "between": ["world", "block"], "motion": f"{start} - {rate}*t"}
    path = joined([bob], [rod | {"frames": [{}, {}]}], until=2.0)
    length = start - rate * path.t
    assert np.abs(np.linalg.norm(path.p[:, 0], axis=1) - length).max() < 1e-12
    assert np.abs(coordinate(path, "rod.distance") - length).max() < 1e-12
    moment = np.cross(path.p[:, 0], path.v[:, 0])[:, 2]
    assert np.ptp(moment) < 1e-11
    speed = np.sum(path.v[:, 0] ** 2, axis=1)
    gained = speed - speed[0] + 2 * G * (path.p[:, 0, 2] + 0.4)
    assert np.abs(path.work - gained).max() < 1e-10
