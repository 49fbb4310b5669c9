"""A run kept in a file is the run; its contact curves live on the bodies."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest

from modelgen import draw, record_of, simulate
from modelgen.errors import ModelgenError
from modelgen.report.run_files import load, save
from modelgen.report.run_record import COLUMNS, rotate_inverse
from modelgen.scene.python_scenes import dynamic, fixed, plane, scene, sphere
from tests.mutants import mutants
from tests.running import library_of

from .runs import ball_on_table


def test_npz_gives_back_what_was_saved(tmp_path: Path) -> None:
    record = ball_on_table()
    save(record, tmp_path / "run.npz")
    again = load(tmp_path / "run.npz")
    for name in COLUMNS:
        np.testing.assert_array_equal(again.columns[name], record.columns[name])
    np.testing.assert_array_equal(again.meshes["0_o"], record.meshes["0_o"])
    np.testing.assert_array_equal(again.pairs, record.pairs)
    assert (again.body_names, again.contact_names) == (record.body_names, record.contact_names)
    assert again.summary == record.summary


def test_csv_has_one_exact_row_a_sample(tmp_path: Path) -> None:
    record = ball_on_table()
    save(record, tmp_path / "run.csv")
    with (tmp_path / "run.csv").open(newline="") as file:
        header, *rows = csv.reader(file)
    table = np.array(rows, dtype=float)
    assert len(set(header)) == len(header) == table.shape[1]
    for name, column in {
        "t": record.columns["t"],
        "ball.p_y": record.columns["p"][:, 1, 1],
        "ball.quaternion_x": record.columns["quaternion"][:, 1, 1],
        "ball-table.force": record.columns["force"][:, 0],
        "energy": record.columns["energy"],
    }.items():
        np.testing.assert_array_equal(table[:, header.index(name)], column)


def test_turning_that_nobody_observes_is_not_told(tmp_path: Path) -> None:
    spinning = {"density": 1.0, "position": [0.0, 0.0, 0.1], "angular_velocity": [0.0, 0.0, 3.0]}
    bodies = [fixed("table", plane()), dynamic("ball", sphere(0.1), **spinning)]
    made = scene("seen", bodies, contact=[{"between": ["ball", "table"]}], observe=["ball.position"])
    library = library_of(made)
    path = simulate(library, until=0.1, samples=2)
    record = record_of(path, library)
    assert np.isnan(path.quaternion[:, 1]).all()
    assert path.estimate is not None
    assert "rad" not in path.estimate.statement
    save(record, tmp_path / "run.csv")
    header = (tmp_path / "run.csv").read_text(encoding="utf-8").splitlines()[0].split(",")
    assert {"table.w_x", "ball.v_x"} <= set(header)
    assert not {"ball.w_x", "ball.quaternion_w"} & set(header)
    draw(record, tmp_path / "run.png")
    draw(record, tmp_path / "frames.png", frames=2)


def test_csv_has_friction_and_slip_where_there_are_any(tmp_path: Path) -> None:
    record = ball_on_table()
    record.columns["friction"][:5, 0, 1] = -2.0
    save(record, tmp_path / "run.csv")
    with (tmp_path / "run.csv").open(newline="") as file:
        header, *rows = csv.reader(file)
    friction = np.array(rows, dtype=float)[:, header.index("ball-table.friction_y")]
    np.testing.assert_array_equal(friction, record.columns["friction"][:, 0, 1])
    assert {"ball-table.slip_x", "ball-table.torque_z"} <= set(header)


def test_contact_curve_is_in_the_axes_of_the_body() -> None:
    record = ball_on_table()
    np.testing.assert_allclose(record.contact_curve(0, "o"), record.columns["points_o"][:, 0])
    lowest = np.tile(
        [0.0, -0.1, 0.0], (len(record.columns["t"]), 1)
    )  # a quarter turn about x: world -z is body -y
    np.testing.assert_allclose(record.contact_curve(0, "f"), lowest, atol=1e-15)


def test_rotation_by_a_quarter_turn() -> None:
    quarter = np.sqrt(0.5) * np.array([[1.0, 0.0, 0.0, 1.0]])
    np.testing.assert_allclose(
        rotate_inverse(quarter, np.array([[0.0, 1.0, 0.0]])), [[1.0, 0.0, 0.0]], atol=1e-15
    )


def test_bodies_that_rest_do_not_count_as_moving() -> None:
    assert ball_on_table().moving == [1]


@pytest.mark.parametrize("content", [b"", b"not a zip", json.dumps({"t": 1}).encode()])
def test_a_file_that_is_no_run_is_refused(content: bytes, tmp_path: Path) -> None:
    path = tmp_path / "run.npz"
    path.write_bytes(content)
    with pytest.raises(ModelgenError, match=r"run\.npz: not a run of modelgen"):
        load(path)


def test_arrays_of_another_program_are_refused(tmp_path: Path) -> None:
    np.savez(tmp_path / "run.npz", t=np.zeros(3))
    with pytest.raises(ModelgenError, match="not a run of modelgen"):
        load(tmp_path / "run.npz")


def test_no_damaged_run_is_read(tmp_path: Path) -> None:
    """Or it holds what was written: of a zip file some bytes say nothing."""
    path = tmp_path / "run.npz"
    save(ball_on_table(), path)
    whole, read = path.read_bytes(), load(path)
    for mutant in mutants(whole, 300):
        path.write_bytes(mutant)
        try:
            found = load(path)
        except ModelgenError as error:
            assert "not a run of modelgen, or damaged" in str(error)  # noqa: PT017
            continue
        assert found.summary == read.summary
        for name, column in read.columns.items():
            np.testing.assert_array_equal(found.columns[name], column)


def test_what_a_csv_file_lacks_is_said(tmp_path: Path) -> None:
    save(ball_on_table(), tmp_path / "run.csv")
    with pytest.raises(ModelgenError, match=r"neither the contact points nor the surfaces .* --out run\.npz"):
        load(tmp_path / "run.csv")


def test_a_run_has_a_known_suffix(tmp_path: Path) -> None:
    with pytest.raises(ModelgenError, match=r"run\.xls: no known format '\.xls'; allowed are \.npz, \.csv"):
        save(ball_on_table(), tmp_path / "run.xls")
    assert list(tmp_path.iterdir()) == []


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(ModelgenError, match=r"away\.npz: no such file"):
        load(tmp_path / "away.npz")
