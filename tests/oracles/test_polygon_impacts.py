"""Impacts of corners and faces: several at once that depend on each other, and one floor told in two ways."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from modelgen import simulate
from modelgen.runtime.trajectory import Outcome
from modelgen.scene import python_scenes as make
from tests.benchmarks.cliff_scenes import escapement
from tests.running import library_of

CASES = [(0.15, 0.5, 0.005), (0.173, 0.2, 0.02), (0.183, 0.3, 0.02)]  # lean, restitution, torque
SHAPES = {
    "box": make.box(0.1, 0.14, 0.18),
    "cube": make.box(0.1, 0.1, 0.1),
    "can": make.cylinder(0.05, 0.12),
    "ellipsoid": make.ellipsoid(0.06, 0.05, 0.04),
}


@pytest.mark.parametrize("accuracy", ["fast", "balanced", "tight"])
@pytest.mark.parametrize("case", CASES)
def test_teeth_that_strike_with_two_corners_always_have_impulses(
    case: tuple[float, float, float], accuracy: str
) -> None:
    """On revolute joints the row of one corner repeats that of the other but for rounding, to which ever
    slower blows of restitution bring the gap rates down."""
    path = simulate(library_of(escapement(*case)), until=0.3, accuracy=accuracy, estimate=False)
    assert path.outcome is not Outcome.COMPLEMENTARITY
    assert not any(event.kind == "fallback-start" for event in path.events)
    assert sum(event.kind == "impact" for event in path.events) > 5
    assert path.energy_drift < 1e-6


@pytest.mark.parametrize("case", CASES)
def test_an_escapement_runs_as_its_estimate_says(case: tuple[float, float, float]) -> None:
    """Two accuracies agree to what both state."""
    library = library_of(escapement(*case))
    balanced, tight = (simulate(library, until=0.3, accuracy=name) for name in ("balanced", "tight"))
    assert balanced.outcome is tight.outcome is Outcome.DONE
    off = np.abs(balanced.coordinates[-1] - tight.coordinates[-1]).max()
    assert off < 3 * (balanced.rotation_error[-1] + tight.rotation_error[-1])


@pytest.mark.cases(6)
@pytest.mark.parametrize(
    ("name", "friction", "seed"), list(product(SHAPES, (0.0, 0.3), range(3))), ids=lambda value: str(value)
)
def test_a_plane_and_the_top_of_a_large_box_are_one_floor(name: str, friction: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    thrown = make.dynamic(
        "body", SHAPES[name], density=1000.0, position=[0, 0, 0.25], rpy=rng.uniform(-1, 1, 3).tolist(),
        velocity=rng.uniform(-0.5, 0.5, 3).tolist(), angular_velocity=rng.uniform(-5, 5, 3).tolist(),
    )  # fmt: skip
    floors = [
        make.fixed("floor", make.plane()),
        make.fixed("floor", make.box(10, 10, 10), position=[0.3, 0.2, -5.0]),
    ]
    touch = {"between": ["body", "floor"], "restitution": 0.4, **({"friction": friction} if friction else {})}
    for accuracy in ("fast", "balanced", "tight"):
        plane, box = (
            simulate(
                library_of(make.scene("toss", [floor, thrown], contact=[touch])),
                until=0.35, samples=20, accuracy=accuracy,
            )
            for floor in floors
        )  # fmt: skip
        assert plane.outcome is box.outcome is Outcome.DONE
        body = plane.body_names.index("body"), box.body_names.index("body")
        off = np.linalg.norm(plane.p[:, body[0]] - box.p[:, body[1]], axis=1)
        assert (off < 3 * (plane.position_error + box.position_error) + 1e-12).all()
