"""Limits of joints in the tables of the core (modelgen.h): contacts without shapes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any


def add_limits(
    integers: dict[str, list[int]], limits: Sequence[Mapping[str, Any]], parameters: list[int]
) -> None:
    """Adds each limit as a contact with its own pair and feature pair, after those with shapes."""
    for limit, start in zip(limits, parameters, strict=True):
        pair, feature_pair = len(integers["pair_search"]), len(integers["feature_pair_kind"])
        rows = {
            **{"contact_pair": pair, "contact_eta": limit["eta"], "contact_feature_pair": feature_pair},
            **{
                "pair_contact": len(integers["contact_pair"]) + 1,
                "pair_feature_pair": feature_pair + 1,
                "pair_search": 0,
            },
            **{
                "feature_pair_kind": limit["kind"],
                "feature_pair_o": limit["o"],
                "feature_pair_f": limit["f"],
                "feature_pair_owner": pair,
            },
            **{"feature_pair_group": -1, "feature_pair_parameters": start},
            "feature_pair_condition": integers["feature_pair_condition"][-1],
        }
        for name, value in rows.items():
            integers[name].append(value)
        for name in ("feature_parameters", "feature_numbers"):
            integers[name] += [0, 0]
        integers["feature_shape"] += [-1, -1]
        integers["feature_tree"] += [-1, -1]
        integers["feature_is_listed"] += [1, 1]
