"""Faces that rest on each other: the outlines of their regions, and where the centre of pressure went."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from modelgen.runtime.region_overlap import Arc, overlap

if TYPE_CHECKING:
    from modelgen.codegen.library import Library

Array = np.ndarray[Any, Any]


def face_outlines(library: Library, patches: Sequence[int]) -> dict[str, Array]:
    """The outline of the region of f of each of the patches, (m, 3) m in axes of its body's centre of mass,
    loops apart by NaN, as "k_outline"; its axes there, (12,), as "k_axes"; the body's index as "k_body", that
    of o's body as "k_other"."""
    found: dict[str, Array] = {}
    for k in patches:
        entry = library.manifest.instance["patches"][k]
        other, face = (library.manifest.instance["faces"][each] for each in entry["faces"])
        axes = np.array(face["placement"], dtype=float)
        loops = overlap(library, (), arcs_of(face)).outline
        gap = np.full((1, 2), np.nan)
        flat = np.vstack([part for loop in loops for part in (loop, loop[:1], gap)])[:-1]
        found[f"{k}_outline"] = axes[:3] + flat @ axes[3:9].reshape(2, 3)
        found[f"{k}_axes"], found[f"{k}_body"] = axes, np.array([face["body"]])
        found[f"{k}_other"] = np.array([other["body"]])
    return found


def arcs_of(face: Mapping[str, Any]) -> tuple[Arc, ...]:
    """The boundary of a face of the manifest, in the axes of the face."""
    return tuple(
        Arc(arc["kind"], arc["parameters"], tuple(arc["ends"]), arc["placement"], arc["loop"])
        for arc in face["boundary"]
    )
