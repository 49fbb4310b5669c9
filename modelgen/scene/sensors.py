"""Sensors of a scene: what is measured during a run, and numbers that follow from it."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import Any

from modelgen.name_suggestions import nearest
from modelgen.notation import component_names
from modelgen.scene.contacts_and_loads import pair_names, pairs_named
from modelgen.scene.prescribed_motions import TIME
from modelgen.scene.scene_types import Body, ContactPair, Joint, Measurand, Sensor
from modelgen.scene.source_location import Place

OF_BODIES: Mapping[str, int] = {  # components of each quantity
    "position": 3, "orientation": 4, "velocity": 3, "angular_velocity": 3,
    "acceleration": 3, "angular_acceleration": 3, "proper_acceleration": 3,
}  # fmt: skip
ACCELERATIONS = ("acceleration", "angular_acceleration", "proper_acceleration")
OF_PAIRS: Mapping[str, int] = {"gap": 1, "force": 1}
OF_JOINTS: Mapping[str, int] = {"coordinate": 1, "rate": 1, "force": 3, "torque": 3}
_AT_POINT = ("position", "velocity", "acceleration", "proper_acceleration")  # quantities of a point of a body


def sensors_of(
    read: Sequence[tuple[Place, Mapping[str, Any]]],
    bodies: Mapping[str, Body],
    pairs: Sequence[ContactPair],
    joints: Sequence[Joint],
) -> tuple[Sensor, ...]:
    """The sensors of the values of their tables; those with expressions use what stands before them.

    Raises SceneError.
    """
    found: dict[str, Sensor] = {}
    for place, values in read:
        taken = {*found, *place.constants, *(each.name for each in place.inputs)}
        if values["name"] in taken:
            raise place.key("name").error(
                f"the name {values['name']!r} a second time", "", "give it another name"
            )
        if values["of"] is None and values["value"] is None:
            raise place.error("neither `of` nor `value`", "", 'write of = "body.position" or value = "..."')
        if values["value"] is None:
            measured = _measurand(values, bodies, pairs, {joint.name: joint for joint in joints}, place)
            found[values["name"]] = Sensor(values["name"], measurand=measured)
            continue
        for key in ("point", "relative_to"):
            if values[key] is not None:
                raise place.key(key).error("it beside `value`", "it goes with `of`", "remove one of the two")
        known = component_names(sensor_sizes(found.values()))
        names = (TIME, *(each.name for each in place.inputs), *known)
        found[values["name"]] = Sensor(
            values["name"], value=place.key("value").expression(values["value"], names)
        )
    return tuple(found.values())


def sensor_sizes(sensors: Iterable[Sensor]) -> tuple[tuple[str, int], ...]:
    """Name and number of components of each sensor."""
    tables = {"body": OF_BODIES, "pair": OF_PAIRS, "joint": OF_JOINTS}
    measured = ((each.name, each.measurand) for each in sensors)
    return tuple((name, tables[of.owner][of.quantity] if of else 1) for name, of in measured)


def _measurand(
    values: Mapping[str, Any],
    bodies: Mapping[str, Body],
    pairs: Sequence[ContactPair],
    joints: Mapping[str, Joint],
    place: Place,
) -> Measurand:
    name, quantity = values["of"].split(".")
    at = place.key("of")
    if name in bodies:
        _check_quantity(quantity, OF_BODIES, at)
        if values["point"] is not None and quantity not in _AT_POINT:
            allowed = f"a point has {', '.join(_AT_POINT[:-1])} and {_AT_POINT[-1]}"
            raise place.key("point").error(f"a point with the {quantity} of a body", allowed, "remove it")
        if values["relative_to"] is not None:
            if quantity == "proper_acceleration":
                allowed = "it is in the body's own axes and relative to free fall"
                raise place.key("relative_to").error(
                    f"it with the {quantity} of a body", allowed, "remove it"
                )
            _check_body(values["relative_to"], bodies, place.key("relative_to"))
        return Measurand("body", name, quantity, (), values["point"], values["relative_to"])
    for key in ("point", "relative_to"):
        if values[key] is not None:
            raise place.key(key).error(f"it with {values['of']!r}", "it goes with a body", "remove it")
    if name in joints:
        _check_quantity(quantity, OF_JOINTS, at)
        return Measurand("joint", name, quantity)
    if measured := pairs_named(name, pairs):
        _check_quantity(quantity, OF_PAIRS, at)
        return Measurand("pair", measured[0] if len(measured) == 1 else name, quantity, measured)
    known = [*bodies, *joints, *pair_names(pairs)]
    raise at.error(
        f"no body, joint or pair named {name!r}", "known are " + ", ".join(known[:20]), nearest(name, known)
    )


def _check_quantity(quantity: str, known: Collection[str], place: Place) -> None:
    if quantity not in known:
        raise place.error(
            f"no quantity {quantity!r}", "allowed are " + ", ".join(known), nearest(quantity, known)
        )


def _check_body(name: str, bodies: Mapping[str, Body], place: Place) -> None:
    if name not in bodies:
        raise place.error(
            f"no body named {name!r}", "bodies: " + ", ".join(list(bodies)[:20]), nearest(name, bodies)
        )
