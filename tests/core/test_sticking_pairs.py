"""Two contacts that stick in dependent rows: what is proved to be the only motion has no other.

Others are searched for mode by mode (scipy.optimize.root from many starts), which shares nothing with the
proof.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import root

from modelgen.runtime.friction import FrictionProblem, sticking_pair_is_unique

Array = NDArray[Any]
TOLERANCE = 1e-8  # of the largest |b|
STARTS = 8


def turned(rng: np.random.Generator, normal: Array) -> Array:
    """(3, 3): a unit normal and two tangents."""
    first = np.cross(normal, rng.normal(size=3))
    first /= np.linalg.norm(first)
    return np.array([normal, first, np.cross(normal, first)])


def pair(seed: int, strongest: float) -> tuple[FrictionProblem, Array]:
    """A body that two points of another hold by friction, at any angles, and forces by which both stick."""
    rng = np.random.default_rng(seed)
    mass, inertia = float(10 ** rng.uniform(-2, 2)), rng.uniform(0.2, 1, size=3)
    size = float(10 ** rng.uniform(-2, 2))
    inverse = np.diag([*[1 / mass] * 3, *(1 / (mass * size**2 * inertia))])
    normals = rng.normal(size=(2, 3))
    normals[1] -= rng.choice([0, 1, 5]) * normals[0]
    rows = []
    for normal in normals:
        axes = turned(rng, normal / np.linalg.norm(normal))
        arm = size * (rng.uniform(0, 0.5) * rng.normal(size=3) - axes[0])
        rows.append(np.hstack([axes, np.cross(arm, axes)]))
    J, mu = np.vstack(rows), rng.uniform(0.05, strongest, size=2)
    A = J @ inverse @ J.T
    N, angle, part = rng.uniform(0.1, 1, 2), rng.uniform(0, 2 * np.pi, 2), rng.uniform(0, 1, 2)
    z = np.column_stack([N, mu * N * part * np.cos(angle), mu * N * part * np.sin(angle)]).ravel()
    return FrictionProblem.of((A + A.T) / 2, -A @ z, mu), z


def forces_and_slip(mode: str, x: Array, mu: float) -> tuple[Array, Array]:
    """Forces and w of a contact from its 3 unknowns: the forces, or N, the angle of slip and its size."""
    if mode == "sticks":
        return x, np.zeros(3)
    t = np.array([np.cos(x[1]), np.sin(x[1])])
    return np.array([x[0], *(-mu * x[0] * t)]), np.array([0, *(x[2] * t)])


def candidates(problem: FrictionProblem, modes: tuple[str, str], rng: np.random.Generator) -> Iterator[Array]:
    """Forces z in these modes, whether they obey the inequalities or not."""
    A, b, mu = problem.A, problem.b, problem.cone[:, 0]
    shown = [k for k in (0, 1) if modes[k] != "opens"]
    held = [row for k in shown for row in range(3 * k, 3 * k + 3)]

    def parts(x: Array) -> tuple[Array, Array]:
        z, w = np.zeros(6), np.zeros(6)
        for place, k in enumerate(shown):
            own = forces_and_slip(modes[k], x[3 * place : 3 * place + 3], mu[k])
            z[3 * k : 3 * k + 3], w[3 * k : 3 * k + 3] = own
        return z, w

    def misfit(x: Array) -> Array:
        z, w = parts(x)
        return np.asarray((A @ z + b - w)[held])

    for _ in range(STARTS if "slips" in modes else 1):
        found = root(misfit, rng.normal(size=len(held)) * 3, tol=1e-13) if held else None
        yield np.zeros(6) if found is None else parts(found.x)[0]


def others(problem: FrictionProblem, seed: int) -> list[Array]:
    """Solutions of Coulomb's law with w not 0."""
    scale = np.sqrt(np.repeat(np.diag(problem.A)[::3], 3))
    size = np.abs(problem.b / scale).max()
    even = FrictionProblem.of(
        problem.A / np.outer(scale, scale), problem.b / scale / size, problem.cone[:, 0]
    )
    rng, modes = np.random.default_rng(seed), ("opens", "sticks", "slips")
    pairs = [(one, two) for one in modes for two in modes if (one, two) != ("sticks", "sticks")]
    return [z for each in pairs for z in candidates(even, each, rng) if obeys(even, z) and moves(even, z)]


def moves(problem: FrictionProblem, z: Array) -> bool:
    return bool(np.abs(problem.A @ z + problem.b).max() > 1e-5)


def obeys(problem: FrictionProblem, z: Array) -> bool:
    """Coulomb's law, inequality by inequality."""
    w = problem.A @ z + problem.b
    for k, mu in enumerate(problem.cone[:, 0]):
        N, f, opening, slip = z[3 * k], z[3 * k + 1 : 3 * k + 3], w[3 * k], w[3 * k + 1 : 3 * k + 3]
        speed = np.linalg.norm(slip)
        small = TOLERANCE * (1 + np.abs(z).max())
        if min(N, opening) < -small or min(N, opening) > small or np.linalg.norm(f) > mu * N + small:
            return False
        if speed > small and np.linalg.norm(f * speed + mu * N * slip) > small * (1 + speed):
            return False
    return True


@pytest.mark.parametrize(("strongest", "least_proved", "least_open"), [(0.5, 5, 1), (2.0, 2, 2)])
def test_what_is_proved_has_no_other_motion(
    strongest: float, least_proved: int, least_open: int, lcp: Any
) -> None:
    """And the search does find others where nothing is proved."""
    proved = several = 0
    for seed in range(15):
        problem, z = pair(seed, strongest)
        found, only = others(problem, seed), sticking_pair_is_unique(problem, z, lcp)
        assert not (only and found), f"seed {seed}: {found[0]}"
        proved, several = proved + only, several + bool(found)
    assert proved >= least_proved
    assert several >= least_open


def test_the_proof_does_not_depend_on_units_and_tangents(lcp: Any) -> None:
    for seed in range(20):
        problem, z = pair(seed, 0.5)
        turn = np.eye(6)
        turn[1:3, 1:3] = [[0.6, 0.8], [-0.8, 0.6]]
        same = FrictionProblem.of(
            1e6 * turn @ problem.A @ turn.T, 1e-3 * turn @ problem.b, problem.cone[:, 0]
        )
        assert sticking_pair_is_unique(problem, z, lcp) == sticking_pair_is_unique(same, 1e-9 * turn @ z, lcp)


def test_other_problems_are_not_proved(lcp: Any) -> None:
    """Forces that do not stick, a matrix of full rank, two coefficients, one contact."""
    seed = next(s for s in range(100) if sticking_pair_is_unique(*pair(s, 0.5), lcp))
    problem, z = pair(seed, 0.5)
    assert not sticking_pair_is_unique(problem, 1.01 * z, lcp)
    regular = problem.A + np.diag(np.diag(problem.A))
    assert not sticking_pair_is_unique(FrictionProblem.of(regular, -regular @ z, problem.cone[:, 0]), z, lcp)
    unlike = problem.cone[:, :2] * [1.0, 1.1]
    assert not sticking_pair_is_unique(FrictionProblem.of(problem.A, problem.b, unlike), z, lcp)
    one = FrictionProblem.of(problem.A[:3, :3], problem.b[:3], problem.cone[:1, 0])
    assert not sticking_pair_is_unique(one, z[:3], lcp)
