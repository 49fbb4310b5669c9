"""A start is refused only where bodies penetrate: a plane between two bodies keeps them apart."""

from __future__ import annotations

from itertools import product
from math import cos, pi, sin

import numpy as np
import pytest

from modelgen import simulate_batch
from modelgen.runtime.trajectory import Outcome
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Shape
from tests.oracles.outlines import OUTLINES
from tests.running import library_of


def extruded(outline: str) -> Shape:
    return make.extrusion(0.02, points=OUTLINES[outline].tolist())


TETRAHEDRON = make.polyhedron([[0.02, 0, 0], [-0.01, 0.017, 0], [-0.01, -0.017, 0], [0, 0, 0.02]])
WAIST = make.revolution("0.02*sin(t)*(1.2 + 0.5*cos(2*t))", "-0.03*cos(t)", domain=(0.0, pi))
UPPER: dict[str, tuple[Shape, float]] = {  # with the radius of a ball about the origin that holds it, m
    "cylinder": (make.cylinder(0.01, 0.05), 0.027),
    "box": (make.box(0.01, 0.02, 0.04), 0.024),
    "frustum": (make.frustum(0.012, 0.006, 0.04), 0.024),
    "dome": (make.dome(0.02, 0.025), 0.03),
    "capsule": (make.capsule(0.01, 0.03), 0.026),
    "disc": (make.disc(0.012), 0.013),
    "tube": (make.tube(0.01, 0.008, 0.04), 0.023),
    "half torus": (make.half_torus(0.02, 0.004), 0.025),
    "torus": (make.torus(0.02, 0.004), 0.025),
    "star": (extruded("star"), 0.052),
    "wedge": (extruded("wedge"), 0.03),
    "hook": (extruded("hook"), 0.045),
    "tetrahedron": (TETRAHEDRON, 0.021),
    "waist": (WAIST, 0.037),
}
LOWER: dict[str, tuple[Shape, float]] = {  # with the height of its top
    "tube": (make.tube(0.03, 0.0105, 0.06), 0.03),
    "torus": (make.torus(0.02, 0.005), 0.005),
    "half torus": (make.half_torus(0.02, 0.005), 0.025),
    "box": (make.box(0.06, 0.05, 0.04), 0.02),
    "cylinder": (make.cylinder(0.015, 0.03), 0.015),
    "frustum": (make.frustum(0.03, 0.01, 0.04), 0.02),
    "star": (extruded("star"), 0.01),
    "hook": (extruded("hook"), 0.01),
    "tetrahedron": (TETRAHEDRON, 0.02),
    "waist": (WAIST, 0.03),
}
TILTS = (0.0, 1e-9, 1e-6, 1e-3, 0.01, 0.2, pi / 4, 1.0, pi / 2, pi - 0.01, pi)


@pytest.mark.cases(4)
@pytest.mark.parametrize("below", LOWER)
@pytest.mark.parametrize("above", UPPER)
@pytest.mark.parametrize("friction", [0.0, 0.2])
def test_a_body_above_another_is_never_refused(above: str, below: str, friction: float) -> None:
    """It leans in a plane of symmetry, where closest points coincide, or a little out of it."""
    upper, radius = UPPER[above]
    lower, top = LOWER[below]
    scene = make.scene(
        "apart",
        [
            make.fixed("lower", lower),
            make.dynamic("upper", upper, mass=0.1, inertia=[1e-5] * 3, position=[0.0, 0.0, top + 2 * radius]),
        ],
        contact=[{"between": ["upper", "lower"], "friction": friction}],
    )
    rng = np.random.default_rng(7)
    starts = [
        [offset, out, top + radius * (1 + rng.uniform(0.01, 3)), cos(tilt / 2), 0.0, sin(tilt / 2), 0.0]
        for tilt, offset, out in product(TILTS, (0.0, 1e-4), (0.0, 1e-6))
    ]
    runs = simulate_batch(library_of(scene), np.array(starts), np.zeros((len(starts), 6)), until=1e-6)
    assert set(runs.outcomes) == {Outcome.DONE}
