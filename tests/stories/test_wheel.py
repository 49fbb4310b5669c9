"""The wheel alone, in an empty folder and a new environment: first_steps as written, then every page.

Each installs the wheel and its extras from the package index, with the Python that runs it:
`python -m pytest tests/stories/test_wheel.py -m slow -n 0`.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from modelgen.errors import DISTRIBUTION
from tests.docs.pages import MANUAL, ROOT, blocks
from tests.running import FILES

FROM_A_CLONE = '".[all]"'  # what first_steps installs in a clone

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the wheel in it, and nothing else."""
    folder = tmp_path_factory.mktemp("wheel")
    run(folder, f'"{sys.executable}" -m pip wheel -q --no-deps --no-cache-dir -w . "{ROOT}"')
    return folder


@pytest.fixture(scope="module")
def wheel(place: Path) -> Path:
    (path,) = place.glob("*.whl")
    return path


def run(folder: Path, script: str) -> str:
    """What a script of shell commands prints; neither this tree nor this environment are to be seen in it."""
    seen = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "VIRTUAL_ENV")}
    python = str(Path(sys.executable).parent)
    done = subprocess.run(
        ["sh", "-e", "-c", script],
        cwd=folder,
        env=seen | {"PATH": f"{python}:{seen['PATH']}", "MODELGEN_CACHE": str(folder / "cache")},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, f"{script}\n{done.stdout[-4000:]}\n{done.stderr[-4000:]}"
    return done.stdout


def test_the_wheel_holds_the_shipped_scenes(wheel: Path) -> None:
    assert wheel.name.startswith(DISTRIBUTION.replace("-", "_"))
    with zipfile.ZipFile(wheel) as archive:
        held = {name: archive.read(name) for name in archive.namelist() if "modelgen/scenes/" in name}
    assert held == {f"modelgen/scenes/{path.name}": path.read_bytes() for path in FILES}


def test_first_steps_run_as_written(place: Path, wheel: Path) -> None:
    """All commands of the page in one shell, with the wheel in place of the clone."""
    script = "\n".join(blocks(MANUAL / "first_steps.md", "sh"))
    assert script.count(FROM_A_CLONE) == 1
    told = run(place, script.replace(FROM_A_CLONE, f'"{wheel.name}[all]"'))
    assert "trusted" in told
    assert (place / "ball.png").stat().st_size > 1000
    where = run(place, ". .venv/bin/activate; cd /; python -c 'import modelgen; print(modelgen.__file__)'")
    assert Path(where.strip()).is_relative_to(place / ".venv")


def test_every_page_runs_from_the_wheel(tmp_path: Path, wheel: Path) -> None:
    """The tests of the blocks of README and manual, beside no source of the package."""
    for name in ("README.md", "pyproject.toml"):
        shutil.copy(ROOT / name, tmp_path)
    shutil.copytree(ROOT / "tests", tmp_path / "tests", ignore=shutil.ignore_patterns("__pycache__"))
    told = run(
        tmp_path,
        f"""python3 -m venv .venv
        .venv/bin/pip install -q "{wheel}[all,dev]"
        .venv/bin/pip install -q "{DISTRIBUTION}[plot]"  # an extra of what is installed: no index has it
        .venv/bin/python -m pytest tests/docs/test_examples.py -m "slow or not slow" -n 2""",
    )
    assert " passed" in told
    assert "failed" not in told
