"""Loads: the bodies and points on which they act, kinds (generated), parameters (numbers of the instance)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from modelgen.assembly.inputs_of_expressions import inputs_of_expressions
from modelgen.model import BodyMotion, LoadKind
from modelgen.scene.scene_types import ForceLoad, Input, Load, SpringLoad, TorqueLoad, Vector

_ZERO = (0.0, 0.0, 0.0)


def bodies_of(load: Load) -> tuple[str, ...]:
    """The names of the bodies on which a load acts."""
    return load.between if isinstance(load, SpringLoad) else (load.body,)


def _points_of(load: Load) -> tuple[Vector, ...]:
    """The points of application of a load, one per body, in its axes as written; none for a torque."""
    match load:
        case SpringLoad(anchors=anchors):
            return anchors
        case ForceLoad(point=point):
            return (point,)
        case TorqueLoad():
            return ()


def load_kind(
    load: Load, motions: tuple[BodyMotion, ...], centres: Sequence[Vector], inputs: Sequence[Input]
) -> LoadKind:
    """The structure of a load on bodies of these motions with these centres of mass."""
    points = _points_of(load)
    arms = tuple(
        motion != "point" and point != centre
        for motion, point, centre in zip(motions, points, centres, strict=False)
    )
    match load:
        case SpringLoad():
            return LoadKind("spring", "spring", motions, arms=arms)
        case ForceLoad():
            texts = (load.frame, *(component.text for component in load.components))
            bare = replace(load, body="", point=_ZERO)
            used = inputs_of_expressions(inputs, load.components)
            return LoadKind("force", "force", motions, texts, bare, arms, inputs=used)
        case TorqueLoad():
            texts = (load.frame, *(component.text for component in load.components))
            used = inputs_of_expressions(inputs, load.components)
            return LoadKind("torque", "torque", motions, texts, replace(load, body=""), inputs=used)


def load_parameters(load: Load, kind: LoadKind, centres: Sequence[Vector]) -> tuple[float, ...]:
    """Points off the centre of mass (3 each, from it), then a spring's stiffness, damping, rest length."""
    arms = zip(_points_of(load), centres, kind.arms, strict=False)
    numbers = [a - b for point, centre, off in arms if off for a, b in zip(point, centre, strict=True)]
    if isinstance(load, SpringLoad):
        numbers += [load.stiffness, load.damping, load.rest_length]
    return tuple(numbers)
