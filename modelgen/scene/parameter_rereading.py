"""A scene read from its tables again and again, with other values of its parameters each time."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from typing import Any, NamedTuple

from modelgen.errors import SimulationError
from modelgen.scene.parameters import checked_values, parameters_of, with_uses
from modelgen.scene.scene_format import SCENE
from modelgen.scene.scene_from_tables import place_of, scene_from_bodies, with_form
from modelgen.scene.scene_types import Body, Input, Origin, Parameter, Scene
from modelgen.scene.shapes_and_bodies import read_body
from modelgen.scene.source_location import Motion, Place
from modelgen.scene.table_types import Several


def changed_scene() -> SimulationError:
    """The error of a scene that its tables do not give."""
    return SimulationError(
        "parameters", "the scene was changed after it was read, and cannot be read again",
        "parameters need a scene as its tables say", "write the change into its tables",
    )  # fmt: skip


def scene_with(scene: Scene, values: Mapping[str, float] | None) -> Scene:
    """A scene with other values of its parameters, by name; scales stay those of the nominal values.

    Raises SimulationError for a name or value that is refused, or a scene that was changed after it was read;
    SceneError where the scene refuses the values.
    """
    if not values:
        return scene
    ranges = {each.name: (each.minimum, each.maximum) for each in scene.parameters}
    own = {each.name: each.value for each in scene.parameters}
    chosen = own | checked_values(values, ranges)
    if scene.origin is None:
        raise changed_scene()
    reader = SceneReader(scene.name, scene.source, scene.origin)
    if reader.scene(own) != replace(scene, nominal=None):
        raise changed_scene()
    found = reader.scene(chosen)
    at_nominal = all(each.value == each.nominal for each in found.parameters)
    return replace(found, nominal=None if at_nominal else scene.nominal or replace(scene, origin=None))


class _Part(NamedTuple):
    """What was read from a part of the tables."""

    value: Any
    remarks: tuple[str, ...]
    follows: bool  # from a parameter


class SceneReader:
    """Reads the scene of an origin; parts of its tables that no parameter reaches are read once."""

    def __init__(self, name: str, source: str, origin: Origin) -> None:
        self.name, self.source, self.origin = name, source, origin
        self._written = parameters_of(origin.tables, Place(source))
        self._parameters: tuple[Parameter, ...] | None = None  # with their uses
        self._inputs: tuple[Input, ...] = ()
        self._parts: dict[tuple[str, int], _Part] = {}

    def scene(self, values: Mapping[str, float]) -> Scene:
        """The scene with these values of all its parameters, without that at the nominal values.

        Raises SceneError.
        """
        return self._scene(values, place_of(Place(self.source), self.origin.tables, values))

    def scene_along(self, values: Mapping[str, float], parameter: str, step: float) -> tuple[Scene, Motion]:
        """The scene with these values, of which all numbers have moved by `step` times their derivatives by a
        parameter, and that motion. Raises SceneError."""
        place = place_of(Place(self.source), self.origin.tables, values, (parameter, step))
        assert place.motion is not None
        return self._scene(values, place), place.motion

    def _scene(self, values: Mapping[str, float], place: Place) -> Scene:
        if place.inputs != self._inputs:  # motions start at the values of inputs
            self._inputs = place.inputs
            self._parts.clear()
        read = {field.key: self._value(field.key, field.type, field.default, place) for field in SCENE.fields}
        bodies: tuple[Body, ...] = tuple(body for _, body in read["body"])
        scene = scene_from_bodies(self.name, bodies, read, place)
        if self._parameters is None:
            self._parameters = with_uses(self._written, place.uses, place)
        parameters = tuple(replace(each, value=values[each.name]) for each in self._parameters)
        scene = replace(scene, parameters=parameters, origin=replace(self.origin, form=None))
        return scene if self.origin.form is None else with_form(scene, self.origin.form)

    def _value(self, key: str, kind: Any, default: Any, place: Place) -> Any:
        """The value of a key at the top of the scene; of bodies their tables and themselves."""
        written = self.origin.tables.get(key)
        if written is None:
            return default
        at = place.key(key)
        if not isinstance(kind, Several):
            return self._part((key, 0), place, lambda: kind.read(written, at))
        return tuple(
            self._part((key, index), place, partial(_item, key, kind, each, at.item(index)))
            for index, each in enumerate(written)
        )

    def _part(self, key: tuple[str, int], place: Place, read: Callable[[], Any]) -> Any:
        """What `read` returns, or returned before where no parameter reaches it."""
        part = self._parts.get(key)
        if part is not None and not part.follows:
            place.remarks.extend(part.remarks)
            return part.value
        remarks, uses = len(place.remarks), len(place.uses)
        value = read()
        self._parts[key] = _Part(value, tuple(place.remarks[remarks:]), len(place.uses) > uses)
        return value


def _item(key: str, kind: Several, written: object, place: Place) -> tuple[Place, Any]:
    """The place and the value of a table of a list, or the body in it."""
    at = kind.place(written, place)
    value = kind.item.read(written, at)
    return at, read_body(value, at) if key == "body" else value
