"""The page that plays a run: player.html with the data of the run put in."""

from __future__ import annotations

import json
from functools import cache
from importlib import resources
from pathlib import Path

from modelgen.model import Model
from modelgen.report.run_record import Record
from modelgen.view.frames import page_data

TOLERANCE = 4e-3  # of the meshes, as a part of the size of a shape
PLACE = "/*DATA*/null"


@cache
def _player() -> str:
    return resources.files("modelgen.view").joinpath("player.html").read_text(encoding="utf-8")


def page_text(record: Record, model: Model, tolerance: float = TOLERANCE) -> str:
    """The text of a page. It loads nothing, from no network."""
    data = json.dumps(page_data(record, model, tolerance), separators=(",", ":"))
    return _player().replace(PLACE, data.replace("</", "<\\/"))


def write_page(record: Record, model: Model, path: Path, tolerance: float = TOLERANCE) -> None:
    """Write the page of a run, what `record_of` returned, of the model of its scene."""
    path.write_text(page_text(record, model, tolerance), encoding="utf-8")
