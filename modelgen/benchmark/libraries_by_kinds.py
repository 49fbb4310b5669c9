"""Libraries by kinds: scenes that differ in numbers alone share one, which is derived and built once."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from modelgen.assembly import require
from modelgen.codegen.build import build
from modelgen.codegen.emit import emit
from modelgen.codegen.library import Library
from modelgen.codegen.manifest_model import instance_of, kinds_of
from modelgen.derivation import derive
from modelgen.model import Model
from modelgen.scene.scene_types import Scene

KINDS = ("shape_kinds", "body_kinds", "contact_kinds", "load_kinds", "joint_kinds", "limit_kinds")


@dataclass
class LibrariesByKinds:
    """Libraries built so far, by set of kinds and real type, in folders under `root`."""

    root: Path
    _built: dict[tuple[Any, ...], Library] = field(default_factory=dict)

    def library(self, scene: Scene, real: str = "double") -> Library:
        """The library of a scene. Raises what `require` and `build` raise."""
        model = require(scene)
        key = (real, *(getattr(model, name) for name in KINDS))
        if key not in self._built:
            self._built[key] = build(emit(derive(model)), real=real, folder=self.root / scene.name)
            return self._built[key]
        return _with_numbers(self._built[key], model)


def _with_numbers(library: Library, model: Model) -> Library:
    manifest = replace(library.manifest, kinds=kinds_of(model), instance=instance_of(model))
    return Library(manifest, library.record, library.path.parent)
