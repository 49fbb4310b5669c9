"""The pieces of JSON Schemas: an entry with its meaning, and an object whose entries are all there."""

from __future__ import annotations

from typing import Any

NUMBER = ["number", "null"]  # null: not finite, or none
TEXTS = {"type": "array", "items": {"type": "string"}}


def entry(kind: str | list[str], meaning: str, **more: Any) -> dict[str, Any]:
    """An entry of one type, or of several."""
    return {"type": kind, "description": meaning, **more}


def record(meaning: str, properties: dict[str, Any]) -> dict[str, Any]:
    """An object with these properties, each required, and no others."""
    return entry(
        "object", meaning, properties=properties, required=list(properties), additionalProperties=False
    )


def numbers(size: int, meaning: str) -> dict[str, Any]:
    """An array of `size` numbers."""
    return entry("array", meaning, items={"type": NUMBER}, minItems=size, maxItems=size)
