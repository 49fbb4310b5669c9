"""The scene of a run, kept with it as plain tables, so that a file of a run can be drawn and explained."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from modelgen.errors import ModelgenError
from modelgen.scene.parameter_rereading import SceneReader
from modelgen.scene.scene_types import Origin, Scene

if TYPE_CHECKING:
    from modelgen.codegen.library import Library


def kept_scene(scene: Scene | None, library: Library) -> dict[str, Any] | None:
    """What is kept of a scene: name, source, tables and forced form. Where it is not given, that of a library
    whose manifest has it; None of a scene that was changed since its tables were read."""
    instance = library.manifest.instance
    if scene is None:
        origin = instance.get("origin")
        return origin and {"name": instance["name"], "source": instance["source"], **origin}
    origin = scene.origin
    if origin is None:
        return None
    values = {each.name: each.value for each in scene.parameters}
    again = SceneReader(scene.name, scene.source, origin).scene(values)
    if again != replace(scene, nominal=None):
        return None
    return {"name": scene.name, "source": scene.source, "tables": dict(origin.tables), "form": origin.form}


def read_again(kept: Mapping[str, Any] | None, parameters: Mapping[str, float], what: str) -> Scene:
    """The scene of a run with the values of its parameters; raises ModelgenError where `kept` is None, for
    `what` is wanted of it."""
    if kept is None:
        raise ModelgenError(
            what,
            "the run does not hold its scene",
            "one that `modelgen simulate SCENE --out run.npz` or record_of(trajectory, library, scene) made",
            "make it so, or name the scene file",
        )
    origin = Origin(kept["tables"], kept["form"])
    return SceneReader(kept["name"], kept["source"], origin).scene(parameters)
