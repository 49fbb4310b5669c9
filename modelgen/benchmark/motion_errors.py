"""Errors between two motions: position, rotation, force and event times; beyond a horizon, distributions."""

from __future__ import annotations

from typing import Any

import numpy as np

from modelgen.benchmark.sampled_motion import Array, Bodies, Motion
from modelgen.runtime.run_distance import angle_between, events_between, forces_between


def separation(a: Motion, b: Motion, bodies: Bodies) -> Array:
    """(n,) at each common sample: the largest distance of body points, over the characteristic length L.

    Body points are the centre of mass and, of a body that turns, three points L along its axes.
    """
    n = min(len(a.t), len(b.t))
    if n == 0 or not bodies.moving:
        return np.zeros(n)
    centres = (a.p[:n] - b.p[:n]) / bodies.length
    apart = np.linalg.norm(centres.astype(np.longdouble), axis=-1)
    for k, turns in enumerate(bodies.turning):
        if turns:
            turned = _axes(a.rotation[:n, k]) - _axes(b.rotation[:n, k])
            tips = np.linalg.norm((centres[:, k, None] + turned).astype(np.longdouble), axis=-1)
            apart[:, k] = np.maximum(apart[:, k], tips.max(axis=1))
    return np.asarray(apart.max(axis=1), dtype=float)


def errors(found: Motion, true: Motion, bodies: Bodies, horizon: float | None) -> dict[str, Any]:
    """Each kind of error up to the horizon, and the comparison of distributions beyond it.

    position m, rotation rad, force (root mean square, over that of the reference), events s; the invariants
    of the whole run; `beyond`: differences of the distributions after the horizon.
    """
    end = np.inf if horizon is None else horizon
    n = int(np.searchsorted(true.t[: len(found.t)], end, side="right"))
    mine, theirs = _cut(found, 0, n), _cut(true, 0, n)
    result = {
        "position": float(np.linalg.norm((mine.p - theirs.p).astype(float), axis=-1).max(initial=0.0)),
        "rotation": _angle(mine, theirs, bodies),
        "force": _force(mine, theirs),
        **events_between(found.events, true.events, end),
        **found.invariants,
    }
    if horizon is not None:
        result["beyond"] = beyond(found, true, bodies, n)
    return result


def beyond(found: Motion, true: Motion, bodies: Bodies, n: int) -> dict[str, float]:
    """Distributions of the samples of two runs after sample n, where single trajectories are not predictable.

    Mean distance of the sorted samples (Wasserstein's) of heights along each axis over L, of speeds and of
    total momentum over their root mean squares.
    """
    last = min(len(found.t), len(true.t))
    a, b = (_cut(motion, n, last) for motion in (found, true))
    if last <= n:
        return {}
    mass = np.array(bodies.mass)
    speeds = [np.linalg.norm(motion.v.astype(float), axis=-1) for motion in (a, b)]
    momenta = [np.einsum("nbi,b->ni", motion.v.astype(float), mass) for motion in (a, b)]
    return {
        "positions": _sorted_apart(a.p.astype(float), b.p.astype(float)) / bodies.length,
        "speeds": _sorted_apart(*speeds) / _size(speeds[1]),
        "momentum": _sorted_apart(*momenta) / _size(momenta[1]),
    }


def _sorted_apart(a: Array, b: Array) -> float:
    """Mean distance of sorted samples, the worst of all columns."""
    columns = np.abs(np.sort(a, axis=0) - np.sort(b, axis=0)).mean(axis=0)
    return float(columns.max(initial=0.0))


def _size(values: Array) -> float:
    return float(np.sqrt((values**2).mean())) or 1.0


def _cut(motion: Motion, start: int, end: int) -> Motion:
    force = None if motion.force is None else motion.force[start:end]
    t, p, rotation, v = (each[start:end] for each in (motion.t, motion.p, motion.rotation, motion.v))
    return Motion(t, p, rotation, v, force, motion.events, motion.invariants)


def _axes(quaternion: Array) -> Array:
    """The body axes in the world, (n, 3 axes, 3)."""
    w, x, y, z = np.moveaxis(quaternion, -1, 0)
    axes = (
        (1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)),
        (2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)),
        (2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)),
    )
    return np.stack([np.stack(axis, axis=-1) for axis in axes], axis=1)


def _angle(a: Motion, b: Motion, bodies: Bodies) -> float:
    """The largest rotation between the two, rad."""
    turning = [k for k, turns in enumerate(bodies.turning) if turns]
    return float(angle_between(a.rotation[:, turning], b.rotation[:, turning]).max(initial=0.0))


def _force(a: Motion, b: Motion) -> float | None:
    return None if a.force is None or b.force is None else forces_between(a.force, b.force)
