"""Groups of bodies of which every two may touch."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import combinations
from typing import Any

from modelgen.name_suggestions import nearest
from modelgen.scene.contacts_and_loads import Bodies, Partner, named
from modelgen.scene.scene_types import Body, ContactPair, Joint
from modelgen.scene.source_location import Place


def group_pairs(
    values: Mapping[str, Any] | None,
    listed: Sequence[ContactPair],
    bodies: Bodies,
    joints: Iterable[Joint],
    place: Place,
) -> Iterator[ContactPair]:
    """The pairs of shapes of a group that no contact lists: of two bodies of which one is dynamic and, unless
    asked for, that no joint joins; raises SceneError."""
    if values is None:
        return
    known = {frozenset(pair.between) for pair in listed}
    joined = set() if values["joined"] else {frozenset(joint.between) for joint in joints}
    members = _members(values["among"], bodies, place.key("among"))
    keys = ("restitution", "friction", "rolling_resistance", "spinning_resistance")
    given = {key: values[key] for key in keys}
    for one, other in combinations(members, 2):
        pair = frozenset((one[0], other[0]))
        if not _can_meet(bodies[one[0]], bodies[other[0]]) or pair in joined:
            continue
        if frozenset((one, other)) not in known:
            yield ContactPair((one, other), **given, candidate=True)


def _can_meet(a: Body, b: Body) -> bool:
    return a is not b and "dynamic" in (a.motion, b.motion)


def _members(texts: Sequence[str], bodies: Bodies, place: Place) -> list[Partner]:
    """The shapes of the group, in the order of the scene."""
    chosen: set[Partner] = set()
    for index, text in enumerate(texts):
        for name in named(text, bodies, place.item(index)):
            body, _, shape = name.partition("/")
            shapes = _shapes_of(body, bodies, place.item(index))
            if shape and shape not in shapes:
                allowed = f"shapes of {body!r}: " + ", ".join(shapes)
                found = f"no shape {shape!r} of body {body!r}"
                raise place.item(index).error(found, allowed, nearest(shape, shapes))
            chosen |= {(body, each) for each in shapes if not shape or each == shape}
    everything = [(body.name, shape.name) for body in bodies.values() for shape in body.shapes]
    return [each for each in everything if each in chosen or not texts]


def _shapes_of(name: str, bodies: Bodies, place: Place) -> list[str]:
    """Names of the shapes of a body; raises SceneError."""
    if name not in bodies:
        allowed = "bodies: " + ", ".join(list(bodies)[:20])
        raise place.error(f"no body named {name!r}", allowed, nearest(name, bodies))
    return [shape.name for shape in bodies[name].shapes]
