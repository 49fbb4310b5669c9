"""A library with other values of its scene's parameters: the tables are read again, nothing is compiled.

Inverse masses, inertia, bounding balls, domains and all other numbers come from the same functions as those
of a scene file with these values, so that they are equal to the last bit. What is compiled, and the numbers
of bodies, contacts, features and conditions, must be those of the library.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Iterable, Iterator, Mapping
from math import inf
from typing import Any
from weakref import WeakKeyDictionary

from modelgen.assembly import require
from modelgen.codegen.library import Library
from modelgen.codegen.manifest import Json
from modelgen.codegen.manifest_model import instance_of, kinds_of
from modelgen.errors import LibraryError, SceneError, SimulationError
from modelgen.model import Model, Scales
from modelgen.repeated_entries import RepeatedEntries
from modelgen.scene.parameter_rereading import SceneReader, changed_scene
from modelgen.scene.parameters import checked_values
from modelgen.scene.scene_types import Origin, Scene
from modelgen.scene.source_location import Motion

KEPT = 64  # sets of values of a library that are kept
KINDS = ("body", "contact", "load", "shape", "joint", "limit")
FREE = ("warnings", "unlisted", "open_edges", "search")  # what no size of the core follows from

Values = Mapping[str, float]


def library_with(library: Library, values: Values) -> Library:
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
    own = {name: each["value"] for name, each in known.items()}
    ranges = {name: (each["minimum"], each["maximum"]) for name, each in known.items()}
    chosen = own | checked_values(values, ranges)
    if chosen == own:
        return library
    variants = _variants_of(library, own)
    kept, key = variants.kept, tuple(chosen.values())
    if key not in kept:
        kept[key] = library.with_instance(variants.instance(chosen))
        if len(kept) > KEPT:
            kept.popitem(last=False)
    kept.move_to_end(key)
    return kept[key]


class Moved:
    """A library of which all numbers move along their derivatives by a parameter."""

    def __init__(self, library: Library, variants: _Variants, parameter: str) -> None:
        self._library, self._variants, self._parameter = library, variants, parameter
        _, motion = variants.along(parameter, 0.0)
        self.kink = max(motion.kinks, key=lambda kink: kink.is_lost, default=None)
        """A number that is on a kink, one that has no derivative if there is any."""
        self.unit = min(((abs(each.value) or 1.0) / abs(each.rate) for each in motion.moved), default=inf)
        """By which the first number changes by as much as itself, or, from zero, by 1; infinite where none
        moves."""
        self.scale = max((abs(each.value) for each in motion.moved), default=0.0)
        """The largest number that moves."""

    def __call__(self, step: float) -> Library:
        """The library after a change by `step`; raises SimulationError as `library_with` does."""
        return self._library.with_instance(self._variants.along(self._parameter, step)[0])


def library_along(library: Library, parameter: str) -> Moved:
    """The functions of a library with numbers that move with a parameter from its value there."""
    own = {each["name"]: each["value"] for each in library.manifest.instance["parameters"]}
    return Moved(library, _variants_of(library, own), parameter)


def _variants_of(library: Library, own: Values) -> _Variants:
    variants = _VARIANTS.get(library)
    if variants is None:
        variants = _VARIANTS[library] = _Variants(library, own)
    return variants


class _Variants:
    """Instances of the scene of a library with other values of its parameters, over the same kinds."""

    def __init__(self, library: Library, own: Values) -> None:
        instance = library.manifest.instance
        origin = instance["origin"]
        if origin is None:
            raise changed_scene()
        self.kept: OrderedDict[tuple[float, ...], Library] = OrderedDict()
        self._own, self._parameters, self._origin = own, instance["parameters"], origin
        self._scales = Scales(**instance["scales"])
        self._reader = SceneReader(instance["name"], instance["source"], Origin(**origin))
        self._model = require(self._reader.scene(own), self._scales)
        self._instance = instance_of(self._model)
        if kinds_of(self._model) != library.manifest.kinds:
            found = "its scene, read again, needs other kinds"
            raise LibraryError(str(library.path), found, "", "it is stale: build again")

    def instance(self, values: Values) -> Json:
        """The instance with these values of all parameters; raises SimulationError."""
        try:
            found, change = self._read(values)
        except SceneError as error:
            raise _refused(f"parameters: {self._told(values, self._changed(values))}", error) from None
        if change:
            raise self._other_structure(values, change)
        parameters = [{**each, "value": values[each["name"]]} for each in self._parameters]
        return found | {"parameters": parameters, "origin": self._origin}

    def along(self, parameter: str, step: float) -> tuple[Json, Motion]:
        """The instance with numbers that have moved along a parameter, and that motion; raises
        SimulationError."""
        try:
            scene, motion = self._reader.scene_along(self._own, parameter, step)
            found, change = self._instance_of(scene)
        except SceneError as error:
            raise _refused(f"parameters: {parameter}", error) from None
        if change:
            remedy = "differentiate where a small change keeps the structure"
            raise SimulationError(f"parameters: {parameter}", f"another structure ({change})", "", remedy)
        return found | {"parameters": self._parameters, "origin": self._origin}, motion

    def _read(self, values: Values) -> tuple[Json, str]:
        """The instance with these values, and what differs other than in numbers, in words."""
        return self._instance_of(self._reader.scene(values))

    def _instance_of(self, scene: Scene) -> tuple[Json, str]:
        model = require(scene, self._scales, self._model)
        instance = instance_of(model, (self._model, self._instance))
        return instance, next(self._changes(model, instance), "")

    def _changes(self, model: Model, instance: Json) -> Iterator[str]:
        for group in KINDS:
            before, after = (getattr(each, f"{group}_kinds") for each in (self._model, model))
            if before != after:
                lost = [kind.name for kind in before if kind not in after]
                new = [kind.name for kind in after if kind not in before]
                same = lost == new  # in name
                told = (
                    f"numbers in {_listed(lost)}" if same else f"{_listed(new)} in place of {_listed(lost)}"
                )
                yield f"kinds of {group}: {told}"
        if not same_but_for_numbers(self._instance, instance):
            yield from differences(self._instance, instance)

    def _other_structure(self, values: Values, change: str) -> SimulationError:
        """The error of values that need another library; it names the parameters that do so."""
        blamed = self._blamed(values)
        return SimulationError(
            f"parameters: {self._told(values, blamed)}",
            f"another structure ({change})",
            f"only numbers may differ from those of the library, built at {self._told(self._own, blamed)}",
            "write the value into the scene and build that",
        )

    def _blamed(self, values: Values) -> list[str]:
        """Of the values, those without which the structure stays; else those with which alone it does not."""
        changed = self._changed(values)
        needed = [name for name in changed if not self._differs({**values, name: self._own[name]})]
        return needed or [n for n in changed if self._differs({**self._own, n: values[n]})] or changed

    def _differs(self, values: Values) -> bool:
        try:
            return self._read(values)[1] != ""
        except SceneError:
            return True

    def _changed(self, values: Values) -> list[str]:
        return [name for name, value in values.items() if value != self._own[name]]

    @staticmethod
    def _told(values: Values, names: Iterable[str]) -> str:
        return ", ".join(f"{name} = {values[name]:.9g}" for name in names)


def _refused(where: str, error: SceneError) -> SimulationError:
    remedy = error.remedy or "choose another value"
    return SimulationError(where, f"refused by {error.where}: {error.found}", error.allowed, remedy)


def _listed(names: Iterable[str]) -> str:
    return ", ".join(names) or "none"


_VARIANTS: WeakKeyDictionary[Library, _Variants] = WeakKeyDictionary()


LISTS = (list, tuple, RepeatedEntries)


def same_but_for_numbers(before: Any, after: Any) -> bool:
    """Whether `differences` finds none; equal parts are passed over at once."""
    if before == after or (isinstance(before, float) and isinstance(after, float)):
        return True
    if isinstance(before, dict) and isinstance(after, dict) and before.keys() == after.keys():
        return all(key in FREE or same_but_for_numbers(each, after[key]) for key, each in before.items())
    if isinstance(before, LISTS) and isinstance(after, LISTS) and len(before) == len(after):
        return all(same_but_for_numbers(one, two) for one, two in zip(before, after, strict=True))
    return False


def differences(before: Any, after: Any, path: str = "") -> Iterator[str]:
    """Where two instances differ in more than the values of their numbers, in words."""
    if before == after or (isinstance(before, float) and isinstance(after, float)):
        return
    if isinstance(before, dict) and isinstance(after, dict) and before.keys() == after.keys():
        for key, each in before.items():
            if key not in FREE:
                yield from differences(each, after[key], f"{path}.{key}" if path else key)
    elif isinstance(before, LISTS) and isinstance(after, LISTS):
        if len(before) != len(after):
            yield f"{path}: {len(after)} in place of {len(before)}"
            return
        for index, (one, two) in enumerate(zip(before, after, strict=True)):
            yield from differences(one, two, f"{path}[{index}]")
    else:
        yield f"{path}: {after!r} in place of {before!r}"
