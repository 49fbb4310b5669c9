"""A start is refused only where bodies penetrate: a plane between two bodies keeps them apart."""

from __future__ import annotations

from itertools import product
from math import cos, pi, sin

import numpy as np
import pytest

from modelgen import simulate
from modelgen.errors import SimulationError
from modelgen.runtime.trajectory import Outcome
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Shape
from tests.running import library_of

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
}
LOWER: dict[str, tuple[Shape, float]] = {  # with the height of its top
    "tube": (make.tube(0.03, 0.0105, 0.06), 0.03),
    "torus": (make.torus(0.02, 0.005), 0.005),
    "half torus": (make.half_torus(0.02, 0.005), 0.025),
    "box": (make.box(0.06, 0.05, 0.04), 0.02),
    "cylinder": (make.cylinder(0.015, 0.03), 0.015),
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
    rng = np.random.default_rng(7)
    refused = []
    for tilt, offset, out in product(TILTS, (0.0, 1e-4), (0.0, 1e-6)):
        height = top + radius * float(1 + rng.uniform(0.01, 3))
        half = tilt / 2
        scene = make.scene(
            "apart",
            [
                make.fixed("lower", lower),
                make.dynamic(
                    "upper", upper, mass=0.1, inertia=[1e-5] * 3, position=[offset, out, height],
                    quaternion=[cos(half), 0.0, sin(half), 0.0],
                ),
            ],
            contact=[{"between": ["upper", "lower"], "friction": friction}],
        )  # fmt: skip
        try:
            path = simulate(library_of(scene), until=1e-6, samples=1, estimate=False)
        except SimulationError as error:
            refused.append((tilt, offset, out, height, str(error)))
        else:
            assert path.outcome is Outcome.DONE
    assert not refused
