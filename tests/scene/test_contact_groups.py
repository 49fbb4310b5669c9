"""The table `contacts`: which pairs belong to a group."""

from __future__ import annotations

import pytest

from modelgen.errors import SceneError
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Body, Scene


def bodies() -> list[Body]:
    ball = make.sphere(0.1, name="ball")
    keys = {"mass": 1.0, "inertia": [1.0, 1.0, 1.0]}
    return [
        make.fixed("floor", make.plane()),
        make.fixed("wall", make.plane(), position=[-5.0, 0.0, 0.0]),
        make.dynamic("a", ball, position=[0.0, 0.0, 1.0], **keys),
        make.dynamic("b", ball, make.sphere(0.2, name="head"), position=[1.0, 0.0, 1.0], **keys),
        make.dynamic("c", ball, position=[2.0, 0.0, 1.0], **keys),
    ]


def scene(**keys: object) -> Scene:
    joint = {"name": "hinge", "kind": "revolute", "between": ["a", "c"]}
    return make.scene("group", bodies(), joint=[joint], **keys)


def pairs(made: Scene) -> set[str]:
    return {"-".join(f"{body}/{shape}" for body, shape in pair.between) for pair in made.contacts}


def test_every_two_bodies_of_which_one_is_dynamic_belong_to_it() -> None:
    made = scene(contacts={"between": "all", "joined": True})
    floor = ["a/ball", "b/ball", "b/head", "c/ball"]
    walls = {f"{one}/plane-{other}" for one in ("floor", "wall") for other in floor}
    others = {"a/ball-b/ball", "a/ball-b/head", "b/ball-c/ball", "b/head-c/ball", "a/ball-c/ball"}
    assert pairs(made) == walls | others
    assert all(pair.candidate for pair in made.contacts)


def test_joined_bodies_do_not_belong_to_it_unless_asked_for() -> None:
    asked = pairs(scene(contacts={"between": "all", "joined": True}))
    assert asked - pairs(scene(contacts={"between": "all"})) == {"a/ball-c/ball"}


def test_a_listed_pair_keeps_what_is_written_there() -> None:
    listed = {"between": ["a", "floor"], "restitution": 0.5}
    made = scene(contact=[listed], contacts={"between": "all", "friction": 0.3})
    (own,) = [pair for pair in made.contacts if not pair.candidate]
    assert own.restitution.value == 0.5
    assert own.friction is None
    assert all(pair.friction is not None for pair in made.contacts if pair.candidate)
    assert len(pairs(made)) == len(made.contacts)


def test_a_group_may_have_some_bodies_or_shapes() -> None:
    assert pairs(scene(contacts={"between": "all", "among": ["fl*", "a", "b/head"]})) == {
        "floor/plane-a/ball", "floor/plane-b/head", "a/ball-b/head",
    }  # fmt: skip


@pytest.mark.parametrize(
    ("contacts", "message"),
    [
        ({"between": "some"}, "between"),
        ({"between": "all", "among": ["d"]}, "no body named 'd'"),
        ({"between": "all", "among": ["x*"]}, "nothing whose name begins"),
        ({"between": "all", "among": ["a/nose"]}, "no shape 'nose'"),
    ],
)
def test_what_does_not_exist_is_named(contacts: dict[str, object], message: str) -> None:
    with pytest.raises(SceneError, match=message):
        scene(contacts=contacts)
