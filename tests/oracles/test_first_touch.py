"""A shape dropped on another touches it when dense points of both say so, for all pairs of kinds of shapes.

`python -m tests.benchmarks.first_touches` is the same with more members of each pair, and a table.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from modelgen.scene import python_scenes as make
from modelgen.scene.scene_format import SHAPE_KINDS
from tests.benchmarks.first_touches import judge, pairs, specimens
from tests.benchmarks.solids_by_decades import KINDS, VARIANTS, seen
from tests.oracles.pieces import G, ran

CLOSE_CALLS = [
    (
        "capsule",
        "segment",
        2,
    ),  # closest points come in over the end of the wire just before
    ("ellipsoid", "paraboloid", 0),  # a needle, thinner than what is near the start of a way through it
    ("revolution", "disc", 4),  # a way that leaves a sheet at its rim, almost along it
    ("torus", "star", 0),
    ("frustum", "paraboloid", 1),
    ("polyhedron", "segment", 0),  # faces that a wire touches with its ends alone
    ("plate", "segment", 1),
    ("torus", "helix", 3),  # a curve of which a part in a thousand is near
    ("torus", "cone", 0),  # a needle of 0.3 degrees
    ("line", "line", 0),
    ("half_torus", "edge", 12),  # Newton's method leaves the cells that hold the closest points
    ("ellipse_curve", "solid", 8),
    ("box", "point", 36),  # a vertex is nearest until just before
    ("capsule", "cam", 17),  # and finds those of a chart beyond its domain, from the other side
    ("tube", "curve", 48),  # a way that leaves a tube just before it ends
    ("half_torus", "segment", 45),
    ("dome", "curve", 41),  # an open end of a small wire is nearest until just before
    ("disc", "outline", 16),  # sides of the disc were taken for far ones
    ("box", "hollow capsule", 9),  # starts between the caps, in the bore of the side
    ("hollow capsule", "solid", 5),
    ("disc", "circle", 1),  # the chord of a wire passes the disc, the wire beside its rim
    ("disc", "line", 3),
    ("helix", "height_field", 3),  # another turn is far behind the sheet
    ("cone", "polyline", 8),  # a tip, thinner than a falling wire moves between two searches
    ("circle", "curve", 19),  # closest points that were none when the small wire was searched last
]


def test_each_kind_of_shape_has_specimens_that_are_dropped() -> None:
    assert tuple(VARIANTS) == SHAPE_KINDS
    assert {name for names in VARIANTS.values() for name in names} == {*KINDS}
    for kind, names in VARIANTS.items():
        for name in names:
            assert seen(KINDS[name](np.random.default_rng(0), 1.0), 5.0).shape.name == kind


def test_each_kind_of_shape_is_dropped_on_some_other_one() -> None:
    for kind in VARIANTS:
        assert any(specimens(kind, other) for other in VARIANTS), kind


@pytest.mark.cases(6)
@pytest.mark.parametrize(("first", "second"), list(pairs([])))
def test_the_first_touch_of_two_kinds_is_not_missed(first: str, second: str) -> None:
    verdict = judge(first, second, 0)
    assert not verdict.fails, str(verdict)


@pytest.mark.cases(2)
@pytest.mark.parametrize(("first", "second", "seed"), CLOSE_CALLS)
def test_touches_that_were_missed_or_refused(first: str, second: str, seed: int) -> None:
    verdict = judge(first, second, seed)
    assert verdict.outcome == "right", str(verdict)


@pytest.mark.cases(6)
@pytest.mark.parametrize("seed", range(60))
def test_a_thin_plate_does_not_pass_a_point_whose_nearest_point_is_a_vertex(seed: int) -> None:
    """No contact follows the point and the vertex while the plate comes down; the way is that of a ray."""
    rng = np.random.default_rng(seed)
    sizes = np.array([10 ** rng.uniform(-4, -1), *rng.uniform(0.2, 1.0, 2)])
    turn = Rotation.random(random_state=seed)
    corner = sizes / 2 * rng.choice([-1, 1], 3)
    struck = corner * (1 - np.array([rng.uniform(0, 2), *rng.uniform(0.001, 0.05, 2)]))
    up = turn.inv().apply([0.0, 0.0, 1.0])  # axes of the plate: the point moves along it, seen from there
    with np.errstate(divide="ignore"):
        enters = ((-np.sign(up) * sizes / 2 - struck) / up).max()  # of the three slabs, before the point
    drop = float(rng.uniform(0.02, 0.3))
    position = -turn.apply(struck + (enters - drop) * up)
    plate = make.dynamic(
        "plate", make.box(*map(float, sizes)), mass=1.0, inertia=[0.1] * 3,
        position=[*map(float, position)], quaternion=[*map(float, np.roll(turn.as_quat(), 1))],
    )  # fmt: skip
    time = float(np.sqrt(2 * drop / G))
    path = ran([make.fixed("pin", make.point()), plate], 1.2 * time, [{"between": ["plate", "pin"]}])
    touched = [event.t for event in path.events if event.kind == "touch-down"]
    assert touched[:1] == [pytest.approx(time, abs=1e-9)]


@pytest.mark.cases(8)
@pytest.mark.parametrize("seed", [73, *range(73), *range(74, 100)])  # 73: over an end and across in one step
def test_two_straight_wires_touch_between_their_ends_alone(seed: int) -> None:
    """One falls on the other where they cross as seen from above, if both reach so far."""
    rng = np.random.default_rng(seed)
    half, drop, kinds = rng.uniform(0.2, 1.0, 2), float(rng.uniform(0.01, 0.1)), rng.integers(2, size=2)
    turns = Rotation.random(2, random_state=seed)
    along = [each.apply([0, 0, 1] if kind else [1, 0, 0]) for each, kind in zip(turns, kinds, strict=True)]
    part = rng.uniform(0.05, 0.95, 2) * rng.choice([-1, 1], 2) + rng.choice([-1, 0, 0, 1], 2)
    part += np.where(np.abs(np.abs(part) - 1) < 0.05, 0.2, 0.0)
    wires = [
        make.segment(2 * float(h)) if kind else make.edge(2 * float(h))
        for h, kind in zip(half, kinds, strict=True)
    ]
    at = part[0] * half[0] * along[0] - part[1] * half[1] * along[1] + np.array([0, 0, drop])
    turned = [{"quaternion": [*map(float, np.roll(each.as_quat(), 1))]} for each in turns]
    low = make.fixed("low", wires[0], **turned[0])
    high = make.dynamic(
        "high", wires[1], mass=1.0, inertia=[0.1] * 3, position=[*map(float, at)], **turned[1]
    )
    time = float(np.sqrt(2 * drop / G))
    path = ran([low, high], 1.2 * time, [{"between": ["high", "low"]}])
    touched = [event.t for event in path.events if event.kind == "touch-down"]
    assert touched[:1] == ([pytest.approx(time, abs=1e-9)] if (np.abs(part) < 1).all() else [])
