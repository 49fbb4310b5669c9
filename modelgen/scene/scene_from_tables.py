"""The Scene from the values of the tables: references resolved, parts put together."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import chain
from typing import Any

from modelgen.errors import SceneError
from modelgen.scene import contacts_and_loads, joints
from modelgen.scene.actuators import actuators_of, check_names
from modelgen.scene.constants import along, with_constants
from modelgen.scene.contact_groups import group_of
from modelgen.scene.expression import Expression
from modelgen.scene.inputs import remark_on_unused, with_inputs
from modelgen.scene.parameters import parameters_of, with_uses
from modelgen.scene.patterns import repeated
from modelgen.scene.plausibility_remarks import remark_on_gravity
from modelgen.scene.run_settings import RUN, check_run
from modelgen.scene.scene_format import SCENE
from modelgen.scene.scene_types import (
    Actuator,
    Body,
    Joint,
    Load,
    Origin,
    Parameter,
    RunSettings,
    Scene,
    Sensor,
    SpringLoad,
)
from modelgen.scene.sensors import sensors_of
from modelgen.scene.shapes_and_bodies import read_body, unique_names
from modelgen.scene.source_location import Place

MENTIONING = (*("observe", "force", "torque", "spring", "actuator"), "sensor")  # tables that name bodies


def scene_from_tables(name: str, written: object, source: str) -> Scene:
    """The scene from plain tables, as a TOML file gives them; raises SceneError."""
    parameters = parameters_of(written, Place(source))
    scene = _scene(name, written, source, parameters)
    if not isinstance(written, Mapping):
        return scene
    if not parameters:
        return replace(scene, origin=Origin(written))
    if scene.fold:
        raise (
            Place(source)
            .key("fold")
            .error("fold together with parameters", "folded numbers stand in the code", "remove fold")
        )
    return replace(scene, origin=Origin(written), nominal=_at_nominal(name, written, source, parameters))


def with_form(scene: Scene, form: str) -> Scene:
    """The scene with one form of the equations forced on all its contacts."""
    return replace(
        scene,
        contacts=tuple(replace(contact, form=form) for contact in scene.contacts),
        nominal=scene.nominal and with_form(scene.nominal, form),
        origin=scene.origin and replace(scene.origin, form=form),
    )


def _at_nominal(name: str, written: object, source: str, parameters: tuple[Parameter, ...]) -> Scene | None:
    """The scene at the nominal values of its parameters; None where the scene has these values."""
    if all(each.value == each.nominal for each in parameters):
        return None
    nominal = tuple(replace(each, value=each.nominal) for each in parameters)
    try:
        return _scene(name, written, source, nominal)
    except SceneError as error:
        found = f"at the nominal values of the parameters: {error.found}"
        raise SceneError(error.where, found, error.allowed, error.remedy) from None


def _scene(name: str, written: object, source: str, parameters: tuple[Parameter, ...]) -> Scene:
    """The scene with these parameters in place of those in its tables."""
    place = place_of(Place(source), written, {each.name: each.value for each in parameters})
    values = SCENE.read(written, place)
    bodies = tuple(read_body(each, at) for at, each in values["body"])
    scene = scene_from_bodies(name, bodies, values, place)
    return replace(scene, parameters=with_uses(parameters, place.uses, place)) if parameters else scene


def place_of(
    place: Place, written: object, parameters: Mapping[str, float], change: tuple[str, float] | None = None
) -> Place:
    """The place of a scene, whose expressions may use its parameters, constants and inputs; `change`: a
    parameter along which all numbers move, and how far. Raises SceneError."""
    known = with_constants(place, written, parameters)
    return with_inputs(known if change is None else along(known, written, *change), written)


def scene_from_bodies(name: str, bodies: tuple[Body, ...], values: Mapping[str, Any], place: Place) -> Scene:
    """The scene of given bodies and the remaining values of the scene's table; raises SceneError."""
    if not bodies:
        raise place.key("body").error("no body", "a scene has one body or more", "add a [[body]]")
    bodies = repeated(bodies, values["pattern"])
    unique_names(bodies, place.key("body"))
    bodies = joints.with_world(bodies, values["joint"])
    known = {body.name: body for body in bodies}
    run = values["run"] or RUN.read({}, place.key("run"))
    check_run(run, place.key("run"))
    remark_on_gravity(values["gravity"], place.key("gravity"))
    joined = joints.joints(values["joint"], known)
    loads = contacts_and_loads.loads(values, known)
    listed = contacts_and_loads.contacts(values["contact"], known)
    texts = None if place.following else [*_texts([values[key] for key in MENTIONING])]
    group = group_of(values["contacts"], listed, known, joined, place.key("contacts"), texts)
    pairs = (*listed, *group.pairs)
    observe = contacts_and_loads.observed(values["observe"], known, pairs, joined, place.key("observe"))
    check_names(place)
    actuators = actuators_of(values["actuator"], joined)
    sensors = sensors_of(values["sensor"], known, pairs, joined)
    remark_on_unused(place.inputs, _names_used(bodies, loads, joined, actuators, sensors), place)
    return Scene(
        name=name,
        source=place.source,
        bodies=bodies,
        contacts=pairs,
        loads=loads,
        joints=joined,
        actuators=actuators,
        inputs=place.inputs,
        sensors=sensors,
        gravity=values["gravity"],
        observe=observe,
        fold=values["fold"],
        run=RunSettings(**run),
        remarks=tuple(place.remarks),
        classes=group.classes,
        near_per_body=group.near_per_body,
        pools=tuple(replace(pool, pattern=len(listed) + pool.pattern) for pool in group.pools),
    )


def _texts(value: object) -> Iterator[str]:
    """All texts in a value of a table."""
    if isinstance(value, str | Expression):
        yield value if isinstance(value, str) else value.text
    elif isinstance(value, Mapping):
        yield from chain.from_iterable(map(_texts, value.values()))
    elif isinstance(value, Sequence):
        yield from chain.from_iterable(map(_texts, value))


def _names_used(
    bodies: Sequence[Body],
    loads: Sequence[Load],
    joined: Sequence[Joint],
    actuators: Sequence[Actuator],
    sensors: Sequence[Sensor],
) -> frozenset[str]:
    """The names that occur in the expressions of loads, paths, motions of joints, actuators and sensors."""
    paths = [body.path for body in bodies if body.path is not None]
    found = [each for path in paths for each in (*path.position, *path.rotation_vector)]
    found += [each for load in loads if not isinstance(load, SpringLoad) for each in load.components]
    found += [joint.motion for joint in joined if joint.motion is not None]
    found += [actuator.force for actuator in actuators]
    found += [sensor.value for sensor in sensors if sensor.value is not None]
    return frozenset().union(*(each.names for each in found))
