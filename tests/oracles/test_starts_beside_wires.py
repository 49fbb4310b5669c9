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
