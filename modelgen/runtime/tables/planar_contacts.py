"""Planar contacts in the tables of the core (modelgen.h): faces, boundaries, support points."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from modelgen.runtime.tables.features import CONDITIONS, with_rows, without_features
from modelgen.runtime.tables.number_pool import INTEGER, Array, NumberPool

SUPPORT_POINTS = 3


def slot_count(instance: Mapping[str, Any]) -> int:
    """The number of patches that may rest at the same time, over all pairs."""
    return int(instance["patches"][-1]["patch_slots"][1]) if instance["patches"] else 0


def shares(instance: Mapping[str, Any]) -> tuple[tuple[int, str], ...]:
    """The number of the patch, and the name of the pair, of each share."""
    pairs = instance["pairs"]
    return tuple(
        (number, str(pairs[share[0]]["name"]))
        for number, patch in enumerate(instance["patches"])
        for share in patch.get("shares", ())
    )


def may_patches_open(integers: Mapping[str, Array], numbers: Sequence[float]) -> bool:
    """Whether patches may cover features that exist only while their faces are tilted, such as rims."""
    tilts = integers["condition_numbers"][integers["condition_kind"] == CONDITIONS.index("tilt")]
    return bool(len(integers["patch_pair"])) and any(numbers[first + 3] >= 0 for first in set(tilts.tolist()))


def add_patches(
    integers: dict[str, Array], numbers: NumberPool, parameters: NumberPool, instance: Mapping[str, Any]
) -> None:
    """Adds the tables of the patches; their support points are the last contacts and feature pairs."""
    faces = [_add_face(face, numbers, parameters) for face in instance["faces"]]
    boundary: dict[str, list[int]] = {f"arc_{key}": [] for key in ("shape", "parameters", "numbers", "loop")}
    first, cover = [0], [0]
    share: list[int] = [0]
    share_pair: list[int] = []
    share_arc: list[int] = []
    second: list[int] = []
    covered: list[int] = []
    for patch in instance["patches"]:
        for side, face in enumerate(patch["faces"]):
            for arc in faces[face]:
                for key, value in zip(boundary, arc, strict=True):
                    boundary[key].append(value)
            (first if side else second).append(len(boundary["arc_shape"]))
        for pair, *ends in patch.get("shares", ()):
            share_pair.append(pair)
            share_arc += [(first[-2], second[-1])[k // 2] + end for k, end in enumerate(ends)]
        share.append(len(share_pair))
        covered += patch["feature_pairs"]
        cover.append(len(covered))
    placed = [
        [instance["faces"][face]["placement"] for face in patch["faces"]] for patch in instance["patches"]
    ]
    columns = boundary | {
        "patch_pair": [patch["pair"] for patch in instance["patches"]],
        "patch_slots": [slot for patch in instance["patches"] for slot in patch["patch_slots"]],
        "patch_arc": first,
        "patch_arc_f": second,
        "patch_numbers": [numbers.place([*o, *f]) for o, f in placed],
        "patch_covered": cover,
        "covered_feature_pair": covered,
        "patch_share": share,
        "share_pair": share_pair,
        "share_arc": share_arc,
    }
    integers |= {name: np.array(values, dtype=INTEGER) for name, values in columns.items()}
    _add_points(integers, parameters, instance)


def _add_face(
    face: Mapping[str, Any], numbers: NumberPool, parameters: NumberPool
) -> list[tuple[int, int, int, int]]:
    """The arcs of a face as (shape, parameters, numbers, loop)."""
    return [
        (
            arc["kind"],
            parameters.place(arc["parameters"]),
            numbers.place([*arc["placement"], *arc["ends"]]),
            arc["loop"],
        )
        for arc in face["boundary"]
    ]


def _add_points(integers: dict[str, Array], parameters: NumberPool, instance: Mapping[str, Any]) -> None:
    patches, faces = instance["patches"], instance["faces"]
    kinds, starts, bodies = [], [], [[faces[face]["body"] for face in patch["faces"]] for patch in patches]
    for patch in patches:
        kinds += [patch.get("friction_kind", patch["kind"]), patch["kind"], patch["kind"]]
        starts += [parameters.place(values) for values in patch["support_points"]]
    o, f = np.repeat(np.array(bodies, dtype=INTEGER).reshape(-1, 2), SUPPORT_POINTS, axis=0).T
    slots = {slot: patch["pair"] for patch in patches for slot in range(*patch["patch_slots"])}
    count, held = len(kinds), [slots[slot] for slot in sorted(slots) for _ in range(SUPPORT_POINTS)]
    rows: dict[str, Sequence[int]] = {
        "feature_pair_kind": kinds,
        "feature_pair_o": o,
        "feature_pair_f": f,
        "feature_pair_owner": [patch["pair"] for patch in patches for _ in range(SUPPORT_POINTS)],
        "feature_pair_parameters": starts,
        "feature_pair_condition": [integers["feature_pair_condition"][-1]] * count,
        "contact_pair": held,
        "contact_eta": [instance["n_eta"]] * len(held),
        "contact_feature_pair": [-1] * len(held),
    }
    with_rows(integers, rows | without_features(count))


def point_restitutions(instance: Mapping[str, Any]) -> Sequence[float]:
    """Restitution of the support points of all slots, which are the last contacts."""
    pairs = {slot: patch["pair"] for patch in instance["patches"] for slot in range(*patch["patch_slots"])}
    return [
        instance["pairs"][pair]["restitution"]
        for _, pair in sorted(pairs.items())
        for _ in range(SUPPORT_POINTS)
    ]


def patch_friction(instance: Mapping[str, Any]) -> list[float]:
    """The static and kinetic friction coefficient of each patch, 0 without friction."""
    return [value for patch in instance["patches"] for value in patch.get("friction", (0.0, 0.0))]


def points_with_friction(instance: Mapping[str, Any]) -> Sequence[bool]:
    """For the support points of all slots, whether they have friction rows."""
    has_friction = {
        slot: "friction" in patch for patch in instance["patches"] for slot in range(*patch["patch_slots"])
    }
    return [
        has_friction and k == 0
        for _, has_friction in sorted(has_friction.items())
        for k in range(SUPPORT_POINTS)
    ]
