"""A wheel on a rail from two measured profiles at 42 poses, beside a dense search.

`python -m tests.benchmarks.wheel_and_rail` prints for each pose the minima of the distance within 3 mm, the
largest difference from the dense search, and the CPU time of a search alone and as one of all.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation

from modelgen import build, derive, distance_minima, emit, require
from modelgen.codegen.library import Library
from modelgen.importing.profile_fit import fit_profile
from modelgen.runtime.poses import pose_matrices as matrices
from modelgen.scene import python_scenes as make
from tests.benchmarks.measured_outlines import curve_distance
from tests.importing.profiles import measured, rail_head, wheel_tread

Array = np.ndarray[Any, Any]
NOISE = 1e-6  # m, of each coordinate of a measured point
RADIUS, GAP = 0.46, 0.5e-3  # m: rolling radius, height of the wheel over the rail at its middle
REACH = 3e-3  # m
UPRIGHT: Array = np.append(np.zeros(3), np.eye(3).ravel())
ALONG, AROUND = (
    801,
    161,
)  # samples of the dense search over the profile, and over the azimuth beside the lowest point


@dataclass(frozen=True)
class Pair:
    """The nodes of both profiles, m, and the library of the scene."""

    rail: Array
    wheel: Array
    library: Library


def wheel_on_rail(noise: float) -> Pair:
    rail, wheel = (
        fit_profile(measured(exact(), noise, seed)).nodes
        for seed, exact in ((1, rail_head), (2, wheel_tread))
    )
    bodies = [
        make.fixed("rail", make.profile_wall(rail.tolist(), 4.0, quaternion=[0.5, 0.5, 0.5, 0.5])),
        make.dynamic(
            "wheel", make.shape("revolution", points=wheel.tolist()), mass=400.0, inertia=[25.0, 25.0, 45.0],
            position=[0.0, 0.0, RADIUS + 0.01], rpy=[-np.pi / 2, 0.0, 0.0],
        ),
    ]  # fmt: skip
    scene = make.scene("wheel_and_rail", bodies, contact=[{"between": ["wheel", "rail"], "friction": 0.3}])
    return Pair(rail, wheel, build(emit(derive(require(scene)))))


def poses() -> Array:
    """(42, 12): seven lateral shifts, three yaws, two rolls."""
    found = []
    for shift, yaw, roll in product(np.linspace(-1.5e-3, 9e-3, 7), (0.0, 5e-3, 20e-3), (0.0, 5e-3)):
        turn = Rotation.from_euler("ZX", [yaw, roll]) * Rotation.from_euler("x", -np.pi / 2)
        found.append(np.append([0.0, shift, RADIUS + GAP], turn.as_matrix().T.ravel()))
    return np.array(found)


def compared(pair: Pair, at: Array) -> Iterator[tuple[Array, Array]]:
    """By pose, the minima of the distance within reach, m, sorted: of the core, and of the dense search."""
    found = distance_minima(
        pair.library, "wheel-rail", matrices(at), matrices(UPRIGHT), gap=REACH, depth=REACH
    )
    assert found.complete.all()
    dense = Dense(pair)
    for k, pose in enumerate(at):
        yield np.sort(found.d[found.row == k]), dense.minima(pose)


class Dense:
    """Minima of the distance of points of the wheel from the profile of the rail, on a grid and refined."""

    def __init__(self, pair: Pair) -> None:
        rail, self.wheel = _spline(pair.rail), _spline(pair.wheel)
        grid = np.linspace(0, rail.x[-1], 20001)
        self.distance = curve_distance(rail, lambda t: rail(t, 1), grid)

    def minima(self, pose: Array) -> Array:
        s, a = np.linspace(0, self.wheel.x[-1], ALONG), np.pi / 2 + np.linspace(-0.2, 0.2, AROUND)
        values = self._off(np.stack(np.meshgrid(s, a, indexing="ij"), axis=-1), pose)
        inner = values[1:-1, 1:-1]
        least = np.ones(inner.shape, dtype=bool)
        for i, j in product((0, 1, 2), repeat=2):
            least &= inner <= values[i : i + inner.shape[0], j : j + inner.shape[1]]
        found = [
            self._refined(np.array([s[i + 1], a[j + 1]]), pose)
            for i, j in zip(*np.nonzero(least), strict=True)
        ]
        within = np.array([each for each in found if abs(each) <= REACH])
        return np.unique(np.round(within, 11))

    def _off(self, at: Array, pose: Array) -> Array:
        profile = self.wheel(at[..., 0])
        local = np.stack(
            [profile[..., 0] * np.cos(at[..., 1]), profile[..., 0] * np.sin(at[..., 1]), profile[..., 1]],
            axis=-1,
        )
        world = local @ pose[3:].reshape(3, 3) + pose[:3]
        return self.distance(world[..., 1:])

    def _refined(self, start: Array, pose: Array) -> float:
        simplex = start + np.array([[0.0, 0.0], [1e-4, 0.0], [0.0, 2e-3]])
        options = {"xatol": 1e-10, "fatol": 1e-15, "maxiter": 1000, "initial_simplex": simplex}
        found = minimize(
            lambda q: float(self._off(q[None], pose)[0]), start, method="Nelder-Mead", options=options
        )
        return float(found.fun)


def _spline(nodes: Array) -> CubicSpline:
    u = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(nodes, axis=0), axis=1))])
    return CubicSpline(u, nodes)


def main() -> None:
    begun = time.process_time()
    pair, at = wheel_on_rail(NOISE), poses()
    built = time.process_time() - begun
    print(f"nodes {len(pair.rail)} and {len(pair.wheel)}; scene and library {built:.1f} s of CPU")
    begun = time.process_time()
    distance_minima(pair.library, "wheel-rail", matrices(at), matrices(UPRIGHT), gap=REACH, depth=REACH)
    together = time.process_time() - begun
    alone, differences = [], []
    for pose, (own, dense) in zip(at, compared(pair, at), strict=True):
        begun = time.process_time()
        distance_minima(pair.library, "wheel-rail", matrices(pose), matrices(UPRIGHT), gap=REACH, depth=REACH)
        alone.append(time.process_time() - begun)
        same = len(own) == len(dense)
        differences.append(float(np.abs(own - dense).max(initial=0.0)) if same else np.inf)
        minima = np.array2string(own * 1e3, precision=6)
        print(f"{pose[1] * 1e3:6.2f} mm  {alone[-1]:.3f} s  {minima} mm  {differences[-1]:.1e} m")
    print(f"largest difference {max(differences):.1e} m")
    print(f"a search alone at most {max(alone):.2f} s, one of 42 {together / len(at):.3f} s of CPU")


if __name__ == "__main__":
    main()
