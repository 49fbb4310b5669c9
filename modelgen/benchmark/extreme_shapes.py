"""Shapes at the ends of double precision: gaps, curvatures, tangents, rims, poles, discs and needles."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from math import cos, pi, sin, sqrt
from typing import Any

import numpy as np

from modelgen.benchmark.extreme_trials import EPS, RUN, Extreme, G, Trial, against, decades, tried_run
from modelgen.benchmark.libraries_by_kinds import LibrariesByKinds
from modelgen.benchmark.tilted_spheroid import tilted_spheroid
from modelgen.runtime.closest_points import Extremum, closest_points
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene.python_scenes import (
    chart,
    circle,
    disc,
    dynamic,
    ellipsoid,
    fixed,
    paraboloid,
    plane,
    scene,
    sphere,
)
from modelgen.scene.scene_types import Scene

Array = np.ndarray[Any, Any]

LARGE_AXES, SMALL_AXES = np.array([0.3, 0.25, 0.2]), np.array([0.1, 0.07, 0.05])
NORMAL = np.array([0.48, -0.6, 0.64])


def _resting(body: Any, ground: Any, until: float, **pair: object) -> Scene:
    name = ground.name
    return scene(
        f"extreme_{body.name}_{name}",
        [ground, body],
        contact=[{"between": [body.name, name], **pair}],
        run={"until": until},
    )


# ---- gaps ----


def _turned() -> Array:
    """A rotation (3,3) without symmetry."""
    axis, angle = np.array([2.0, -3.0, 6.0]) / 7, 1.1
    skew = np.cross(np.eye(3), axis)
    return np.asarray(np.eye(3) - sin(angle) * skew + (1 - cos(angle)) * skew @ skew)


def _tip(axes: Array, n: Array) -> Array:
    """The point of an ellipsoid with this exterior normal."""
    scaled = axes * n
    return np.asarray(axes * scaled / np.linalg.norm(scaled))


def _eggs() -> Scene:
    one = fixed("large", ellipsoid(*LARGE_AXES), position=[0.0, 0.0, 0.0], rpy=[0.1, 0.0, 0.0])
    two = dynamic("small", ellipsoid(*SMALL_AXES), density=1000.0, position=[0.0, 0.0, 1.0])
    return _resting(two, one, 1.0)


def _try_gap(gap: float, libraries: LibrariesByKinds) -> Trial:
    """Two ellipsoids placed so that a gap (m) and its normal are known: the error of both."""
    Q = _turned()
    p = _tip(LARGE_AXES, NORMAL) + gap * NORMAL - Q @ _tip(SMALL_AXES, -Q.T @ NORMAL)
    here, there = np.eye(3, 4), np.column_stack([Q, p])
    found = closest_points(libraries.library(_eggs()), "small-large", there, here)
    turned = float(np.linalg.norm(found.normal[0] + NORMAL))
    error = max(abs(float(found.d[0]) - gap) / max(float(np.abs(p).max()), 0.3), turned)
    told = () if found.certified[0] else (f"outcome {Extremum(int(found.outcome[0])).name}, not certified",)
    return Trial(error, told, "warned" if told else "safe")


# ---- curvatures that cancel ----


def _ball_in_bowl(x: float) -> Scene:
    """A ball of radius (1 - x) of its bowl's, through one swing of the pendulum of length x."""
    ball = dynamic(
        "ball",
        sphere(0.1 * (1 - x)),
        mass=1.0,
        inertia=[4e-3] * 3,
        position=[0.3 + _arm(x) * sin(1.0), 0.2, 0.4 - _arm(x) * cos(1.0)],
    )
    return _resting(
        ball, fixed("bowl", sphere(0.1, cavity=True), position=[0.3, 0.2, 0.4]), 2 * pi * sqrt(_arm(x) / G)
    )


def _arm(x: float) -> float:
    return 0.1 - 0.1 * (1 - x)


def _pendulum_error(x: float, path: Trajectory) -> float:
    """Over the pendulum's length, against theta = 2 asin(k sn(K - w t, k^2)), k = sin(1/2)."""
    from scipy.special import ellipj, ellipk

    k = sin(0.5)
    sine = k * ellipj(ellipk(k * k) - sqrt(G / _arm(x)) * path.t, k * k)[0]
    theta = 2 * np.arcsin(sine)
    at = path.body_names.index("ball")
    true = np.stack(
        [0.3 + _arm(x) * np.sin(theta), np.full_like(theta, 0.2), 0.4 - _arm(x) * np.cos(theta)], -1
    )
    return float(np.abs(path.p[:, at] - true).max()) / _arm(x)


def _try_ball_in_bowl(x: float, libraries: LibrariesByKinds) -> Trial:
    return tried_run(partial(_ball_in_bowl, x), libraries, partial(_pendulum_error, x))


def _egg_in_cavity(x: float) -> Scene:
    axes = [0.30, 0.25, 0.20]
    sizes = [(1 - x) * axis for axis in axes]
    egg = dynamic(
        "egg",
        ellipsoid(*sizes),
        density=1000.0,
        position=[0.0, 0.0, sizes[2] - axes[2]],
        velocity=[0.3 * sqrt(x), -0.2 * sqrt(x), 0.0],
        angular_velocity=[0.1, 0.2, 3.0],
    )
    return _resting(egg, fixed("cave", ellipsoid(*axes, cavity=True)), 0.1 * sqrt(x))


def _dome_on_dome(x: float) -> Scene:
    """Two paraboloids of curvature x over the size, one on the other."""
    lid = dynamic(
        "lid",
        ellipsoid(0.1, 0.1, 0.1 * x),
        mass=1.0,
        inertia=[1e-3, 1e-3, 2e-3],
        position=[0.0, 0.0, 0.1 * x],
        velocity=[0.1, 0.05, 0.0],
        angular_velocity=[0.0, 0.0, 2.0],
    )
    return _resting(lid, fixed("dome", paraboloid(-0.1 / x, -0.15 / x)), 0.05)


def _egg_on_plane(ratio: float, turned: float = 0.2) -> Scene:
    """A spheroid about z of this ratio of height to width, the larger 0.1 m, tilted, at rest on a table."""
    a, c = (0.1, 0.1 * ratio) if ratio <= 1 else (0.1 / ratio, 0.1)
    egg = tilted_spheroid(a, c, turned, [0.0, 1.0, 0.5])
    return _resting(egg, fixed("table", plane()), 0.5)


# ---- curves ----


def _crossed_rings(angle: float) -> Scene:
    """A ring hangs in another, their tangents crossing at an angle."""
    ring = dynamic(
        "ring",
        circle(0.15),
        mass=0.3,
        inertia=[0.003375, 0.003375, 0.00675],
        position=[0.0, 0.0, -0.35],
        rpy=["pi/2", 0.0, angle],
        velocity=[0.01, 0.01, 0.0],
    )
    hook = fixed("hook", circle(0.2), rpy=["pi/2", 0.0, 0.0])
    return _resting(ring, hook, 0.02, normal=[0.0, 0.0, -1.0])


def _tilted_coin(tilt: float) -> Scene:
    """A flat disc at rest on its rim, tilted; it falls flat."""
    coin = dynamic(
        "coin",
        disc(0.05),
        mass=0.1,
        inertia=[6.25e-5, 6.25e-5, 1.25e-4],
        position=[0.0, 0.0, 0.05 * sin(tilt)],
        rpy=[tilt, 0.0, 0.3],
    )
    return _resting(coin, fixed("table", plane()), 0.2 * sqrt(tilt) * sqrt(0.05 / G))


def _at_pole(angle: float) -> Scene:
    """A globe of the user's own, which touches a table near a pole of its chart."""
    globe = chart(
        "r*cos(v)*cos(u)",
        "r*cos(v)*sin(u)",
        "0.8*r*sin(v)",
        domain=[(-pi, pi), (-pi / 2, pi / 2)],
        periodic=[True, False],
        poles=["v_min", "v_max"],
        parameters={"r": 0.1},
    )
    slope = angle / 0.8
    height = 0.1 * sqrt((0.8 * cos(slope)) ** 2 + sin(slope) ** 2)
    body = dynamic(
        "globe",
        globe,
        mass=1.0,
        inertia=[4e-3, 4e-3, 5e-3],
        position=[0.0, 0.0, height],
        rpy=[slope, 0.0, 0.7],
        angular_velocity=[0.5, 0.2, 1.0],
    )
    return _resting(body, fixed("table", plane()), 0.1)


def _compared(make: Callable[[float], Scene]) -> Callable[[float, LibrariesByKinds], Trial]:
    """Runs of scenes in double precision against long double."""

    def attempt(value: float, libraries: LibrariesByKinds) -> Trial:
        return tried_run(partial(make, value), libraries, against(libraries, partial(make, value)))

    return attempt


SHAPES = (
    Extreme(
        "gap", "gap of two ellipsoids of 0.3 m, 0.1 m; m", decades(-17, 8), (1e-16, 1e-9, 1.0, 1e8),
        "rounding of the pose", lambda x: 4 * EPS, "gap over the distance, and normal", _try_gap,
    ),
    Extreme(
        "penetration", "depth of the same; m", tuple(-x for x in decades(-17, -1)), (-1e-16, -1e-9, -0.1),
        "rounding of the pose", lambda x: 4 * EPS, "gap over the distance, and normal", _try_gap,
    ),
    Extreme(
        "conforming ball", "1 - r/R in a round bowl", decades(-1, -8), (1e-1, 1e-4, 1e-8),
        "tolerance + eps/x", lambda x: 1e-11 + 20 * EPS / x, "swing over R - r, against the pendulum",
        _try_ball_in_bowl, warned=1.9e-3, refused=1.9e-5,
    ),
    Extreme(
        "conforming ellipsoid", "1 - ratio of sizes to its cavity", decades(-1, -8), (1e-1, 1e-3, 1e-8),
        "tolerance + eps/x^2", lambda x: 1e-11 + 10 * EPS / x**2, RUN, _compared(_egg_in_cavity),
        warned=5e-3, refused=5e-4,
    ),
    Extreme(
        "flat on flat", "curvature of both times the size", decades(0, -8), (1.0, 1e-4, 1e-8),
        "tolerance + eps/x", lambda x: 1e-11 + 10 * EPS / x, RUN, _compared(_dome_on_dome),
        warned=6e-4, refused=6e-6,
    ),
    Extreme(
        "disc", "height over width of a spheroid on a plane", decades(0, -8), (1e-1, 1e-3, 1e-8),
        "tolerance", lambda x: 2e-11, RUN, _compared(_egg_on_plane),
    ),
    Extreme(
        "needle", "height over width of a spheroid on a plane", decades(0, 7), (1e1, 1e3, 1e7),
        "tolerance + 200 eps x", lambda x: 2e-11 + 200 * EPS * x, RUN, _compared(_egg_on_plane),
        warned=2e3, refused=2e5,
    ),
    Extreme(
        "parallel tangents", "angle of two rings that touch; rad", decades(-1, -8), (1e-1, 1e-2, 1e-8),
        "tolerance/x^2", lambda x: 1e-11 + 1e-13 / x**2, RUN, _compared(_crossed_rings),
        warned=4e-2, refused=4e-3,
    ),
    Extreme(
        "rim flat on a plane", "lean of a coin; rad", decades(-1, -9), (1e-1, 1e-3, 1e-9),
        "tolerance + eps/x", lambda x: 1e-12 + 10 * EPS / x, RUN, _compared(_tilted_coin), warned=1.1e-3,
        switched=2e-5, switch="it stands on three points of the rim",
    ),
    Extreme(
        "pole of a chart", "distance of the contact from it; rad", decades(-1, -9), (1e-1, 1e-9),
        "none: a cap of its own lies there", lambda x: 2e-11, RUN, _compared(_at_pole),
    ),
)  # fmt: skip
