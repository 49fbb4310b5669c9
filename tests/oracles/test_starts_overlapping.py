"""A start is refused exactly where bodies overlap, however deep, and wherever else they are nearer."""

from __future__ import annotations

from dataclasses import replace
from math import cos, pi, sin

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from modelgen import simulate
from modelgen.errors import SimulationError
from modelgen.runtime.trajectory import Outcome
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Shape
from tests.benchmarks.measured_solids import Solid, depth, random_solid
from tests.core.planar import crossings, inside
from tests.oracles.outlines import OUTLINES
from tests.running import library_of

Array = np.ndarray


def is_refused(lower: Shape, upper: Shape, friction: float, **pose: object) -> bool:
    scene = make.scene(
        "start",
        [make.fixed("lower", lower), make.dynamic("upper", upper, mass=0.1, inertia=[1e-3] * 3, **pose)],
        contact=[{"between": ["upper", "lower"], "friction": friction}],
    )
    try:
        path = simulate(library_of(scene), until=1e-9, samples=1, estimate=False)
    except SimulationError as error:
        if "interpenetrate" not in str(error) and "passes through it" not in str(error):
            raise
        return True
    assert path.outcome is Outcome.DONE
    return False


def do_overlap(first: Array, second: Array) -> bool:
    return bool(
        len(crossings([first], [second])) or inside([first], second).any() or inside([second], first).any()
    )


@pytest.mark.cases(5)
@pytest.mark.parametrize("seed", range(300))
def test_polygons_in_a_plane_are_refused_where_they_overlap(seed: int) -> None:
    """Extrusions level with each other, of equal and of different lengths."""
    rng = np.random.default_rng(seed)
    lower, upper = (OUTLINES[str(name)] for name in rng.choice(list(OUTLINES), 2))
    lengths = [float(x) for x in rng.choice([[0.01, 0.01], [0.01, 0.02], [0.02, 0.01]])]
    friction, shift = float(rng.choice([0.0, 0.2])), float(rng.choice([0.0, 0.003]))
    angle, near = float(rng.uniform(0, 2 * pi)), np.inf
    turn = np.array([[cos(angle), -sin(angle)], [sin(angle), cos(angle)]])
    while near > 0.02:
        at = rng.uniform(-0.1, 0.1, 2)
        placed = upper @ turn.T + at
        near = float(np.min(np.linalg.norm(lower[:, None] - placed[None], axis=-1)))
    shapes = [
        make.extrusion(length, points=outline.tolist())
        for outline, length in zip((lower, upper), lengths, strict=True)
    ]
    refused = is_refused(
        *shapes, friction, position=[*map(float, at), shift],
        axis_angle={"axis": [0.0, 0.0, 1.0], "angle": angle},
    )  # fmt: skip
    assert refused == do_overlap(lower, placed)


def drawn_solid(rng: np.random.Generator) -> Solid:
    return random_solid(rng, float(rng.uniform(0.5, 2)))


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(200, 300))
def test_solids_of_all_kinds_are_refused_where_they_overlap(seed: int) -> None:
    """The depth of either one's points in the other, by signed distances of their own, tells."""
    rng = np.random.default_rng(seed)
    lower, upper = drawn_solid(rng), drawn_solid(rng)
    turns = [Rotation.random(random_state=rng) for _ in range(2)]
    way = rng.normal(size=3)
    at = way / np.linalg.norm(way) * (lower.size + upper.size) * rng.uniform(0.5, 1.0)
    friction = float(rng.choice([0.0, 0.2]))
    between = turns[0].inv() * turns[1]
    deepest = max(
        depth(upper, lower, turns[0].inv().apply(at), between.as_matrix()),
        depth(lower, upper, turns[1].inv().apply(-at), between.inv().as_matrix()),
    )
    assert abs(deepest) > 1e-6
    level = turns[0].inv()
    pose = {"position": level.apply(at).tolist(), "quaternion": np.roll(between.as_quat(), 1).tolist()}
    assert is_refused(lower.shape, upper.shape, friction, **pose) == (deepest > 0)


def outside(solid: Solid) -> Solid:
    """What is not in a solid."""
    return replace(solid, distance=lambda x: -solid.distance(x))


@pytest.mark.cases(12)
@pytest.mark.parametrize("seed", range(120))
def test_a_solid_wholly_within_another_is_refused(seed: int) -> None:
    """Their surfaces do not cross; all points of the smaller one are in the larger one."""
    rng = np.random.default_rng(seed)
    lower, turn = drawn_solid(rng), Rotation.random(random_state=rng)
    tried = rng.uniform(-lower.size, lower.size, (4000, 3))
    at = tried[np.argsort(lower.distance(tried))[int(rng.integers(20))]]
    size, drawn = float(-lower.distance(at)) * rng.uniform(0.2, 0.8), int(rng.integers(1 << 32))
    while True:
        upper = random_solid(np.random.default_rng(drawn), size)
        if depth(upper, outside(lower), at, turn.as_matrix()) < 0:
            break
        size /= 2
    pose = {"position": at.tolist(), "quaternion": np.roll(turn.as_quat(), 1).tolist()}
    assert is_refused(lower.shape, upper.shape, float(rng.choice([0.0, 0.2])), **pose)


def test_a_block_about_the_centre_line_of_a_ring_is_told_to_be_within_it() -> None:
    """No closest points tell: the surface of the ring is beyond its focal points from all of them."""
    block = make.polyhedron(
        [[0.1, 0.0, 0.0], [-0.07, 0.1, 0.0], [-0.07, -0.1, 0.03], [0.0, 0.02, 0.12], [0.01, 0.02, -0.11]]
    )
    bodies = [
        make.dynamic("ring", make.torus(1.0, 0.4), mass=1.0, inertia=[1.0] * 3),
        make.dynamic("block", block, mass=1.0, inertia=[1.0] * 3, position=[1.0, 0.0, 0.02]),
    ]
    scene = make.scene("within", bodies, contact=[{"between": ["ring", "block"]}])
    with pytest.raises(SimulationError, match="'block' is within 'ring', or passes through it, at the start"):
        simulate(library_of(scene), until=1e-9)
