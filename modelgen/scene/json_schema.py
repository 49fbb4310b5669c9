"""The JSON Schema of the scene format, from the tables that the reader uses."""

from __future__ import annotations

from typing import Any

from modelgen.scene.scene_format import DEFINED, SCENE


def scene_schema() -> dict[str, Any]:
    """JSON Schema (draft 2020-12) of a scene file, for validation and completion in editors."""
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "modelgen scene",
        "description": "Rigid bodies, their shapes, contacts and loads, in SI units.",
        **SCENE.schema(),
        "$defs": {each.name: each.type.schema() for each in DEFINED},
    }
