"""Pruning: states on which no observed quantity depends are left out of the model."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from modelgen.assembly.masses import Mass
from modelgen.errors import SceneError, nearest
from modelgen.model import BodyMotion
from modelgen.scene.scene_types import (
    IDENTITY_QUATERNION,
    Body,
    ContactPair,
    ForceLoad,
    Load,
    Scene,
    Shape,
    SpringLoad,
    TorqueLoad,
    Vector,
)

BODY_QUANTITIES = ("position", "orientation", "velocity", "angular_velocity")
CONTACT_QUANTITIES = ("force", "gap")
JOINT_QUANTITIES = ("coordinates", "force", "torque")
_ENDS = ("min", "max", "y_min", "y_max")  # of the limits of a joint
_TURNING = frozenset({"wx", "wy", "wz", "qw", "qx", "qy", "qz"})
_ZERO = (0.0, 0.0, 0.0)


def bodies_of(load: Load) -> tuple[str, ...]:
    """The names of the bodies on which a load acts."""
    return load.between if isinstance(load, SpringLoad) else (load.body,)


def points_of(load: Load) -> tuple[Vector, ...]:
    """The points of application of a load, one per body, in its axes as written; none for a torque."""
    match load:
        case SpringLoad(anchors=anchors):
            return anchors
        case ForceLoad(point=point):
            return (point,)
        case TorqueLoad():
            return ()


def check_observed(scene: Scene, contacts: Iterable[str]) -> None:
    """Raises SceneError for an observed name that is no quantity of a body, contact or joint; limits
    such as `elbow:min` count as contacts."""
    limits = [
        f"{joint.name}:{end}"
        for joint in scene.joints
        for end, bound in zip(_ENDS, (*joint.limits, *joint.limits_y), strict=True)
        if bound is not None
    ]
    known = {f"{body.name}.{quantity}" for body in scene.bodies for quantity in BODY_QUANTITIES}
    known |= {f"{contact}.{each}" for contact in (*contacts, *limits) for each in CONTACT_QUANTITIES}
    known |= {f"{joint.name}.{quantity}" for joint in scene.joints for quantity in JOINT_QUANTITIES}
    for index, name in enumerate(scene.observe):
        if name not in known:
            raise SceneError(
                f"{scene.source}: observe[{index}]",
                f"no quantity {name!r}",
                f"body.{'|'.join(BODY_QUANTITIES)}, body-body.{'|'.join(CONTACT_QUANTITIES)} or "
                f"joint.{'|'.join(JOINT_QUANTITIES)}",
                nearest(name, known),
            )


TURNING = ("orientation", "angular_velocity", "angular_acceleration", "proper_acceleration")  # of a body


def watched(scene: Scene) -> tuple[str, ...]:
    """What must be computed: the observed names and, beside them, what sensors measure; empty: everything."""
    if not scene.observe:
        return ()
    words = list(scene.observe)
    for sensor in scene.sensors:
        if sensor.measurand is None:
            continue
        name, quantity, base = sensor.measurand.name, sensor.measurand.quantity, sensor.measurand.relative_to
        if sensor.measurand.owner == "body":
            turning = sensor.measurand.point is not None or quantity in TURNING
            words += [f"{name}.position", *([f"{name}.orientation"] if turning else [])]
            words += [f"{base}.position", f"{base}.orientation"] if base else []
        else:
            words.append(f"{name}.{'coordinates' if quantity in ('coordinate', 'rate') else quantity}")
    return tuple(dict.fromkeys(words))


def pairs_by_body(scene: Scene) -> Mapping[str, tuple[ContactPair, ...]]:
    """The contact pairs of each body, by its name."""
    found: dict[str, list[ContactPair]] = {body.name: [] for body in scene.bodies}
    for pair in scene.contacts:
        for name in {owner for owner, _ in pair.between} & found.keys():
            found[name].append(pair)
    return {name: tuple(pairs) for name, pairs in found.items()}


def motion_of(scene: Scene, body: Body, mass: Mass | None, pairs: Sequence[ContactPair]) -> BodyMotion:
    """The least motion of the body, with these contact pairs, that the scene needs."""
    if body.motion != "dynamic" or mass is None:
        return "driven" if body.motion == "driven" else "fixed"
    turns = (
        _is_watched(scene, body)
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


def _is_watched(scene: Scene, body: Body) -> bool:
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
