"""Round bodies that land flat, or nearly so, come to the end of their run and gain no energy."""

from __future__ import annotations

import numpy as np
import pytest

from modelgen import simulate
from modelgen.runtime.trajectory import Outcome
from modelgen.scene.read import read_text
from modelgen.scene.scene_from_tables import scene_from_tables
from tests.benchmarks.verdict_scenes import drawn
from tests.running import library_of

HEXAGON = "[[0.3, 0], [0.15, 0.26], [-0.15, 0.26], [-0.3, 0], [-0.15, -0.26], [0.15, -0.26]]"
FLOORS = {
    "plane": 'kind = "plane"',
    "box": 'kind = "box", size = [0.5, 0.5, 0.1], position = [0, 0, -0.05]',
    "prism": f'kind = "extrusion", points = {HEXAGON}, length = 0.1, position = [0, 0, -0.05]',
    "drum": 'kind = "cylinder", radius = 0.4, length = 0.1, position = [0, 0, -0.05]',
}
BODIES = {  # shape, and height of the centre of mass at rest
    "can": ('kind = "cylinder", radius = 0.08, length = 0.12', 0.06),
    "coin": ('kind = "cylinder", radius = 0.1, length = 0.03', 0.015),
    "tube": ('kind = "tube", radius = 0.1, bore = 0.06, length = 0.1', 0.05),
    "frustum": ('kind = "frustum", radius_bottom = 0.08, radius_top = 0.04, length = 0.1', 0.0392857),
}
SCENE = """
[[body]]
name = "floor"
motion = "fixed"
shape = {{ {floor} }}
[[body]]
name = "falling"
shape = {{ {body} }}
density = 700.0
position = [0.02, -0.03, {height}]
rpy = [{tilt}, {across}, {yaw}]
[[contact]]
between = ["falling", "floor"]
friction = {friction}
restitution = {restitution}
"""


@pytest.mark.parametrize("floor", FLOORS)
@pytest.mark.parametrize("body", BODIES)
def test_a_body_that_lands_on_its_flat_end_stays_on_it_and_gains_nothing(floor: str, body: str) -> None:
    random = np.random.default_rng([len(floor), *body.encode()])
    shape, rest = BODIES[body]
    tilt = 10 ** random.uniform(-12, -3) * random.integers(0, 2)
    text = SCENE.format(
        floor=FLOORS[floor], body=shape, height=rest + 0.02 + random.uniform(0.02, 0.1), tilt=tilt,
        across=-tilt / 3, yaw=random.uniform(0, 3), friction=random.uniform(0, 0.8),
        restitution=random.uniform(0, 0.4),
    )  # fmt: skip
    path = simulate(library_of(read_text(text, "flat.toml")), until=1.0, estimate=False)
    assert path.outcome is Outcome.DONE
    assert rest - 1e-7 <= path.p[-1, 1, 2] <= rest + 5e-3  # a coin wobbles on, as Euler's disc
    assert np.all(np.diff(path.energy) <= 1e-7 * path.energy[0])


@pytest.mark.parametrize("seed", [92, 95])
def test_a_cylinder_that_clatters_flat_on_a_box_goes_on(seed: int) -> None:
    """Its rim strikes an edge that it was not seen to be near; and time-stepping takes it over that."""
    tables = drawn("stacks and piles", seed)
    path = simulate(library_of(scene_from_tables("clatters", tables, "<drawn>")), estimate=False)
    assert path.outcome is Outcome.DONE
    assert any("a contact was found too late" in warning for warning in path.warnings)
    assert path.penetration_max < 1e-5


def test_a_ring_that_lands_flat_goes_on() -> None:
    """All around it is equally near to the floor for a moment, and its contact singular."""
    tables = drawn("thin and spline shapes", 57)
    path = simulate(library_of(scene_from_tables("ring", tables, "<drawn>")))
    assert path.is_trusted
    assert any("too near to a singularity" in warning for warning in path.warnings)
    assert path.outcome_contact == ""


DROPPED = """
[[body]]
name = "floor"
motion = "fixed"
shape = {{ kind = "plane" }}
[[body]]
name = "low"
shape = {{ kind = "box", size = {low} }}
density = 500.0
position = [0.0, 0.0, {middle}]
[[body]]
name = "top"
shape = {{ kind = "box", size = {top} }}
density = {density}
position = [{x}, {y}, {height}]
[[contact]]
between = ["low", "floor"]
friction = {mu}
[[contact]]
between = ["top", "low"]
restitution = {restitution}
friction = {mu}
"""


@pytest.mark.parametrize("seed", range(12))
def test_a_block_that_drops_flat_on_another_is_trusted(seed: int) -> None:
    """The lower face rests all the time, and each bounce above it is no event of it."""
    random = np.random.default_rng(seed)
    low = random.uniform([0.1, 0.1, 0.05], [0.4, 0.4, 0.3])
    top = low * random.uniform([0.3, 0.3, 0.3], [0.95, 0.95, 1.5])
    x, y = random.uniform(-0.45, 0.45, 2) * (low - top)[:2]
    text = DROPPED.format(
        low=low.tolist(), top=top.tolist(), middle=low[2] / 2, density=random.uniform(200, 2000), x=x, y=y,
        height=low[2] + top[2] / 2 + 10 ** random.uniform(-3, -0.7), mu=random.uniform(0.1, 0.9),
        restitution=random.uniform(0.05, 0.8),
    )  # fmt: skip
    path = simulate(library_of(read_text(text, "dropped.toml")), until=1.5)
    assert path.is_trusted
    assert path.p[-1, 1, 2] == pytest.approx(low[2] / 2, abs=1e-8)


TOSSED = [  # polyhedra; member 31 comes to lie on a face of three corners after some forty rockings
    seed
    for seed in (31, *range(12))
    if drawn("tossed solids", seed)["body"][1]["shape"]["kind"] == "polyhedron"
]


@pytest.mark.parametrize("seed", TOSSED)
def test_a_face_whose_corners_carry_the_load_is_one_planar_contact(seed: int) -> None:
    tables = drawn("tossed solids", seed)
    tables["run"]["samples"] = 400
    path = simulate(library_of(scene_from_tables("tossed", tables, "<drawn>")), estimate=False)
    stands_on_corners = np.count_nonzero(path.force > 1e-6, axis=1) >= 3
    assert not np.any(stands_on_corners & np.all(path.patch < 0, axis=1))
