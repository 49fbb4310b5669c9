"""What the running half knows of the generated code, and what it knows of one build. Plain JSON, no symbols.

The manifest is the same on every machine and is committed; the record of a build is not.
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict, dataclass, fields
from typing import Any, TypeVar

from modelgen.errors import LibraryError

FEET = {"plane": 1, "sphere": 2}  # MG_FLAT, MG_ROUND: shapes that know their point nearest to another
Json = dict[str, Any]
Record = TypeVar("Record", "Manifest", "BuildRecord")


@dataclass(frozen=True, slots=True)
class Manifest:
    """Names, shapes, units, sources and counts of the functions; the kinds; the sentence over them.

    `functions[name]` = {inputs: [{name, shape, unit}], outputs: [...], instructions, citation}.
    `composed[name]` = the same of a function that is derived and counted, but not compiled.
    `kinds` = {body, contact, load, shape: [...]} in the order of their indices.
    `sentence` = the scene as tables: bodies, contacts, loads, sizes, scales, initial state, gravity, run.
    """

    abi: int
    functions: Json
    composed: Json
    kinds: Json
    sentence: Json

    def to_json(self) -> str:
        """JSON text with sorted keys, the same for equal manifests."""
        return _written(self)

    @classmethod
    def from_json(cls, text: str, source: str = "manifest") -> Manifest:
        """The manifest in `text`; raises LibraryError if it is none."""
        return _read(cls, text, source)

    @property
    def name(self) -> str:
        """The scene's name."""
        return str(self.sentence["name"])

    @property
    def vocabulary(self) -> str:
        """SHA-256 (hex) of what a library must agree with: ABI, functions and kinds, not the sentence."""
        text = json.dumps([self.abi, self.functions, self.kinds], sort_keys=True, allow_nan=False)
        return hashlib.sha256(text.encode()).hexdigest()


@dataclass(frozen=True, slots=True)
class BuildRecord:
    """One build of a manifest's vocabulary on one machine."""

    hash: str  # of text, flags, compiler, CPU target, ABI
    real: str  # double, float or long double
    file: str  # name of the library
    vocabulary: str  # of the manifest that it was built for
    versions: Json  # of the tools that made text and library

    def to_json(self) -> str:
        """JSON text with sorted keys."""
        return _written(self)

    @classmethod
    def from_json(cls, text: str, source: str = "build record") -> BuildRecord:
        """The record in `text`; raises LibraryError if it is none."""
        return _read(cls, text, source)


def record_name(real: str) -> str:
    """File name of the record of a library over one real type: library.json, library-long-double.json."""
    return "library.json" if real == "double" else f"library-{real.replace(' ', '-')}.json"


def _written(record: Manifest | BuildRecord) -> str:
    return json.dumps(asdict(record), sort_keys=True, indent=1, allow_nan=False) + "\n"


def _read(cls: type[Record], text: str, source: str) -> Record:
    try:
        values = json.loads(text)
    except json.JSONDecodeError as error:
        raise LibraryError(source, f"it is not JSON: {error}", "", "build again") from None
    names = {item.name for item in fields(cls)}
    if not isinstance(values, dict) or values.keys() != names:
        found = f"it is not a {cls.__name__} of this version"
        raise LibraryError(source, found, f"keys {sorted(names)}", "build again")
    return cls(**values)
