"""Features and conditions of the feature pairs in the tables of the core (modelgen.h)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import hypot, pi
from typing import Any

from modelgen.codegen.manifest import Manifest, have_centre_curves

CELLS_PER_TREE, CELLS_MIN, CELLS_MAX = 4096, 32768, 131072
CONDITIONS = ("quadric", "parameter", "disc", "wing", "direction", "tilt")  # MG_CONDITION_QUADRIC ..


class FeatureTables:
    """`integers`: arrays of mg_system; `numbers`: its array of numbers; parameters of shapes are added to
    `parameters`."""

    def __init__(self, manifest: Manifest, parameters: list[float], endless: float) -> None:
        self.numbers: list[float] = []
        feature_pairs, length = manifest.instance["feature_pairs"], manifest.instance["scales"]["length"]
        kinds = manifest.kinds["shape"]
        sides = [feature_pair[side] for feature_pair in feature_pairs for side in ("shape_o", "shape_f")]
        conditions = [condition for feature_pair in feature_pairs for condition in feature_pair["conditions"]]
        first = [0]
        for feature_pair in feature_pairs:
            first.append(first[-1] + len(feature_pair["conditions"]))
        self.integers: dict[str, list[int]] = {
            "feature_pair_condition": first,
            "feature_shape": [side["kind"] for side in sides],
            "feature_parameters": [append(parameters, side["parameters"]) for side in sides],
            "feature_numbers": [
                append(self.numbers, _side_numbers(side, endless, spans(side, kinds, length)))
                for side in sides
            ],
            "feature_tree": _trees(feature_pairs, manifest.kinds),
            "condition_kind": [CONDITIONS.index(each["kind"]) for each in conditions],
            "condition_feature": [each["side"] for each in conditions],
            "condition_feature_pair": [each["next"] for each in conditions],
            "condition_numbers": [append(self.numbers, each["numbers"]) for each in conditions],
            "condition_is_line_end": [int(each.get("line", False)) for each in conditions],
        }


def _trees(
    feature_pairs: Sequence[Mapping[str, Any]], kinds: Mapping[str, Sequence[Mapping[str, Any]]]
) -> list[int]:
    """The number of the tree of cells of each side, or -1: of a point, and of pairs that are not searched by
    cells. Features that differ in their placement alone share one."""
    trees: dict[tuple[Any, ...], int] = {}
    numbers = []
    for feature_pair in feature_pairs:
        kind = kinds["contact"][feature_pair["kind"]]
        shapes = feature_pair["shape_o"], feature_pair["shape_f"]
        is_closed_form = have_centre_curves(kinds["shape"][shape["kind"]]["kind"] for shape in shapes)
        for shape in shapes:
            if kind["convex"] or not kind["n_eta"] or not shape["domain"] or is_closed_form:
                numbers.append(-1)
                continue
            key = (shape["kind"], tuple(shape["parameters"]), *(tuple(ends) for ends in shape["domain"]))
            numbers.append(trees.setdefault(key, len(trees)))
    return numbers


def cell_capacity(trees: int) -> int:
    """Room for the cells of this many trees."""
    return min(max(CELLS_PER_TREE * trees, CELLS_MIN), CELLS_MAX) if trees else 1


def append(pool: list[float], values: Sequence[float]) -> int:
    """Adds the values at the end; returns where they start."""
    start = len(pool)
    pool.extend(values)
    return start


def spans(side: Mapping[str, Any], kinds: Sequence[Mapping[str, Any]], length: float) -> list[float]:
    """The scale of each coordinate of a shape: its range over 2 pi; if unbounded, the characteristic length,
    or the angle of a helix over that length."""
    turning = kinds[side["kind"]]["kind"] == "helix"
    endless = length / hypot(*side["parameters"]) if turning else length
    return [endless if None in ends else (ends[1] - ends[0]) / (2 * pi) for ends in side["domain"]]


def _side_numbers(side: Mapping[str, Any], endless: float, spanned: Sequence[float]) -> list[float]:
    """Placement (12), bounds of u and v (4), radius and centre of a bounding ball (4), scales of u and v
    (2)."""
    bounds = [*side["domain"], [0.0, 0.0], [0.0, 0.0]][:2]
    low_high = [
        end if bound is None else bound
        for interval in bounds
        for bound, end in zip(interval, (-endless, endless), strict=True)
    ]
    radius = endless if side["bounding_radius"] is None else side["bounding_radius"]
    return [*side["placement"], *low_high, radius, *side["centre"], *[*spanned, 1.0, 1.0][:2]]
