"""Bodies as pictures and pages show them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from modelgen import read, record_of, require, simulate
from modelgen.report.body_pictures import draw_bodies, on_picture
from modelgen.report.displayed_bodies import body_shape, stage_at_start, stage_of
from modelgen.scene.read import read_text
from tests.running import FILES, library_of

ROD = """
[[body]]
name = "rod"
mass = 1.0
inertia = [1.0, 1.0, 1.0]
center_of_mass = [0.1, 0.0, 0.0]
shape = { kind = "point", at = [0.0, 0.5, 0.0], position = [0.3, 0.0, 0.0], rpy = [0.0, 0.0, "pi/2"] }
"""

PLATE = """
[[body]]
name = "below"
motion = "fixed"
shape = { kind = "box", size = [WIDTH, WIDTH, 0.04] }

[[body]]
name = "ball"
density = 1000.0
shape = { kind = "sphere", radius = 0.02 }
"""

FALL = """
[run]
until = 0.15

[[body]]
name = "floor"
motion = "fixed"
shape = { kind = "plane" }

[[body]]
name = "ball"
density = 1000.0
shape = { kind = "sphere", radius = 0.03 }
position = [0.0, 0.0, 0.15]

[[contact]]
between = ["ball", "floor"]
"""


@pytest.mark.cases(5)
@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_every_body_with_a_shape_is_drawn(path: Path) -> None:
    model = require(read(path))
    with_shape = [index for index, body in enumerate(model.whole.bodies) if body.shapes]
    assert not [index for index in with_shape if body_shape(model, index, 1.0, 0.1).is_empty]


def test_a_point_is_drawn_as_a_line_from_the_centre_of_mass() -> None:
    (line,) = body_shape(require(read_text(ROD, "rod.toml")), 0, 1.0, 0.1).lines
    assert np.allclose(line, [[0.0, 0.0, 0.0], [-0.3, 0.0, 0.0]], atol=1e-15)


@pytest.mark.parametrize("fall", [0.01, 0.15])  # m, at a time
@pytest.mark.parametrize(("width", "is_whole"), [(0.1, True), (0.2, True), (2.0, False)])
def test_what_stands_still_is_cut_off_only_where_all_of_it_would_leave_bodies_small(
    width: float, is_whole: bool, fall: float
) -> None:
    model = require(read_text(PLATE.replace("WIDTH", str(width)), "plate.toml"))
    p = np.array([[[0.0, 0.0, 0.0], [0.0, 0.0, z]] for z in (0.04 + fall, 0.04)])
    quaternion = np.broadcast_to([1.0, 0.0, 0.0, 0.0], (2, 2, 4))
    stage = stage_at_start({"t": np.array([0.0, 1.0]), "p": p, "quaternion": quaternion}, model, 0.1)
    corner = np.array([width / 2, width / 2, -0.02])
    assert (np.linalg.norm(corner - stage.centre) <= stage.size and not stage.follow) == is_whole


def test_a_picture_shows_the_bodies_from_the_start_to_the_end_of_a_fall() -> None:
    scene = read_text(FALL, "fall.toml")
    record = record_of(simulate(library_of(scene), estimate=False, samples=10), library_of(scene), scene)
    stage = stage_of(record, require(scene), 0.1)
    axes = pytest.importorskip("matplotlib.figure").Figure().subplots()
    for sample in (0, -1):
        draw_bodies(axes, record, stage, sample)
        low, high = axes.get_ylim()
        height = on_picture(record.columns["p"][sample, 1])[1]
        assert low <= height - 0.03 < height + 0.03 <= high
