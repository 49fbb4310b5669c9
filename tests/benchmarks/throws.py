"""A body thrown so that it reaches a place after it has struck the floor: three ways to find the throw.

Run with `python -m tests.benchmarks.throws [--starts 20]`. The velocity and spin of an ellipsoid with
friction and restitution are sought, from perturbed starts, such that after 0.6 s, with one or two blows on
the way, its centre is at a target. Told are how many starts reach it to 1e-6 m, and how many runs each way
takes: Gauss and Newton's method with derivatives and with differences of runs, and a random search (one-fifth
rule).
"""

from __future__ import annotations

import argparse
from collections.abc import Callable

import numpy as np
from scipy.optimize import least_squares

from modelgen import sensitivity
from modelgen.codegen.library import Library
from modelgen.scene.read import read_text
from tests.running import with_velocity
from tests.sensitivity.differences import differentiable

SCENE = """
gravity = [0.0, 0.0, -9.81]
[[body]]
name = "floor"
motion = "fixed"
shape = { kind = "plane" }

[[body]]
name = "egg"
shape = { kind = "ellipsoid", semi_axes = [0.12, 0.09, 0.07] }
density = 800.0
position = [0.0, 0.0, 0.5]

[[contact]]
between = ["egg", "floor"]
friction = 0.3
restitution = 0.7
"""
BODY, UNTIL = "egg", 0.6
EFFORT = 1e-7  # weight of the throw itself beside the miss, m per m/s
REACHED = 1e-6  # m; the effort keeps a throw from ending nearer
BY = [f"{BODY}.velocity", f"{BODY}.angular_velocity"]
FIRST = np.array([0.8, 0.1, 0.3, 2.0, -3.0, 1.0])  # m/s, rad/s
SIZES = np.array([1.0, 1.0, 1.0, 10.0, 10.0, 10.0])


class Throw:
    """The miss of a throw, with a count of runs."""

    def __init__(self, library: Library, target: np.ndarray) -> None:
        self._library, self._target, self.runs = library, target, 0

    def _thrown(self, throw: np.ndarray) -> Library:
        return with_velocity(self._library, BODY, throw.tolist())

    def residual(self, throw: np.ndarray) -> np.ndarray:
        """(9,) the miss, m, and the throw against the first one, weighted."""
        self.runs += 1
        found = sensitivity(self._thrown(throw), UNTIL, of=[f"{BODY}.position"], by=[])
        return np.concatenate([found.value[0] - self._target, EFFORT * (throw - FIRST)])

    def slope(self, throw: np.ndarray) -> np.ndarray:
        found = sensitivity(self._thrown(throw), UNTIL, of=[f"{BODY}.position"], by=BY)
        return np.vstack([found.jacobian[0], EFFORT * np.eye(6)])

    def cost(self, throw: np.ndarray) -> float:
        return float(np.sum(self.residual(throw) ** 2))


def by_derivatives(throw: Throw, start: np.ndarray) -> np.ndarray:
    found: np.ndarray = least_squares(throw.residual, start, jac=throw.slope, x_scale=SIZES).x
    return found


def by_differences(throw: Throw, start: np.ndarray) -> np.ndarray:
    found: np.ndarray = least_squares(throw.residual, start, jac="2-point", x_scale=SIZES).x
    return found


def by_random_search(throw: Throw, start: np.ndarray) -> np.ndarray:
    random, size, best, at = np.random.default_rng(0), 0.3, throw.cost(start), start
    for _ in range(2000):
        tried = at + size * random.normal(size=len(at))
        cost = throw.cost(tried)
        size *= 1.5 if cost < best else 1.5**-0.25
        if cost < best:
            best, at = cost, tried
        if size < 1e-7 or best < REACHED**2:
            break
    return at


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--starts", type=int, default=20)
    count = parser.parse_args().starts
    library = differentiable(read_text(SCENE, "throw.toml"))
    random = np.random.default_rng(1)
    target = np.array([0.7, 0.15, 0.25])
    starts = [FIRST + random.normal(size=6) * np.array([0.3, 0.3, 0.5, 2, 2, 2]) for _ in range(count)]
    ways: dict[str, Callable[[Throw, np.ndarray], np.ndarray]] = {
        "derivatives": by_derivatives, "differences": by_differences, "random search": by_random_search
    }  # fmt: skip
    for name, way in ways.items():
        misses, runs = [], []
        for start in starts:
            throw = Throw(library, target)
            found = way(throw, start)
            runs.append(throw.runs)
            misses.append(float(np.linalg.norm(throw.residual(found)[:3])))
        reached = sum(miss < REACHED for miss in misses)
        print(
            f"{name:14s} reached {reached} of {count}, median miss {np.median(misses):.1e} m, "
            f"runs: median {int(np.median(runs))}, most {max(runs)}",
            flush=True,
        )


if __name__ == "__main__":
    main()
