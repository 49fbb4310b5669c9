"""Forces at one instant as points and vectors."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from modelgen.report.surface_grids import feature_pair_of
from modelgen.rotations import rotation_of

Array = np.ndarray[Any, Any]


def arrows_of(
    columns: Mapping[str, Array], instance: Mapping[str, Any], moving: Sequence[bool]
) -> dict[str, tuple[Array, Array]]:
    """Points (n, 3) m and forces (n, 3) N on the body that moves: "normal" and "friction" of the contacts,
    "pressure" of resting faces. Numbers of rows are those of the contacts and of the faces that may rest.

    Args:
        columns: one sample, as a Trajectory names them.
        instance: of the manifest.
        moving: whether each body moves.
    """
    count = len(instance["contacts"])
    seconds = [int(feature_pair_of(instance, k)["f"]) for k in range(count)]
    side = np.array([1.0 if moving[body] else -1.0 for body in seconds]).reshape(-1, 1)
    points = columns["points_f"][0, :count]
    normal = side * columns["normals"][0, :count] * columns["force"][0, :count, None]
    friction = side * columns["friction"][0, :count]
    presses, pressures, rubbing = _of_patches(columns, instance, moving)
    return {
        "normal": (points, normal),
        "friction": (np.concatenate([points, presses]), np.concatenate([friction, rubbing])),
        "pressure": (presses, pressures),
    }


def _of_patches(
    columns: Mapping[str, Array], instance: Mapping[str, Any], moving: Sequence[bool]
) -> tuple[Array, Array, Array]:
    """Centres of pressure of the slots of resting faces, resultants and friction there."""
    points = columns["patch_point"][0]
    pressures, rubbing = np.zeros_like(points), np.zeros_like(points)
    for slot, patch in enumerate(columns["patch"][0].tolist()):
        if patch < 0:
            continue
        face = instance["faces"][instance["patches"][patch]["faces"][1]]
        axes, body = np.array(face["placement"], dtype=float), int(face["body"])
        outward = rotation_of(columns["quaternion"][0, body]) @ np.cross(axes[3:6], axes[6:9])
        side = 1.0 if moving[body] else -1.0
        pressures[slot] = -side * columns["patch_force"][0, slot] * outward
        rubbing[slot] = side * columns["patch_friction"][0, slot]
    return points, pressures, rubbing
