"""Rows of the erratum table on planar contacts: a rim in a table, and corners that carry a force."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from modelgen.verification.errata.surface_errata import Errors

SMALL = 1e-9  # what counts as zero, of quantities of order 1


def upright_glass(n: int, seed: int) -> Errors:
    """Section 5.3: phi_f of a rim that lies in the table, run through either way; from pi, from 0 or pi."""
    random = np.random.default_rng(seed)
    found = []
    for k in range(n):
        angle, way = random.uniform(-np.pi, np.pi), 1.0 if k % 2 else -1.0
        inward = -np.array([np.cos(angle), np.sin(angle), 0.0])  # principal normal of the rim
        binormal, z = np.array([0.0, 0.0, way]), np.array([0.0, 0.0, -1.0])
        found.append(abs(np.arctan2(-z @ inward, z @ binormal)))
    phi = np.array(found)
    return np.abs(phi - np.pi), np.minimum(phi, np.abs(phi - np.pi))


def three_forces(n: int, seed: int) -> Errors:
    """Corollary 5.2: 1 where no three corners carry the crossing of the diagonals with positive forces; 1
    where none do with forces that are not negative."""
    random = np.random.default_rng(seed)
    best = np.array([_best_weight(random) for _ in range(n)])
    return (best <= SMALL).astype(float), (best < -SMALL).astype(float)


def _best_weight(random: np.random.Generator) -> float:
    """The largest least weight at the crossing, over all triples of corners of a convex quadrilateral."""
    arms = random.uniform(0.3, 2.0, 4)
    angle = random.uniform(0.3, np.pi - 0.3)
    one, two = np.array([1.0, 0.0]), np.array([np.cos(angle), np.sin(angle)])
    corners = np.array([arms[0] * one, arms[1] * two, -arms[2] * one, -arms[3] * two])
    weights = [
        np.linalg.solve(np.vstack([corners[list(triple)].T, np.ones(3)]), [0.0, 0.0, 1.0]).min()
        for triple in combinations(range(4), 3)
    ]
    return float(max(weights))
