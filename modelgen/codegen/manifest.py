"""The manifest describes the generated code to the runtime; the build record describes one compilation. Plain
JSON.

A manifest is written as two files: its structure, which is the same on every machine and may be committed,
and its instance, the numbers of the scene, whose last digits depend on the machine. The record of a build is
a third.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable
from dataclasses import asdict, dataclass, fields
from typing import Any

from modelgen.codegen.manifest_repeated_pairs import with_repeats, without_repeats
from modelgen.errors import LibraryError

FEET = {
    "plane": 1,
    "sphere": 2,
}  # MG_NEAREST_PLANE, MG_NEAREST_SPHERE: shapes that know their point nearest to another
FLAT = ("plane", "edge", "point")  # shapes whose normals against each other follow from poses
SPINES = {
    "cylinder": 1,
    "line": 1,
    "torus": 2,
    "circle": 2,
    "sphere": 3,
}  # MG_SPINE_LINE ..: shapes at a constant distance from a line, a circle or a point


def have_spines(shapes: Iterable[str]) -> bool:
    """Whether closest points of these kinds of shapes follow from their spines in closed form; not of
    two spheres."""
    kinds = set(shapes)
    return kinds <= set(SPINES) and kinds != {"sphere"}


Json = dict[str, Any]
STRUCTURE, INSTANCE = "manifest.json", "instance.json"  # names of the files
WRITTEN = "instance_without_repeats"  # as a file has it


@dataclass(frozen=True, slots=True)
class Manifest:
    """Names, shapes, units, sources and counts of the functions; the kinds; the instance over them.

    `functions[name]` = {inputs: [{name, shape, unit}], outputs: [...], instructions, citation, unused}, the
    last being the poses, twists, or parts of them that no output depends on, if there are any.
    `composed[name]` = the same of a function that is derived and counted, but not compiled.
    `kinds` = {body, contact, load, shape: [...]} in the order of their indices.
    `instance` = the scene as tables: bodies, contacts, loads, sizes, scales, initial state, gravity, run.
    """

    abi: int
    functions: Json
    composed: Json
    kinds: Json
    instance: Json

    def structure_json(self) -> str:
        """JSON text of all but the instance, a line an entry, with a summary of the instance's tables."""
        parts = {
            "abi": self.abi,
            "composed": self.composed,
            "functions": self.functions,
            "kinds": self.kinds,
            "tables": _tables(self.instance),
        }
        return _lines(parts) + "\n"

    def instance_json(self) -> str:
        """JSON text of the instance, a line an entry, with the set of kinds that it is written in."""
        return _lines({WRITTEN: without_repeats(self.instance), "kinds_hash": self.kinds_hash}) + "\n"

    @classmethod
    def from_json(cls, structure: str, instance: str, source: str = "manifest") -> Manifest:
        """The manifest of both texts; raises LibraryError if they are none, or of different kinds."""
        values = _object(structure, ("abi", "composed", "functions", "kinds", "tables"), cls, source)
        spoken = _object(instance, (WRITTEN, "kinds_hash"), cls, f"{source}: its instance")
        del values["tables"]
        manifest = cls(**values, instance=with_repeats(spoken[WRITTEN]))
        if manifest.kinds_hash != spoken["kinds_hash"]:
            raise LibraryError(
                source, "its instance is of another set of kinds", "", "it is stale: build again"
            )
        return manifest

    @property
    def name(self) -> str:
        """The scene's name."""
        return str(self.instance["name"])

    @property
    def kinds_hash(self) -> str:
        """SHA-256 (hex) of what a library must agree with: ABI, functions and kinds, not the instance."""
        text = json.dumps([self.abi, self.functions, self.kinds], sort_keys=True, allow_nan=False)
        return hashlib.sha256(text.encode()).hexdigest()


@dataclass(frozen=True, slots=True)
class BuildRecord:
    """One build of a manifest's set of kinds on one machine."""

    hash: str  # of text, flags, compiler, CPU target, ABI
    source: str  # of the text alone, with real type and level
    cpu: str  # what the compiler took from the processor that the library was built for
    real: str  # double, float or long double
    file: str  # name of the library
    kinds_hash: str  # of the manifest that it was built for
    versions: Json  # of the tools that made text and library

    def to_json(self) -> str:
        """JSON text with sorted keys."""
        return json.dumps(asdict(self), sort_keys=True, indent=1, allow_nan=False) + "\n"

    @classmethod
    def from_json(cls, text: str, source: str = "build record") -> BuildRecord:
        """The record in `text`; raises LibraryError if it is none."""
        return cls(**_object(text, tuple(item.name for item in fields(cls)), cls, source))


def record_name(real: str) -> str:
    """File name of the record of a library over one real type: library.json, library-long-double.json."""
    return "library.json" if real == "double" else f"library-{real.replace(' ', '-')}.json"


def _tables(instance: Json) -> Json:
    """Summary of the instance's tables: bodies, pairs, feature pairs and contacts by name, without
    numbers."""
    bodies = [body["name"] for body in instance["bodies"]]
    return {
        "bodies": [{key: body[key] for key in ("name", "motion", "kind")} for body in instance["bodies"]],
        "joints": [
            {"name": joint["name"], "kind": joint["kind"], "bodies": [bodies[joint[s]] for s in "ab"]}
            for joint in instance["joints"]
        ],
        "loads": [
            {"kind": load["kind"], "bodies": [bodies[body] for body in load["bodies"]]}
            for load in instance["loads"]
        ],
        "pairs": [
            {
                "name": pair["name"],
                "feature_pairs": pair["feature_pairs"][1] - pair["feature_pairs"][0],
                "search": pair["search"],
            }
            for pair in instance["pairs"]
        ],
        "patches": [patch["name"] for patch in instance["patches"]],
        "sizes": {key: instance[key] for key in ("n_q", "n_u", "n_eta")},
    }


def _lines(value: Json) -> str:
    """JSON text with sorted keys; the two outer levels have a line per entry."""
    parts = []
    for key in sorted(value):
        entry = value[key]
        if isinstance(entry, dict) and any(isinstance(each, dict | list) for each in entry.values()):
            inner = ",\n".join(f"  {json.dumps(name)}: {_entries(entry[name])}" for name in sorted(entry))
            parts.append(f" {json.dumps(key)}: {{\n{inner}\n }}")
        else:
            parts.append(f" {json.dumps(key)}: {_line(entry)}")
    return "{\n" + ",\n".join(parts) + "\n}"


def _entries(value: Any) -> str:
    """A list of objects, a line each; anything else on one line."""
    if isinstance(value, list) and value and isinstance(value[0], dict):
        return "[\n" + ",\n".join(f"   {_line(entry)}" for entry in value) + "\n  ]"
    return _line(value)


_line = json.JSONEncoder(sort_keys=True, allow_nan=False).encode  # once, as there may be many lines


def _object(text: str, names: tuple[str, ...], cls: type, source: str) -> Json:
    """The JSON object in `text` with these keys; raises LibraryError if it is none."""
    try:
        values = json.loads(text)
    except json.JSONDecodeError as error:
        raise LibraryError(source, f"it is not JSON: {error}", "", "build again") from None
    if not isinstance(values, dict) or values.keys() != set(names):
        found = f"it is not a {cls.__name__} of this version"
        raise LibraryError(source, found, f"keys {sorted(names)}", "build again")
    return values
