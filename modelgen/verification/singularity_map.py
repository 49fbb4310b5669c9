"""Singularities of a kind of contact: the condition in words, and its margin over the coordinates."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from modelgen.contact.form_table import contact_kernels
from modelgen.verification.contact_sides import Feature
from modelgen.verification.contacts import eta_of, sample_of
from modelgen.verification.extremal_motion import columns, repeated
from modelgen.verification.random_configurations import Configurations, Partnership, local_axes

Array = np.ndarray[Any, Any]
CELLS = 81  # of the map, in either direction
ANGLE = 0.6  # rad, between the first tangents of both sides
SIMPLE = ("plane", "sphere", "point")  # the same everywhere: the map is over the partner's coordinates


@dataclass(frozen=True)
class MarginMap:
    """mu over two coordinates of one side (rows: the second), or of both; everything else is held."""

    condition: str
    axes: tuple[str, str]
    ranges: tuple[tuple[float, float], tuple[float, float]]
    mu: Array  # (CELLS, CELLS), NaN where there is no pair
    held: str


CONDITIONS = {  # by the dimensions of o and f
    (2, 2): "det A = 0, A = K_f + K_o + d K_o K_f in one tangent frame, (4.1), (4.7)",
    (2, 1): "S = 0, S = κ_f det(I + d K_o) + [K_o adj(I + d K_o)]_ee, κ_f = k_f sin φ_f, (4.32) to (4.35)",
    (1, 1): "D = 0, D = (1 + d κ_o)(1 + d κ_f) − cos² ψ; at d = 0: parallel tangents, Section 4.2.2",
    (2, 0): "det(I + d K_o) = 0: the point lies at a focal point of the surface",
    (1, 0): "1 + d κ_o = 0: the point lies on the axis of curvature of the curve",
}  # fmt: skip


def margin_map(pair: Partnership) -> MarginMap | None:
    """The map at touching contact, or at a small gap for a point beside a curve; None of two points."""
    condition = CONDITIONS.get((pair.o.dimension, pair.f.dimension))
    if condition is None:
        return None
    first = pair.o if pair.o.shape.kind not in SIMPLE or pair.f.dimension == 0 else pair.f
    side = "o" if first is pair.o else "f"
    if first.dimension == 2:
        names, chosen = (f"u_{side}", f"v_{side}"), ((side, 0), (side, 1))
    else:
        names, chosen = (f"t_{side}", "angle"), ((side, 0), ("", 0))
    ranges = tuple(_range(pair, *each) for each in chosen)
    grid = np.array([axis.ravel() for axis in np.meshgrid(*(np.linspace(*r, CELLS) for r in ranges))])
    alpha = {s: _middle(getattr(pair, s), grid.shape[1]) for s in "of"}
    angle = np.full(grid.shape[1], ANGLE)
    for (s, k), values in zip(chosen, grid, strict=True):
        if s:
            alpha[s][k] = values
        else:
            angle = values
    d = 0.1 * pair.length if pair.o.dimension + pair.f.dimension == 1 else 0.0
    mu = _margins(pair, alpha["o"], alpha["f"], angle, d).reshape(CELLS, CELLS)
    held = f"d = {d:.3g} m, everything else in the middle of its range"
    if names[1] != "angle" and pair.f.dimension:
        held += f", angle between the first tangents {ANGLE} rad"
    return MarginMap(condition, names, (ranges[0], ranges[1]), mu, held)


def _range(pair: Partnership, side: str, k: int) -> tuple[float, float]:
    return getattr(pair, side).ranges[k] if side else (-np.pi / 2, np.pi / 2)


def _middle(feature: Feature, n: int) -> Array:
    middle = [0.6 * low + 0.4 * high for low, high in feature.ranges]
    return np.tile(np.reshape(middle, (-1, 1)), (1, n))


def _margins(pair: Partnership, alpha_o: Array, alpha_f: Array, angle: Array, d: float) -> Array:
    """mu of the form's own kernel at pairs that stand in the frames of both sides."""
    n = len(angle)
    x_o, A_o = local_axes(pair.o, alpha_o, pair.numbers[0], pair.placements[0])
    x_f, A_f = local_axes(pair.f, alpha_f, pair.numbers[1], pair.placements[1])
    c, s, zero = np.cos(angle), np.sin(angle), np.zeros(n)
    turn = np.array([[c, s, zero], [s, -c, zero], [zero, zero, zero - 1]]).transpose(2, 0, 1)
    R = A_o @ turn @ A_f.transpose(0, 2, 1)
    p = x_o + d * A_o[:, :, 2] - np.einsum("nij,nj->ni", R, x_f)
    still = np.tile(np.concatenate([np.zeros(3), np.eye(3).ravel()]).reshape(-1, 1), (1, n))
    if pair.kind.f.pose == "identity":
        R = R.transpose(0, 2, 1)
        p = -np.einsum("nij,nj->ni", R, p)
    moved = np.concatenate([p.T, R.transpose(0, 2, 1).reshape(n, 9).T])
    pose_o, pose_f = (moved, still) if pair.kind.f.pose == "identity" else (still, moved)
    none, sign = np.zeros((6, n)), np.sign(-np.sin(angle)) if pair.f.dimension == 1 else np.ones(n)
    alpha = np.concatenate([alpha_o, alpha_f])
    at = Configurations(alpha, pose_o, pose_f, none, none, none, none, np.full(n, d), sign)
    with np.errstate(all="ignore"):
        drawn = sample_of(pair, at)
        place: ca.Function = contact_kernels(pair.kind).place
        out = columns(place, pose_o, pose_f, eta_of(drawn), repeated(pair.parameters, n))
    mu = out[3][0]
    return np.where(np.isfinite(mu), mu, np.nan)
