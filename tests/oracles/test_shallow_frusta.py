"""A ball falls onto the wall of a lying frustum, or inside it, when the distance from the cone says so.

The cone of a frustum whose ends are almost as wide has its apex far away: the sizes of both bodies and the
taper go by decades.
"""

from __future__ import annotations

from math import hypot, sqrt

import numpy as np
import pytest

from modelgen.scene import python_scenes as make
from tests.oracles.pieces import G, ran


@pytest.mark.cases(12)
@pytest.mark.parametrize("seed", range(60))
def test_a_ball_touches_the_wall_of_a_lying_frustum_in_time(seed: int) -> None:
    rng = np.random.default_rng(seed)
    size, taper = 10 ** rng.uniform(0.3, 2.7), 10 ** rng.uniform(-9, -0.5) * rng.choice([-1, 1])
    is_hollow, drop, length = bool(rng.integers(2)), rng.uniform(0.05, 0.5), 4 + rng.uniform(0.5, 2.5) * size
    ball = make.sphere(1.0) if rng.integers(2) else make.ellipsoid(1.0, 1.0, 1.0)
    wall = make.frustum(
        size + taper * length / 2, size - taper * length / 2, length, cavity=is_hollow
    )  # along x: the radius is `size` at the middle
    reach = hypot(1.0, taper)  # from the axis of the ball to the wall, across the axis of the frustum
    height = drop + reach - size if is_hollow else size + reach + drop
    lying = {"quaternion": [sqrt(0.5), 0.0, sqrt(0.5), 0.0]}
    bodies = [
        make.fixed("wall", wall, **lying),
        make.dynamic("ball", ball, mass=1.0, inertia=[0.4] * 3, position=[0.0, 0.0, float(height)]),
    ]
    time = sqrt(2 * drop / G)
    path = ran(bodies, 1.2 * time, [{"between": ["ball", "wall"]}])
    touched = [event.t for event in path.events if event.kind in ("touch-down", "impact")]
    assert touched
    assert touched[0] == pytest.approx(time, abs=1e-9 + 1e-14 * size / (G * time))
