"""Contacts that stick in dependent rows: what is proved to be the only motion has no other.

Others are searched for mode by mode (scipy.optimize.root from many starts), and built into problems whose two
motions are known; neither shares anything with the proof.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.linalg import null_space
from scipy.optimize import nnls, root

from modelgen.runtime.friction import FrictionProblem, sticking_motion_is_unique

Array = NDArray[Any]
TOLERANCE = 1e-8  # of the largest |b|
STARTS = 8
MODES = ("opens", "sticks", "slips")


def turned(rng: np.random.Generator, normal: Array) -> Array:
    """(3, 3): a unit normal and two tangents."""
    first = np.cross(normal, rng.normal(size=3))
    first /= np.linalg.norm(first)
    return np.array([normal, first, np.cross(normal, first)])


def rows_of(rng: np.random.Generator, count: int) -> Array:
    """(3 count, 6): rows of points by which others hold a body, at any angles, times M^-1/2."""
    mass, inertia = float(10 ** rng.uniform(-2, 2)), rng.uniform(0.2, 1, size=3)
    size = float(10 ** rng.uniform(-2, 2))
    root_inverse = 1 / np.sqrt(np.array([*[mass] * 3, *(mass * size**2 * inertia)]))
    normals = rng.normal(size=(count, 3))
    normals[1:] -= rng.choice([0, 1, 5]) * normals[0]
    rows = []
    for normal in normals:
        axes = turned(rng, normal / np.linalg.norm(normal))
        arm = size * (rng.uniform(0, 0.5) * rng.normal(size=3) - axes[0])
        rows.append(np.hstack([axes, np.cross(arm, axes)]))
    return np.vstack(rows) * root_inverse


def held(seed: int, count: int, strongest: float) -> tuple[FrictionProblem, Array]:
    """A body that points of others hold by friction, and forces by which all stick."""
    rng = np.random.default_rng(seed)
    J, mu = rows_of(rng, count), rng.uniform(0.05, strongest, size=count)
    N, angle, part = rng.uniform(0.1, 1, count), rng.uniform(0, 2 * np.pi, count), rng.uniform(0, 1, count)
    z = np.column_stack([N, mu * N * part * np.cos(angle), mu * N * part * np.sin(angle)]).ravel()
    return FrictionProblem.of(J @ J.T, -J @ (J.T @ z), mu), z


def forces_and_slip(mode: str, x: Array, mu: float) -> tuple[Array, Array]:
    """Forces and w of a contact from its 3 unknowns: the forces, or N, the angle of slip and its size."""
    if mode == "sticks":
        return x, np.zeros(3)
    t = np.array([np.cos(x[1]), np.sin(x[1])])
    return np.array([x[0], *(-mu * x[0] * t)]), np.array([0, *(x[2] * t)])


def candidates(problem: FrictionProblem, modes: tuple[str, ...], rng: np.random.Generator) -> Iterator[Array]:
    """Forces z in these modes, whether they obey the inequalities or not."""
    A, b, mu = problem.A, problem.b, problem.cone[:, 0]
    shown = [k for k, mode in enumerate(modes) if mode != "opens"]
    kept = [row for k in shown for row in range(3 * k, 3 * k + 3)]

    def parts(x: Array) -> tuple[Array, Array]:
        z, w = np.zeros(len(b)), np.zeros(len(b))
        for place, k in enumerate(shown):
            own = forces_and_slip(modes[k], x[3 * place : 3 * place + 3], mu[k])
            z[3 * k : 3 * k + 3], w[3 * k : 3 * k + 3] = own
        return z, w

    def misfit(x: Array) -> Array:
        z, w = parts(x)
        return np.asarray((A @ z + b - w)[kept])

    regular = modes.count("sticks") < 2
    for _ in range(STARTS if "slips" in modes or not regular else 1):
        start = rng.normal(size=len(kept)) * 3
        found = root(misfit, start, method="hybr" if regular else "lm", tol=1e-13) if kept else None
        yield np.zeros(len(b)) if found is None else parts(found.x)[0]


def others(problem: FrictionProblem, seed: int) -> list[Array]:
    """Solutions of Coulomb's law with w not 0."""
    scale = np.sqrt(np.repeat(np.diag(problem.A)[::3], 3))
    size = np.abs(problem.b / scale).max()
    even = FrictionProblem.of(
        problem.A / np.outer(scale, scale), problem.b / scale / size, problem.cone[:, 0]
    )
    rng, count = np.random.default_rng(seed), len(problem.cone)
    sets = [each for each in product(MODES, repeat=count) if set(each) != {"sticks"}]
    return [z for each in sets for z in candidates(even, each, rng) if obeys(even, z) and moves(even, z)]


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


def sticking_forces(J: Array, mu: Array, load: Array) -> Array | None:
    """Forces within their cones of which J'z = load; None if none were found."""
    turns = np.linspace(0, 2 * np.pi, 48, endpoint=False)
    edges = [
        np.array([*np.zeros(3 * k), 1, m * np.cos(a), m * np.sin(a), *np.zeros(len(J) - 3 * k - 3)])
        for k, m in enumerate(mu)
        for a in turns
    ]
    size = np.linalg.norm(load)
    weights, rest = nnls(J.T @ np.array(edges).T / size, load / size)
    return np.array(edges).T @ weights if rest < 1e-12 else None


def ambiguous(seed: int, count: int) -> tuple[FrictionProblem, Array, Array] | None:
    """A body that may rest, with forces that hold it, or move with others; None if the draw cannot rest."""
    rng = np.random.default_rng(seed)
    J, mu = rows_of(rng, count), rng.uniform(0.2, 2, size=count)
    modes = rng.choice(MODES, size=count, p=[0.2, 0.2, 0.6])
    shut = [
        J[3 * k : 3 * k + (1 if mode == "slips" else 3)] for k, mode in enumerate(modes) if mode != "opens"
    ]
    free = null_space(np.vstack([null_space(J).T, *shut]))  # J does not see the motions of its null space
    if not free.shape[1]:
        return None
    d = free @ rng.normal(size=free.shape[1]) * 10 ** rng.uniform(-3, 0)
    w, z = J @ d, np.zeros(3 * count)
    for k, mode in enumerate(modes):
        own = slice(3 * k + 1, 3 * k + 3)
        if mode == "opens" and w[3 * k] < 0:
            return None
        if mode == "opens":
            continue
        z[3 * k] = rng.uniform(0.1, 1)
        z[own] = -mu[k] * z[3 * k] * w[own] / np.linalg.norm(w[own]) if mode == "slips" else 0
    rest = sticking_forces(J, mu, J.T @ z - d)
    return None if rest is None else (FrictionProblem.of(J @ J.T, -J @ (J.T @ rest), mu), rest, z)


@pytest.mark.parametrize(
    ("count", "strongest", "draws", "least_proved", "least_open"),
    [(2, 0.5, 15, 5, 1), (2, 2.0, 15, 2, 2), (3, 0.5, 6, 2, 0), (3, 2.0, 6, 1, 1)],
)
def test_what_is_proved_has_no_other_motion(
    count: int, strongest: float, draws: int, least_proved: int, least_open: int, lcp: Any
) -> None:
    """And the search does find others where nothing is proved."""
    proved = several = 0
    for seed in range(draws):
        problem, z = held(seed, count, strongest)
        found, only = others(problem, seed), sticking_motion_is_unique(problem, z, lcp)
        assert not (only and found), f"seed {seed}: {found[0]}"
        proved, several = proved + only, several + bool(found)
    assert proved >= least_proved
    assert several >= least_open


@pytest.mark.parametrize("count", [1, 2, 3, 4])
def test_nothing_is_proved_of_two_known_motions(count: int, lcp: Any) -> None:
    known = 0
    for seed in range(400):
        if (drawn := ambiguous(seed, count)) is None:
            continue
        problem, rest, z = drawn
        assert obeys(problem, z)
        known += 1
        assert not sticking_motion_is_unique(problem, rest, lcp), f"seed {seed}"
    assert known >= 20 or count == 1


def test_the_proof_does_not_depend_on_units_and_tangents(lcp: Any) -> None:
    for seed in range(30):
        count = 2 + seed % 3
        problem, z = held(seed, count, 0.5)
        turn = np.kron(np.eye(count), [[1, 0, 0], [0, 0.6, 0.8], [0, -0.8, 0.6]])
        same = FrictionProblem.of(
            1e6 * turn @ problem.A @ turn.T, 1e-3 * turn @ problem.b, problem.cone[:, 0]
        )
        proved = sticking_motion_is_unique(problem, z, lcp)
        assert sticking_motion_is_unique(same, 1e-9 * turn @ z, lcp) == proved


def test_other_problems_are_not_proved(lcp: Any) -> None:
    """Forces that do not stick, a matrix that is not symmetric, two coefficients, five contacts."""
    seed = next(s for s in range(100) if sticking_motion_is_unique(*held(s, 2, 0.5), lcp))
    problem, z = held(seed, 2, 0.5)
    assert not sticking_motion_is_unique(problem, 1.01 * z, lcp)
    odd = problem.A + 0.1 * np.triu(problem.A)
    assert not sticking_motion_is_unique(FrictionProblem.of(odd, -odd @ z, problem.cone[:, 0]), z, lcp)
    unlike = problem.cone[:, :2] * [1.0, 1.1]
    assert not sticking_motion_is_unique(FrictionProblem.of(problem.A, problem.b, unlike), z, lcp)
    assert not sticking_motion_is_unique(*held(seed, 5, 0.05), lcp)
