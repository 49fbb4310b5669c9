"""Bodies with edges: what is read, what is refused and how, and the user's own solid."""

from __future__ import annotations

import copy
from collections.abc import Callable
from math import atan, nan
from typing import Any

import jsonschema
import pytest

from modelgen.errors import SceneError
from modelgen.geometry.shape_features import features_of
from modelgen.scene import python_scenes as build
from modelgen.scene.json_schema import scene_schema
from modelgen.scene.read import read_text
from modelgen.scene.scene_types import Shape

SCHEMA = scene_schema()
VALIDATOR = jsonschema.Draft202012Validator({"$ref": "#/$defs/shape", "$defs": SCHEMA["$defs"]})
SQUARE = [[0, 0], [1, 0], [1, 1], [0, 1]]
CORNERS = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
OUTLINE = {"x": "cos(t)", "y": "sin(t)", "domain": [0, "2*pi"]}


def test_numbers_stand_in_a_fixed_order() -> None:
    assert build.box(1, 2, 3).parameters == (("x", 1), ("y", 2), ("z", 3))
    assert build.cylinder(1, 2).parameters == (("radius", 1), ("length", 2))
    assert build.cylinder(1).parameters == (("radius", 1),)
    assert build.disc(2).parameters == (("radius", 2),)
    assert build.capsule(1, 2).parameters == (("radius", 1), ("length", 2))
    assert build.tube(2, 1, 3).parameters == (("radius", 2), ("bore", 1), ("length", 3))
    assert build.frustum(1, 2, 3).parameters == (("radius_bottom", 1), ("radius_top", 2), ("length", 3))
    assert build.half_torus(2, 1).parameters == (("major", 2), ("minor", 1))
    assert [name for name, _ in build.polyhedron(CORNERS).parameters][:4] == ["x0", "y0", "z0", "x1"]
    assert [value for _, value in build.polyhedron(CORNERS).parameters] == [c for p in CORNERS for c in p]
    assert build.extrusion(3, points=SQUARE).parameters[-2:] == (("y3", 1), ("length", 3))
    round_one = build.extrusion(3, **OUTLINE, parameters={"q": 5})
    assert round_one.parameters == (("length", 3), ("q", 5))


def test_a_polygon_is_turned_counterclockwise() -> None:
    assert build.extrusion(1, points=SQUARE[::-1]) == build.extrusion(1, points=SQUARE)


def test_an_outline_is_turned_counterclockwise() -> None:
    turned = build.extrusion(1, x="cos(t)", y="-sin(t)", domain=["-pi/2", "3*pi/2"])
    assert turned.profile is not None
    assert turned.profile.components[1].text == "-sin(3.1415926535897931 - t)"
    assert build.extrusion(1, **OUTLINE).profile.components[0].text == "cos(t)"  # type: ignore[union-attr]


REFUSED: list[tuple[Callable[[], object], list[str]]] = [
    (lambda: build.box(1, 0, 1), ["shape box.size[1]", "the number 0", "a positive number"]),
    (lambda: build.box(1, nan, 1), ["size[1]", "the number nan"]),
    (lambda: build.cylinder(1, -2), ["shape cylinder.length", "the number -2"]),
    (lambda: build.disc(-1), ["shape disc.radius"]),
    (lambda: build.disc(1, cavity=True), ["'cavity' where kind is 'disc'"]),
    (lambda: build.capsule(1, 0), ["shape capsule.length", "the number 0"]),
    (lambda: build.tube(1, 1, 1), ["bore 1 is not smaller than radius 1"]),
    (lambda: build.frustum(1, 0, 1), ["frustum.radius_top", "the number 0"]),
    (lambda: build.dome(1, 2), ["length 2 of a part of a ball", "from 0.001 to 1.999"]),
    (lambda: build.half_torus(1, 1), ["major 1 is not larger than minor 1"]),
    (lambda: build.polyhedron(CORNERS[:3]), ["vertices: 3 points", "4 at least"]),
    (lambda: build.polyhedron([*CORNERS[:3], [1, 1, 0]]), ["4 points on one plane", "span a volume"]),
    (lambda: build.polyhedron([[k, 2 * k, 0] for k in range(5)]), ["5 points on one line"]),
    (lambda: build.polyhedron([*CORNERS[:3], [nan, 1, 0]]), ["vertices[3][0]", "the number nan"]),
    (lambda: build.polyhedron([*CORNERS[:3], [1, 0]]), ["vertices[3]", "a list of 2", "a list of 3"]),
    (lambda: build.extrusion(1), ["an outline without x", "points, or x, y and domain"]),
    (lambda: build.extrusion(1, points=SQUARE, x="t"), ["'points' and 'x' together"]),
    (lambda: build.extrusion(1, points=SQUARE[:2]), ["points: 2 points", "3 corners"]),
    (lambda: build.extrusion(0, points=SQUARE), ["extrusion.length"]),
    (lambda: build.extrusion(1, points=[[0, 0], [1, 1], [1, 0], [0, 1]]), ["sides 0 and 2 that cross"]),
    (lambda: build.extrusion(1, points=[[0, 0], [2, 0], [2, 2], [1, 0], [0, 2]]), ["sides 0 and 2", "cross"]),
    (
        lambda: build.extrusion(1, points=[[0, 0], [1, 0], [2, 0], [1, 1]]),
        ["points[1]", "on one line", "leave"],
    ),
    (lambda: build.extrusion(1, points=[*SQUARE, SQUARE[0]]), ["points[", "on one line with its neighbours"]),
    (lambda: build.extrusion(1, x="cos(t)", y="sin(t)", domain=[0, 6]), ["ends are 0.282 m apart", "close"]),
    (lambda: build.extrusion(1, x="sin(t)", y="1e-5*cos(t)", domain=[0, "2*pi"]), ["next to nothing"]),
    (
        lambda: build.extrusion(1, x="cos(t)", y="sin(2*t)", domain=[0, "2*pi"]),
        ["turns 0 times", "crosses itself", "one extrusion for each loop"],
    ),
    (
        lambda: build.extrusion(1, x="cos(t)", y="sin(t)", domain=[0, "4*pi"]),
        ["turns 2 times", "halve the domain"],
    ),
    (
        lambda: build.extrusion(1, x="cos(t)", y="sin(t) + 2*cos(t)**2", domain=[0, "2*pi"]),
        ["cannot see", "star-shaped", "use points"],
    ),
    (
        lambda: build.extrusion(1, x="t*(1-t)", y="t*(1-t)*(0.5-t)", domain=[0, 1]),
        ["a corner where it closes"],
    ),
    (lambda: build.extrusion(1, **OUTLINE, parameters={"length": 1}), ["the name 'length'", "rename"]),
    (lambda: build.extrusion(1, x="cos(u)", y="t", domain=[0, 1]), ["extrusion.x", "unknown name 'u'"]),
    (
        lambda: build.dynamic("coin", build.disc(1), density=1.0),
        ["the disc 'disc' bounds no finite solid", "mass and inertia"],
    ),
    (
        lambda: build.dynamic("room", build.box(1, 1, 1, cavity=True), density=1.0),
        ["the cavity 'box' bounds no finite solid"],
    ),
]


@pytest.mark.parametrize(("make", "fragments"), REFUSED)
def test_what_bounds_no_body_is_refused(make: Callable[[], object], fragments: list[str]) -> None:
    with pytest.raises(SceneError) as caught:
        make()
    for fragment in fragments:
        assert fragment in str(caught.value)


def tables_of(shape: Shape) -> dict[str, Any]:
    """The features of a shape as a user would write them."""
    tables: dict[str, Any] = {"face": [], "edge": [], "vertex": [], "convex": features_of(shape).convex}
    for feature in features_of(shape).features:
        conditions = [
            {"kind": c.kind, "numbers": list(c.numbers)} | ({"next": c.next} if c.next else {})
            for c in feature.conditions
        ]
        part: dict[str, Any] = {"name": feature.name, "conditions": conditions}
        pose = {
            "position": list(feature.shape.pose.position),
            "quaternion": list(feature.shape.pose.quaternion),
        }
        if feature.shape.kind == "conical_side":  # no kind of the scene: a cone, seen from its apex
            part |= _cone_of(conditions, **dict(feature.shape.parameters))
        elif feature.dimension == 0:
            part["at"] = [value for _, value in feature.shape.parameters]
        else:
            hollow = {"cavity": True} if feature.shape.cavity else {}
            part["shape"] = {"kind": feature.shape.kind, **dict(feature.shape.parameters), **pose, **hollow}
        tables[("vertex", "edge", "face")[feature.dimension]].append(part)
    return tables


def _cone_of(conditions: list[dict[str, Any]], radius: float, taper: float) -> dict[str, Any]:
    """The side of a frustum, with conditions of the height z over its middle, as a cone that opens to -z."""
    depth, sign = radius / taper, 1 if taper > 0 else -1  # of the apex; of the axis of the cone
    slopes = [(each["numbers"][0], each["numbers"][3]) for each in conditions]
    moved = [
        each | {"numbers": [c + depth * b, 0, 0, sign * b, *[0] * 6]}
        for each, (c, b) in zip(conditions, slopes, strict=True)
    ]
    pose = {"position": [0, 0, depth], "quaternion": [1, 0, 0, 0] if taper > 0 else [0, 1, 0, 0]}
    return {"shape": {"kind": "cone", "half_angle": atan(abs(taper)), **pose}, "conditions": moved}


CATALOGUE = {
    "box": build.box(1, 2, 3),
    "cylinder": build.cylinder(0.5, 2),
    "tube": build.tube(0.5, 0.3, 2),
    "disc": build.disc(1),
    "capsule": build.capsule(0.3, 1),
    "frustum of a cone": build.solid(**tables_of(build.frustum(1, 2, 1.5))),
    "frustum that narrows": build.solid(**tables_of(build.frustum(2, 1, 1.5))),
    "dome": build.dome(1, 0.4),
    "half_torus": build.half_torus(1, 0.3),
    "polyhedron": build.polyhedron(CORNERS),
    "extrusion": build.extrusion(1, points=[[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]]),
}


@pytest.mark.parametrize("name", CATALOGUE)
def test_every_body_of_the_catalogue_can_be_written_as_a_solid(name: str) -> None:
    tables = tables_of(CATALOGUE[name])
    VALIDATOR.validate({"kind": "solid", **tables})
    written, known = features_of(build.solid(**tables)), features_of(CATALOGUE[name])
    assert written.convex == known.convex
    assert len(written.features) == len(known.features)
    by_name = {feature.name: feature for feature in written.features}
    for feature in known.features:
        other = by_name[feature.name]
        assert (other.dimension, other.shape.kind) == (feature.dimension, feature.shape.kind)
        assert dict(other.shape.parameters) == dict(feature.shape.parameters)
        for a, b in zip(other.conditions, feature.conditions, strict=True):
            assert (a.kind, a.next) == (b.kind, b.next)
            assert a.numbers == pytest.approx(b.numbers, abs=1e-15)


def box_with(change: Callable[[dict[str, Any]], object]) -> Callable[[], Shape]:
    def make() -> Shape:
        tables = copy.deepcopy(tables_of(CATALOGUE["box"]))
        change({part["name"]: part for noun in ("face", "edge", "vertex") for part in tables[noun]})
        return build.solid(**tables)

    return make


BROKEN: list[tuple[Callable[[], object], list[str]]] = [
    (lambda: build.solid(face=[]), ["face: a solid without a face"]),
    (box_with(lambda p: p["top"].update(name="bottom")), ["a second feature named 'bottom'"]),
    (
        box_with(lambda p: p["top"]["conditions"][0].update(next="top_frnt")),
        ["(face 'top')", "next = 'top_frnt', which is no feature", "did you mean 'top_front'?"],
    ),
    (
        box_with(lambda p: p["top_front"]["conditions"].pop(0)),
        ["'top_front', which does not lead back", "a wing of 'top_front' must have next ="],
    ),
    (
        box_with(lambda p: p["top_front_left"]["conditions"].pop(0)),
        ["leads to 'top_front_left', which does not lead back", "a direction"],
    ),
    (
        box_with(lambda p: p["top_front_left"].update(at=[0, 0, 0])),
        ["1.87 m from the end of", "lies on its edges"],
    ),
    (box_with(lambda p: p["top_front"]["shape"].update(position=[0, -1, 1.6])), ["0.1 m off the face"]),
    (
        box_with(lambda p: p["top"]["conditions"][0]["numbers"].__setitem__(0, 1.5)),
        ["the condition of 'top' for 'top_front' is 0.5 m off zero there", "vanishes on the edge"],
    ),
    (
        box_with(lambda p: p["top_front"]["conditions"][0].update(numbers=[1.0, 1.0])),
        ["conditions[0].numbers", "a wing of length 1.41421356", "length 1"],
    ),
    (
        box_with(lambda p: p["top_front"]["conditions"][0]["numbers"].reverse()),
        ["a wing of 'top_front' that leads off the face"],
    ),
    (
        box_with(lambda p: p["top_front"]["conditions"][0].update(numbers=[1.0, 0.0])),
        ["a wing of 'top_front' that points out of the face", "change the sign"],
    ),
    (
        box_with(lambda p: p["top_front"]["conditions"][0].pop("next")),
        ["a wing that leads nowhere", "add next"],
    ),
    (
        box_with(lambda p: p["top_front"]["conditions"][0].update(next="top_front_left")),
        ["a wing into 'top_front_left'", "into faces"],
    ),
    (
        box_with(lambda p: p["top"]["conditions"][0].update(kind="wing", numbers=[1.0, 0.0])),
        ["conditions[0].kind", "'wing'", "quadric, parameter"],
    ),
    (
        box_with(lambda p: p["top"]["conditions"][0].update(numbers=[1.0] + 9 * [0.0])),
        ["a quadric that is the same everywhere"],
    ),
    (
        box_with(lambda p: p["top_front"]["conditions"][2]["numbers"].__setitem__(1, 2.0)),
        ["index 0 and sign 2", "sign 1 or -1"],
    ),
    (box_with(lambda p: p["top"]["shape"].update(kind="circle", radius=1)), ["shape.kind", "'circle'"]),
    (
        box_with(lambda p: p["top"]["shape"].update(kind="cylinder", radius=1, length=1)),
        ["unknown key 'length'"],
    ),
    (
        box_with(lambda p: p["top_front"].update(shape={"kind": "line"})),
        ["not level in its shape frame", "use edge"],
    ),
    (
        lambda: build.dynamic("own", build.solid(**tables_of(CATALOGUE["box"])), density=1.0),
        ["the volume of the user's own solid", "mass and inertia"],
    ),
]


@pytest.mark.parametrize(("make", "fragments"), BROKEN)
def test_a_solid_that_does_not_hold_together_is_refused(
    make: Callable[[], object], fragments: list[str]
) -> None:
    with pytest.raises(SceneError) as caught:
        make()
    for fragment in fragments:
        assert fragment in str(caught.value)


HALF_BALL = """
[[body]]
name = "dome"
mass = 1.0
inertia = [1, 1, 1]
[body.shape]
kind = "solid"
convex = true
[[body.shape.face]]
name = "round"
shape = { kind = "sphere", radius = 0.5 }
conditions = [{ kind = "quadric", numbers = [0, 0, 0, 1, 0, 0, 0, 0, 0, 0], next = "rim" }]
[[body.shape.face]]
name = "flat"
shape = { kind = "plane", rpy = ["pi", 0, 0] }
conditions = [{ kind = "quadric", numbers = [0.25, 0, 0, 0, -1, -1, 0, 0, 0, 0], next = "rim" }]
[[body.shape.edge]]
name = "rim"
shape = { kind = "circle", radius = 0.5 }
conditions = [
    { kind = "wing", numbers = [-1, 0], next = "flat" },
    { kind = "wing", numbers = [0, 1], next = "round" },
]
[[body]]
name = "table"
motion = "fixed"
shape = { kind = "plane" }
[[contact]]
between = ["dome", "table"]
"""


def test_a_solid_is_written_in_a_scene_file() -> None:
    scene = read_text(HALF_BALL, "dome.toml")
    composite = features_of(scene.bodies[0].shapes[0])
    assert [feature.name for feature in composite.features] == ["round", "flat", "rim"]
    assert composite.convex
    assert composite.features[1].shape.pose.quaternion[1] == pytest.approx(1.0)
