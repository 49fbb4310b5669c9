"""The page that plays a run: player.html with the data of the run put in."""

from __future__ import annotations

import json
from functools import cache
from importlib import resources
from pathlib import Path

from modelgen.assembly import require
from modelgen.model import Model
from modelgen.report.run_record import Record
from modelgen.view.frames import page_data

TOLERANCE = 4e-3  # of the meshes, as a part of the size of a shape
PLACE = "/*DATA*/null"


@cache
def _player() -> str:
    return resources.files("modelgen.view").joinpath("player.html").read_text(encoding="utf-8")


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
    data = json.dumps(page_data(record, model, tolerance, plots), separators=(",", ":"), allow_nan=False)
    return _player().replace(PLACE, data.replace("</", "<\\/"))


def write_page(
    record: Record,
    path: Path,
    model: Model | None = None,
    tolerance: float = TOLERANCE,
    plots: tuple[str, ...] | None = None,
) -> None:
    """Write the page of a run; arguments and errors as of `page_text`."""
    path.write_text(page_text(record, model, tolerance, plots), encoding="utf-8")
