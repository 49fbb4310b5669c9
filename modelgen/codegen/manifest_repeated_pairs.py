"""Pairs whose feature pairs are those of another pair but for their bodies: a file has them once.

Of 1378 pairs of equal boxes the file has one, with 404 lines, in place of 556,712.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

Entries = Sequence[dict[str, Any]]


def without_repeats(instance: Mapping[str, Any]) -> dict[str, Any]:
    """An instance less the feature pairs of pairs that repeat those of another."""
    return {**instance, "feature_pairs": list(_kept(instance))}


def with_repeats(instance: Mapping[str, Any]) -> dict[str, Any]:
    """An instance with all feature pairs, from what `without_repeats` returned."""
    found: list[dict[str, Any]] = []
    kept = iter(instance["feature_pairs"])
    for index, pair in enumerate(instance["pairs"]):
        first, end = pair["feature_pairs"]
        if "repeats" not in pair:
            found += [next(kept) for _ in range(first, end)]
        else:
            start, stop = instance["pairs"][pair["repeats"]]["feature_pairs"]
            found += repeated(found[start:stop], index, pair["bodies"])
    return {**instance, "feature_pairs": found}


def repeated(entries: Entries, pair: int, bodies: Sequence[int]) -> Iterator[dict[str, Any]]:
    """Feature pairs as those of another pair; `bodies`: as the user named them."""
    a, b = bodies
    for entry in entries:
        o, f = (b, a) if entry["swapped"] else (a, b)
        yield {**entry, "pair": pair, "o": o, "f": f}


def _kept(instance: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    for pair in instance["pairs"]:
        if "repeats" not in pair:
            yield from instance["feature_pairs"][slice(*pair["feature_pairs"])]
