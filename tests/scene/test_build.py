"""Scenes written in Python are the scenes of the files, and are refused for the same reasons."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import pytest

from modelgen.errors import SceneError
from modelgen.scene import python_scenes as build
from modelgen.scene.read import read_text
from modelgen.scene.shape_catalogue import SHAPES

from .broken_structure import SOUND


def test_python_and_toml_give_the_same_scene() -> None:
    egg = build.dynamic("egg", build.sphere(0.1), mass=1.0, inertia=[0.004, 0.004, 0.004])
    table = build.fixed("table", build.plane())
    built = build.scene("drop", [table, egg], contact=[{"between": ["egg", "table"]}])
    assert replace(built, source="drop.toml") == read_text(SOUND, "drop.toml")


def test_a_surface_of_the_users_own_in_five_lines() -> None:
    wave = build.chart("u", "v", "h*sin(u)", domain=[(-1, 1), (-1, 1)], parameters={"h": 0.1})
    sheet = build.fixed("sheet", wave)
    ball = build.dynamic("ball", build.sphere(0.1), density=1000.0, position=[0, 0, 1])
    scene = build.scene("waves", [sheet, ball], contact=[{"between": ["ball", "sheet"]}])
    assert scene.bodies[0].shapes[0].chart is not None
    assert scene.bodies[0].shapes[0].chart.components[2].names == {"h", "u"}


def test_every_shape_of_the_catalogue_has_its_parameters_in_order() -> None:
    built = [
        build.plane(),
        build.sphere(1),
        build.ellipsoid(1, 2, 3),
        build.torus(2, 1),
        build.cylinder(1),
        build.cone(0.5),
        build.paraboloid(1, -2),
        build.superellipsoid(1, 2, 3, 4, 5),
        build.line(),
        build.segment(1),
        build.edge(1),
        build.circle(1),
        build.ellipse_curve(1, 2),
        build.helix(1, lead=0.2),
        build.point(1, 2, 3),
    ]
    assert [shape.kind for shape in built] == list(SHAPES)
    for shape in built:
        assert tuple(name for name, _ in shape.parameters) == SHAPES[shape.kind].parameters
    assert dict(built[7].parameters) == {"a": 1, "b": 2, "c": 3, "p": 4, "q": 5}
    assert dict(built[13].parameters)["pitch"] == 0.2 / (2 * pi)  # m per radian


def test_a_body_written_as_a_table_joins_the_others() -> None:
    table = {"name": "table", "motion": "fixed", "shape": {"kind": "plane"}}
    ball = build.dynamic("ball", density=1.0, shape={"kind": "sphere", "radius": 1})
    scene = build.scene("both", [ball], body=[table], contact=[{"between": ["ball", "table"]}])
    assert [body.name for body in scene.bodies] == ["ball", "table"]


def test_a_driven_body_has_its_path() -> None:
    lift = build.driven("lift", build.plane(), path={"position": [0, 0, "0.1*sin(t)"]})
    assert lift.path is not None
    assert lift.path.position[2].text == "0.1*sin(t)"
    assert lift.path.rotation_vector[0].text == "0.0"


@pytest.mark.parametrize(
    ("make", "fragments"),
    [
        (lambda: build.sphere(-1), ["<python>: shape sphere.radius", "the number -1"]),
        (lambda: build.sphere(1, colour="red"), ["shape sphere", "unknown key 'colour'"]),
        (lambda: build.dynamic("egg", build.sphere(1)), ["body egg", "without mass"]),
        (lambda: build.fixed("two words"), ["body two words.name", "a name is allowed"]),
        (lambda: build.scene("../x", []), ["<python>: ../x", "letters, digits"]),
        (lambda: build.scene("x", []), ["no body"]),
        (lambda: build.scene("x", [build.fixed("a"), build.fixed("a")]), ["a second body named 'a'"]),
    ],
)
def test_python_is_refused_with_the_same_messages(make, fragments: list[str]) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(SceneError) as caught:
        make()
    for fragment in fragments:
        assert fragment in str(caught.value)
