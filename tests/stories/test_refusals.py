"""Bad input: one clear message, exit 2, nothing written. A run that ends early keeps what it has."""

from __future__ import annotations

import errno
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from modelgen.report.run_files import load
from modelgen.runtime.core_session import Session

EGG = "scenes/ellipsoid_on_plane.toml"
Modelgen = Callable[..., Any]
TIP = """{ kind = "chart", x = "u*cos(v)", y = "u*sin(v)", z = "u*(2 - u)", domain = [[0, 1], [0, "2*pi"]],
    periodic = [false, true], poles = ["u_min"] }""".replace("\n", "")

SUNK = """
[[body]]
name = "table"
motion = "fixed"
shape = { kind = "plane" }

[[body]]
name = "ball"
density = 1000.0
position = [0.0, 0.0, 0.05]
shape = { kind = "sphere", radius = 0.1 }

[[contact]]
between = ["ball", "table"]
"""


def files(folder: Path) -> set[Path]:
    return set(folder.rglob("*"))


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("simulate", "scenes/nowhere.toml"), "no such file"),
        (("check", "broken.toml"), "not TOML"),
        (("simulate", "typo.toml"), "did you mean"),
        (
            ("simulate", "sunk.toml"),
            "sunk.toml: contact[0] (contact 'ball-table'): the bodies interpenetrate",
        ),
        (("simulate", "tip.toml"), "tip.toml: body[1].shape (shape 'chart', pole u_min): the surface is not"),
        (("simulate", EGG, "--out", "run.xls"), ".npz, .csv"),
        (("simulate", EGG, "--plot", "run.bmp"), ".png, .svg"),
        (("simulate", EGG, "--out", "no/where/run.npz"), "no folder"),
        (("simulate", EGG, "--out", "folder.npz"), "folder.npz: it is a folder; a file; name one"),
        (
            ("simulate", EGG, "--plot", "folder.npz/folder.png"),
            "folder.png: it is a folder; a file; name one",
        ),
        (("simulate", EGG, "--out", "/proc/run.npz"), "/proc/run.npz: cannot be written: "),
        (("inspect", EGG, "--out", "folder.npz"), "it is a folder"),
        (("inspect", EGG, "--at", "none.json"), "--at: none.json: it cannot be read: No such file"),
        (
            ("build", EGG, "--out", "sunk.toml"),
            "sunk.toml: 'sunk.toml' is a file; a folder for the generated",
        ),
        (("build", EGG, "--out", "sunk.toml/a/b"), "sunk.toml' is a file; a folder for the generated"),
        (("check", "folder.npz/folder.png"), "folder.npz/folder.png: it is a folder; a scene is a TOML file"),
        (("simulate", EGG, "--until", "-1"), "--until: the number -1; a positive number"),
        (("simulate", EGG, "--until", "soon"), "--until: in 'soon'"),
        (("simulate", EGG, "--samples", "0"), "--samples: the number 0; a whole number from 1"),
        (("simulate", EGG, "--samples", "1.5"), "--samples: the number 1.5"),
        (("simulate", EGG, "--tolerance", "7"), "--tolerance: the number 7; a number from 1e-18 to 0.01"),
        (("simulate", "loose.toml"), "loose.toml: run.tolerance"),
        (
            ("simulate", EGG, "--accuracy", "nonsense"),
            "--accuracy: the text 'nonsense'; allowed are coarse, fast",
        ),
        (("simulate", EGG, "--accuracy", "tigt"), "did you mean 'tight'?"),
        (("check", EGG, "--form", "suport"), "did you mean 'support'?"),
        (("build", EGG, "--real", "half"), "--real: the text 'half'; allowed are double"),
        (("build", EGG, "--main", "run.c"), "write: modelgen export SCENE --to c --out FOLDER"),
        (("export", EGG), "--to: no format; allowed: c"),
        (("export", EGG, "--to", "fmi"), "--to: 'fmi'; allowed: c"),
        (("export", "no.toml", "--to", "c"), "no.toml"),
        (
            ("export", EGG, "--to", "c", "--out", "run.csv"),
            "'run.csv' is a file; a folder for the files of the export; name another: --out FOLDER",
        ),
        (("export", EGG, "--to", "urdf"), "is an ellipsoid"),
        (("export", EGG, "--to", "casadi", "--real", "float"), "--real: it is given with --to casadi"),
        (("fit", EGG, "none.csv", "--by", "egg.velocity"), "none.csv: no such file; check the path"),
        (("inspect", EGG, "--format", "pdf"), "--format: the text 'pdf'; allowed are text, latex, html"),
        (("plot", "run.csv", "-o", "run.png"), "--out run.npz"),
        (("plot", EGG, "-o", "run"), ".png, .svg"),
        (("plot", "broken.npz", "-o", "run.png"), "not a run"),
        (("check", "units.toml"), "write the number without its unit: lengths are in m"),
        (("inspect", "egg-plane"), "ellipsoid"),
        (("inspect", "sphere-plane:suport"), "support"),
        (("inspect", EGG, "--formula", "mg_nothing"), "mg_nothing"),
    ],
    ids=lambda value: " ".join(map(str, value)) if isinstance(value, tuple) else "",
)
@pytest.mark.parametrize("json", [(), ("--json",)], ids=["text", "json"])
def test_refused(
    arguments: tuple[str, ...], words: str, json: tuple[str, ...], modelgen: Modelgen, tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:  # fmt: skip
    (tmp_path / "scenes").symlink_to(Path("scenes").absolute())
    (tmp_path / "broken.toml").write_text("this is = not [toml")
    (tmp_path / "broken.npz").write_bytes(b"nothing")
    (tmp_path / "typo.toml").write_text(SUNK.replace('"table"]', '"tabel"]'))
    (tmp_path / "sunk.toml").write_text(SUNK)
    (tmp_path / "units.toml").write_text(SUNK.replace("radius = 0.1", 'radius = "100 mm"'))
    weighed = SUNK.replace("density = 1000.0", "mass = 1.0\ninertia = [1.0, 1.0, 1.0]")
    (tmp_path / "tip.toml").write_text(weighed.replace('{ kind = "sphere", radius = 0.1 }', TIP))
    (tmp_path / "loose.toml").write_text("[run]\ntolerance = 7.0\n" + SUNK)
    (tmp_path / "run.csv").write_text("t,energy\n0.0,1.0\n")
    (tmp_path / "folder.npz/folder.png").mkdir(parents=True)
    monkeypatch.chdir(tmp_path)
    before = files(tmp_path)
    answer = modelgen(*arguments, *json)
    assert answer.code == 2
    assert words in answer.err
    assert answer.err.count("\n") == 1
    assert answer.out == ""
    assert files(tmp_path) == before


@pytest.mark.parametrize(
    "arguments",
    [
        *[("plot", name, *more) for name in ("no.npz", "no.toml", "no") for more in ((), ("-o", "x.pdf"))],
        *[("report", name, *more) for name in ("no.npz", "no.toml") for more in ((), ("-o", "x.pdf"))],
        *[("view", "no.npz", "--out", "x.pdf"), ("view", "no.toml", "--plots", "z", "--out", "x.html")],
        *[("simulate", "no.toml", "--out", "x.pdf"), ("simulate", "no.toml", "--until", "-1")],
        *[("check", "no.toml"), ("build", "no.toml", "--real", "z"), ("export", "no.toml", "--to", "z")],
        *[("sweep", "no.toml"), ("sweep", "no.toml", "--plot", "x.pdf"), ("inspect", "no.toml", "--at", "z")],
        *[("fit", "no.toml", "no.csv", "--plot", "x.pdf"), ("fit", "sunk.toml", "no.csv", "--plot", "x.pdf")],
        *[("linearise", "no.toml", "--plot", "x.pdf"), ("measure", "no.toml", "--plot", "x.pdf")],
        *[
            ("tune", "no.toml"),
            ("sensitivity", "no.toml", "--by", "x"),
            ("import", "no.xml", "--out", "no/x.pdf"),
        ],
    ],
    ids=" ".join,
)
def test_a_file_to_be_read_that_is_missing_is_told_before_all_else(
    arguments: tuple[str, ...], modelgen: Modelgen, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "sunk.toml").write_text(SUNK)
    monkeypatch.chdir(tmp_path)
    answer = modelgen(*arguments)
    assert (answer.code, answer.out, answer.err.count("\n")) == (2, "", 1)
    assert answer.err.startswith("no")
    assert ": no such file; " in answer.err


@pytest.mark.parametrize("verb", ["plot", "report"])
def test_a_file_to_be_written_is_asked_for(verb: str, modelgen: Modelgen, tmp_path: Path) -> None:
    (tmp_path / "sunk.toml").write_text(SUNK)
    answer = modelgen(verb, tmp_path / "sunk.toml")
    assert (answer.code, answer.out) == (2, "")
    assert answer.err.startswith("--out: no file to write; write --out r")


@pytest.mark.parametrize("verb", ["simulate", "build", "linearise", "measure"])
def test_a_folder_that_nothing_can_be_written_into_is_refused_first(
    verb: str, modelgen: Modelgen, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "sunk.toml").write_text(SUNK)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("os.access", lambda path, mode: mode == os.R_OK)
    answer = modelgen(verb, "sunk.toml")
    assert (answer.code, answer.out, answer.err.count("\n")) == (2, "", 1)
    assert "is not yours to write into" in answer.err
    assert "go to another folder, or name one: build --out FOLDER" in answer.err


def test_a_scene_that_may_not_be_read_is_refused_in_one_line(
    modelgen: Modelgen, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def forbidden(path: Path) -> bytes:
        raise PermissionError(errno.EACCES, "Permission denied", str(path))

    (tmp_path / "sunk.toml").write_text(SUNK)
    monkeypatch.setattr("os.access", lambda path, mode: False)
    monkeypatch.setattr(Path, "read_bytes", forbidden)
    answer = modelgen("check", tmp_path / "sunk.toml")
    assert answer.code == 2
    assert answer.err.endswith("cannot be read: Permission denied; check the path and its permissions\n")
    assert answer.err.count("\n") == 1


@pytest.fixture
def ending(monkeypatch: pytest.MonkeyPatch) -> Callable[[Any], None]:
    """Makes the core's third call end as told: a code, or an exception."""

    def arrange(end: Any) -> None:
        advance, calls = Session.advance, []

        def changed(self: Session, *arguments: Any) -> int:
            calls.append(1)
            if len(calls) != 3:
                return advance(self, *arguments)
            if isinstance(end, int):
                return end
            raise end

        monkeypatch.setattr(Session, "advance", changed)

    return arrange


@pytest.mark.parametrize(
    ("end", "code", "outcome"), [(KeyboardInterrupt(), 130, "interrupted"), (23, 1, "complementarity")]
)
def test_a_run_that_ends_early_keeps_what_was_computed(
    end: Any, code: int, outcome: str, ending: Callable[[Any], None], modelgen: Modelgen, tmp_path: Path
) -> None:
    ending(end)
    answer = modelgen(
        "simulate", EGG, "--until", 1e3, "--samples", 10**4, "--out", tmp_path / "run.npz", "--json"
    )
    assert answer.code == code
    assert outcome in answer.err
    assert answer.json["outcome"] == outcome
    record = load(tmp_path / "run.npz")
    assert record.summary["outcome"] == outcome
    assert 0 < record.columns["t"][-1] == answer.json["t_end"] < 1e3
    assert "the last sample is the state then" in answer.err
    assert answer.err.count("interrupted") == (code == 130)


@pytest.mark.parametrize("where", ["advance", "begin"])
def test_ctrl_c_in_the_companion_run_keeps_the_run_and_says_so(
    where: str, modelgen: Modelgen, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    whole = getattr(Session, where)

    def stopping(self: Session, *arguments: Any) -> Any:
        if self.accuracy.name.endswith("companion"):
            raise KeyboardInterrupt
        return whole(self, *arguments)

    monkeypatch.setattr(Session, where, stopping)
    answer = modelgen("simulate", EGG, "--until", 0.1, "--out", tmp_path / "run.npz", "--json")
    assert answer.code == 130
    assert answer.err.startswith("interrupted in the companion run")
    assert answer.json["outcome"] == "done"
    assert "uncertified: the companion run was interrupted" in answer.json["estimate"]["statement"]
    assert load(tmp_path / "run.npz").columns["t"][-1] == 0.1


@pytest.mark.parametrize(
    ("which", "options", "words"),
    [
        ("fast", (), "interrupted as the run came to its end: the run is whole, its error is not certified"),
        ("fast", ("--no-estimate",), "interrupted as the run came to its end: the run is whole"),
        ("fast, companion", (), "interrupted in the companion run: the run is whole"),
    ],
)
def test_ctrl_c_in_the_call_that_ends_a_run_is_not_lost(
    which: str,
    options: tuple[str, ...],
    words: str,
    modelgen: Modelgen,
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
) -> None:
    advance = Session.advance

    def stopped(self: Session, end: float, steps: int, record: Any) -> int:
        code = advance(self, end, 10**9, record)
        if self.accuracy.name == which and self.run.t >= 0.1:
            raise KeyboardInterrupt  # as the signal is seen where the call returns
        return code

    monkeypatch.setattr(Session, "advance", stopped)
    out = ("--accuracy", "fast", "--until", 0.1, "--out", tmp_path / "run.npz", "--json", *options)
    answer = modelgen("simulate", EGG, *out)
    assert answer.code == 130
    assert answer.err.splitlines()[-1] == words
    assert answer.json["outcome"] == "done"
    assert load(tmp_path / "run.npz").columns["t"][-1] == 0.1


STOP_AT = """
import sys
module = sys.argv.pop(1)
class Stop:
    def find_spec(self, name, path=None, target=None):
        if name == module:
            raise KeyboardInterrupt
sys.meta_path.insert(0, Stop())
from modelgen.cli import main
main()
"""


@pytest.mark.parametrize("module", ["modelgen.cli.command_group", "click", "modelgen.cli.manual"])
def test_an_interrupt_while_the_verbs_load_is_no_traceback(module: str) -> None:
    ended = subprocess.run([sys.executable, "-c", STOP_AT, module, "manual"], capture_output=True, text=True)
    assert (ended.returncode, ended.stdout, ended.stderr) == (130, "", "interrupted\n")


def test_a_scene_of_fixed_bodies_alone_says_that_nothing_moves(
    modelgen: Modelgen, shared_folder: Path
) -> None:
    (shared_folder / "still.toml").write_text(SUNK[: SUNK.index("[[body]]", 5)])
    answer = modelgen("simulate", "still.toml", "--json")
    assert answer.code == 0
    assert any('without motion = "fixed"' in warning for warning in answer.json["warnings"])
    assert any("nothing moves" in hint for hint in modelgen("check", "still.toml", "--json").json["hints"])


def test_every_verb_names_the_files_it_wrote_in_the_same_words(modelgen: Modelgen, tmp_path: Path) -> None:
    picture = tmp_path / "run.svg"
    ran = modelgen("simulate", EGG, "--until", 0.05, "--out", tmp_path / "run.npz", "--plot", picture)
    drawn = modelgen("plot", tmp_path / "run.npz", "-o", picture)
    assert ran.out.splitlines()[-3:-1] == [f"written: {tmp_path / 'run.npz'}", f"written: {picture}"]
    assert drawn.out.splitlines() == [f"written: {picture}"]


def test_interrupt_before_the_run_is_no_traceback(
    modelgen: Modelgen, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupt(path: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("modelgen.read", interrupt)
    answer = modelgen("check", EGG)
    assert (answer.code, answer.out) == (130, "")
