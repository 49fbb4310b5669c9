"""Pairs of geoms that touch as tables of a scene: one group of all bodies where that says the same."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator
from itertools import product

from modelgen.importing.mujoco_contacts import Touch, Touches
from modelgen.importing.mujoco_joints import ModelJoint
from modelgen.importing.mujoco_shapes import Shapes
from modelgen.importing.scene_writing import Section

Partner = tuple[str, str]  # body and shape
Pairs = dict[frozenset[Partner], Touch]


def contact_tables(found: Touches, shapes: Shapes, joints: Iterable[ModelJoint]) -> list[Section]:
    """`[contacts]`, or a `[[contact]]` for each pair of shapes."""
    partners = {geom: (body.name, str(table["name"])) for geom, (body, table) in shapes.items()}
    pairs: Pairs = {
        frozenset((partners[a], partners[b])): touch
        for (a, b), touch in found.items()
        if a in partners and b in partners
    }
    if not pairs:
        return []
    alike = set(pairs.values())
    if len(alike) == 1 and len(pairs) > 1 and set(pairs) == set(_group(shapes, joints)):
        (touch,) = alike
        return [Section("contacts", {"between": "all", **touch.keys()}, single=True)]
    return [
        Section("contact", {"between": between, **touch.keys()}) for between, touch in _listed(pairs, shapes)
    ]


def _group(shapes: Shapes, joints: Iterable[ModelJoint]) -> Iterator[frozenset[Partner]]:
    """The pairs of `between = "all"`."""
    joined = {frozenset(joint.between) for joint in joints}
    members = [(body, str(table["name"])) for body, table in shapes.values()]
    for k, (body, name) in enumerate(members):
        for other, second in members[k + 1 :]:
            apart = body is not other and not (body.fixed and other.fixed)
            if apart and frozenset((body.name, other.name)) not in joined:
                yield frozenset(((body.name, name), (other.name, second)))


def _listed(pairs: Pairs, shapes: Shapes) -> Iterator[tuple[list[str], Touch]]:
    """Partners as scene files name them: a body that has one shape, or body/shape."""
    owned: dict[str, list[Partner]] = defaultdict(list)
    for body, table in shapes.values():
        owned[body.name].append((body.name, str(table["name"])))
    order = {body.name: k for k, (body, _) in enumerate(shapes.values())}
    grouped: dict[tuple[str, str], list[frozenset[Partner]]] = defaultdict(list)
    for pair in pairs:
        one, other = sorted((body for body, _ in pair), key=order.__getitem__)
        grouped[one, other].append(pair)
    for one, other in grouped:
        for a, b in product(owned[one], owned[other]):
            touch = pairs.get(frozenset((a, b)))
            if touch is not None:
                yield [each[0] if len(owned[each[0]]) == 1 else "/".join(each) for each in (a, b)], touch
