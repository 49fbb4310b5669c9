"""Coaxial supports: a ball on the axis of a ring, or another body of revolution coaxial with it, touches all
of it at once, at no point by itself; three parts of the ring, a third of a turn apart, hold it there; of
an arc those at its ends and in the middle."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import cos, pi, sin

from modelgen.assembly.rim_support_points import held_places, spread
from modelgen.geometry.composites.feature_constructors import turned
from modelgen.geometry.meridians import is_of_revolution, meridian_of
from modelgen.rotations import rotation_of
from modelgen.scene.pose_arithmetic import compose, to_outer
from modelgen.scene.scene_types import Condition, Feature, Pose, Shape, Vector


def coaxial_supports_of(feature: Feature) -> tuple[Feature, ...]:
    """Meridians of a feature of revolution: they touch another feature while that is coaxial.

    Each belongs to the material, so that nothing that it touches is free to go on. None of other features.
    """
    meridian = meridian_of(feature)
    if meridian is None:
        return ()
    supports, condition = [], _on_axis_of(feature, 1.0)
    angles = held_places(feature) if feature.dimension == 1 else spread(0.0, 2 * pi, True)
    for k, angle in enumerate(angles, start=1):
        half = angle / 2
        turn = compose(feature.shape.pose, Pose(quaternion=(cos(half), 0.0, 0.0, sin(half))))
        rotation = rotation_of(turn.quaternion)
        supports.append(
            replace(
                meridian,
                name=f"{_label(feature)}.coaxial{k}",
                shape=_moved_shape(meridian.shape, turn),
                conditions=(*(turned(each, rotation) for each in meridian.conditions), condition),
            )
        )
    return tuple(supports)


def _moved_shape(shape: Shape, pose: Pose) -> Shape:
    """The shape seen from the frame in which the pose is given; of a point, its coordinates."""
    if shape.kind != "point":
        return replace(shape, pose=compose(pose, shape.pose))
    at = to_outer(pose, [value for _, value in shape.parameters])
    return replace(shape, parameters=tuple(zip("xyz", map(float, at), strict=True)))


def _on_axis_of(feature: Feature, sign: float) -> Condition:
    axis = rotation_of(feature.shape.pose.quaternion)[:, 2]
    return Condition("coaxial", (*feature.shape.pose.position, *map(float, axis), sign), None)


def is_coaxial_support(feature: Feature) -> bool:
    return any(each.kind == "coaxial" and each.numbers[-1] > 0 for each in feature.conditions)


def bearer_of(support: Feature, features: Sequence[Feature]) -> Feature:
    """The one of the features that the support is a part of."""
    return next(each for each in features if support.name.startswith(f"{_label(each)}.coaxial"))


def _label(feature: Feature) -> str:
    return feature.name or feature.shape.kind


def has_coaxial_supports(feature: Feature, other: Feature, is_first: bool) -> bool:
    """Whether supports of the feature replace it while it is coaxial with the other one.

    That is a ball, or another surface of revolution. Where both could have supports, those of the lower
    dimension are taken, of two alike those of the first one of the pair: `is_first` says whether this is it.
    """
    if other.dimension < 2 or is_coaxial_support(other):
        return False
    is_ball = other.shape.kind == "sphere"
    if not (is_ball or is_of_revolution(other.shape)):
        return False
    mine = meridian_of(feature)
    if mine is None or is_ball:
        return mine is not None
    theirs = meridian_of(other)
    if theirs is None:
        return True
    mine_first, theirs_first = (mine.dimension, feature.name), (theirs.dimension, other.name)
    return is_first if mine_first == theirs_first else mine_first < theirs_first


def eccentric(feature: Feature) -> Feature:
    """A feature of revolution as it touches another one: not while they are coaxial."""
    return replace(feature, conditions=(*feature.conditions, _on_axis_of(feature, -1.0)))


def seen_from_body(feature: Feature, pose: Pose, centre: Vector) -> Feature:
    """The feature of a shape at the pose, with the axes of its conditions in the axes of the body, from its
    centre of mass: the same numbers for all that hand over to each other."""
    return replace(
        feature,
        conditions=tuple(
            replace(each, numbers=_moved(each.numbers, pose, centre)) if each.kind == "coaxial" else each
            for each in feature.conditions
        ),
    )


def _moved(numbers: tuple[float, ...], pose: Pose, centre: Vector) -> tuple[float, ...]:
    point, axis = to_outer(pose, numbers[:3]) - centre, rotation_of(pose.quaternion) @ numbers[3:6]
    return (*map(float, point), *map(float, axis), numbers[6])
