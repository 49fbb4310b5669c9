"""A body of faces, edges and vertices on the command line, from check to picture."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from jsonschema import Draft202012Validator

from modelgen.report.run_files import load

BOX = "scenes/box_dropped.toml"
CORNERS = {
    f"{z}_{y}_{x}" for z in ("bottom", "top") for y in ("front", "back") for x in ("left", "right")
}  # fmt: skip
Modelgen = Callable[..., Any]


def test_check_lists_each_pair_of_features(modelgen: Modelgen) -> None:
    facts = modelgen("check", BOX, "--json").json
    assert {contact["name"] for contact in facts["contacts"]} == {f"box-table:{name}" for name in CORNERS}
    assert {contact["kind"] for contact in facts["contacts"]} == {"plane_point_explicit"}
    assert facts["states"]["eta"] == 0
    text = modelgen("check", BOX).out
    assert "plane_point_explicit" in text
    assert "and 5 more" in text


def test_build_makes_one_kernel_for_all_corners(modelgen: Modelgen) -> None:
    counts = modelgen("build", BOX, "--json").json["instructions"]
    assert [name for name in counts if name.endswith("_rates")] == ["mg_plane_point_explicit_rates"]


def test_simulate_names_the_features_that_touch(modelgen: Modelgen, tmp_path: Path) -> None:
    npz, picture = tmp_path / "box.npz", tmp_path / "box.svg"
    summary = modelgen("simulate", BOX, "--samples", 30, "--out", npz, "--plot", picture, "--json").json
    Draft202012Validator(modelgen("schema").json["$defs"]["result"]).validate(summary)
    assert summary["outcome"] == "done"
    assert {event["features"] for event in summary["events"] if event["kind"] != "face-contact"} <= CORNERS
    assert [event["features"] for event in summary["events"] if event["kind"] == "face-contact"] == ["bottom"]
    assert summary["final"]["box"]["p"][2] == pytest.approx(0.03, abs=1e-9)
    record = load(npz)
    assert record.summary | {"out": str(npz), "plot": str(picture)} == summary
    assert record.columns["patch_force"][-1].sum() == pytest.approx(500 * 0.2 * 0.1 * 0.06 * 9.81, rel=1e-9)
    assert picture.read_text().lstrip().startswith("<?xml")


def test_people_read_which_feature_touches(modelgen: Modelgen) -> None:
    text = modelgen("simulate", BOX, "--samples", 5).out
    first = next(line for line in text.splitlines() if "touch-down" in line)
    assert "box-table:" in first


@pytest.mark.slow
def test_the_file_of_a_run_gives_its_picture(modelgen: Modelgen, tmp_path: Path) -> None:
    modelgen("simulate", "scenes/cylinder_dropped.toml", "--samples", 30, "--out", tmp_path / "can.npz")
    answer = modelgen("plot", tmp_path / "can.npz", "-o", tmp_path / "can.png", "--json")
    assert answer.json == {"file": str(tmp_path / "can.png"), "scene": "cylinder_dropped", "outcome": "done"}
    assert (tmp_path / "can.png").read_bytes().startswith(b"\x89PNG")


def test_a_spreadsheet_says_nan_where_a_contact_is_on_no_features(modelgen: Modelgen, tmp_path: Path) -> None:
    modelgen("simulate", "scenes/cylinder_dropped.toml", "--samples", 10, "--out", tmp_path / "can.csv")
    head, *rows = (tmp_path / "can.csv").read_text().splitlines()
    gaps = [k for k, name in enumerate(head.split(",")) if name.endswith(".gap")]
    cells = np.array([row.split(",") for row in rows])[:, gaps]
    assert cells.shape == (11, 8)
    assert (cells[0] == "nan").sum() == 6  # three points of each rim, which does not lie flat
