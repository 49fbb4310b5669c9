"""The picture of a run has every panel, and names the extra that it needs."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from modelgen.errors import ModelgenError
from modelgen.report.run_plot import _finish, draw, require_matplotlib
from modelgen.report.run_record import Record
from modelgen.report.snapshots import frame_samples

from .runs import ball_on_table

pytest.importorskip("matplotlib")


def comments(record: Record, path: Path) -> set[str]:
    """matplotlib writes each text of an SVG as a comment before its glyphs."""
    draw(record, path)
    parser = ElementTree.XMLParser(target=ElementTree.TreeBuilder(insert_comments=True))
    tree = ElementTree.parse(path, parser)
    return {node.text.strip() for node in tree.iter() if node.tag is ElementTree.Comment and node.text}


def test_svg_has_motion_forces_gap_energy_and_both_curves(tmp_path: Path) -> None:
    record = ball_on_table()
    shown = replace(record, meshes={**record.meshes, "0_f": record.meshes["0_o"]})
    texts = comments(shown, tmp_path / "run.svg")
    assert {"normal contact force", "gap", "position of the centre of mass"} <= texts
    assert "ring: done at t = 2 s, trusted, error not estimated" in texts
    assert {"ball-table: contact curve on table", "ball-table: contact curve on ball"} <= texts
    assert any(text.startswith("energy") for text in texts)
    assert {"E", "work", "E - E0 - work (right axis)"} <= texts


def test_friction_and_slip_are_drawn_where_there_are_any(tmp_path: Path) -> None:
    record = ball_on_table()
    assert not {"friction force", "slip"} & comments(record, tmp_path / "run.svg")
    record.columns["slip"][:5, 0, 1] = 0.3
    assert {"friction force", "slip"} <= comments(record, tmp_path / "run.svg")


def test_a_point_that_stays_on_its_body_is_not_drawn_as_a_curve(tmp_path: Path) -> None:
    texts = comments(ball_on_table(), tmp_path / "run.svg")
    assert "ball-table: contact curve on table" in texts
    assert "ball-table: contact curve on ball" not in texts


def test_frames_of_a_run_without_shapes_are_refused(tmp_path: Path) -> None:
    with pytest.raises(ModelgenError, match="no body of this run has a shape"):
        draw(replace(ball_on_table(), meshes={}), tmp_path / "run.png", frames=2)


@pytest.mark.parametrize(("changes", "second"), [([], 20), ([1e-4], 20), ([1e-4, 0.5], 10), ([0.03], 1)])
def test_the_second_picture_is_that_of_the_first_change_after_the_first(
    changes: list[float], second: int
) -> None:
    record = ball_on_table()
    record.summary["events"] = [{"t": t} for t in changes]
    assert frame_samples(record, 3) == [0, second, 40]


def test_a_legend_tells_how_many_lines_it_leaves_out() -> None:
    axes = require_matplotlib()().add_subplot()
    for k in range(24):
        axes.plot([0, 1], [k, k], label=str(k))
    _finish(axes)
    named = [text.get_text() for text in axes.get_legend().get_texts()]
    assert named == [*(str(k) for k in range(19)), "and 5 more"]


def test_rounding_is_not_spread_over_a_panel() -> None:
    axes = require_matplotlib()().add_subplot()
    axes.plot([0, 1], [0.02, 0.02 + 1e-15])
    _finish(axes)
    low, high = axes.get_ylim()
    assert low < 0.019 < 0.021 < high


def test_png_is_a_picture(tmp_path: Path) -> None:
    draw(ball_on_table(), tmp_path / "run.png")
    assert (tmp_path / "run.png").read_bytes().startswith(b"\x89PNG")


def test_a_run_without_samples_or_contacts_is_drawn(tmp_path: Path) -> None:
    full = ball_on_table()
    empty = {name: column[:0] for name, column in full.columns.items()}
    draw(replace(full, columns=empty), tmp_path / "empty.png")
    free = {name: column[:, :0] if name in PER_CONTACT else column for name, column in full.columns.items()}
    texts = comments(
        replace(full, columns=free, contact_names=(), pairs=np.zeros((0, 2), int), meshes={}),
        tmp_path / "free.svg",
    )
    assert not any("contact curve" in text for text in texts)
    assert not {"normal contact force", "gap"} & texts
    assert "angular velocity, world axes" in texts


PER_CONTACT = ("force", "gap", "friction", "contact_torque", "slip", "points_o", "points_f", "normals")


def test_a_picture_has_a_known_suffix(tmp_path: Path) -> None:
    with pytest.raises(ModelgenError, match=r"run\.bmp: no known format '\.bmp'; allowed are \.png, \.svg"):
        draw(ball_on_table(), tmp_path / "run.bmp")


def test_missing_matplotlib_is_named_with_the_command(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    with pytest.raises(ModelgenError, match=r'pip install "modelgen-contact\[plot\]"'):
        require_matplotlib()
