"""The quantities that a scene observes: their names, and those that its sensors need."""

from __future__ import annotations

from collections.abc import Iterable

from modelgen.errors import SceneError
from modelgen.name_suggestions import nearest
from modelgen.scene.scene_types import Scene

BODY_QUANTITIES = ("position", "orientation", "velocity", "angular_velocity")
CONTACT_QUANTITIES = ("force", "gap")
JOINT_QUANTITIES = ("coordinates", "force", "torque")
_ENDS = ("min", "max", "y_min", "y_max")  # of the limits of a joint
_OF_ROTATION = ("orientation", "angular_velocity", "angular_acceleration", "proper_acceleration")  # of a body


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


def needed_quantities(scene: Scene) -> tuple[str, ...]:
    """What must be computed: the observed names and, beside them, what sensors measure; empty: everything."""
    if not scene.observe:
        return ()
    words = list(scene.observe)
    for sensor in scene.sensors:
        if sensor.measurand is None:
            continue
        name, quantity, base = sensor.measurand.name, sensor.measurand.quantity, sensor.measurand.relative_to
        if sensor.measurand.owner == "body":
            turning = sensor.measurand.point is not None or quantity in _OF_ROTATION
            words += [f"{name}.position", *([f"{name}.orientation"] if turning else [])]
            words += [f"{base}.position", f"{base}.orientation"] if base else []
        elif sensor.measurand.owner == "pair":
            words += [f"{each}.{quantity}" for each in sensor.measurand.pairs]
        else:
            words.append(f"{name}.{'coordinates' if quantity in ('coordinate', 'rate') else quantity}")
    return tuple(dict.fromkeys(words))
