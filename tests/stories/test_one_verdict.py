"""Whatever shows a run judges it as `simulate` does."""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np
import pytest

from modelgen import build, derive, draw, emit, read, record_of, require, simulate, simulate_batch, start_many
from modelgen.codegen.library import Library
from modelgen.export.export_formats import Choices, export
from modelgen.model import Model
from modelgen.view.page import write_page
from tests.c_compiler import CC, needs_c
from tests.export.folders import STRICT

DOUBT = "rounding decided whether an edge in the plane of a face was struck"
SCENE = """
[run]
until = 0.3
samples = 10
[[input]]
name = "push"
default = 0.0
minimum = -1.0
maximum = 1.0
[[body]]
name = "left"
motion = "fixed"
shape = { kind = "box", size = [2.0, 2.0, 2.0] }
position = [-1.0, 0.0, -1.0]
[[body]]
name = "right"
motion = "fixed"
shape = { kind = "cylinder", radius = 1.0, length = 2.0 }
position = [1.0, 0.0, HEIGHT]
[[body]]
name = "block"
shape = { kind = "box", size = [0.3, 0.2, 0.1] }
density = 1000.0
position = [-0.5, 0.0, 0.05]
velocity = [2.0, 0.0, 0.0]
[[force]]
body = "block"
force = ["push", "0", "0"]
[[sensor]]
name = "place"
of = "block.position"
[contacts]
between = "all"
"""
JUDGED = pytest.mark.parametrize(("height", "kinds"), [("-1.0", ("flush",)), ("-1.1", ())])


def model_at(height: str, folder: Path) -> Model:
    """A block slides from a plate to a round one, which is level with the first, or lower."""
    file = folder / "seam.toml"
    file.write_text(SCENE.replace("HEIGHT", height))
    return require(read(file))


def library_at(height: str, folder: Path) -> Library:
    return build(emit(derive(model_at(height, folder))))


@JUDGED
def test_groups_batches_and_environments(height: str, kinds: tuple[str, ...], tmp_path: Path) -> None:
    gym = pytest.importorskip("gymnasium") and pytest.importorskip("modelgen.gym")
    library = library_at(height, tmp_path)
    assert simulate(library, samples=2).doubt_kinds == kinds
    many = start_many(library, 2)
    many.step(0.3)
    assert many.doubts == (kinds, kinds)
    start = many._starts[:, : library.manifest.instance["n_q"] + library.manifest.instance["n_u"]]
    q, u = np.split(start, [library.manifest.instance["n_q"]], axis=1)
    assert simulate_batch(library, q, u, until=0.3).doubts == (kinds, kinds)
    environment = gym.make(library, reward="0", every=0.1, horizon=0.3)
    environment.reset()
    infos = [environment.step([0.0])[4] for _ in range(3)]
    assert infos == [{}, {}, {"doubts": "flush"} if kinds else {}]


@needs_c
@JUDGED
def test_exported_programs(height: str, kinds: tuple[str, ...], tmp_path: Path) -> None:
    export(
        derive(model_at(height, tmp_path)), "c", tmp_path / "c", tmp_path / "library", Choices(figures=False)
    )
    sources = ("scene.c", "modelgen_runtime.c", "example.c")
    command = [*CC, *STRICT, "-O0", *sources, "-lm", "-o", "example"]
    subprocess.run(command, cwd=tmp_path / "c", check=True)
    ran = subprocess.run([tmp_path / "c" / "example"], capture_output=True, text=True, check=True)
    assert ran.stderr == (f"not trusted: {DOUBT}\n" if kinds else "")


@JUDGED
def test_pictures_and_pages(height: str, kinds: tuple[str, ...], tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    library = library_at(height, tmp_path)
    record = record_of(simulate(library), library, read(tmp_path / "seam.toml"))
    draw(record, tmp_path / "run.svg", frames=0)
    write_page(record, tmp_path / "run.html")
    for file in ("run.svg", "run.html"):
        text = (tmp_path / file).read_text(encoding="utf-8")
        assert ("not trusted" in text) == bool(kinds)
        assert ("trusted, error" in text) != bool(kinds)
