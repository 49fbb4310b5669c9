"""A start is refused if and only if a body without surfaces is in a solid: outlines and segments at random.

The judge has the distance of 20,000 points of each curve from the solid in closed form. Members at which the
least one is within a hundredth of the smaller body of zero are left out. A solid that stands above the area
of an outline, or passes through the area alone, is not in it: an outline is touched from outside.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from modelgen.scene.scene_types import Scene
from tests.benchmarks.solids_by_decades import KINDS
from tests.oracles.pieces import is_start_refused, near_start

MEMBERS = 24
POINTS = np.linspace(0, 1, 20_000)
SOLIDS = ("box", "cylinder", "tube", "frustum", "dome", "polyhedron", "star", "torus")


def _member(wire: str, solid: str, seed: int) -> tuple[Scene, bool | None]:
    """A fixed wire beside a free solid; and whether it is in the solid, None where that is close."""
    rng = np.random.default_rng([*(list(KINDS).index(kind) for kind in (wire, solid)), seed])
    thin, thick = KINDS[wire](rng, 1.0), KINDS[solid](rng, float(10 ** rng.uniform(-1, 1.5)))
    turns = [Rotation.random(random_state=int(rng.integers(2**31))) for _ in range(2)]
    rim = turns[0].apply(np.concatenate([edge(POINTS) for edge in thin.edges]))
    parts = [*thick.faces] or [*thick.edges]
    surface = turns[1].apply(
        parts[rng.integers(len(parts))](*rng.uniform(0, 1, (2 if thick.faces else 1, 1)))
    )
    size = min(thin.size, thick.size)
    at = rim[rng.integers(len(rim))] - surface[0] + 0.3 * size * rng.normal(size=3)
    least = float(thick.distance(turns[1].inv().apply(rim - at)).min())
    scene = near_start(thin.shape, thick.shape, turns, at)
    return scene, None if abs(least) < 0.01 * size else least < 0


@pytest.mark.cases(3)
@pytest.mark.parametrize("solid", SOLIDS)
@pytest.mark.parametrize("wire", ["outline", "segment"])
def test_a_wire_is_refused_if_and_only_if_it_is_in_a_solid(wire: str, solid: str) -> None:
    members = [_member(wire, solid, seed) for seed in range(MEMBERS)]
    known = [(scene, inside) for scene, inside in members if inside is not None]
    assert {inside for _, inside in known} == {False, True}
    assert [is_start_refused(scene) for scene, _ in known] == [inside for _, inside in known]


def _beside(wire: str, solid: str, seed: int) -> Scene | None:
    """A small wire close to some place of a large solid, not in it; None where the solid bends too much."""
    rng = np.random.default_rng([*(list(KINDS).index(kind) for kind in (wire, solid)), seed])
    thin, thick = KINDS[wire](rng, 1.0), KINDS[solid](rng, float(10 ** rng.uniform(2, 3)))
    turns = [Rotation.random(random_state=int(rng.integers(2**31))) for _ in range(2)]
    rim = turns[0].apply(np.concatenate([edge(POINTS) for edge in thin.edges]))
    place = thick.faces[rng.integers(len(thick.faces))](*rng.uniform(0, 1, (2, 1)))[0]
    step = 1e-5 * thick.size * np.eye(3)
    normal = turns[1].apply(thick.distance(place + step) - thick.distance(place - step))
    normal /= np.linalg.norm(normal)
    gap = 10 ** rng.uniform(-3, -0.5)
    at = rim[(rim @ normal).argmin()] - turns[1].apply(place) - gap * normal
    is_apart = thick.distance(turns[1].inv().apply(rim - at)).min() > 1e-4
    return near_start(thin.shape, thick.shape, turns, at) if is_apart else None


@pytest.mark.cases(3)
@pytest.mark.parametrize("solid", ["tube", "half_torus", "torus", "capsule"])
@pytest.mark.parametrize("wire", ["segment", "curve", "bspline_curve"])
def test_a_small_wire_close_to_a_large_solid_starts(wire: str, solid: str) -> None:
    """From a thousandth of the size of the wire off the solid, which is up to a thousand times larger."""
    found = [_beside(wire, solid, seed) for seed in range(MEMBERS)]
    scenes = [scene for scene in found if scene is not None]
    assert len(scenes) > MEMBERS / 4
    assert not any(is_start_refused(scene) for scene in scenes)
