"""Patterns: copies turned about an axis, of one kind, that move as one turned motion."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from modelgen import Accuracy, require, simulate
from modelgen.errors import SceneError
from modelgen.scene import python_scenes as make
from modelgen.scene.read import read_text
from modelgen.scene.scene_types import Body, Scene
from tests.running import library_of

COUNT, CENTER = 5, np.array([0.1, -0.2, 0.0])
PATTERN = {"of": "ball", "count": COUNT, "center": list(CENTER)}


def ball(**keys: object) -> Body:
    return make.dynamic(
        "ball", make.ellipsoid(0.05, 0.04, 0.03), density=1000.0,
        **{"position": [0.4, 0.0, 0.12], "rpy": [0.1, 0.2, 0.3], **keys},
    )  # fmt: skip


def ring(**keys: object) -> Scene:
    thrown = ball(velocity=[0.3, 0.2, -1.0], angular_velocity=[1.0, 2.0, 3.0])
    return make.scene(
        "ring", [make.fixed("table", make.plane()), thrown], pattern=[PATTERN],
        contact=[{"between": ["ball_*", "table"], "restitution": 0.5}], **keys,
    )  # fmt: skip


@pytest.mark.parametrize("axis", "xyz")
def test_copies_are_turned_with_their_velocities(axis: str) -> None:
    written = ball(velocity=[1.0, 2.0, 3.0], angular_velocity=[4.0, 5.0, 6.0])
    scene = make.scene("ring", [written], pattern=[{**PATTERN, "about": axis}])
    assert [body.name for body in scene.bodies] == [f"ball_{k}" for k in range(COUNT)]
    for k, body in enumerate(scene.bodies):
        turn = Rotation.from_euler(axis, 2 * np.pi * k / COUNT)
        assert body.pose.position == pytest.approx(
            CENTER + turn.apply(np.array(written.pose.position) - CENTER), abs=1e-15
        )
        assert body.velocity == pytest.approx(turn.apply(written.velocity), abs=1e-14)
        assert body.angular_velocity == pytest.approx(turn.apply(written.angular_velocity), abs=1e-14)
        found, start = (Rotation.from_quat(np.roll(b.pose.quaternion, -1)) for b in (body, written))
        assert (found * (turn * start).inv()).magnitude() < 1e-14


def test_copies_are_one_kind_and_move_as_one_turned_motion() -> None:
    scene = ring()
    model = require(scene)
    assert len(model.contact_kinds) == 1
    assert len(model.pairs) == COUNT
    path = simulate(library_of(scene), until=0.5, accuracy=Accuracy.tight(), estimate=False)
    first = path.p[:, path.body_names.index("ball_0")]
    for k in range(1, COUNT):
        turn = Rotation.from_euler("z", 2 * np.pi * k / COUNT)
        there = path.p[:, path.body_names.index(f"ball_{k}")]
        assert np.abs(there - (CENTER + turn.apply(first - CENTER))).max() < 1e-10


def test_repeated_shapes_are_one_kind_even_where_one_sits_at_the_body() -> None:
    peg = make.shape("ellipsoid", semi_axes=[0.2, 0.05, 0.05], name="peg")
    star = make.dynamic("star", peg, mass=1.0, inertia=[0.1, 0.1, 0.1], position=[0, 0, 1.0])
    floor = make.fixed("floor", make.plane())
    scene = make.scene(
        "star", [floor, star], pattern=[{"of": "star/peg", "count": 3}],
        contact=[{"between": ["star/peg_*", "floor"]}],
    )  # fmt: skip
    assert [shape.name for shape in scene.bodies[1].shapes] == ["peg_0", "peg_1", "peg_2"]
    model = require(scene)
    assert len(model.contact_kinds) == 1
    assert len(model.pairs) == 3


def test_a_text_twice_names_all_pairs_of_copies() -> None:
    scene = make.scene("ring", [ball()], pattern=[PATTERN], contact=[{"between": ["ball_*", "ball_*"]}])
    pairs = {frozenset(body for body, _ in pair.between) for pair in scene.contacts}
    assert len(scene.contacts) == len(pairs) == COUNT * (COUNT - 1) // 2


def test_planar_copies_keep_to_turned_planes() -> None:
    disc = make.planar("disc", mass=1.0, inertia=[1, 1, 1], normal=[1, 0, 0])
    scene = make.scene("discs", [disc], pattern=[{"of": "disc", "count": 4}])
    normals = [body.normal for body in scene.bodies if body.normal is not None]
    assert np.abs(np.array(normals) - [[1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0]]).max() < 1e-15
    assert [joint.name for joint in scene.joints] == [f"world_disc_{k}_planar" for k in range(4)]


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ('of = "bal"\ncount = 3', r"pattern\[0\].of: no body named 'bal'.*did you mean 'ball'"),
        ('of = "ball/shere"\ncount = 3', "no shape 'shere' of 'ball'.*did you mean 'sphere'"),
        ('of = "ball"\ncount = 1', "count.*from 2 to 1000"),
        ('of = "ball"\ncount = 3\nabout = "u"', "allowed are x, y, z"),
        ('of = "lift"\ncount = 3', "driven on a path"),
    ],
)
def test_a_pattern_of_nothing_is_refused(text: str, found: str) -> None:
    scene = (
        '[[body]]\nname = "ball"\nshape = { kind = "sphere", radius = 1 }\ndensity = 1\n'
        '[[body]]\nname = "lift"\nmotion = "driven"\npath = { position = ["t", 0, 0] }\n[[pattern]]\n'
    )
    with pytest.raises(SceneError, match=found):
        read_text(scene + text)


def test_a_contact_of_names_that_nothing_begins_with_is_refused() -> None:
    with pytest.raises(SceneError, match=r"contact\[0\].between: nothing whose name begins as 'bowl_\*'"):
        make.scene("ring", [ball()], pattern=[PATTERN], contact=[{"between": ["ball_*", "bowl_*"]}])
