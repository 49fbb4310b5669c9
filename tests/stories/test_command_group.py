"""Commands are loaded by name; the help lists them all, and a shell completes them."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner

from modelgen.cli.command_group import MODULES, app

ROOT = Path(__file__).parents[2]


def test_the_help_lists_every_command() -> None:
    answer = CliRunner().invoke(app, ["--help"])
    listed = answer.stdout[answer.stdout.index("Commands:") :].splitlines()[1:]
    assert [line.split()[0] for line in listed] == list(MODULES)
    assert answer.exit_code == 0


@pytest.mark.parametrize("name", MODULES)
def test_every_command_has_its_help(name: str) -> None:
    answer = CliRunner().invoke(app, [name, "--help"])
    assert answer.exit_code == 0
    assert answer.stdout.startswith(f"Usage: modelgen {name} ")


def test_a_misspelt_command_is_answered_by_the_nearest() -> None:
    answer = CliRunner().invoke(app, ["simulat"])
    assert answer.exit_code == 2
    assert "No such command 'simulat'. Did you mean 'simulate'?" in answer.stderr


@pytest.mark.parametrize(
    ("words", "completed"), [("modelgen si", "simulate"), ("modelgen simulate --me", "--method")]
)
def test_a_shell_completes_commands_and_options(words: str, completed: str) -> None:
    asked = {"_MODELGEN_COMPLETE": "bash_complete", "COMP_WORDS": words}
    told = subprocess.run(
        [sys.executable, "-c", "import sys; sys.argv[0] = 'modelgen'; from modelgen.cli import main; main()"],
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, **asked, "COMP_CWORD": str(len(words.split()) - 1), "PYTHONPATH": str(ROOT)},
    )
    assert told.stdout.split() == [f"plain,{completed}"]


@pytest.mark.parametrize(
    ("shell", "script", "start"),
    [
        ("bash", ".bash_completions/modelgen.sh", ".bashrc"),
        ("zsh", ".zfunc/_modelgen", ".zshrc"),
        ("fish", ".config/fish/completions/modelgen.fish", None),
    ],
)
def test_completion_is_installed_once(shell: str, script: str, start: str | None, tmp_path: Path) -> None:
    place = {"HOME": str(tmp_path), "SHELL": f"/bin/{shell}"}
    if start is not None:
        (tmp_path / start).write_text("alias l=ls\n")
    for _ in range(2):
        assert CliRunner().invoke(app, ["--install-completion"], env=place).exit_code == 0
    shown = CliRunner().invoke(app, ["--show-completion"], env=place).stdout
    assert (tmp_path / script).read_text() == shown.rstrip("\n") + "\n"
    assert "_MODELGEN_COMPLETE" in shown
    if start is not None:
        first, *added = (tmp_path / start).read_text().splitlines()
        assert first == "alias l=ls"
        assert len(added) == 1


def test_completion_of_an_unknown_shell_is_refused() -> None:
    answer = CliRunner().invoke(app, ["--show-completion"], env={"SHELL": "/bin/tcsh"})
    assert answer.exit_code == 2
    assert "bash, zsh, fish" in answer.stderr
