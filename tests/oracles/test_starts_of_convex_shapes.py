"""A start is refused if and only if the bodies overlap: convex shapes at random, thin and endless ones too.

The judge knows points of which each shape is the hull: two hulls have a common point if and only if a linear
program of their weights has a solution. Members of which hulls 3 % larger and 15 % smaller do not agree are
left out: the core follows lines on a face that are an eighth of it apart, and less of a disc may be in
another. A disc in a frustum is left out as well: lines are not followed through cones.
"""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np
import pytest
from scipy.optimize import linprog
from scipy.spatial.transform import Rotation

from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Scene, Shape
from tests.oracles.pieces import is_start_refused, near_start

Array = np.ndarray[Any, Any]
LARGER, SMALLER = 1.03, 0.85
MEMBERS = 24
FAR = 30.0  # m, of a shape without end what the judge sees, to either side
ENDLESS = ("line", "endless")
PIERCED = ("box", "plate", "frustum", "polyhedron", "disc", "cylinder")
PAIRS = tuple(
    kinds
    for kinds in product((*ENDLESS, "segment", "rod", "capsule", "disc"), PIERCED)
    if kinds != ("disc", "frustum")
)


def _circles(*rims: tuple[float, float]) -> Array:
    """Points of circles about z, by radius and height."""
    t = np.linspace(0, 2 * np.pi, 100, endpoint=False)
    return np.concatenate([np.stack([r * np.cos(t), r * np.sin(t), z + 0 * t], axis=1) for r, z in rims])


def _shape(kind: str, rng: np.random.Generator) -> tuple[Shape, Array]:
    """A shape of random proportions, and points whose convex hull it is, m."""
    a, b, c = (float(each) for each in 10 ** rng.uniform(-1, 0, 3))
    match kind:
        case "line":
            return make.line(), np.array([[0, 0, -FAR], [0, 0, FAR]])
        case "endless":
            return make.cylinder(a), _circles((a, -FAR), (a, FAR))
        case "segment":
            return make.segment(3 * a), np.array([[0, 0, -1.5 * a], [0, 0, 1.5 * a]])
        case "rod":
            return make.cylinder(0.1 * a, 3 * b), _circles((0.1 * a, -1.5 * b), (0.1 * a, 1.5 * b))
        case "capsule":
            angles, length = np.linspace(0, np.pi / 2, 20), 3 * b
            rims = [
                (0.1 * a * np.cos(t), s * (length / 2 + 0.1 * a * np.sin(t))) for t in angles for s in (-1, 1)
            ]
            return make.capsule(0.1 * a, length), _circles(*rims)
        case "cylinder":
            return make.cylinder(a, b), _circles((a, -b / 2), (a, b / 2))
        case "frustum":
            shape = make.shape("frustum", radius_bottom=a, radius_top=b, length=c)
            return shape, _circles((a, -c / 2), (b, c / 2))
        case "disc":
            return make.disc(a), _circles((a, 0.0))
        case "polyhedron":
            corners = a * rng.normal(size=(8, 3))
            return make.polyhedron(corners.tolist()), corners
    size = (a, b, 0.01 * c if kind == "plate" else c)
    return make.box(*size), np.array([*product((-0.5, 0.5), repeat=3)]) * size


def _do_meet(one: Array, two: Array) -> bool:
    rows = np.zeros((5, len(one) + len(two)))
    rows[:3] = np.concatenate([one, -two]).T
    rows[3, : len(one)] = rows[4, len(one) :] = 1.0
    return bool(linprog(np.zeros(rows.shape[1]), A_eq=rows, b_eq=[0, 0, 0, 1, 1]).status == 0)


def _scaled(points: Array, factor: float) -> Array:
    centre = points.mean(axis=0)
    return np.asarray(centre + factor * (points - centre))


def _member(kinds: tuple[str, str], seed: int) -> tuple[Scene, bool | None]:
    """A fixed and a free body near each other; and whether they overlap, None where that is close."""
    rng = np.random.default_rng([PAIRS.index(kinds), seed])
    (first, fixed), (second, free) = (_shape(kind, rng) for kind in kinds)
    turns = [Rotation.random(random_state=int(rng.integers(2**31))) for _ in kinds]
    size = float(np.abs(free).max())
    near = turns[0].apply(fixed * [1.0, 1.0, 1 / FAR if kinds[0] in ENDLESS else 1.0])
    fixed, free = (turn.apply(points) for turn, points in zip(turns, (fixed, free), strict=True))
    one, two = (some[rng.integers(len(some), size=4)].T @ rng.dirichlet([1] * 4) for some in (near, free))
    at = one - two + 0.2 * (size + np.abs(near).max()) * rng.normal(size=3)
    answers = {_do_meet(_scaled(fixed, k), _scaled(free + at, k)) for k in (SMALLER, LARGER)}
    scene = near_start(first, second, turns, at)
    return scene, answers.pop() if len(answers) == 1 else None


@pytest.mark.cases(4)
@pytest.mark.parametrize("kinds", PAIRS, ids="-".join)
def test_a_start_is_refused_if_and_only_if_convex_shapes_overlap(kinds: tuple[str, str]) -> None:
    members = [_member(kinds, seed) for seed in range(MEMBERS)]
    known = [(scene, overlap) for scene, overlap in members if overlap is not None]
    assert {overlap for _, overlap in known} == {False, True}
    assert [is_start_refused(scene) for scene, _ in known] == [overlap for _, overlap in known]
