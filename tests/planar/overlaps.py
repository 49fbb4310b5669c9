"""The regions of a patch laid on each other at a sample of a run."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from modelgen.codegen.library import Library
from modelgen.report.resting_face_outlines import arcs_of
from modelgen.runtime.region_overlap import Overlap, overlap
from modelgen.runtime.trajectory import Trajectory

Array = np.ndarray[Any, Any]


def patch_overlap(library: Library, trajectory: Trajectory, sample: int, patch: int) -> Overlap:
    """The regions of a patch laid on each other at a sample of a run, and its centre of pressure against
    their hull, in the axes of o's face; of f's where o's is a whole plane."""
    entry = library.manifest.instance["patches"][patch]
    o, f = (library.manifest.instance["faces"][k] for k in entry["faces"])
    whole = not o["boundary"]
    hull, other = (_face_pose(trajectory, sample, face) for face in ((f if whole else o), f))
    slots = np.flatnonzero(trajectory.patch[sample] == patch)
    centre = trajectory.patch_point[sample, slots[0]] if len(slots) else np.full(3, np.nan)
    R = hull[3:].reshape(3, 3)  # its rows are the axes
    pose = np.concatenate([R @ (other[:3] - hull[:3]), (R @ other[3:].reshape(3, 3).T).T.ravel()])
    point = (R @ (np.asarray(centre, dtype=float) - hull[:3]))[None, :2]
    return overlap(library, () if whole else arcs_of(o), arcs_of(f), pose, point)


def _face_pose(trajectory: Trajectory, sample: int, face: Mapping[str, Any]) -> Array:
    """(12,): the axes of a face in the world at a sample."""
    body, axes = int(face["body"]), np.array(face["placement"], dtype=float)
    w, *spin = np.asarray(trajectory.quaternion[sample, body], dtype=float)
    vectors = axes.reshape(4, 3)
    inner = 2.0 * np.cross(spin, vectors)
    turned = vectors + w * inner + np.cross(spin, inner)
    turned[0] += trajectory.p[sample, body]
    return np.asarray(turned.ravel())
