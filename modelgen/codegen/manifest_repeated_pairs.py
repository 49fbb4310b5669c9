"""Pairs whose feature pairs are those of another pair but for their bodies: a file has them once.

Of 1378 pairs of equal boxes the file has one, with 404 lines, in place of 556,712.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from modelgen.repeated_entries import RepeatedEntries

Entries = Sequence[dict[str, Any]]


def without_repeats(instance: Mapping[str, Any]) -> dict[str, Any]:
    """An instance less the feature pairs of pairs that repeat those of another."""
    return {**instance, "feature_pairs": list(_kept(instance))}


def with_repeats(instance: Mapping[str, Any]) -> dict[str, Any]:
    """An instance with all feature pairs, from what `without_repeats` returned."""
    kept = iter(instance["feature_pairs"])
    own = {
        index: [next(kept) for _ in range(*pair["feature_pairs"])]
        for index, pair in enumerate(instance["pairs"])
        if "repeats" not in pair
    }
    return {**instance, "feature_pairs": all_of(instance["pairs"], own)}


def all_of(pairs: Sequence[Mapping[str, Any]], own: Mapping[int, Entries]) -> RepeatedEntries[dict[str, Any]]:
    """The feature pairs of all pairs; `own`: those of each pair that repeats none, by its number."""
    sources = [own[pair.get("repeats", index)] for index, pair in enumerate(pairs)]
    bodies = [(pair["bodies"][0], pair["bodies"][1]) if "repeats" in pair else None for pair in pairs]
    return RepeatedEntries(sources, bodies, _repeated)


def _repeated(entry: Mapping[str, Any], pair: int, bodies: tuple[int, int]) -> dict[str, Any]:
    o, f = bodies[::-1] if entry["swapped"] else bodies
    return {**entry, "pair": pair, "o": o, "f": f}


def _kept(instance: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    for pair in instance["pairs"]:
        if "repeats" not in pair:
            yield from instance["feature_pairs"][slice(*pair["feature_pairs"])]
