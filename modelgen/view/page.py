"""The page that plays a run: player.html with the data of the run put in."""

from __future__ import annotations

import json
from collections.abc import Mapping
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any

from modelgen.assembly import require
from modelgen.file_writing import write_file
from modelgen.model import Model
from modelgen.report.run_record import Record
from modelgen.view.page_data import page_data

TOLERANCE = 4e-3  # of the meshes, as a part of the size of a shape
PLACE, RUN_PLACE = "/*DATA*/null", "/*RUN*/"


@cache
def _part(name: str) -> str:
    return resources.files("modelgen.view").joinpath(name).read_text(encoding="utf-8")


def page_text(
    record: Record,
    model: Model | None = None,
    tolerance: float = TOLERANCE,
    plots: tuple[str, ...] | None = None,
) -> str:
    """The text of a page. It loads nothing, from no network.

    Args:
        record: what `record_of(trajectory, library, scene)` or `load` returned.
        model: what `require` made of its scene; of the scene that the record holds where None.
        tolerance: of the meshes, as a part of the size of each shape.
        plots: titles of the plots that are open at first; those that suit the run where None.

    Raises:
        ModelgenError: no model is given and the record holds no scene, or a plot is unknown.
    """
    model = require(record.scene_again("view")) if model is None else model
    return _filled(page_data(record, model, tolerance, plots), "")


def running_page_text(page: Mapping[str, Any], run: Mapping[str, Any]) -> str:
    """The text of a page that computes its run. It loads nothing, from no network.

    Args:
        page: what `self_running_page_data` returned.
        run: what run_in_page.js takes as `data.run`.
    """
    return _filled({**page, "run": run}, f"<script>\n{_part('run_in_page.js')}</script>")


def _filled(data: Mapping[str, Any], script: str) -> str:
    text = json.dumps(data, separators=(",", ":"), allow_nan=False).replace("</", "<\\/")
    return _part("player.html").replace(PLACE, text).replace(RUN_PLACE, script)


def write_page(
    record: Record,
    path: Path,
    model: Model | None = None,
    tolerance: float = TOLERANCE,
    plots: tuple[str, ...] | None = None,
) -> None:
    """Write the page of a run; arguments and errors as of `page_text`."""
    write_file(path, page_text(record, model, tolerance, plots))
