"""The sides and conditions of the links as the tables of the core (modelgen.h)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import hypot, pi
from typing import Any

from modelgen.codegen.manifest import FEET, Manifest

COARSE, GRID = 9, 17  # MG_COARSE, MG_GRID
CONDITIONS = ("quadric", "parameter", "disc", "wing", "direction", "tilt")  # MG_CONDITION_QUADRIC ..


class Sides:
    """`integers`: arrays of mg_system; `numbers`: its pool; the lengths of shapes join `parameters`."""

    def __init__(self, manifest: Manifest, parameters: list[float], endless: float) -> None:
        self.numbers: list[float] = []
        links, length = manifest.sentence["links"], manifest.sentence["scales"]["length"]
        kinds = manifest.kinds["shape"]
        sides = [link[side] for link in links for side in ("shape_o", "shape_f")]
        conditions = [condition for link in links for condition in link["conditions"]]
        first = [0]
        for link in links:
            first.append(first[-1] + len(link["conditions"]))
        self.integers: dict[str, list[int]] = {
            "link_condition": first,
            "side_shape": [side["kind"] for side in sides],
            "side_parameters": [append(parameters, side["parameters"]) for side in sides],
            "side_numbers": [
                append(self.numbers, _side_numbers(side, endless, spans(side, kinds, length)))
                for side in sides
            ],
            **_kept(links, manifest.kinds),
            "condition_kind": [CONDITIONS.index(each["kind"]) for each in conditions],
            "condition_side": [each["side"] for each in conditions],
            "condition_next": [each["next"] for each in conditions],
            "condition_numbers": [append(self.numbers, each["numbers"]) for each in conditions],
        }


def _kept(
    links: Sequence[Mapping[str, Any]], kinds: Mapping[str, Sequence[Mapping[str, Any]]]
) -> dict[str, list[int]]:
    """Which sides keep their samples: those with ends, of links searched by samples; alike, the same."""
    tables: dict[tuple[Any, ...], int] = {}
    side_table, table_first = [], [0]
    for link in links:
        for side, other in (("o", "f"), ("f", "o")):
            shape, mate = link[f"shape_{side}"], link[f"shape_{other}"]
            count = _samples(shape, kinds["shape"][mate["kind"]]["kind"])
            if kinds["contact"][link["kind"]]["convex"] or count == 0:
                side_table.append(-1)
                continue
            key = (link[side], shape["kind"], *(tuple(shape[k]) for k in ("parameters", "placement")))
            key = (*key, *(tuple(ends) for ends in shape["domain"]), count)
            if key not in tables:
                table_first.append(table_first[-1] + count)
            side_table.append(tables.setdefault(key, len(tables)))
    return {"side_table": side_table, "table_first": table_first}


def _samples(shape: Mapping[str, Any], mate: str) -> int:
    """How many a search during a run takes of a whole side; 0 where it has no ends."""
    if not shape["domain"] or any(None in ends for ends in shape["domain"]):
        return 0
    return (GRID if mate in FEET else COARSE) ** 2


def append(pool: list[float], values: Sequence[float]) -> int:
    """Adds the values at the end; returns where they start."""
    start = len(pool)
    pool.extend(values)
    return start


def spans(side: Mapping[str, Any], kinds: Sequence[Mapping[str, Any]], length: float) -> list[float]:
    """What each coordinate of a shape is measured against: its range over 2 pi; the characteristic length,
    or what it turns by along that, where it has no end."""
    turning = kinds[side["kind"]]["kind"] == "helix"
    endless = length / hypot(*side["parameters"]) if turning else length
    return [endless if None in ends else (ends[1] - ends[0]) / (2 * pi) for ends in side["domain"]]


def _side_numbers(side: Mapping[str, Any], endless: float, spanned: Sequence[float]) -> list[float]:
    """Placement (12), bounds of u and v (4), radius and centre of a ball (4), what u and v are measured
    against (2)."""
    bounds = [*side["domain"], [0.0, 0.0], [0.0, 0.0]][:2]
    low_high = [
        end if bound is None else bound
        for interval in bounds
        for bound, end in zip(interval, (-endless, endless), strict=True)
    ]
    radius = endless if side["bounding"] is None else side["bounding"]
    return [*side["placement"], *low_high, radius, *side["centre"], *[*spanned, 1.0, 1.0][:2]]
