"""Contact parameters to start from: the two sides are sampled, the likeliest pairs refined by Newton.

A pair of samples is likely when the points are near each other and the normals opposed, a curve's tangent
across the normal; around the likeliest the sides are sampled again, finer. Of all extrema found, the one with
the smallest |d| is taken. Two curves have no exterior: the second lies on the positive side at the start,
unless the scene says on which side it lies.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from modelgen.errors import SimulationError
from modelgen.runtime.samples import Patch, Sampled
from modelgen.runtime.session import Session
from modelgen.runtime.tables import Array

ZOOMS = 2  # finer samplings around the likeliest pair
STARTS = 6  # pairs refined by Newton
SHRINK = 0.2  # size of a finer window against the one before


def find_closest(session: Session) -> None:
    """Writes the closest points of every contact into session.eta, at the start's poses.

    Raises:
        SimulationError: no extremum was found from any start; names the contact.
    """
    poses = session.poses()
    for index, contact in enumerate(session.sentence["contacts"]):
        layout = session.layout(index)
        if layout == ["none", "none"]:
            continue
        o = Sampled(session, contact["shape_o"], poses[contact["o"]], layout[0])
        f = Sampled(session, contact["shape_f"], poses[contact["f"]], layout[1])
        best = _best(session, index, _starts(o, f))
        if best is None:
            raise SimulationError(
                f"contact {contact['name']!r}",
                "no pair of closest points was found at the start",
                "surfaces with a nearest pair there",
                "start the bodies nearer to each other, or away from a symmetric position",
            )
        if layout[1] == "signed_curve":
            best = _oriented(session, index, contact, best)
        session.eta[contact["eta"] : contact["eta"] + len(best)] = best


def _oriented(session: Session, index: int, contact: Mapping[str, Any], eta: Array) -> Array:
    """eta with the signs of two curves turned round where the start asks for it."""
    found = session.settle(index, eta)
    hint, d = contact["normal"], float(found["d"])
    touching = float(session.settings.start_gap * session.system.length)
    if hint is None and abs(d) <= touching:
        raise SimulationError(
            f"contact {contact['name']!r}",
            "two curves touch at the start, which has no side of its own",
            "a gap, or a contact that says on which side the second curve lies",
            "give the contact a normal, from the first curve to the second",
        )
    wrong = d < 0 if hint is None else float(np.dot(found["normal"], hint)) < 0
    return eta * np.array([1, 1, -1, -1]) if wrong else eta


def _starts(o: Sampled, f: Sampled) -> list[Array]:
    """Contact parameters of the likeliest pairs, finest first."""
    apart = float(np.linalg.norm(f.origin - o.origin))
    reach = apart + max(o.bounding or 0.0, f.bounding or 0.0, 1e-3 * apart)
    windows = o.window(2 * reach), f.window(2 * reach)
    starts: list[Array] = []
    for _ in range(ZOOMS + 1):
        patches = o.sample(windows[0]), f.sample(windows[1])
        pairs = _likeliest(*patches)
        starts = [np.concatenate([o.eta(patches[0], i), f.eta(patches[1], j)]) for i, j in pairs] + starts
        i, j = pairs[0]
        windows = _around(windows[0], patches[0].uv[i]), _around(windows[1], patches[1].uv[j])
    return starts


def _around(window: Array, centre: Array) -> Array:
    half = SHRINK / 2 * (window[:, 1] - window[:, 0])
    return np.stack([centre - half, centre + half], -1)


def _likeliest(o: Patch, f: Patch) -> list[tuple[int, int]]:
    """Indices of the STARTS pairs with the least |P_f - P_o| + size (1 + n_o.n_f).

    With a curve |n_o.tangent| is in the place of the last, with two curves nothing.
    """
    span = f.points[None, :] - o.points[:, None]
    distance = np.sqrt((span**2).sum(-1))
    size = min(np.ptp(o.points, axis=0).max(), np.ptp(f.points, axis=0).max())
    merit = distance + size * _tilt(o, f)
    flat = np.argpartition(merit.ravel(), STARTS)[:STARTS]
    ordered = flat[np.argsort(merit.ravel()[flat])]
    return [(int(k) // len(f.points), int(k) % len(f.points)) for k in ordered]


def _tilt(o: Patch, f: Patch) -> Array:
    """How far from extremal the directions of each pair (n_o, n_f) are, from 0."""
    cosine: Array = o.directions @ f.directions.T
    if o.is_curve:
        return np.zeros_like(cosine)
    return np.abs(cosine) if f.is_curve else 1.0 + cosine


def _best(session: Session, index: int, starts: list[Array]) -> Array | None:
    found: list[tuple[float, Array]] = []
    for start in starts:
        result = session.settle(index, start)
        regular = min(result["margin"]) > session.accuracy.lost
        if result["steps"] >= 0 and regular and np.isfinite(result["d"]):
            found.append((abs(float(result["d"])), result["eta"]))
    return min(found, key=lambda pair: pair[0])[1] if found else None
