"""What influences the observed quantities: bodies tied together by contacts, joints and springs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from modelgen.assembly.loads import bodies_of
from modelgen.scene.scene_types import Scene


def influencing(scene: Scene, contacts: Sequence[str]) -> tuple[Scene, tuple[str, ...]]:
    """The part of a scene, with contacts of these names, that its `observe` depends on; the bodies left out.

    Everything where nothing, or nothing that moves by forces, is observed.

    What does not move by forces passes no influence on.
    """
    dynamic = {body.name for body in scene.bodies if body.motion == "dynamic"}
    needed = _closed(set(_observed(scene, contacts)) & dynamic, [set(tie) & dynamic for tie in _ties(scene)])
    if not needed or needed == dynamic:
        return scene, ()
    kept = [k for k, pair in enumerate(scene.contacts) if needed & {owner for owner, _ in pair.between}]
    kept_contacts = tuple(scene.contacts[k] for k in kept)
    place = {number: k for k, number in enumerate(kept)}
    kept_pools = tuple(
        replace(pool, pattern=place[pool.pattern]) for pool in scene.pools if pool.pattern in place
    )
    kept_loads = tuple(load for load in scene.loads if needed & set(bodies_of(load)))
    kept_joints = tuple(joint for joint in scene.joints if needed & set(joint.between))
    part = replace(scene, contacts=kept_contacts, pools=kept_pools, loads=kept_loads, joints=kept_joints)
    standing = {name for tie in _ties(part) for name in tie} | set(_observed(scene, contacts))
    bodies = tuple(body for body in scene.bodies if body.name in needed | (standing - dynamic))
    return replace(part, bodies=bodies), tuple(b.name for b in scene.bodies if b.name in dynamic - needed)


def _ties(scene: Scene) -> Iterator[tuple[str, ...]]:
    """The names of bodies that one contact, load or joint is between, or the contacts of one pool."""
    yield from (tuple(owner for owner, _ in pair.between) for pair in scene.contacts)
    yield from (tuple(name for k in pool.classes for name, _ in scene.classes[k]) for pool in scene.pools)
    yield from (bodies_of(load) for load in scene.loads)
    yield from (joint.between for joint in scene.joints)


def _observed(scene: Scene, contacts: Sequence[str]) -> Iterator[str]:
    """The bodies that are observed, or that an observed contact or joint is between."""
    between = {name: tuple(o for o, _ in c.between) for name, c in zip(contacts, scene.contacts, strict=True)}
    between |= {joint.name: joint.between for joint in scene.joints}
    for name in scene.observe:
        thing = name.rpartition(".")[0]
        yield from between.get(thing) or between.get(thing.partition(":")[0]) or (thing,)


def _closed(found: set[str], ties: Sequence[set[str]]) -> set[str]:
    """The connected components that contain the observed bodies."""
    while True:
        more = found.union(*(tie for tie in ties if tie & found))
        if more == found:
            return found
        found = more
