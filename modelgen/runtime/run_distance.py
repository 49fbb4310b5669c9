"""How far two runs of one scene are apart at their common samples."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import sqrt
from typing import Any

import numpy as np

from modelgen.runtime.event_matching import alone, in_pairs
from modelgen.runtime.tables.ctypes_structures import Array
from modelgen.runtime.trajectory import Event, Trajectory

MOTION = ("p", "quaternion", "v", "w")  # columns of a run that are compared
EMPTY = {"gap": np.nan, "feature_pair": -1, "force": 0.0}  # of a contact that a run has not
APART = ("position", "rotation", "velocity", "spin")


def motions_compared(a: Mapping[str, Array], b: Mapping[str, Array], instance: Mapping[str, Any]) -> Array:
    """Two runs by their columns p, quaternion, v and w at n samples: (7, n), the largest difference of a body
    in each of APART, then the largest components of p, v and w of the first run."""
    free = [k for k, body in enumerate(instance["bodies"]) if body["motion"] == "free"]
    moving = [k for k, body in enumerate(instance["bodies"]) if body["motion"] in ("point", "free")]
    sizes = (("p", moving), ("v", moving), ("w", free))
    return np.array(
        [
            distance_between(a["p"], b["p"], moving),
            angle_between(a["quaternion"][:, free], b["quaternion"][:, free]),
            distance_between(a["v"], b["v"], moving),
            distance_between(a["w"], b["w"], free),
            *(np.abs(a[key][:, bodies]).max(axis=(1, 2), initial=0.0) for key, bodies in sizes),
        ],
        dtype=float,
    )


def apart_of(a: Trajectory, b: Trajectory, n: int, instance: Mapping[str, Any]) -> Array:
    """`motions_compared` of the first n samples of two runs."""
    mine, theirs = ({key: getattr(run, key)[:n] for key in MOTION} for run in (a, b))
    return motions_compared(mine, theirs, instance)


def distance_between(a: Array, b: Array, bodies: Sequence[int]) -> Array:
    """(n,): the largest distance of the vectors (.., nb, 3) of some bodies at the samples that both have."""
    n, chosen = min(len(a), len(b)), list(bodies)
    apart = np.linalg.norm((a[:n, chosen] - b[:n, chosen]).astype(float), axis=-1)
    return np.asarray(apart.max(axis=1, initial=0.0), dtype=float)


def angle_between(a: Array, b: Array) -> Array:
    """(n,) rad: the largest angle between unit quaternions (n, nb, 4), from their chords."""
    chord = np.minimum(np.linalg.norm(a - b, axis=-1), np.linalg.norm(a + b, axis=-1))
    largest = chord.astype(float).max(axis=1, initial=0.0)
    return np.asarray(4 * np.arcsin(np.minimum(largest / 2, 1.0)), dtype=float)


def columns_in_common(a: Trajectory, b: Trajectory) -> tuple[Mapping[str, Array], Mapping[str, Array]]:
    """The columns gap, feature_pair and force of two runs with the contacts that either has, in one order."""
    if a.contact_names == b.contact_names:
        return tuple({name: getattr(run, name) for name in EMPTY} for run in (a, b))  # type: ignore[return-value]
    place = {name: k for k, name in enumerate(dict.fromkeys((*a.contact_names, *b.contact_names)))}

    def columns(run: Trajectory) -> Mapping[str, Array]:
        at, made = [place[name] for name in run.contact_names], {}
        for name, empty in EMPTY.items():
            column = getattr(run, name)
            made[name] = np.full((len(run.t), len(place)), empty, dtype=column.dtype)
            made[name][:, at] = column
        return made

    return columns(a), columns(b)


def gaps_between(a: Mapping[str, Array], b: Mapping[str, Array], n: int) -> float | None:
    """m: the largest difference of a gap in n samples while its contact is on the same features in both runs,
    given by their columns."""
    mine, theirs = a["gap"][:n], b["gap"][:n]
    same = (a["feature_pair"][:n] == b["feature_pair"][:n]) & np.isfinite(mine) & np.isfinite(theirs)
    return float(np.abs(mine - theirs)[same].max()) if same.any() else None


def forces_between(a: Array, b: Array) -> float | None:
    """Root mean square of the difference over that of b; None without forces."""
    if a.shape != b.shape or b.size == 0:
        return None
    size, apart = (sqrt(float((each.astype(float) ** 2).sum()) / b.size) for each in (b, a - b))
    return apart / (size or 1.0)


def events_between(found: Sequence[Event] | None, true: Sequence[Event] | None, end: float) -> dict[str, Any]:
    """Largest difference of the times of events up to `end` that both runs have, None without any, and how
    many one of them has alone."""
    if found is None or true is None or not (found or true):
        return {"events": None, "events_unmatched": None}
    until = [[event for event in events if event.t <= end] for events in (found, true)]
    pairs = in_pairs(until[0], until[1])
    apart = [abs(a.t - b.t) for a, b in pairs]
    return {"events": max(apart, default=None), "events_unmatched": len(alone(until[0], until[1], pairs))}
