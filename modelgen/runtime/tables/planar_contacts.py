"""Patches in the tables of the core (modelgen.h): faces with their boundaries, and points that hold them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from modelgen.runtime.tables.feature_sides import append

PADS = 3


def slot_count(sentence: Mapping[str, Any]) -> int:
    """How many patches may rest at a time, over all pairs."""
    return int(sentence["patches"][-1]["slots"][1]) if sentence["patches"] else 0


def add_patches(
    integers: dict[str, list[int]], numbers: list[float], parameters: list[float], sentence: Mapping[str, Any]
) -> None:
    """The tables of the patches; their points are the last contacts, on links behind all others."""
    faces = [_add_face(face, numbers, parameters) for face in sentence["faces"]]
    boundary: dict[str, list[int]] = {f"arc_{key}": [] for key in ("shape", "parameters", "numbers", "loop")}
    first, cover = [0], [0]
    second: list[int] = []
    covered: list[int] = []
    for patch in sentence["patches"]:
        for side, face in enumerate(patch["faces"]):
            for arc in faces[face]:
                for key, value in zip(boundary, arc, strict=True):
                    boundary[key].append(value)
            (first if side else second).append(len(boundary["arc_shape"]))
        covered += patch["links"]
        cover.append(len(covered))
    placed = [
        [sentence["faces"][face]["placement"] for face in patch["faces"]] for patch in sentence["patches"]
    ]
    integers |= boundary | {
        "patch_pair": [patch["pair"] for patch in sentence["patches"]],
        "patch_slots": [slot for patch in sentence["patches"] for slot in patch["slots"]],
        "patch_arc": first,
        "patch_arc_f": second,
        "patch_numbers": [append(numbers, [*o, *f]) for o, f in placed],
        "patch_cover": cover,
        "covered": covered,
    }
    _add_points(integers, parameters, sentence)


def _add_face(
    face: Mapping[str, Any], numbers: list[float], parameters: list[float]
) -> list[tuple[int, int, int, int]]:
    """The arcs of a face: shape, parameters, numbers, loop."""
    return [
        (
            arc["kind"],
            append(parameters, arc["parameters"]),
            append(numbers, [*arc["placement"], *arc["ends"]]),
            arc["loop"],
        )
        for arc in face["boundary"]
    ]


def _add_points(integers: dict[str, list[int]], parameters: list[float], sentence: Mapping[str, Any]) -> None:
    faces = sentence["faces"]
    pairs: dict[int, int] = {}
    for patch in sentence["patches"]:
        o, f = (faces[face]["body"] for face in patch["faces"])
        for slot in range(*patch["slots"]):
            pairs[slot] = patch["pair"]
        for number, values in enumerate(patch["pads"]):
            kind = patch["kind"] if number else patch.get("rubbing", patch["kind"])
            _add_link(integers, kind, patch["pair"], o, f, append(parameters, values))
    for _, pair in sorted(pairs.items()):
        for _ in range(PADS):
            integers["contact_pair"].append(pair)
            integers["contact_eta"].append(sentence["n_eta"])
            integers["contact_link"].append(-1)


def _add_link(integers: dict[str, list[int]], kind: int, pair: int, o: int, f: int, start: int) -> None:
    row = {
        **{"link_kind": kind, "link_o": o, "link_f": f, "link_pair": pair},
        **{"link_group": -1, "link_parameters": start, "link_condition": integers["link_condition"][-1]},
    }
    for name, value in row.items():
        integers[name].append(value)
    for name in ("side_shape", "side_parameters", "side_numbers"):
        integers[name] += [0, 0]
    integers["side_table"] += [-1, -1]


def point_restitutions(sentence: Mapping[str, Any]) -> Sequence[float]:
    """Of the points of all places, the last contacts."""
    pairs = {slot: patch["pair"] for patch in sentence["patches"] for slot in range(*patch["slots"])}
    return [sentence["pairs"][pair]["restitution"] for _, pair in sorted(pairs.items()) for _ in range(PADS)]


def patch_friction(sentence: Mapping[str, Any]) -> list[float]:
    """Static and kinetic coefficient of each patch, 0 without friction."""
    return [value for patch in sentence["patches"] for value in patch.get("friction", (0.0, 0.0))]


def rubbing_points(sentence: Mapping[str, Any]) -> Sequence[bool]:
    """Of the points of all places, those that have rows of friction."""
    rubs = {slot: "friction" in patch for patch in sentence["patches"] for slot in range(*patch["slots"])}
    return [rubs and k == 0 for _, rubs in sorted(rubs.items()) for k in range(PADS)]
