"""Planar contacts in the tables of the core (modelgen.h): faces, boundaries, support points."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from modelgen.runtime.tables.features import append

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


def add_patches(
    integers: dict[str, list[int]], numbers: list[float], parameters: list[float], instance: Mapping[str, Any]
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
    integers |= boundary | {
        "patch_pair": [patch["pair"] for patch in instance["patches"]],
        "patch_slots": [slot for patch in instance["patches"] for slot in patch["patch_slots"]],
        "patch_arc": first,
        "patch_arc_f": second,
        "patch_numbers": [append(numbers, [*o, *f]) for o, f in placed],
        "patch_covered": cover,
        "covered_feature_pair": covered,
        "patch_share": share,
        "share_pair": share_pair,
        "share_arc": share_arc,
    }
    _add_points(integers, parameters, instance)


def _add_face(
    face: Mapping[str, Any], numbers: list[float], parameters: list[float]
) -> list[tuple[int, int, int, int]]:
    """The arcs of a face as (shape, parameters, numbers, loop)."""
    return [
        (
            arc["kind"],
            append(parameters, arc["parameters"]),
            append(numbers, [*arc["placement"], *arc["ends"]]),
            arc["loop"],
        )
        for arc in face["boundary"]
    ]


def _add_points(integers: dict[str, list[int]], parameters: list[float], instance: Mapping[str, Any]) -> None:
    faces = instance["faces"]
    pairs: dict[int, int] = {}
    for patch in instance["patches"]:
        o, f = (faces[face]["body"] for face in patch["faces"])
        for slot in range(*patch["patch_slots"]):
            pairs[slot] = patch["pair"]
        for number, values in enumerate(patch["support_points"]):
            kind = patch["kind"] if number else patch.get("friction_kind", patch["kind"])
            _add_feature_pair(integers, kind, patch["pair"], o, f, append(parameters, values))
    for _, pair in sorted(pairs.items()):
        for _ in range(SUPPORT_POINTS):
            integers["contact_pair"].append(pair)
            integers["contact_eta"].append(instance["n_eta"])
            integers["contact_feature_pair"].append(-1)


def _add_feature_pair(
    integers: dict[str, list[int]], kind: int, pair: int, o: int, f: int, start: int
) -> None:
    row = {
        **{"feature_pair_kind": kind, "feature_pair_o": o, "feature_pair_f": f, "feature_pair_owner": pair},
        **{
            "feature_pair_group": -1,
            "feature_pair_parameters": start,
            "feature_pair_condition": integers["feature_pair_condition"][-1],
        },
    }
    for name, value in row.items():
        integers[name].append(value)
    for name in ("feature_parameters", "feature_numbers"):
        integers[name] += [0, 0]
    integers["feature_shape"] += [-1, -1]
    integers["feature_tree"] += [-1, -1]
    integers["feature_is_listed"] += [1, 1]


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
