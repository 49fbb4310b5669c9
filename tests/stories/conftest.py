"""The command line in a folder of its own, with the shipped scenes beside it."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner

from modelgen.cli.command_group import app
from modelgen.codegen.compiler import find_compiler
from modelgen.codegen.core_cache import runtime_object
from tests.running import LEVEL

ROOT = Path(__file__).parents[2]
PENDULUM = """<mujoco><worldbody><body><joint type="hinge" axis="0 1 0"/>
<geom type="sphere" size="0.1" pos="0 0 -1"/></body></worldbody></mujoco>"""


class Answer:
    """What a command left: exit code, both streams, and the JSON object on standard output."""

    def __init__(self, code: int, out: str, err: str) -> None:
        self.code, self.out, self.err = code, out, err

    @property
    def json(self) -> Any:
        value = json.loads(self.out)
        assert isinstance(value, dict)
        return value


@pytest.fixture(scope="session", autouse=True)
def core() -> None:
    """Compile the core before the first command, so that no command reports it among its own messages."""
    compiler = find_compiler()
    runtime_object(compiler, compiler.flags("double", LEVEL))


@pytest.fixture(scope="session")
def shared_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One folder for all commands, so that each scene is compiled once."""
    folder = tmp_path_factory.mktemp("stories")
    shutil.copytree(ROOT / "scenes", folder / "scenes")
    return folder


@pytest.fixture
def modelgen(shared_folder: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., Answer]:
    """Runs `modelgen ARGUMENTS...` in the shared folder."""
    monkeypatch.chdir(shared_folder)

    def run(*arguments: object) -> Answer:
        result = CliRunner().invoke(app, [str(argument) for argument in arguments])
        assert result.exception is None or isinstance(result.exception, SystemExit), result.exc_info
        return Answer(result.exit_code, result.stdout, result.stderr)

    return run
