"""What the contacts of a scene follow from: where it is the same in two scenes, so are their contacts, but
for the coefficients of friction and restitution."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any

from modelgen.assembly.characteristic_scales import flush_height
from modelgen.assembly.faces_across_shapes import terms_of
from modelgen.assembly.friction_constraints import friction_constraints_of
from modelgen.model import BodyMotion, Model, PairEntry, PatchEntry
from modelgen.scene.scene_types import ContactPair, Restitution, Scene, Vector

Inputs = tuple[Any, ...]


def have_same_contacts(
    scene: Scene, motions: Iterable[BodyMotion], centres: Iterable[Vector], flush: float, known: Model
) -> bool:
    """Whether the pairs, feature pairs, contacts, faces and patches of a model follow from a scene as well,
    whose bodies have these motions and centres of mass, and that flush height (m), but for the coefficients
    of its pairs."""
    if flush != flush_height(known.scene, known.scales):
        return False
    mine, other = _inputs(scene, motions, centres), _inputs(known.scene, *_motions(known))
    if mine != other:
        return False
    pairs, before = scene.contacts, known.scene.contacts
    return pairs == before or (
        [_structure(pair) for pair in pairs] == [_structure(pair) for pair in before]
        and _alike(pairs) == _alike(before)
    )


def models_have_same_contacts(model: Model, known: Model) -> bool:
    """The same of the scene of another model."""
    return have_same_contacts(model.scene, *_motions(model), flush_height(model.scene, model.scales), known)


def with_coefficients(scene: Scene, known: Model) -> tuple[tuple[PairEntry, ...], tuple[PatchEntry, ...]]:
    """The pairs and patches of a model with the coefficients of the contacts of a scene."""
    if scene.contacts == known.scene.contacts:
        return known.pairs, known.patches
    numbers = {body.name: k for k, body in enumerate(scene.bodies)}
    pairs = tuple(
        replace(
            entry,
            restitution=pair.restitution,
            friction=friction_constraints_of(pair, numbers[pair.between[0][0]]),
        )
        for entry, pair in zip(known.pairs, scene.contacts, strict=True)
    )
    return pairs, tuple(_patch(entry, scene.contacts[entry.pair]) for entry in known.patches)


def _patch(entry: PatchEntry, pair: ContactPair) -> PatchEntry:
    if pair.friction is None:
        return entry
    return replace(entry, friction=(pair.friction.static[0], pair.friction.kinetic[0]))


def _motions(model: Model) -> tuple[list[BodyMotion], list[Vector]]:
    motions = [model.body_kinds[entry.kind].motion for entry in model.bodies]
    return motions, [entry.centre_of_mass for entry in model.bodies]


def _inputs(scene: Scene, motions: Iterable[BodyMotion], centres: Iterable[Vector]) -> Inputs:
    """All but the pairs; bodies that move may be anywhere."""
    bodies = tuple(
        (
            *(body.name, body.shapes, motion, centre, body.repeated, body.placed),
            body.pose if motion == "fixed" else None,
        )
        for body, motion, centre in zip(scene.bodies, motions, centres, strict=True)
    )
    welds = tuple((each.between, each.frames) for each in scene.joints if each.kind == "weld")
    return bodies, welds, scene.source, scene.fold, scene.run.form


def _structure(pair: ContactPair) -> tuple[ContactPair, Any]:
    """A pair without its coefficients, and the constraints that it has."""
    constraints = friction_constraints_of(pair, 0)
    plain = replace(
        pair,
        restitution=Restitution(),
        friction=None if pair.friction is None else replace(pair.friction, static=(1, 1), kinetic=(1, 1)),
        rolling_resistance=float(bool(pair.rolling_resistance)),
        spinning_resistance=float(bool(pair.spinning_resistance)),
    )
    return plain, [constraint.kind for constraint in constraints]


def _alike(pairs: Sequence[ContactPair]) -> list[int]:
    """For each pair the first with the same terms; faces in one plane with the same terms are one patch."""
    first: dict[tuple[object, ...], int] = {}
    return [first.setdefault(terms_of(pair), k) for k, pair in enumerate(pairs)]
