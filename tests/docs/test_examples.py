"""Every code block of the README and the manual works as printed, in one folder beside the shipped scenes."""

from __future__ import annotations

import re
import shlex
import subprocess
from collections.abc import Iterable
from pathlib import Path

import pytest
from click.testing import CliRunner

from modelgen import require
from modelgen.cli.command_group import app
from modelgen.cli.manual import page, script_of
from modelgen.scene.read import read_text
from tests.c_compiler import needs_c
from tests.docs.pages import EXAMPLES, MANUAL, PAGES, blocks

# What a block without bodies of its own is put into: keys of a contact or of the scene, or whole tables.
TABLES = """
[[body]]
name = "table"
motion = "fixed"
shape = { kind = "plane" }

[[body]]
name = "ball"
density = 1000.0
position = [0.0, 0.0, 1.0]
shape = { kind = "sphere", radius = 0.1 }

[[body]]
name = "wall"
motion = "fixed"
position = [0.0, 5.0, 0.0]

[[body]]
name = "mass"
mass = 1.0
inertia = [1.0, 1.0, 1.0]
position = [1.0, 5.0, 0.0]

[[body]]
name = "upper"
mass = 1.0
inertia = [1.0, 1.0, 1.0]
position = [0.5, 0.0, 5.0]

[[body]]
name = "lower"
mass = 1.0
inertia = [1.0, 1.0, 1.0]
position = [1.5, 0.0, 5.0]
"""
CONTACT = '\n[[contact]]\nbetween = ["ball", "table"]\n'
OF_A_SCENE = ("observe", "fold", "gravity")


@pytest.fixture(scope="session")
def workplace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One folder for all examples, so that a scene is built once; with the shipped scenes."""
    folder = tmp_path_factory.mktemp("examples")
    assert CliRunner().invoke(app, ["new", "--scenes", "--out", str(folder / "scenes")]).exit_code == 0
    return folder


def examples(language: str) -> list[object]:
    """All blocks of a language; those that draw a film are studies, which take long."""
    return [
        pytest.param(code, id=f"{path.stem}-{number}", marks=pytest.mark.slow if ".gif" in code else ())
        for path in PAGES
        if path.stem not in EXAMPLES or language != "python"
        for number, code in enumerate(blocks(path, language))
    ]


@pytest.mark.parametrize("code", examples("python"))
def test_python_block_runs(code: str, workplace: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(workplace)
    exec(compile(code, "example", "exec"), {"__name__": "example"})


@pytest.mark.parametrize("topic", EXAMPLES)
def test_a_worked_example_runs(
    topic: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The blocks of its page as one script: it compares its results, prints what the page says, and draws."""
    monkeypatch.chdir(tmp_path)
    code = script_of(page(topic))
    assert "assert" in code
    exec(compile(code, topic, "exec"), {"__name__": "example"})
    assert [capsys.readouterr().out] == blocks(MANUAL / f"{topic}.md", "text")
    assert (tmp_path / f"{topic}.png").stat().st_size > 1000


@pytest.mark.usefixtures("hasty")
@pytest.mark.parametrize("path", [path for path in PAGES if blocks(path, "sh")], ids=lambda path: path.stem)
def test_commands_run_in_order(path: Path, workplace: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(workplace)
    run_commands(line for line in commands(path) if not is_slow(line))


@pytest.mark.slow
def test_slow_commands_run(workplace: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(workplace)
    run_commands(line for path in PAGES for line in commands(path) if is_slow(line))


def commands(path: Path) -> list[str]:
    lines = (line for block in blocks(path, "sh") for line in block.splitlines())
    return [line for line in lines if line.startswith("modelgen ")]


def is_slow(command: str) -> bool:
    """Whether it compiles the core for WebAssembly."""
    return "--to browser" in command


def run_commands(lines: Iterable[str]) -> None:
    for line in lines:
        result = CliRunner().invoke(app, shlex.split(line, comments=True)[1:])
        assert result.exit_code == 0, f"{line}\n{result.output}"


@needs_c
def test_the_c_program_compiles_and_runs(workplace: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """By the line that the manual prints, without optimisation, which takes longer than the rest."""
    monkeypatch.chdir(workplace)
    (block,) = (block for block in blocks(MANUAL / "c.md", "sh") if "export" in block)
    build, compile_and_run = block.splitlines()
    assert CliRunner().invoke(app, [*shlex.split(build)[1:], "--no-figures"]).exit_code == 0
    command = compile_and_run.replace("-O2", "-O0")
    result = subprocess.run(["sh", "-c", command], capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stderr
    assert result.stdout


@pytest.mark.parametrize("code", examples("toml"))
def test_toml_block_is_read(code: str) -> None:
    for text in scenes_of(code):
        read_text(text, "example.toml")


def scenes_of(code: str) -> list[str]:
    """The scenes that a block makes: its own, or one for each key, or one with its tables."""
    if "[[body]]" in code:
        return [code]
    if code.lstrip().startswith("["):
        return [TABLES + CONTACT + code]
    lines = re.findall(r"^\w+ = .*$", code, re.MULTILINE)
    above = "".join(f"{line}\n" for line in lines if line.split()[0] in OF_A_SCENE)
    if above:
        return [above.replace("ball-bowl", "ball-table") + TABLES + CONTACT]
    return [TABLES + CONTACT + line + ("\nfriction = 0.3" if "resistance" in line else "") for line in lines]


def test_observing_and_folding_leave_states_and_parameters_out(workplace: Path) -> None:
    (keys,) = (block for path in PAGES for block in blocks(path, "toml") if "observe =" in block)
    whole = (workplace / "scenes/ball_in_bowl.toml").read_text(encoding="utf-8").replace(
        'name = "ball"', 'name = "ball"\nangular_velocity = [0.0, 0.0, 1.0]'
    )  # fmt: skip
    full, less = (require(read_text(text, "manual.toml")) for text in (whole, keys + whole))
    assert (full.n_q, less.n_q) == (7, 3)
    assert [pair.parameters for pair in full.feature_pairs] == [(0.1, 0.12)]
    assert [pair.parameters for pair in less.feature_pairs] == [()]
    assert "ball: orientation and spin" in less.left_out[0]
