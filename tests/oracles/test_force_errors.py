"""Stated errors of forces against Newton's equations in 50 digits, where masses make the equations of the
forces badly conditioned: they cover the true errors, which are those of rounding."""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import accumulate, pairwise

import mpmath
import numpy as np
import pytest

from modelgen import simulate
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Scene
from tests.running import library_of

G, RADIUS = 9.81, 0.1
ROUNDED = 1e-10  # relative; of the equations of forces as they stand it would be up to 1


def balls(masses: np.ndarray, places: np.ndarray) -> list[object]:
    return [
        make.dynamic(
            f"b{k}", make.sphere(RADIUS), mass=float(m), inertia=[0.4 * float(m) * RADIUS**2] * 3,
            position=place.tolist(),
        )
        for k, (m, place) in enumerate(zip(masses, places, strict=True))
    ]  # fmt: skip


def tower(masses: np.ndarray) -> Scene:
    """Frictionless spheres, one on the other."""
    n = len(masses)
    places = np.array([[0.0, 0.0, RADIUS + 2 * RADIUS * k] for k in range(n)])
    names = ["floor", *(f"b{k}" for k in range(n))]
    return make.scene(
        "tower", [make.fixed("floor", make.plane()), *balls(masses, places)],
        contact=[{"between": list(pair)} for pair in pairwise(names)], gravity=[0, 0, -G],
    )  # fmt: skip


def zigzag(masses: np.ndarray, width: float) -> Scene:
    """Frictionless spheres in a gap between two walls, left and right in turn, each on the one below."""
    n, across = len(masses), width - 2 * RADIUS
    rise = float(np.sqrt(4 * RADIUS**2 - across**2))
    places = np.array([[(k % 2) * across, 0.0, RADIUS + rise * k] for k in range(n)])
    walls = [
        make.fixed("floor", make.plane()),
        make.fixed(
            "left", make.plane(), position=[-RADIUS, 0, 0], rotation=[[0, 0, 1], [0, 1, 0], [-1, 0, 0]]
        ),
        make.fixed(
            "right",
            make.plane(),
            position=[across + RADIUS, 0, 0],
            rotation=[[0, 0, -1], [0, 1, 0], [1, 0, 0]],
        ),
    ]
    pairs = [("floor", "b0"), *((("left", "right")[k % 2], f"b{k}") for k in range(n))]
    pairs += list(pairwise(f"b{k}" for k in range(n)))
    return make.scene(
        "zigzag", [*walls, *balls(masses, places)], contact=[{"between": list(pair)} for pair in pairs],
        gravity=[0, 0, -G],
    )  # fmt: skip


def forces_of_zigzag(masses: np.ndarray, p: np.ndarray) -> np.ndarray:
    """Forces of floor, walls and neighbours on spheres at p (n, 3), from the topmost sphere down."""
    n = len(masses)
    with mpmath.workdps(50):
        neighbours, walls = [mpmath.mpf(0)] * n, [mpmath.mpf(0)] * n
        load = [mpmath.mpf(0), mpmath.mpf(0)]  # x and z on the sphere from above
        for k in range(n - 1, 0, -1):
            x, z = (mpmath.mpf(float(p[k, i])) - mpmath.mpf(float(p[k - 1, i])) for i in (0, 2))
            size, weight = mpmath.sqrt(x * x + z * z), mpmath.mpf(float(masses[k])) * mpmath.mpf(G)
            neighbours[k] = (weight - load[1]) * size / z
            walls[k] = abs(load[0] + neighbours[k] * x / size)
            load = [-neighbours[k] * x / size, -neighbours[k] * z / size]
        floor = mpmath.mpf(float(masses[0])) * mpmath.mpf(G) - load[1]
        walls[0] = abs(load[0])
        return np.array([float(each) for each in (floor, *walls, *neighbours[1:])])


def check(path: Trajectory, right: np.ndarray) -> None:
    assert path.estimate is not None
    apart = path.force[0, : len(right)] - right
    error = np.sqrt((apart**2).sum() / (right**2).sum())
    assert path.estimate.force is not None
    assert error <= path.estimate.force
    assert error < ROUNDED
    assert path.estimate.force < 1000 * ROUNDED


SIZES = np.unique(np.geomspace(2, 50, 20).astype(int)).tolist()


@pytest.mark.cases(4)
@pytest.mark.parametrize("decades", [0, 4, 8, 10])
@pytest.mark.parametrize("n", SIZES)
def test_the_error_of_forces_in_a_tower_is_stated(n: int, decades: int) -> None:
    rng = np.random.default_rng(100 * n + decades)
    masses = 10.0 ** (decades * (np.arange(n) % 2 - 0.5) * rng.choice([-1, 1]) + rng.uniform(0, 0.1, n))
    weights = accumulate(Fraction(float(m)) * Fraction(G) for m in masses[::-1])
    right = np.array([float(each) for each in weights])[::-1]
    check(simulate(library_of(tower(masses)), until=1e-6, samples=1), right)


@pytest.mark.cases(6)
@pytest.mark.parametrize("seed", range(200))
def test_the_error_of_forces_in_a_random_stack_is_stated(seed: int) -> None:
    rng = np.random.default_rng(seed)
    n, decades = int(rng.integers(2, 13)), float(rng.uniform(0, 4))
    masses = 10.0 ** rng.uniform(-decades, decades, n)
    width = float(rng.uniform(2.3, 3.6)) * RADIUS
    path = simulate(library_of(zigzag(masses, width)), until=1e-6, samples=1)
    check(path, forces_of_zigzag(masses, path.p[0, 3:]))


@dataclass(frozen=True)
class Lift:
    """Spheres that spin about y between two walls, on a platform that a force lifts and whose slide has
    armature. Springs join the centres of neighbours."""

    masses: np.ndarray
    width: float  # m, between the walls
    spins: np.ndarray  # rad/s, of one sign, so that all contacts slip
    friction: float
    platform: float  # kg
    armature: float  # kg
    lift: float  # N
    stiffness: np.ndarray  # N/m, of the spring from each sphere to the next
    rest: np.ndarray  # m

    def scene(self) -> Scene:
        still = zigzag(self.masses, self.width)
        n, table = len(self.masses), make.box(2.0, 2.0, 0.1)
        spun = [
            replace(body, angular_velocity=(0.0, float(w), 0.0))
            for body, w in zip(still.bodies[3:], self.spins, strict=True)
        ]
        lifted = make.dynamic(
            "floor", table, mass=self.platform, inertia=[self.platform] * 3, position=[0, 0, -0.05]
        )
        slide = {
            "name": "slide",
            "kind": "prismatic",
            "between": ["world", "floor"],
            "armature": self.armature,
        }
        springs = [
            {"between": [f"b{k}", f"b{k + 1}"], "stiffness": float(s), "rest_length": float(r)}
            for k, (s, r) in enumerate(zip(self.stiffness, self.rest, strict=True))
        ]
        pairs = [("floor", "b0"), *((("left", "right")[k % 2], f"b{k}") for k in range(n))]
        pairs += pairwise(f"b{k}" for k in range(n))
        contact = [{"between": list(pair), "friction": self.friction} for pair in pairs]
        return make.scene(
            "lift", [lifted, *still.bodies[1:3], *spun], contact=contact, gravity=[0, 0, -G], joint=[slide],
            spring=springs, force=[{"body": "floor", "force": ["0", "0", repr(self.lift)]}],
        )  # fmt: skip

    def forces(self, p: np.ndarray) -> np.ndarray:
        """Of floor, walls and neighbours on spheres at p (n, 3): they solve one linear system with the
        accelerations of all bodies, which keep the gaps."""
        n, exact = len(self.masses), mpmath.mpf
        with mpmath.workdps(50):
            at = [(exact(float(x)), exact(float(z))) for x, z in p[:, [0, 2]]]
            touches = [(-1, 0, (exact(0), exact(1)))]
            touches += [(-2, k, (exact(1 - 2 * (k % 2)), exact(0))) for k in range(n)]
            for k in range(n - 1):
                x, z = (at[k + 1][i] - at[k][i] for i in range(2))
                size = mpmath.sqrt(x * x + z * z)
                touches.append((k, k + 1, (x / size, z / size)))
            size = 2 * n + 1 + len(touches)  # accelerations, that of the platform, forces
            A, b = mpmath.zeros(size), mpmath.zeros(size, 1)
            for k in range(n):
                A[2 * k, 2 * k] = A[2 * k + 1, 2 * k + 1] = exact(float(self.masses[k]))
                b[2 * k + 1] = -exact(float(self.masses[k])) * exact(G)
            A[2 * n, 2 * n] = exact(self.platform) + exact(self.armature)
            b[2 * n] = exact(self.lift) - exact(self.platform) * exact(G)
            for k, (stiff, rest) in enumerate(zip(self.stiffness, self.rest, strict=True)):
                x, z = (at[k + 1][i] - at[k][i] for i in range(2))
                size_of = mpmath.sqrt(x * x + z * z)
                pull = exact(float(stiff)) * (size_of - exact(float(rest)))
                for i, along in enumerate((x / size_of, z / size_of)):
                    b[2 * k + i] += pull * along
                    b[2 * k + 2 + i] -= pull * along
            for j, (below, above, (x, z)) in enumerate(touches):
                column, slip = 2 * n + 1 + j, exact(self.friction)
                # slip of the upper body is w x (-R normal), of the lower w x (R normal), w along y
                push = (x + slip * z, z - slip * x)
                for i in range(2):
                    A[2 * above + i, column] -= push[i]
                    A[column, 2 * above + i] += (x, z)[i]
                    if below >= 0:
                        A[2 * below + i, column] += push[i]
                        A[column, 2 * below + i] -= (x, z)[i]
                if below == -1:
                    A[2 * n, column] += push[1]
                    A[column, 2 * n] -= z
            return np.array([float(each) for each in mpmath.lu_solve(A, b)[2 * n + 1 :]])


def lift(seed: int) -> Lift:
    """Whose contacts all press."""
    rng = np.random.default_rng(seed)
    while True:
        friction = float(rng.uniform(0.05, 0.3)) * (seed % 2)
        n, decades = int(rng.integers(2, 10)), float(rng.uniform(0, 2 if friction else 4))
        masses = 10.0 ** rng.uniform(-decades, decades, n)
        platform, armature = (float(10.0 ** rng.uniform(-2, 2)) for _ in range(2))
        whole = masses.sum() + platform + armature
        drawn = Lift(
            masses=masses, width=float(rng.uniform(2.3, 3.6)) * RADIUS, spins=rng.uniform(1, 5, n),
            friction=friction, platform=platform, armature=armature,
            lift=float(whole * G * rng.uniform(0.5, 1.5)), stiffness=10.0 ** rng.uniform(0, 4, n - 1),
            rest=RADIUS * rng.uniform(0.5, 2.0, n - 1),
        )  # fmt: skip
        places = np.array([body.pose.position for body in zigzag(masses, drawn.width).bodies[3:]])
        forces = drawn.forces(places)
        if forces.min() > 1e-6 * forces.max():
            return drawn


@pytest.mark.cases(6)
@pytest.mark.parametrize("seed", range(200))
def test_the_error_of_forces_with_armature_springs_and_slip_is_stated(seed: int) -> None:
    """But for stacks that may also jam, whose friction mode the core leaves to time-stepping."""
    drawn = lift(seed)
    path = simulate(library_of(drawn.scene()), until=1e-6, samples=1)
    if drawn.friction and "fallback-start" in {event.kind for event in path.events}:
        assert not path.is_trusted
        return
    check(path, drawn.forces(path.p[0, 3:]))
