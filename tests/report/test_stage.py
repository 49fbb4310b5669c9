"""Bodies as pictures and pages show them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from modelgen import read, require
from modelgen.report.displayed_bodies import body_shape
from modelgen.scene.read import read_text
from tests.running import FILES

ROD = """
[[body]]
name = "rod"
mass = 1.0
inertia = [1.0, 1.0, 1.0]
center_of_mass = [0.1, 0.0, 0.0]
shape = { kind = "point", at = [0.0, 0.5, 0.0], position = [0.3, 0.0, 0.0], rpy = [0.0, 0.0, "pi/2"] }
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
