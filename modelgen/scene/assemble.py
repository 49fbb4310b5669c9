"""The Scene from the values of the tables: references resolved, parts put together."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from modelgen.scene import contacts_and_loads, joints
from modelgen.scene.constants import with_constants
from modelgen.scene.contact_groups import group_pairs
from modelgen.scene.patterns import repeated
from modelgen.scene.remarks import remark_on_gravity
from modelgen.scene.run_settings import RUN, check_run
from modelgen.scene.scene_format import SCENE
from modelgen.scene.scene_types import Body, RunSettings, Scene
from modelgen.scene.shapes_and_bodies import read_body, unique_names
from modelgen.scene.source_location import Place


def scene_from_tables(name: str, written: object, source: str) -> Scene:
    """The scene from plain tables, as a TOML file gives them; raises SceneError."""
    place = with_constants(Place(source), written)
    values = SCENE.read(written, place)
    bodies = tuple(read_body(each, at) for at, each in values["body"])
    return scene_from_bodies(name, bodies, values, place)


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
    observe = contacts_and_loads.observed(
        values["observe"], known, (each.name for each in joined), place.key("observe")
    )
    listed = contacts_and_loads.contacts(values["contact"], known)
    return Scene(
        name=name,
        source=place.source,
        bodies=bodies,
        contacts=(*listed, *group_pairs(values["contacts"], listed, known, joined, place.key("contacts"))),
        loads=contacts_and_loads.loads(values, known),
        joints=joined,
        gravity=values["gravity"],
        observe=observe,
        fold=values["fold"],
        run=RunSettings(**run),
        remarks=tuple(place.remarks),
    )
