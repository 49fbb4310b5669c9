"""The manifest: everything that the running half knows of the generated code. Plain JSON, no symbols."""

from __future__ import annotations

import json
from dataclasses import dataclass, field, fields
from typing import Any

from modelgen.errors import LibraryError

Json = dict[str, Any]


@dataclass(frozen=True, slots=True)
class Manifest:
    """Names, shapes, units, sources and counts of the functions; the kinds; the sentence over them.

    `functions[name]` = {inputs: [{name, shape, unit}], outputs: [...], instructions, citation}.
    `kinds` = {body, contact, load, shape: [...]} in the order of their indices.
    `sentence` = the scene as tables: bodies, contacts, loads, sizes, scales, initial state, gravity, run.
    """

    abi: int
    functions: Json
    kinds: Json
    sentence: Json
    versions: Json = field(default_factory=dict)  # of the tools that made text and library
    hash: str = ""  # of text, flags, compiler, CPU target, ABI; empty until built
    real: str = ""  # double, float or long double; empty until built
    file: str = ""  # name of the library; empty until built

    def to_json(self) -> str:
        """JSON text with sorted keys, the same for equal manifests."""
        values = {item.name: getattr(self, item.name) for item in fields(self)}
        return json.dumps(values, sort_keys=True, indent=1, allow_nan=False) + "\n"

    @classmethod
    def from_json(cls, text: str, source: str = "manifest") -> Manifest:
        """The manifest in `text`; raises LibraryError if it is none."""
        try:
            values = json.loads(text)
        except json.JSONDecodeError as error:
            raise LibraryError(source, f"it is not JSON: {error}", "", "build again") from None
        names = {item.name for item in fields(cls)}
        if not isinstance(values, dict) or values.keys() != names:
            raise LibraryError(
                source, "it is not a manifest of this version", f"keys {sorted(names)}", "build again"
            )
        return cls(**values)

    @property
    def name(self) -> str:
        """The scene's name."""
        return str(self.sentence["name"])
