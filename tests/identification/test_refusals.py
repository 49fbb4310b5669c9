"""What `fit` refuses, with the place and the remedy; and what the command prints, draws and returns."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner
from jsonschema import Draft202012Validator

from modelgen import fit
from modelgen.cli.command_group import app
from modelgen.errors import SimulationError
from modelgen.identification.recording_files import read_recording
from modelgen.report.fit_output import fit_facts, fitted_schema
from tests.identification.motions import BOUNCE, MOTIONS

HEAD = "t,ball.position_x,ball.position_z\n"
ROWS = "0.0,0.0,0.35\n0.1,0.1,0.301\n0.2,0.2,0.154\n"


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "the file is empty"),
        ("# a comment\n\n", "the file is empty"),
        (HEAD, "names, but no rows"),
        ("t,ball.positon_x\n0,1\n", "did you mean 'ball.position_x'?"),
        ("time,ball.position_x\n0,1\n", "no column 't'"),
        ("t\n0\n1\n", "only times"),
        ("t,ball.position_x,ball.position_x\n0,1,1\n", "twice"),
        ("t,,ball.position_x\n0,1,1\n", "a column without a name"),
        (HEAD.replace(",", ";") + "0;0,5;1,5\n", "columns apart by ';'; commas between columns"),
        (HEAD + "0,0\n", "line 2: 2 cells; 3, as there are names"),
        (HEAD + "0,0,0.35\n0.1,x,0.3\n", "line 3, column 'ball.position_x': 'x'"),
        (HEAD + "0,0,0.35\n0.1,nan,0.3\n", "leave a cell empty"),
        (HEAD + "0,0,0.35\n0.1,inf,0.3\n", "a finite number"),
        (HEAD + "0,0,0.35\n0.2,0.1,0.3\n0.2,0.2,0.1\n", "ascending times; sort the rows by t"),
        (HEAD + "0,0,0.35\n,0.1,0.3\n", "a finite time"),
        (HEAD + "-1,0,0.35\n0.2,0.1,0.3\n", "from 0 s, the start of the run, on; subtract the first"),
        (HEAD + "0,,0.35\n0.1,,0.3\n", "ball.position_x: nothing was measured"),
        ("t,ball.position_x\n0,\n0.1,0.1\n", "1 measured numbers for 2 unknowns"),
        ("t,ball.orientation_w\n0,1\n1,1\n", "all four of an orientation"),
        ("# start ball.spin = 1\n" + HEAD + ROWS, "did you mean"),
        ("# start ball.velocity = 1, 2\n" + HEAD + ROWS, "3 finite numbers"),
        ("# start ball.velocity = 1, a, 2\n" + HEAD + ROWS, "line 1, start of ball.velocity: 'a'"),
    ],
)
def test_a_file_is_refused(text: str, told: str, tmp_path: Path) -> None:
    path = tmp_path / "data.csv"
    path.write_text(text)
    with pytest.raises(SimulationError) as refused:
        fit(MOTIONS["bounce"].library, path, by=["friction", "restitution"])
    assert told in str(refused.value)


@pytest.mark.parametrize(
    ("options", "told"),
    [
        ({"by": []}, "nothing to fit"),
        ({"by": "friction"}, 'write by=["friction"]'),
        ({"by": ["frcition"]}, "did you mean 'friction'?"),
        ({"by": ["friction", "friction"]}, "twice"),
        ({"by": ["ball.velocity", "ball.velocity_x"]}, "twice"),
        ({"by": ["floor.position"]}, "known:"),
        ({"noise": {"ball.positon": 1.0}}, "did you mean 'ball.position'?"),
        ({"noise": {"ball.position": 0.0}}, "a positive number"),
        ({"loss": "l1"}, "linear, soft_l1, huber, cauchy"),
        ({"starts": 0}, "a whole number, at least 1"),
        ({"start": ["floor"]}, "bodies that move freely: ball"),
        ({"parameters": {"restitution": 2.0}}, "restitution"),
        ({"losss": "huber"}, "unknown keyword 'losss'"),
        ({"of": ["ball.positon"]}, "did you mean"),
    ],
)
def test_arguments_are_refused(options: dict[str, Any], told: str) -> None:
    motion = MOTIONS["bounce"]
    with pytest.raises(SimulationError) as refused:
        fit(motion.library, motion.recording(), **{"by": ["friction"], **options})
    assert told in str(refused.value)


@pytest.mark.parametrize(
    ("columns", "told"),
    [
        ([], "no recordings"),
        ([3], "a int"),
        ({"t": [0.0, 1.0], "ball.position_x": [0.0, np.nan]}, "row 2: nan"),
        ({"t": [0.0, 1.0], "ball.position_x": [0.0]}, "2 rows, as t has"),
        ({"t": [0.5, 1.0], "ball.position": np.zeros((2, 3))}, "first measured at 0.5 s"),
    ],
)
def test_columns_are_refused(columns: Any, told: str) -> None:
    with pytest.raises(SimulationError) as refused:
        fit(MOTIONS["bounce"].library, columns, by=["friction"], start=["ball"])
    assert told in str(refused.value)


def test_a_library_without_derivatives_is_refused() -> None:
    from tests.running import scene_of

    with pytest.raises(SimulationError, match="derivatives"):
        fit(scene_of("bouncing_ball"), {"t": [0, 1], "ball.position": np.zeros((2, 3))}, by=["ball.velocity"])


def test_a_file_is_read_as_it_says(tmp_path: Path) -> None:
    path = tmp_path / "data.csv"
    path.write_text("# measured\n# start ball.velocity = 1.0, 0.5, 0.0\n" + HEAD + "0,0,0.35\n\n0.1,,0.3\n")
    found = read_recording(path)
    assert found.columns == ("ball.position_x", "ball.position_z")
    assert found.t.tolist() == [0.0, 0.1]
    assert np.isnan(found.values[1, 0])
    assert found.values[:, 1].tolist() == [0.35, 0.3]
    assert found.start["ball.velocity"].tolist() == [1.0, 0.5, 0.0]


def test_columns_that_do_not_count_are_not_read(tmp_path: Path) -> None:
    path = tmp_path / "data.csv"
    path.write_text("t,ball.position_x,other,ball.position_z\n0,0,nan,1\n1,0,x,2\n")
    found = read_recording(path, ["ball.position"])
    assert found.columns == ("ball.position_x", "ball.position_z")
    assert found.values.tolist() == [[0.0, 1.0], [0.0, 2.0]]
    assert read_recording(path, ["ball.position_z"]).columns == ("ball.position_z",)


@pytest.fixture
def workplace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with the scene and a recording of it."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "ball.toml").write_text(BOUNCE)
    columns = MOTIONS["bounce"].recording(7)
    rows = np.stack(list(columns.values()), axis=1)
    np.savetxt(tmp_path / "ball.csv", rows, delimiter=",", header=",".join(columns), comments="")
    return tmp_path


def test_the_command_fits_draws_and_prints(workplace: Path) -> None:
    line = ["fit", "ball.toml", "ball.csv", "--by", "friction,restitution"]
    options = ["--set", "restitution=0.5", "--noise", "ball.position=2e-3", "--plot", "left.svg"]
    result = CliRunner().invoke(app, [*line, *options])
    assert result.exit_code == 0, result.output
    assert "restitution  0.7" in result.stdout or "restitution  0.69" in result.stdout
    assert "<svg" in (workplace / "left.svg").read_text()
    refused = CliRunner().invoke(app, ["fit", "ball.toml", "nowhere.csv", "--by", "friction"])
    assert refused.exit_code == 2
    assert "nowhere.csv: no such file" in refused.stderr
    wrong = CliRunner().invoke(app, ["fit", "ball.toml", "ball.csv", "--by", "frict"])
    assert wrong.exit_code == 2
    assert "did you mean 'friction'?" in wrong.stderr
    assert "Traceback" not in wrong.output


def test_facts_are_those_of_the_schema() -> None:
    motion = MOTIONS["bounce"]
    found = fit(motion.library, motion.recording(1), by=["restitution"], starts=2)
    facts = json.loads(json.dumps(fit_facts(found) | {"plot": None}))
    Draft202012Validator(fitted_schema()).validate(facts)
    assert facts["unknowns"][0]["value"] == found["restitution"]
