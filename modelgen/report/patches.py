"""Faces that rest on each other: the outlines of their regions, and where the centre of pressure went."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from modelgen.runtime.regions import Arc, Overlap, overlap

if TYPE_CHECKING:
    from modelgen.codegen.library import Library
    from modelgen.runtime.trajectory import Trajectory

Array = np.ndarray[Any, Any]


def face_outlines(library: Library, patches: Sequence[int]) -> dict[str, Array]:
    """The outline of the region of f of each of the patches, (m, 3) m in axes of its body's centre of mass,
    loops apart by NaN, as "k_outline"; its axes there, (12,), as "k_axes"; the body's index as "k_body"."""
    found: dict[str, Array] = {}
    for k in patches:
        entry = library.manifest.sentence["patches"][k]
        face = library.manifest.sentence["faces"][entry["faces"][1]]
        axes = np.array(face["placement"], dtype=float)
        loops = overlap(library, (), _arcs(face)).outline
        gap = np.full((1, 2), np.nan)
        flat = np.vstack([part for loop in loops for part in (loop, loop[:1], gap)])[:-1]
        found[f"{k}_outline"] = axes[:3] + flat @ axes[3:9].reshape(2, 3)
        found[f"{k}_axes"], found[f"{k}_body"] = axes, np.array([face["body"]])
    return found


def patch_overlap(library: Library, trajectory: Trajectory, sample: int, patch: int) -> Overlap:
    """The regions of a patch laid on each other at a sample of a run, and its centre of pressure against
    their hull, in the axes of o's face; of f's where o's is a whole plane."""
    entry = library.manifest.sentence["patches"][patch]
    o, f = (library.manifest.sentence["faces"][k] for k in entry["faces"])
    whole = not o["boundary"]
    hull, other = (_face_pose(trajectory, sample, face) for face in ((f if whole else o), f))
    slots = np.flatnonzero(trajectory.patch[sample] == patch)
    centre = trajectory.patch_point[sample, slots[0]] if len(slots) else np.full(3, np.nan)
    R = hull[3:].reshape(3, 3)  # its rows are the axes
    pose = np.concatenate([R @ (other[:3] - hull[:3]), (R @ other[3:].reshape(3, 3).T).T.ravel()])
    point = (R @ (np.asarray(centre, dtype=float) - hull[:3]))[None, :2]
    return overlap(library, () if whole else _arcs(o), _arcs(f), pose, point)


def _face_pose(trajectory: Trajectory, sample: int, face: Mapping[str, Any]) -> Array:
    """(12,): the axes of a face in the world at a sample."""
    body, axes = int(face["body"]), np.array(face["placement"], dtype=float)
    w, *spin = np.asarray(trajectory.quaternion[sample, body], dtype=float)
    vectors = axes.reshape(4, 3)
    inner = 2.0 * np.cross(spin, vectors)
    turned = vectors + w * inner + np.cross(spin, inner)
    turned[0] += trajectory.p[sample, body]
    return np.asarray(turned.ravel())


def _arcs(face: Mapping[str, Any]) -> tuple[Arc, ...]:
    return tuple(
        Arc(arc["kind"], arc["parameters"], tuple(arc["ends"]), arc["placement"], arc["loop"])
        for arc in face["boundary"]
    )
