"""Time-stepping in scenes of many pairs leaves out those that are far apart: none of them meets unseen."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from modelgen import build, derive, emit, require, simulate
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Scene

BODIES = 30  # 465 pairs; scenes of up to 400 follow all of them
STEP = 2e-3  # s


def shower(seed: int, speed: float) -> tuple[Scene, np.ndarray]:
    """Balls at rest in layers above a floor, a fast one that is shot through them; their radii (30,), m."""
    rng = np.random.default_rng(seed)
    radii = rng.uniform(0.04, 0.1, BODIES)
    names = [f"ball{i}" for i in range(BODIES)]
    places = [(0.22 * (i % 3), 0.22 * (i // 3 % 3), 0.15 + 0.22 * (i // 9)) for i in range(BODIES)]
    places[0] = (-1.0, 0.22, 0.4)
    velocities = [[speed, 0.0, 0.0], *([[0.0, 0.0, 0.0]] * (BODIES - 1))]
    balls = [
        make.dynamic(name, make.sphere(float(radius)), density=800.0, position=list(place), velocity=velocity)
        for name, radius, place, velocity in zip(names, radii, places, velocities, strict=True)
    ]
    pairs = [{"between": list(pair)} for pair in combinations(["floor", *names], 2)]
    return make.scene("shower", [make.fixed("floor", make.plane()), *balls], contact=pairs), radii


@pytest.mark.cases(3)
@pytest.mark.parametrize("scheme", ["stewart-trinkle", "moreau"])
@pytest.mark.parametrize(("seed", "speed"), [(0, 2.0), (1, 20.0), (2, 100.0)])
def test_no_pair_that_is_left_out_meets(seed: int, speed: float, scheme: str) -> None:
    """Gaps by the centres and radii of the balls, at the ends of steps."""
    scene, radii = shower(seed, speed)
    path = simulate(
        build(emit(derive(require(scene)))),
        until=0.6, samples=150, estimate=False,
        method="time-stepping", step=STEP, scheme=scheme,
    )  # fmt: skip
    i, j = np.triu_indices(BODIES, 1)
    p = path.p[:, 1:]
    gap = np.linalg.norm(p[:, i] - p[:, j], axis=2) - radii[i] - radii[j]
    told = path.gap[:, BODIES:]  # behind those with the floor
    followed = np.isfinite(told)
    assert path.outcome.succeeded
    assert gap.min() >= -1e-8
    np.testing.assert_allclose(told[followed], gap[followed], atol=1e-9)
    assert not followed.all()
    assert followed[np.abs(gap) < 1e-6].all()  # what touches is followed
    assert p[..., 2].min() >= radii.min() - 1e-8
