"""Limits of joints in the tables of the core (modelgen.h): contacts without shapes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from modelgen.runtime.tables.features import with_rows, without_features
from modelgen.runtime.tables.number_pool import Array


def add_limits(
    integers: dict[str, Array], limits: Sequence[Mapping[str, Any]], parameters: Sequence[int]
) -> None:
    """Adds each limit as a contact with its own pair and feature pair, after those with shapes."""
    count = len(limits)
    names = ("pair_search", "feature_pair_kind", "contact_pair")
    pairs, feature_pairs, contacts = (range(n, n + count) for n in (len(integers[name]) for name in names))
    rows: dict[str, Sequence[int]] = {
        "contact_pair": pairs,
        "contact_eta": [limit["eta"] for limit in limits],
        "contact_feature_pair": feature_pairs,
        "pair_contact": [contact + 1 for contact in contacts],
        "pair_feature_pair": [feature_pair + 1 for feature_pair in feature_pairs],
        "pair_search": [0] * count,
        **{f"feature_pair_{key}": [limit[key] for limit in limits] for key in ("kind", "o", "f")},
        "feature_pair_owner": pairs,
        "feature_pair_parameters": parameters,
        "feature_pair_condition": [integers["feature_pair_condition"][-1]] * count,
    }
    with_rows(integers, rows | without_features(count))
