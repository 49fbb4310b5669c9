"""The generated text: deterministic, clean under strict warnings, and silent about all but its own names."""

from __future__ import annotations

import os
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import pytest

from modelgen import derive, emit, require
from modelgen.codegen.emit import Package
from modelgen.codegen.library import REAL_FLAGS
from modelgen.scene.scene_types import Scene
from tests.c_compiler import CC, needs_c
from tests.model.scenes import TABLE, WIDE, ball_on_table, contact, egg, scene

PRINT_HASH = """
import hashlib
from modelgen import derive, emit, require
from tests.model.scenes import WIDE
package = emit(derive(require(WIDE)))
text = "".join(name + package.files[name] for name in package.files)
text += package.manifest.structure_json() + package.manifest.instance_json()
print(hashlib.sha256(text.encode()).hexdigest())
"""


def write(package: Package, folder: Path) -> Path:
    for name, text in package.files.items():
        (folder / name).write_text(text, encoding="utf-8")
    return folder / "model.c"


def test_text_is_the_same_in_every_process() -> None:
    found = {
        subprocess.run(
            [sys.executable, "-c", PRINT_HASH],
            env={**os.environ, "PYTHONHASHSEED": seed, "PYTHONPATH": os.pathsep.join(["."])},
            cwd=Path(__file__).parents[2],
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for seed in ("1", "2", "3")
    }
    assert len(found) == 1


@pytest.mark.cases(2)
@pytest.mark.parametrize("real", REAL_FLAGS)
@pytest.mark.parametrize("made", [WIDE, ball_on_table()], ids=["wide", "ball"])
@needs_c
def test_text_compiles_without_a_warning(made: Scene, real: str, tmp_path: Path) -> None:
    source = write(emit(derive(require(made))), tmp_path)
    strict = ["-std=c99", "-O1", "-Wall", "-Wextra", "-Werror", "-pedantic", *REAL_FLAGS[real]]
    answer = subprocess.run(
        [*CC, *strict, "-c", source.name, "-o", "model.o"], cwd=tmp_path, capture_output=True, text=True
    )
    assert answer.returncode == 0, answer.stderr[:2000]


def test_the_text_knows_the_vocabulary_and_not_the_scene() -> None:
    one = emit(derive(require(scene(TABLE, egg(), contact("egg", "table")))))
    other = emit(derive(require(scene(TABLE, egg("pebble", "[0.3, 0.2, 0.1]"), contact("pebble", "table")))))
    assert one.files == other.files
    assert one.manifest.instance != other.manifest.instance


def test_text_does_not_grow_with_the_number_of_bodies() -> None:
    sizes = set()
    for n in (2, 6):
        names = [f"egg{i}" for i in range(n)]
        touching = [contact(a, b) for a, b in pairwise(names)]
        made = scene(TABLE, *map(egg, names), *touching, *(contact(name, "table") for name in names))
        sizes.add(tuple(emit(derive(require(made))).files.values()))
    assert len(sizes) == 1
