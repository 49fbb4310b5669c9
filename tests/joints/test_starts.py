"""Starts that joints refuse or mend, joints that repeat each other, and dead centres."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import pytest

from modelgen import Accuracy, simulate, simulate_batch
from modelgen.errors import SceneError, SimulationError
from modelgen.runtime.thresholds import Thresholds
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene import python_scenes as make
from tests.joints.test_closed_forms import block, coordinate, joined
from tests.running import library_of, run

FLAT = {"rotation": [[1, 0, 0], [0, 0, 1], [0, -1, 0]]}  # hinges about the world's y
SPEED = 5.0


def parallelogram(angle: float, until: float, kinds: Sequence[str] = ("revolute",) * 4) -> Trajectory:
    """Two cranks of 0.3 m, 1 m apart, under a bar of 1 m, turning at SPEED without any load."""
    direction, across = (
        np.array([np.cos(angle), 0, np.sin(angle)]),
        np.array([-np.sin(angle), 0, np.cos(angle)]),
    )
    tip, v, right = 0.3 * direction, 0.3 * SPEED * across, np.array([1.0, 0.0, 0.0])
    spin = {"velocity": list(v / 2), "angular_velocity": [0, -SPEED, 0], "inertia": (0.01, 0.01, 0.01)}
    bodies = [
        block("left", position=list(tip / 2), **spin),
        block("bar", position=list(tip + right / 2), velocity=list(v)),
        block("right", position=list(tip / 2 + right), **spin),
    ]
    joints = [
        {"name": "A", "between": ["world", "left"]},
        {"name": "B", "between": ["left", "bar"], "position": list(tip)},
        {"name": "C", "between": ["bar", "right"], "position": list(tip + right)},
        {"name": "D", "between": ["right", "world"], "position": list(right)},
    ]
    turned = [{"kind": kind, **(FLAT if kind == "revolute" else {})} for kind in kinds]
    joints = [{**joint, **own} for joint, own in zip(joints, turned, strict=True)]
    return joined(bodies, joints, until=until, gravity=[0, 0, 0])


@pytest.mark.cases(2)
@pytest.mark.parametrize(("angle", "passed"), [(np.pi / 2, 5), (1.2, 5), (0.0, 4)])
def test_a_parallelogram_goes_on_through_its_dead_centres_which_are_named(angle: float, passed: int) -> None:
    path = parallelogram(angle, 3.0)
    assert np.abs(coordinate(path, "A.angle") + SPEED * path.t).max() < 1e-9
    assert path.energy_drift < 1e-11
    assert path.joint_error_max < 1e-13
    (named,) = [warning for warning in path.warnings if "were singular" in warning]
    assert f"singular {passed} times" in named
    assert "joint 'D' lost a row" in named


@pytest.mark.parametrize("kinds", [("revolute", "spherical", "universal", "revolute"), ("revolute",) * 4])
def test_rows_that_are_lost_together_at_a_dead_centre_do_not_hide_each_other(kinds: tuple[str, ...]) -> None:
    """Of a rod between a ball joint and a universal joint two rows turn over at once."""
    (named,) = [each for each in parallelogram(np.pi / 2, 1.2, kinds).warnings if "were singular" in each]
    told = re.search(r"first before t = ([0-9.]+) s", named)
    assert told is not None
    early = Thresholds().joint_rank_tolerance ** 0.5  # rad: rows count as lost so near to the dead centre
    assert (np.pi / 2 - early) / SPEED < float(told[1]) < np.pi / 2 / SPEED + 0.1


def test_a_contact_beside_redundant_joints_keeps_its_certificate() -> None:
    """The joints hold some rows twice, the one contact that rubs none: its force is unique."""
    level = {"kind": "revolute", **FLAT}
    bodies = [
        block("left", position=[0, 0, 0.1]), block("right", position=[0.4, 0, 0.1]),
        make.dynamic("bar", make.box(0.5, 0.05, 0.02), density=1000.0, position=[0.2, 0, 0.2]),
        make.dynamic("ball", make.sphere(0.03), density=500.0, position=[0.2, 0, 0.24]),
    ]  # fmt: skip
    ends = {
        "A": (["world", "left"], 0.0, 0.0), "B": (["left", "bar"], 0.0, 0.2),
        "C": (["bar", "right"], 0.4, 0.2), "D": (["right", "world"], 0.4, 0.0),
    }  # fmt: skip
    joints = [
        {"name": name, "between": between, "position": [x, 0, z], **level}
        for name, (between, x, z) in ends.items()
    ]
    contact = [{"between": ["ball", "bar"], "friction": 0.3}]
    path = joined(bodies, joints, until=0.3, contact=contact)
    assert path.redundant_max == 0
    assert any("redundant: 3 of its 5 rows" in warning for warning in path.warnings)
    assert not any("not unique" in warning for warning in path.warnings)


def test_a_linkage_that_stays_away_from_its_dead_centres_names_none() -> None:
    assert not [warning for warning in parallelogram(np.pi / 2, 0.2).warnings if "dead centre" in warning]
    assert not [warning for warning in run("four_bar", Accuracy.tight()).warnings if "dead centre" in warning]


@pytest.mark.parametrize("accuracy", ["fast", "balanced"])
@pytest.mark.parametrize("away", [0.0, 0.3])
@pytest.mark.parametrize("speed", [1.0, 20.0, 200.0])
def test_a_rotor_that_turns_far_in_a_step_passes_no_dead_centre(
    accuracy: str, away: float, speed: float
) -> None:
    rotor = make.dynamic(
        "rotor", mass=1.0, inertia=[1e-3] * 3, position=[away, 0, 0], velocity=[0, speed * away, 0],
        angular_velocity=[0, 0, speed],
    )  # fmt: skip
    hinge = {"name": "hinge", "kind": "revolute", "between": ["world", "rotor"]}
    library = library_of(make.scene("rotor", [rotor], joint=[hinge], gravity=[0, 0, 0]))
    path = simulate(library, until=2.0, accuracy=accuracy, samples=2, estimate=False)
    assert not [warning for warning in path.warnings if "dead centre" in warning]


def test_a_door_on_two_hinges_swings_as_on_one_and_says_that_the_second_is_redundant() -> None:
    door = block("door", inertia=(0.4, 0.1, 0.5), position=[0.5, 0.0, 0.0])
    hinge = {"kind": "revolute", "between": ["world", "door"], **FLAT}
    lower, upper = ({**hinge, "position": [0, y, 0], "name": n} for n, y in (("lower", -0.4), ("upper", 0.4)))
    one, two = joined([door], [{**lower, "position": [0, 0, 0]}], 2.0), joined([door], [lower, upper], 2.0)
    assert np.abs(one.p - two.p).max() < 1e-11
    assert [w for w in two.warnings if w.startswith("joint 'upper' is redundant: 5 of its 5 rows")]
    assert np.abs(two.joint_force.sum(axis=1) - one.joint_force[:, 0]).max() < 1e-9
    assert np.abs(two.joint_force[:, 0] - two.joint_force[:, 1]).max() < 1e-9


def test_bodies_that_a_joint_cannot_bring_together_are_refused_by_name() -> None:
    apart = {"name": "pin", "kind": "revolute", "between": ["world", "block"]}
    apart["frames"] = [{}, {"position": [0.0, 0.01, 0.0]}]
    with pytest.raises(SimulationError, match=r"joint 'pin'.*do not fit together at the start by 0.01 m"):
        joined([block()], [apart])


@pytest.mark.parametrize(
    ("kind", "words"),
    [
        ("revolute", "0.02 m apart, their z axes are 90 degrees apart, angles count by the length"),
        ("weld", "0.02 m apart, their axes are turned by 120 degrees, angles count"),
        ("spherical", "0.02 m apart; at most"),
    ],
)
def test_places_and_axes_that_do_not_fit_are_told_apart(kind: str, words: str) -> None:
    turned = {"axis": [1.0, 1.0, 1.0], "angle": 2 * np.pi / 3}
    apart = {"name": "pin", "kind": kind, "between": ["world", "block"]}
    apart["frames"] = [{}, {"position": [0.0, 0.02, 0.0], "axis_angle": turned}]
    with pytest.raises(SimulationError, match=f"the origins of its frames are {words}"):
        joined([block()], [apart])


def test_bodies_that_nearly_fit_are_brought_together() -> None:
    near = {"name": "pin", "kind": "spherical", "between": ["world", "block"]}
    near["frames"] = [{}, {"position": [0.3, 1e-7, 0.0]}]
    path = joined([block(position=[-0.3, 0.0, 0.0])], [near])
    assert np.abs(path.p[0, 0] - [-0.3, -1e-7, 0]).max() < 1.1e-7
    assert path.energy_drift < 1e-12


def test_velocities_that_do_not_fit_lose_what_an_impulse_of_the_joints_would_take() -> None:
    pin = {"name": "pin", "kind": "revolute", "between": ["world", "block"], **FLAT}
    bar = block(inertia=(0.1, 0.2, 0.3), position=[0.5, 0.0, 0.0], velocity=[3.0, 1.0, -2.0])
    path = joined([bar], [pin], gravity=[0, 0, 0])
    rate = 2.0 * 2.0 * 0.5 / (0.2 + 2.0 * 0.25)  # angular momentum about the pin over the moment about it
    assert np.abs(coordinate(path, "pin.angle") - rate * path.t).max() < 1e-11
    (warning,) = [warning for warning in path.warnings if "velocities at the start" in warning]
    assert "'pin' by 3 m/s" in warning


def test_a_start_past_a_limit_is_refused_by_name() -> None:
    slide = {"name": "slide", "kind": "prismatic", "between": ["world", "block"], "limits": [0.1, "none"]}
    with pytest.raises(SimulationError, match=r"joint 'slide'.*past its limit \(minimum\)"):
        joined([block()], [slide])


def test_a_batch_of_pendulums_is_as_many_single_runs() -> None:
    pin = {"name": "pin", "kind": "revolute", "between": ["world", "block"], **FLAT}
    library = library_of(make.scene("batched", [block(position=[0.5, 0.0, 0.0])], joint=[pin]))
    rates = np.array([0.0, 1.0, -2.0])
    q = np.tile(library.manifest.instance["initial_q"], (3, 1))
    u = np.stack([np.zeros(3), np.zeros(3), -0.5 * rates, np.zeros(3), rates, np.zeros(3)], axis=1)
    batch = simulate_batch(library, q, u, until=1.0, accuracy="tight")
    alone = simulate(library, until=1.0, accuracy="tight", samples=1)
    assert np.abs(batch.q[0, :3] - alone.p[-1, 0]).max() < 1e-15
    assert batch.energy_drift.max() < 1e-12
    assert np.ptp(batch.u[:, 4]) > 0.1


def test_a_chain_of_twenty_links_keeps_its_energy_and_its_joints_for_long() -> None:
    links = [block(f"link{k}", mass=0.1, inertia=(0.001, 0.001, 0.0002), position=[0.1 * k + 0.05, 0, 0])
             for k in range(20)]  # fmt: skip
    names = ["world", *(f"link{k}" for k in range(20))]
    joints = [{"kind": "spherical", "between": [a, b], "position": [0.1 * k, 0, 0]}
              for k, (a, b) in enumerate(pairwise(names))]  # fmt: skip
    scene = make.scene("chain", links, joint=joints)
    path = simulate(library_of(scene), until=1.0, accuracy=Accuracy.balanced(), samples=10)
    assert path.energy_drift < 1e-9
    assert path.joint_error_max < 1e-13


@pytest.mark.slow
def test_a_four_bar_linkage_does_not_drift_over_a_hundred_turns() -> None:
    path = run("four_bar", Accuracy.balanced(), until=70.0)
    assert path.coordinates[-1, 0] > 200 * np.pi
    assert path.energy_drift < 1e-9
    assert path.joint_error_max < 1e-13


@pytest.mark.parametrize(
    ("joint", "where", "said"),
    [
        ({"kind": "revolut"}, r"joint\[0\].kind", "revolute"),
        ({"kind": "screw"}, r"joint\[0\]", "lead"),
        ({"kind": "screw", "lead": 0.0}, r"joint\[0\].lead", "a lead of 0"),
        ({"kind": "gear", "teeth": [0, 3]}, r"joint\[0\].teeth", "without teeth"),
        ({"kind": "rope"}, r"joint\[0\].limits", "without limits"),
        ({"kind": "revolute", "limits": [1.0, 0.0]}, r"joint\[0\].limits", "the first is the smaller"),
        ({"kind": "revolute", "motion": "t", "stiffness": 1.0}, r"joint\[0\].motion", "remove one"),
        ({"kind": "revolute", "motion": "x"}, r"joint\[0\].motion", "t"),
        ({"kind": "weld", "limits": [0.0, 1.0]}, r"joint\[0\]", "belongs to"),
        ({"kind": "weld", "between": ["world", "world"]}, r"joint\[0\].between", "itself"),
        ({"kind": "weld", "between": ["world", "blok"]}, r"joint\[0\].between", "'block'"),
        ({"kind": "weld", "position": [0, 0, 0], "frames": [{}, {}]}, r"joint\[0\]", "together"),
    ],
)
def test_a_joint_that_cannot_be_is_refused_with_its_place(joint, where: str, said: str) -> None:
    with pytest.raises(SceneError, match=rf"{where}.*{said}"):
        make.scene("bad", [block()], joint=[{"between": ["world", "block"], **joint}])
