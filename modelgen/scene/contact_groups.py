"""Groups of bodies of which every two may touch.

A large group of equal bodies has too many pairs to list them: of two classes of equal bodies one pair is
listed, and a pool stands for the others.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import chain, combinations, combinations_with_replacement, product, starmap
from typing import Any

from modelgen.name_suggestions import nearest
from modelgen.scene.contacts_and_loads import Bodies, named
from modelgen.scene.scene_types import (
    IDENTITY_QUATERNION,
    Body,
    ContactPair,
    Joint,
    PairPool,
    Partner,
    Pose,
    Scene,
)
from modelgen.scene.source_location import Place

LISTED = 500  # pairs: up to so many, all pairs of a group are listed
POOLED = 100  # pairs of two classes: fewer are listed
_AT_REST = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Group:
    """The pairs of a group that no contact lists, one of each pool."""

    pairs: tuple[ContactPair, ...] = ()
    classes: tuple[tuple[Partner, ...], ...] = ()
    pools: tuple[PairPool, ...] = ()  # with patterns counted from the first of these pairs
    near_per_body: int = 8  # for how many near pairs of pools there is room


def group_of(
    values: Mapping[str, Any] | None,
    listed: Sequence[ContactPair],
    bodies: Bodies,
    joints: Iterable[Joint],
    place: Place,
    mentioned: Sequence[str] | None,
) -> Group:
    """The pairs of shapes of a group that no contact lists: of two bodies of which one is dynamic and, unless
    asked for, that no joint joins; raises SceneError.

    `mentioned`: texts of the scene in which names of bodies may be, whose pairs have results of their own;
    None: those of all bodies.
    """
    if values is None:
        return Group()
    known = {frozenset(pair.between) for pair in listed}
    joints = tuple(joints)
    joined = set() if values["joined"] else {frozenset(joint.between) for joint in joints}
    members = _members(values["among"], bodies, place.key("among"))
    keys = ("restitution", "friction", "rolling_resistance", "spinning_resistance")
    given = {key: values[key] for key in keys}
    named_alone = {name for joint in joints for name in joint.between}
    named_alone |= {body for pair in listed for body, _ in pair.between}
    classes: tuple[tuple[Partner, ...], ...] = ()
    if mentioned is not None and values["near_per_body"]:
        classes = _classes(members, bodies, named_alone, mentioned)

    def pairs(between: Iterable[tuple[Partner, Partner]]) -> Iterator[ContactPair]:
        for one, other in between:
            if not _can_meet(bodies[one[0]], bodies[other[0]]) or frozenset((one[0], other[0])) in joined:
                continue
            if frozenset((one, other)) not in known:
                yield ContactPair((one, other), **given, candidate=True)

    if not classes:
        return Group(tuple(pairs(combinations(members, 2))))
    pooled = {member for each in classes for member in each}
    alone = [member for member in members if member not in pooled]
    place_of = {member: k for k, member in enumerate(members)}

    def in_order(one: Partner, other: Partner) -> tuple[Partner, Partner]:
        return (one, other) if place_of[one] < place_of[other] else (other, one)

    of_alone = starmap(in_order, product(alone, chain.from_iterable(classes)))
    found = [*pairs(chain(combinations(alone, 2), of_alone))]
    pools: list[PairPool] = []
    for first, second in combinations_with_replacement(range(len(classes)), 2):
        one, other = classes[first], classes[second]
        if first == second:
            every: Iterable[tuple[Partner, Partner]] = combinations(one, 2)
        else:
            every = starmap(in_order, product(one, other))
        pool = PairPool(len(found), (first, second))
        if pool.size(classes) >= POOLED:
            pools.append(pool)
            every = [next(iter(every))]
        found += pairs(every)
    return Group(tuple(found), classes, tuple(pools), values["near_per_body"])


def listed(scene: Scene) -> Scene:
    """The scene with all pairs of its pools listed."""
    return replace(scene, contacts=tuple(all_pairs(scene)), classes=(), pools=()) if scene.pools else scene


def all_pairs(scene: Scene) -> Iterator[ContactPair]:
    """The contact pairs of a scene, with all of its pools."""
    pools = {pool.pattern: pool for pool in scene.pools}
    for number, pair in enumerate(scene.contacts):
        if number not in pools:
            yield pair
            continue
        one, other = (scene.classes[k] for k in pools[number].classes)
        every = combinations(one, 2) if one is other else product(one, other)
        yield from (replace(pair, between=each) for each in every)


def _classes(
    members: Sequence[Partner], bodies: Bodies, named_alone: set[str], mentioned: Sequence[str]
) -> tuple[tuple[Partner, ...], ...]:
    """The classes of equal shapes of equal bodies, of a large group."""
    if len(members) * (len(members) - 1) <= 2 * LISTED:
        return ()
    found: dict[object, list[Partner]] = {}
    for body, shape in members:
        own = bodies[body]
        if own.motion != "dynamic" or len(own.shapes) != 1 or body in named_alone:
            continue
        if not any(body in text for text in mentioned):
            found.setdefault(_without_place(own), []).append((body, shape))
    return tuple(tuple(each) for each in found.values() if len(each) > 1)


def _without_place(body: Body) -> Body:
    """The body without its name, place and velocity, but for whether it is turned or turns."""
    pose = body.pose if body.pose.quaternion == IDENTITY_QUATERNION else Pose(quaternion=(0.0, 1.0, 0.0, 0.0))
    spin = _AT_REST if body.angular_velocity == _AT_REST else (1.0, 0.0, 0.0)
    return replace(
        body, name="", pose=replace(pose, position=_AT_REST), velocity=_AT_REST, angular_velocity=spin
    )


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
