"""The penetration that a run by time-stepping reports is that of its states, by support functions."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from modelgen import simulate
from modelgen.scene import python_scenes as make
from tests.benchmarks.groups import SHAPES, support_of
from tests.oracles.pieces import TABLE
from tests.running import library_of

STEP = 1e-3  # s


@pytest.mark.cases(1)
@pytest.mark.parametrize("shape", ["dome", "frustum", "cylinder"])
def test_a_penetration_that_is_removed_within_the_step_is_none(shape: str) -> None:
    """Bodies roll from a rim onto a face and back, where a contact appears within a step."""
    chance = np.random.default_rng(5)
    solid = SHAPES[shape]()
    own = support_of(solid)
    for _ in range(5):
        rpy, spin = ([float(a) for a in chance.uniform(-size, size, 3)] for size in (1, 5))
        body = make.dynamic("b", solid, density=500.0, position=[0, 0, 0.12], rpy=rpy, angular_velocity=spin)
        contact = [{"between": ["b", "table"], "friction": 0.3}]
        library = library_of(make.scene("drop", [TABLE, body], contact=contact))
        centre = np.array(library.manifest.instance["bodies"][1]["centre_of_mass"])
        run = simulate(library, until=0.6, samples=600, estimate=False, method="time-stepping", step=STEP)
        turns = Rotation.from_quat(run.quaternion[:, 1][:, [1, 2, 3, 0]]).as_matrix()
        lowest = min(p[2] - R[2] @ centre - own(-R[2]) for p, R in zip(run.p[:, 1], turns, strict=True))
        assert run.penetration_max < 1e-10
        assert lowest > -1e-10
