"""What a page shows that computes its run itself: bodies, contacts and patches without samples."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from modelgen.assembly import require
from modelgen.model import Model
from modelgen.report.displayed_bodies import REACH, body_shape, not_fixed, stage_of
from modelgen.report.recorded_scene import read_again
from modelgen.report.resting_face_outlines import face_outlines
from modelgen.report.run_record import Record
from modelgen.view.page_data import contact_of, packed_mesh, patch_of, stage_data
from modelgen.view.plots import Shown, plots_to_come

if TYPE_CHECKING:
    from modelgen.codegen.library import Library

COARSE = 2e-2  # tolerance of the meshes of a slider, as a part of the size of each shape


def self_running_page_data(
    record: Record, model: Model, library: Library, tolerance: float
) -> dict[str, Any]:
    """The contents of a page, as `page_data` has them, less what the run gives.

    Args:
        record: a run of the scene, by which the picture is sized.
        model: what `require` made of its scene.
        library: what `build` returned.
        tolerance: of the meshes, as a part of the size of each shape.
    """
    moving, patches = sorted(not_fixed(model)), range(len(record.patch_names))
    record = replace(record, faces=face_outlines(library, patches))
    stage = stage_of(record, model, tolerance, may_move=True)
    has_friction = any(pair.friction for pair in model.pairs) or any(
        any(each.friction) for each in model.patches
    )
    shown = Shown(moving, range(len(record.pairs)), patches, has_friction)
    return {
        **stage_data(stage, model),
        "scene": record.summary["scene"],
        "outcome": "",
        "said": "",
        "t": "",
        "contacts": [{**contact_of(record, k, moving), "index": k} for k in shown.contacts],
        "patches": [{**patch_of(record, k, moving), "index": k} for k in patches],
        "events": [],
        "plots": plots_to_come(record, stage.size, shown, None),
    }


class Shapes:
    """Meshes of the bodies at the values of the sliders of a page.

    Attributes:
        meshes: by body, those that follow from parameters: one for each set of values.
    """

    def __init__(self, record: Record, page: Mapping[str, Any]) -> None:
        """`record`: a run of the scene; `page`: what `self_running_page_data` returned."""
        self._record = record
        self._reach = REACH * float(page["size"]) + float(np.linalg.norm(page["centre"]))
        self._found: list[list[dict[str, Any]]] = []

    def look(self, _: Library, values: Mapping[str, float]) -> None:
        """Make the meshes of a set of values."""
        scene = read_again(self._record.scene, {**self._record.summary["parameters"], **values}, "export")
        model = require(scene)
        meshes = [body_shape(model, index, self._reach, COARSE) for index in range(len(model.bodies))]
        self._found.append([packed_mesh(mesh) for mesh in meshes])

    @property
    def meshes(self) -> dict[int, list[dict[str, Any]]]:
        by_body = zip(*self._found, strict=True)
        return {k: list(every) for k, every in enumerate(by_body) if any(one != every[0] for one in every)}
