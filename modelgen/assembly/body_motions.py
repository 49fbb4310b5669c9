"""How a body moves in the model: fixed, driven, as a point, or freely if anything depends on its rotation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from modelgen.assembly.loads import bodies_of
from modelgen.assembly.masses import Mass
from modelgen.model import BodyMotion
from modelgen.scene.scene_types import (
    IDENTITY_QUATERNION,
    Body,
    ContactPair,
    Load,
    Scene,
    Shape,
    SpringLoad,
    TorqueLoad,
    Vector,
)

_TURNING = frozenset({"wx", "wy", "wz", "qw", "qx", "qy", "qz"})
_ZERO = (0.0, 0.0, 0.0)


def pairs_by_body(scene: Scene) -> Mapping[str, tuple[ContactPair, ...]]:
    """The contact pairs of each body, by its name; of the pairs of a pool, one."""
    found: dict[str, list[ContactPair]] = {body.name: [] for body in scene.bodies}
    for pair in scene.contacts:
        for name in {owner for owner, _ in pair.between} & found.keys():
            found[name].append(pair)
    for pool in scene.pools:
        pattern = scene.contacts[pool.pattern]
        for own, other in zip(pool.classes, pool.classes[::-1], strict=True):
            for member in scene.classes[own]:
                found[member[0]].append(replace(pattern, between=(member, scene.classes[other][0])))
    return {name: tuple(pairs) for name, pairs in found.items()}


def motion_of(scene: Scene, body: Body, mass: Mass | None, pairs: Sequence[ContactPair]) -> BodyMotion:
    """The least motion of the body, with these contact pairs, that the scene needs."""
    if body.motion != "dynamic" or mass is None:
        return "driven" if body.motion == "driven" else "fixed"
    turns = (
        _is_rotation_observed(scene, body)
        or any(body.name in joint.between for joint in scene.joints)
        or any(pair.friction is not None for pair in pairs)
        or any(_turns_by(load, body.name, mass.centre) for load in scene.loads)
        or not all(_is_centred(shape, mass.centre) for shape in contacting_shapes(body, pairs))
    )
    return "free" if turns else "point"


def contacting_shapes(body: Body, pairs: Sequence[ContactPair]) -> tuple[Shape, ...]:
    """The shapes of the body that take part in one of its contact pairs."""
    used = {shape for pair in pairs for owner, shape in pair.between if owner == body.name}
    return tuple(shape for shape in body.shapes if shape.name in used)


def _is_rotation_observed(scene: Scene, body: Body) -> bool:
    """True if the rotation of the body is observed. If everything is observed, a rotation that stays zero is
    not."""
    if scene.observe:
        return any(f"{body.name}.{name}" in scene.observe for name in ("orientation", "angular_velocity"))
    return body.angular_velocity != _ZERO or body.pose.quaternion != IDENTITY_QUATERNION


def _is_centred(shape: Shape, centre: Vector) -> bool:
    """True for a sphere or a point whose centre is the centre of mass."""
    at_origin = shape.kind == "point" and not any(value for _, value in shape.parameters)
    return (shape.kind == "sphere" or at_origin) and shape.pose.position == centre


def _turns_by(load: Load, body: str, centre: Vector) -> bool:
    """True if the load exerts a torque on the body or depends on its orientation."""
    if body not in bodies_of(load):
        return False
    if isinstance(load, SpringLoad):
        return load.anchors[load.between.index(body)] != centre
    names: frozenset[str] = frozenset().union(*(component.names for component in load.components))
    return (
        isinstance(load, TorqueLoad) or load.frame == "body" or load.point != centre or bool(names & _TURNING)
    )
