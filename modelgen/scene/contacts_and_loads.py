"""Contacts, loads and observed quantities: what refers to bodies by name."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from itertools import combinations, product
from math import hypot
from typing import Any

from modelgen.name_suggestions import is_exchanged, nearest
from modelgen.scene.finite_expressions import triple
from modelgen.scene.free_shapes import FREE_SHAPES
from modelgen.scene.quaternions import conjugate, turned
from modelgen.scene.scene_format import LOAD_NAMES, QUANTITIES
from modelgen.scene.scene_types import (
    Body,
    ContactPair,
    ForceLoad,
    Joint,
    Load,
    Shape,
    SpringLoad,
    TorqueLoad,
)
from modelgen.scene.shape_catalogue import SHAPES
from modelgen.scene.source_location import Place

Bodies = Mapping[str, Body]
Partner = tuple[str, str]  # body, shape
LEAST_PART = 1e-9  # of a direction, along a plane


def contacts(read: Iterable[tuple[Place, Mapping[str, Any]]], bodies: Bodies) -> tuple[ContactPair, ...]:
    """The contact pairs, each named once; raises SceneError."""
    pairs: dict[frozenset[Partner], ContactPair] = {}
    for place, values in read:
        for between in _pairs(values["between"], bodies, place.key("between")):
            pair = _contact(dict(values) | {"between": between}, bodies, place)
            if frozenset(pair.between) in pairs:
                found = "the pair " + " and ".join(map(repr, between)) + " a second time"
                raise place.key("between").error(found, "each pair of shapes is listed once", "remove one")
            pairs[frozenset(pair.between)] = pair
    return tuple(pairs.values())


def pair_names(pairs: Sequence[ContactPair]) -> tuple[str, ...]:
    """`a-b`, or `a/shape-b/shape` where two bodies touch with several shapes."""
    plain = ["-".join(body for body, _ in pair.between) for pair in pairs]
    full = ["-".join("/".join(partner) for partner in pair.between) for pair in pairs]
    count = Counter(plain)
    return tuple(p if count[p] == 1 else f for p, f in zip(plain, full, strict=True))


def pair_named(name: str, pairs: Iterable[str]) -> str:
    """The pair of that name, also where its partners stand in the other order; `name` where there is none.

    For quantities that do not depend on the order."""
    known = list(pairs)
    return name if name in known else next((each for each in known if is_exchanged(each, name)), name)


def pairs_named(name: str, pairs: Sequence[ContactPair]) -> tuple[str, ...]:
    """The pairs of shapes that a name means: the pair of that name, or all pairs of two bodies `a-b`, in
    either order; none where there is no such pair."""
    names = pair_names(pairs)
    if pair_named(name, names) in names:
        return (pair_named(name, names),)
    between = (["-".join(body for body, _ in pair.between[::way]) for way in (1, -1)] for pair in pairs)
    return tuple(each for each, orders in zip(names, between, strict=True) if name in orders)


def loads(values: Mapping[str, Any], bodies: Bodies) -> tuple[Load, ...]:
    """Forces, torques and springs, in this order; raises SceneError."""
    return (
        *(_force(each, bodies, at) for at, each in values["force"]),
        *(_torque(each, bodies, at) for at, each in values["torque"]),
        *(_spring(each, bodies, at) for at, each in values["spring"]),
    )


def _force(values: Mapping[str, Any], bodies: Bodies, place: Place) -> ForceLoad:
    _check_dynamic(values["body"], bodies, place.key("body"))
    components = triple(values["force"], _load_names(place), place.key("force"))
    return ForceLoad(values["body"], components, values["point"], values["frame"])


def _torque(values: Mapping[str, Any], bodies: Bodies, place: Place) -> TorqueLoad:
    _check_dynamic(values["body"], bodies, place.key("body"))
    components = triple(values["torque"], _load_names(place), place.key("torque"))
    return TorqueLoad(values["body"], components, values["frame"])


def _load_names(place: Place) -> tuple[str, ...]:
    return (*LOAD_NAMES, *(each.name for each in place.inputs))


def _spring(values: Mapping[str, Any], bodies: Bodies, place: Place) -> SpringLoad:
    _check_partners(values["between"], bodies, place.key("between"))
    return SpringLoad(
        **{key: values[key] for key in ("between", "anchors", "stiffness", "damping", "rest_length")}
    )


def observed(
    names: tuple[str, ...],
    bodies: Bodies,
    pairs: Sequence[ContactPair],
    joints: Iterable[Joint],
    place: Place,
) -> tuple[str, ...]:
    """The observed names: `body.quantity`, `joint.quantity`, or `contact.quantity`, which `require` knows,
    of a pair in its own order; raises SceneError."""
    known, touching = [joint.name for joint in joints], pair_names(pairs)
    found = []
    for index, name in enumerate(names):
        owner, quantity = name.split(".")
        found.append(f"{pair_named(owner, touching)}.{quantity}")
        if owner in known or "-" in owner or ":" in owner:
            continue
        if owner not in bodies:
            allowed = "bodies and joints: " + ", ".join([*bodies, *known][:20])
            raise place.item(index).error(
                f"no body named {owner!r}", allowed, nearest(owner, [*bodies, *known])
            )
        if quantity not in QUANTITIES:
            allowed = "allowed are " + ", ".join(QUANTITIES)
            raise place.item(index).error(f"no quantity {quantity!r}", allowed, nearest(quantity, QUANTITIES))
    return tuple(found)


def _contact(values: Mapping[str, Any], bodies: Bodies, place: Place) -> ContactPair:
    at = place.key("between")
    first, second = (_partner(text, bodies, at) for text in values["between"])
    _check_partners((first[0], second[0]), bodies, at)
    normal = values["normal"]
    if normal is not None and not (any(normal) and _are_curves((first, second), bodies)):
        raise place.key("normal").error(
            f"{list(normal)} between {first[1]!r} and {second[1]!r}",
            "a nonzero direction between two curves is allowed: a surface has an exterior side",
            "remove it",
        )
    _check_resistance(values, place)
    _check_along(values, first, bodies, place.key("friction"))
    keys = (
        *("restitution", "form", "normal", "features", "points"),
        *("friction", "rolling_resistance", "spinning_resistance"),
    )
    return ContactPair((first, second), **{key: values[key] for key in keys})


def _pairs(texts: tuple[str, str], bodies: Bodies, place: Place) -> Iterable[tuple[str, str]]:
    """The pairs of partners that two texts name: those of one text among themselves if the two are equal."""
    if texts[0] == texts[1] and "*" in texts[0]:
        return combinations(named(texts[0], bodies, place), 2)
    first, second = (named(text, bodies, place) for text in texts)
    return product(first, second)


def named(text: str, bodies: Bodies, place: Place) -> list[str]:
    """The text, or all that begins as it does before `*`: bodies, and shapes within each."""
    if "*" not in text:
        return [text]
    name, _, shape = text.partition("/")
    owners = [body for body in bodies if body.startswith(name[:-1])] if name.endswith("*") else [name]
    found = owners
    if shape:
        known = ((owner, [each.name for each in _body(owner, bodies, place).shapes]) for owner in owners)
        found = [
            f"{owner}/{each}"
            for owner, shapes in known
            for each in (
                [one for one in shapes if one.startswith(shape[:-1])] if shape.endswith("*") else [shape]
            )
        ]
    if not found:
        allowed = "bodies: " + ", ".join(list(bodies)[:20])
        raise place.error(f"nothing whose name begins as {text!r} says", allowed, "check the names")
    return found


def _check_resistance(values: Mapping[str, Any], place: Place) -> None:
    for key in ("rolling_resistance", "spinning_resistance"):
        if values[key] and values["friction"] is None:
            raise place.key(key).error(
                f"{values[key]:g} m without friction",
                "a contact that resists rolling or spinning has friction",
                "add friction, or remove it",
            )


def _check_along(values: Mapping[str, Any], first: Partner, bodies: Bodies, place: Place) -> None:
    """Friction by direction on a plane of the first body: the direction has a part in it."""
    friction = values["friction"]
    shape = _shape(first, bodies)
    if friction is None or friction.direction is None or shape.kind != "plane":
        return
    x, y, z = turned(conjugate(shape.pose.quaternion), friction.direction)
    if hypot(x, y) <= LEAST_PART * hypot(x, y, z):
        raise place.key("direction").error(
            f"{list(friction.direction)} along the normal of the plane of {first[0]!r}",
            "a direction with a part along the surface is allowed",
            "friction acts along the plane: turn it",
        )


def _shape(partner: Partner, bodies: Bodies) -> Shape:
    body, name = partner
    return next(each for each in bodies[body].shapes if each.name == name)


def _are_curves(partners: tuple[Partner, Partner], bodies: Bodies) -> bool:
    shapes = (_shape(partner, bodies) for partner in partners)
    curves = {kind for table in (SHAPES, FREE_SHAPES) for kind, spec in table.items() if spec.curve}
    return all(shape.curve is not None or shape.kind in curves for shape in shapes)


def _partner(text: str, bodies: Bodies, place: Place) -> Partner:
    name, _, shape = text.partition("/")
    shapes = [each.name for each in _body(name, bodies, place).shapes]
    if not shapes:
        raise place.error(f"the body {name!r} without a shape", "", f"add a shape to {name!r}")
    if not shape and len(shapes) > 1:
        choices = " or ".join(f"'{name}/{each}'" for each in shapes)
        raise place.error(
            f"the body {name!r}, which has {len(shapes)} shapes", "name one", f"write {choices}"
        )
    if shape and shape not in shapes:
        allowed = f"shapes of {name!r}: " + ", ".join(shapes)
        raise place.error(f"no shape {shape!r} of body {name!r}", allowed, nearest(shape, shapes))
    return name, shape or shapes[0]


def _body(name: str, bodies: Bodies, place: Place) -> Body:
    if name not in bodies:
        allowed = "bodies: " + ", ".join(list(bodies)[:20])
        raise place.error(f"no body named {name!r}", allowed, nearest(name, bodies))
    return bodies[name]


def _check_partners(names: tuple[str, str], bodies: Bodies, place: Place) -> None:
    first, second = (_body(name, bodies, place) for name in names)
    if first is second:
        raise place.error(f"the body {names[0]!r} with itself", "", "name two different bodies")
    if "dynamic" not in (first.motion, second.motion):
        found = f"{names[0]!r} ({first.motion}) and {names[1]!r} ({second.motion})"
        raise place.error(found, "one of the two must be dynamic", "remove the pair or free a body")


def _check_dynamic(name: str, bodies: Bodies, place: Place) -> None:
    motion = _body(name, bodies, place).motion
    if motion != "dynamic":
        raise place.error(
            f"the body {name!r}, which is {motion}", "loads act on dynamic bodies", "name another body"
        )
