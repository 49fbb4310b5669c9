"""A library with other values of its scene's parameters: the tables are read again, nothing is compiled.

Inverse masses, inertia, bounding balls, domains and all other numbers come from the same functions as those
of a scene file with these values, so that they are equal to the last bit. What is compiled, and the numbers
of bodies, contacts, features and conditions, must be those of the library.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from math import isfinite
from numbers import Real
from typing import Any
from weakref import WeakKeyDictionary

from modelgen.assembly import require
from modelgen.codegen.library import Library
from modelgen.codegen.manifest import Json
from modelgen.codegen.manifest_instance import instance_of, kinds_of
from modelgen.errors import LibraryError, SceneError, SimulationError, nearest
from modelgen.model import Model, Scales
from modelgen.scene.assemble import scene_with
from modelgen.scene.parameters import out_of_range
from modelgen.scene.scalar_types import HUGE
from modelgen.scene.scene_types import Origin

KEPT = 64  # sets of values of a library whose tables are kept
KINDS = ("body", "contact", "load", "shape", "joint", "limit")
FREE = ("warnings", "unlisted", "search", "parameters", "origin")  # what no size of the core follows from


@dataclass
class _Read:
    """What is known of a library: its model at its own values, and its libraries at others."""

    model: Model
    kept: OrderedDict[tuple[float, ...], Library] = field(default_factory=OrderedDict)


_READ: WeakKeyDictionary[Library, _Read] = WeakKeyDictionary()


def library_with(library: Library, values: Mapping[str, float]) -> Library:
    """The functions of a library with other values of the parameters of its scene.

    Args:
        library: what `build` returned, or `Library.load`.
        values: by name; the other parameters keep the values of the library.

    Raises:
        SimulationError: a name is unknown, a value is no finite number, out of its range or refused by the
            scene, or it changes what is compiled or the number of contacts, features or conditions.
        LibraryError: the library is of another version.
    """
    known = {each["name"]: each for each in library.manifest.instance.get("parameters", ())}
    chosen = {name: each["value"] for name, each in known.items()}
    chosen |= {name: _checked(name, value, known) for name, value in values.items()}
    if all(chosen[name] == known[name]["value"] for name in values):
        return library
    read = _READ.get(library)
    if read is None:
        read = _READ[library] = _Read(_model_of(library))
    key = tuple(chosen.values())
    if key not in read.kept:
        read.kept[key] = _made(library, read.model, chosen)
        if len(read.kept) > KEPT:
            read.kept.popitem(last=False)
    read.kept.move_to_end(key)
    return read.kept[key]


def _checked(name: str, value: object, known: Mapping[str, Json]) -> float:
    if name not in known:
        allowed = "parameters: " + (
            ", ".join(known) or "none; a scene names them in its [[parameter]] tables"
        )
        raise SimulationError("parameters", f"no parameter {name!r}", allowed, nearest(name, known))
    where = f"parameters: {name}"
    if isinstance(value, bool) or not isinstance(value, Real):
        raise SimulationError(where, repr(value), "a number is allowed")
    number = float(value)
    if not isfinite(number) or abs(number) > HUGE:
        raise SimulationError(where, repr(number), f"a number from {-HUGE:g} to {HUGE:g} is allowed")
    if outside := out_of_range(number, known[name]["minimum"], known[name]["maximum"]):
        raise SimulationError(where, f"the number {number!r}", outside)
    return number


def _model_of(library: Library) -> Model:
    """The model of a library at its own values."""
    instance = library.manifest.instance
    model = _model(instance, {each["name"]: each["value"] for each in instance["parameters"]})
    if kinds_of(model) != library.manifest.kinds:
        found = "its scene, read again, needs other kinds"
        raise LibraryError(str(library.path), found, "", "it is stale: build again")
    return model


def _model(instance: Json, values: Mapping[str, float]) -> Model:
    origin = instance["origin"]
    if origin is None:
        raise SimulationError(
            "parameters", "the scene was changed after it was read, and cannot be read again",
            "parameters need a scene as its file or tables say", "write the change into the scene",
        )  # fmt: skip
    scene = scene_with(instance["name"], Origin(**origin), instance["source"], values)
    return require(scene, Scales(**instance["scales"]))


def _made(library: Library, own: Model, values: Mapping[str, float]) -> Library:
    instance = library.manifest.instance
    changed = [each["name"] for each in instance["parameters"] if values[each["name"]] != each["value"]]
    try:
        model = _model(instance, values)
    except SceneError as error:
        remedy = error.remedy or "choose another value"
        found = f"refused by {error.where}: {error.found}"
        raise SimulationError(_where(values, changed), found, error.allowed, remedy) from None
    told = [{**each, "value": values[each["name"]]} for each in instance["parameters"]]
    other = instance_of(model) | {"parameters": told, "origin": instance["origin"]}
    change = next(_changes(own, instance, model, other), None)
    if change is not None:
        raise _other_structure(library, own, values, changed, change)
    return library.with_instance(other)


def _where(values: Mapping[str, float], names: list[str]) -> str:
    return f"parameters: {_at(values, names)}"


def _changes(own: Model, instance: Json, model: Model, other: Json) -> Iterator[str]:
    """What differs, in words, other than in numbers."""
    for group in KINDS:
        before, after = (getattr(each, f"{group}_kinds") for each in (own, model))
        if before != after:
            names = [", ".join(kind.name for kind in kinds) or "none" for kinds in (before, after)]
            told = f"{names[1]} in place of {names[0]}" if names[0] != names[1] else f"numbers in {names[0]}"
            yield f"kinds of {group}: {told}"
    for key in instance:
        if key not in FREE:
            yield from _differences(instance[key], other.get(key), key)


def _differences(before: Any, after: Any, path: str) -> Iterator[str]:
    """Where two tables differ in more than the values of their numbers."""
    if isinstance(before, float) and isinstance(after, float):
        return
    if isinstance(before, dict) and isinstance(after, dict) and before.keys() == after.keys():
        for key, each in before.items():
            if key not in FREE:
                yield from _differences(each, after[key], f"{path}.{key}")
    elif isinstance(before, list | tuple) and isinstance(after, list | tuple):
        if len(before) != len(after):
            yield f"{path}: {len(after)} in place of {len(before)}"
            return
        for index, (one, two) in enumerate(zip(before, after, strict=True)):
            yield from _differences(one, two, f"{path}[{index}]")
    elif before != after:
        yield f"{path}: {after!r} in place of {before!r}"


def _other_structure(
    library: Library, own: Model, values: Mapping[str, float], changed: list[str], change: str
) -> SimulationError:
    """The error of values that need another library; names the parameters each of which does so alone."""
    instance = library.manifest.instance
    before = {each["name"]: each["value"] for each in instance["parameters"]}
    alone = [name for name in changed if _alone(own, instance, {**before, name: values[name]})]
    return SimulationError(
        _where(values, alone or changed),
        f"another structure ({change})",
        f"only numbers may differ from those of the library, built at {_at(before, alone or changed)}",
        "write the value into the scene and build that",
    )


def _alone(own: Model, instance: Json, values: Mapping[str, float]) -> bool:
    try:
        model = _model(instance, values)
    except SceneError:
        return True
    return next(_changes(own, instance, model, instance_of(model)), None) is not None


def _at(values: Mapping[str, float], names: list[str]) -> str:
    return ", ".join(f"{name} = {values[name]:.9g}" for name in names)
