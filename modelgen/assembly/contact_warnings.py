"""Warnings about shapes in contact: singular points of charts and points without curvature."""

from __future__ import annotations

from collections.abc import Iterator

from modelgen.assembly.friction_constraints import has_friction
from modelgen.errors import SceneError
from modelgen.geometry.face_regions import regions_of
from modelgen.geometry.shape_features import features_of
from modelgen.geometry.shape_warnings import declared_limits
from modelgen.geometry.user_shape_checks import check_user_shape
from modelgen.scene.scene_types import Partner, Scene, Shape


def soundness(scene: Scene) -> tuple[str, ...]:
    """Warnings on the shapes that may touch, each named `body/shape`; SceneError where none could run, with
    the place of the shape in the scene."""
    touching = touching_shapes(scene)
    found: list[str] = []
    for i, body in enumerate(scene.bodies):
        for k, shape in enumerate(body.shapes):
            if (body.name, shape.name) in touching:
                where = f"{scene.source}: body[{i}].shape{f'[{k}]' if len(body.shapes) > 1 else ''}"
                found += [f"{body.name}/{shape.name}: {text}" for text in _remarks(shape, where)]
    found += [
        f"{name}: contacts are with this shape, which stands for {what}" for name, what in stand_ins(scene)
    ]
    return (*found, *_standing(scene))


def touching_shapes(scene: Scene) -> set[Partner]:
    """The shapes that take part in contacts, each with its body."""
    listed = {partner for pair in scene.contacts for partner in pair.between}
    return listed.union(*(scene.classes[k] for pool in scene.pools for k in pool.classes))


def stand_ins(scene: Scene) -> list[tuple[str, str]]:
    """The shapes that may touch and stand for another surface: `body/shape`, and the latter in words."""
    touching = touching_shapes(scene)
    return [
        (f"{body.name}/{shape.name}", shape.stands_for)
        for body in scene.bodies
        for shape in body.shapes
        if shape.stands_for and (body.name, shape.name) in touching
    ]


def _standing(scene: Scene) -> Iterator[str]:
    """Warnings on pairs whose faces cannot rest on each other as patches because of their kind of
    friction."""
    shapes = {(body.name, shape.name): shape for body in scene.bodies for shape in body.shapes}
    for pair in scene.contacts:
        flat = [regions_of(shapes[partner]) for partner in pair.between if partner in shapes]
        bounded = any(region.arcs for regions in flat for region in regions)
        if pair.friction is None or has_friction(pair) or not (len(flat) == 2 and all(flat) and bounded):
            continue
        why = "rolling or spinning resistance" if pair.friction.direction is None else "friction by direction"
        name = "-".join(body for body, _ in pair.between)
        yield f"{name}: with {why}, faces that lie flat stand on points of them"


def _remarks(shape: Shape, where: str) -> tuple[str, ...]:
    try:
        features_of(shape)
        return (*check_user_shape(shape), *declared_limits(shape))
    except SceneError as error:
        raise SceneError(f"{where} ({error.where})", error.found, error.allowed, error.remedy) from None
