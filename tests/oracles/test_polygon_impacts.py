"""Impacts of corners and faces: several at once that depend on each other, and one floor told in two ways."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from modelgen import simulate
from modelgen.runtime.trajectory import Outcome
from modelgen.scene import python_scenes as make
from tests.benchmarks.cliff_scenes import PIVOT, TEETH, escapement, pallet_corners, wheel_corners
from tests.running import library_of

CASES = [(0.15, 0.5, 0.005), (0.173, 0.2, 0.02), (0.183, 0.3, 0.02)]  # lean, restitution, torque
ROOTS = [(0.1783, 0.0, 0.007517), (0.180654, 0.0, 0.006889), (0.153002, 0.3, 0.001194)]  # the same
SHAPES = {
    "box": make.box(0.1, 0.14, 0.18),
    "cube": make.box(0.1, 0.1, 0.1),
    "can": make.cylinder(0.05, 0.12),
    "ellipsoid": make.ellipsoid(0.06, 0.05, 0.04),
}


@pytest.mark.slow
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


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
def test_an_escapement_runs_as_its_estimate_says(case: tuple[float, float, float]) -> None:
    """Two accuracies agree to what both state."""
    library = library_of(escapement(*case))
    balanced, tight = (simulate(library, until=0.3, accuracy=name) for name in ("balanced", "tight"))
    assert balanced.outcome is tight.outcome is Outcome.DONE
    off = np.abs(balanced.coordinates[-1] - tight.coordinates[-1]).max()
    assert off < 3 * (balanced.rotation_error[-1] + tight.rotation_error[-1])


def turned(corners: list[tuple[float, float]], angle: float) -> np.ndarray:
    return np.array(corners) @ [[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]]


def depth_of_points(points: np.ndarray, polygon: np.ndarray) -> float:
    """How deep points lie in a polygon, m; 0 where none does."""
    a, along = polygon, np.roll(polygon, -1, axis=0) - polygon
    span = points[:, None] - a
    part = np.clip((span * along).sum(axis=2) / (along**2).sum(axis=1), 0, 1)
    apart = np.linalg.norm(span - part[..., None] * along, axis=2).min(axis=1)
    ahead = (a[:, 1] > points[:, None, 1]) != ((a + along)[:, 1] > points[:, None, 1])
    with np.errstate(divide="ignore", invalid="ignore"):
        beyond = span[..., 0] < along[:, 0] * span[..., 1] / along[:, 1]
    is_inside = (ahead & beyond).sum(axis=1) % 2 == 1
    return float(np.where(is_inside, apart, 0.0).max())


@pytest.mark.slow
@pytest.mark.parametrize("accuracy", ["fast", "balanced", "tight"])
@pytest.mark.parametrize(
    ("lean", "restitution", "torque", "friction"),
    [(*case, friction) for case in ROOTS for friction in (0.0, 0.2)],
)
def test_a_pallet_that_slides_into_the_root_of_a_tooth_strikes_its_other_side(
    lean: float, restitution: float, torque: float, friction: float, accuracy: str
) -> None:
    """By corners in polygons. In the last case a tooth begins beside the tip of a wedge, behind its side."""
    library = library_of(escapement(lean, restitution, torque, friction))
    path = simulate(library, until=0.4, accuracy=accuracy, samples=400, estimate=False)
    assert path.outcome is Outcome.DONE
    for wheel_turn, anchor_turn in path.coordinates:
        wheel = turned(wheel_corners(), wheel_turn - np.pi / TEETH / 2)
        for side in (1, -1):
            pallet = turned(pallet_corners(side), anchor_turn + lean) + np.array([0, PIVOT])
            assert depth_of_points(pallet, wheel) < 1e-7
            assert depth_of_points(wheel, pallet) < 1e-7


@pytest.mark.slow
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
