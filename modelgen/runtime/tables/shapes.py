"""Tables of the shapes of pairs: balls around them, by which near pairs are found, and their material."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import accumulate
from typing import Any

from modelgen.runtime.tables.number_pool import NumberPool

FEW_PAIRS = 400  # up to so many, all pairs that contacts list are followed all the time

TERMS = (
    *("plane", "turned", "ring", "capsule", "ellipsoid", "superellipsoid", "paraboloid", "polygon"),
    "samples",
)  # MG_TERM_PLANE ..
NO_MATERIAL, UNKNOWN = -1, -2  # MG_NO_MATERIAL, MG_UNKNOWN_MATERIAL

Key = tuple[int, str]  # body, and the name of its shape: the same whatever the values of parameters


class BallTables:
    """Each ball once; pairs by their two balls, those of one ball in the order of the other.

    Pairs that sensors measure are followed all the time.
    """

    def __init__(self, instance: Mapping[str, Any]) -> None:
        pairs, limits = instance["pairs"], instance["limits"]
        balls: dict[Key, list[float]] = {}
        of_pairs = [_keys_of(instance, pair, balls) for pair in pairs]
        _add_members(instance, of_pairs, balls)
        index = {key: k for k, key in enumerate(balls)}
        partners: list[list[tuple[int, int]]] = [[] for _ in index]
        for k, (o, f) in enumerate((index[o], index[f]) for o, f in of_pairs):
            partners[min(o, f)].append((max(o, f), k))
        ordered = [sorted(each) for each in partners]
        begin = [0]
        for each in ordered:
            begin.append(begin[-1] + len(each))
        is_large = int(len(pairs) + len(limits) > FEW_PAIRS)
        measured = set(instance["sensors"].get("pairs", ()))
        self.count, self.index = len(index), index
        self.integers = {
            "pair_is_candidate": [
                *(
                    int(k not in measured) * (is_large or int(pair.get("candidate", False)))
                    for k, pair in enumerate(pairs)
                ),
                *([0] * len(limits)),
            ],
            "pair_balls": [*(index[key] for both in of_pairs for key in both), *([-1, -1] * len(limits))],
            "ball_body": [body for body, _ in index],
            "ball_partner_begin": begin,
            "ball_partner": [other for each in ordered for other, _ in each],
            "ball_pair": [pair for each in ordered for _, pair in each],
        }
        self.reals = {"ball": [value for ball in balls.values() for value in ball]}


def _keys_of(
    instance: Mapping[str, Any], pair: Mapping[str, Any], balls: dict[Key, list[float]]
) -> tuple[Key, Key]:
    """The balls of a pair, which are added to those known: centre, m, in the axes of the body, and radius,
    m, -1 where it is unbounded."""
    keys = _shapes(instance, pair)
    for key, ball in zip(keys, pair["bounding_balls"], strict=True):
        balls.setdefault(key, [*ball["centre"], -1.0 if ball["radius"] is None else ball["radius"]])
    return keys


def _add_members(
    instance: Mapping[str, Any], of_pairs: Sequence[tuple[Key, Key]], balls: dict[Key, list[float]]
) -> None:
    """Add the balls of all bodies whose pairs are in pools, which are those of the patterns."""
    classes = instance.get("classes", ())
    for pool in instance.get("pools", ()):
        known = {key: balls[key] for key in of_pairs[pool["pattern"]]}
        for members in (classes[k] for k in pool["classes"]):
            keys = [(body, shape) for body, shape in members]
            like = next(ball for key, ball in known.items() if key in set(keys))
            balls |= {key: like for key in keys if key not in balls}


class SolidTables:
    """`count`: solids with terms; `integers`: arrays of mg_system. Numbers are added to `numbers`."""

    def __init__(self, instance: Mapping[str, Any], balls: Mapping[Key, int], numbers: NumberPool) -> None:
        """`balls`: numbers of balls by shape."""
        entries = instance["solids"]
        known = [each for each in entries if each["terms"]]
        index = {
            (each["body"], each["shape"]): k for each, k in zip(entries, _solid_numbers(entries), strict=True)
        }
        unknown = {each["body"] for each in entries if each["cavity"] and _is_unknown(each)}
        for each in entries:
            key = each["body"], each["shape"]
            if _is_unknown(each) or (each["body"] in unknown and not each["cavity"]):
                index[key] = UNKNOWN
        self.count = len(known)
        self.integers = {
            "ball_solid": [index[key] for key in balls],
        } | solid_arrays(known, numbers)


def solid_arrays(solids: Sequence[Mapping[str, Any]], numbers: NumberPool) -> dict[str, list[int]]:
    """Arrays of mg_system of solids that have terms. Numbers are added to `numbers`."""
    terms = [term for each in solids for term in each["terms"]]
    return {
        "solid_body": [each["body"] for each in solids],
        "solid_is_cavity": [int(each["cavity"]) for each in solids],
        "solid_numbers": [numbers.append(each["placement"]) for each in solids],
        "solid_term": [*accumulate((len(each["terms"]) for each in solids), initial=0)],
        "term_kind": [TERMS.index(term["kind"]) for term in terms],
        "term_numbers": [numbers.append(term["numbers"]) for term in terms],
        "term_size": [len(term["numbers"]) for term in terms],
    }


def _solid_numbers(entries: Sequence[Mapping[str, Any]]) -> list[int]:
    """The number in the core of each of the manifest's solids; NO_MATERIAL of one without terms."""
    ends = accumulate(int(bool(each["terms"])) for each in entries)
    return [end - 1 if each["terms"] else NO_MATERIAL for each, end in zip(entries, ends, strict=True)]


def _is_unknown(entry: Mapping[str, Any]) -> bool:
    """Whether no terms describe a shape's material, or only about."""
    return entry["terms"] is None or entry.get("about", False)


def _shapes(instance: Mapping[str, Any], pair: Mapping[str, Any]) -> tuple[Key, Key]:
    """The shapes of a pair: their bodies o, f of its first feature pair, and their names."""
    source = instance["pairs"][pair["repeats"]] if "repeats" in pair else pair
    is_swapped = instance["feature_pairs"][source["feature_pairs"][0]]["swapped"]
    o, f = (each["shape"] for each in pair["bounding_balls"])
    bodies = pair["bodies"][::-1] if is_swapped else pair["bodies"]
    return (bodies[0], o), (bodies[1], f)
