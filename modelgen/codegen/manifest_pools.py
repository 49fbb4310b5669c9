"""Pools of pairs as plain values for the manifest: classes of equal shapes of equal bodies, and for how many
near pairs of two classes there are slots."""

from __future__ import annotations

from math import ceil
from typing import Any

from modelgen.model import Model

UNEVEN = 3  # how many times more of them than on the average may be of one pool
FEWEST = 32  # slots of a pool


def pools_of(model: Model) -> dict[str, Any]:
    """The classes, each a list of bodies with the names of their shapes, and the pools: the pair that is the
    pattern, the two classes, the slots; nothing for a scene without pools."""
    scene = model.scene
    if not scene.pools:
        return {}
    number = {entry.name: k for k, entry in enumerate(model.bodies)}
    sizes = [pool.size(scene.classes) for pool in scene.pools]
    members = {member for pool in scene.pools for k in pool.classes for member in scene.classes[k]}
    near = scene.near_per_body * len(members)
    slots = [min(size, FEWEST + ceil(near * min(1.0, UNEVEN * size / sum(sizes)))) for size in sizes]
    return {
        "classes": [[[number[body], shape] for body, shape in members] for members in scene.classes],
        "pools": [
            {"pattern": pool.pattern, "classes": list(pool.classes), "slots": count}
            for pool, count in zip(scene.pools, slots, strict=True)
        ],
    }
