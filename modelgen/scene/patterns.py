"""Patterns: a body, or a shape of a body, repeated at equal angles about an axis."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from math import cos, pi, sin
from typing import Any

from modelgen.name_suggestions import nearest
from modelgen.scene.pose_input import VECTOR
from modelgen.scene.quaternions import Quaternion, product, turned
from modelgen.scene.scalar_types import Choice, Text, Whole
from modelgen.scene.scene_types import Body, Pose, Shape, Vector
from modelgen.scene.source_location import Place
from modelgen.scene.table_types import Field, Table

AXES: Mapping[str, Vector] = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}

PATTERN = Table(
    (
        Field(
            "of",
            Text(
                r"^[A-Za-z][A-Za-z0-9_]{0,63}(/[A-Za-z][A-Za-z0-9_]{0,63})?$",
                "the name of a body, or body/shape, is allowed",
            ),
            'what is repeated, "body" or "body/shape"; its copies are NAME_0, itself, NAME_1, ...',
            required=True,
        ),
        Field("count", Whole(2, 1000), "how many there are", required=True),
        Field("about", Choice(tuple(AXES)), "axis of the world; of the body for a shape", default="z"),
        Field("center", VECTOR, "a point of the axis [x, y, z], m", default=(0.0, 0.0, 0.0)),
    )
)


def repeated(bodies: tuple[Body, ...], read: Iterable[tuple[Place, Mapping[str, Any]]]) -> tuple[Body, ...]:
    """The bodies with every pattern carried out, one after the other; raises SceneError."""
    for place, values in read:
        name, _, shape = values["of"].partition("/")
        names = [body.name for body in bodies]
        if name not in names:
            raise place.key("of").error(
                f"no body named {name!r}", "bodies: " + ", ".join(names[:20]), nearest(name, names)
            )
        body = bodies[names.index(name)]
        copies = (_with_shapes(body, shape, values, place),) if shape else _bodies(body, values, place)
        at = names.index(name)
        bodies = (*bodies[:at], *copies, *bodies[at + 1 :])
    return bodies


def _bodies(body: Body, values: Mapping[str, Any], place: Place) -> tuple[Body, ...]:
    if body.path is not None:
        found = f"the body {body.name!r}, which is driven on a path in the world"
        raise place.key("of").error(found, "fixed and dynamic bodies are repeated", "write each one")
    return tuple(
        replace(
            body,
            name=f"{body.name}_{k}",
            pose=_turned(body.pose, turn, values["center"]),
            velocity=turned(turn, body.velocity),
            angular_velocity=turned(turn, body.angular_velocity),
            normal=None if body.normal is None else turned(turn, body.normal),
            repeated=True,
        )
        for k, turn in enumerate(_turns(values))
    )


def _with_shapes(body: Body, name: str, values: Mapping[str, Any], place: Place) -> Body:
    names = [shape.name for shape in body.shapes]
    if name not in names:
        allowed = f"shapes of {body.name!r}: " + ", ".join(names[:20])
        raise place.key("of").error(f"no shape {name!r} of {body.name!r}", allowed, nearest(name, names))
    at = names.index(name)
    shape = body.shapes[at]
    copies: list[Shape] = [
        replace(shape, name=f"{name}_{k}", pose=_turned(shape.pose, turn, values["center"]), repeated=True)
        for k, turn in enumerate(_turns(values))
    ]
    taken = next((copy.name for copy in copies if copy.name in names), None)
    if taken is not None:
        found = f"a copy named {taken!r}, as is another shape of {body.name!r}"
        raise place.key("of").error(found, "names of shapes are unique within a body", "rename that shape")
    return replace(body, shapes=(*body.shapes[:at], *copies, *body.shapes[at + 1 :]))


def _turns(values: Mapping[str, Any]) -> list[Quaternion]:
    """The turn to each place, none to the first."""
    x, y, z = AXES[values["about"]]
    halves = [pi * k / values["count"] for k in range(values["count"])]
    return [(cos(half), sin(half) * x, sin(half) * y, sin(half) * z) for half in halves]


def _turned(pose: Pose, turn: Quaternion, center: Vector) -> Pose:
    """The pose turned about an axis through a point."""
    (a, b, c), (x, y, z) = center, pose.position
    u, v, w = turned(turn, (x - a, y - b, z - c))
    return Pose((a + u, b + v, c + w), product(turn, pose.quaternion))
