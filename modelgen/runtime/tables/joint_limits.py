"""Limits of joints in the tables of the core (modelgen.h): contacts without shapes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any


def add_limits(
    integers: dict[str, list[int]], limits: Sequence[Mapping[str, Any]], parameters: list[int]
) -> None:
    """Each limit is a contact, with a pair and a link of its own behind those with shapes."""
    for limit, start in zip(limits, parameters, strict=True):
        pair, link = len(integers["pair_search"]), len(integers["link_kind"])
        rows = {
            **{"contact_pair": pair, "contact_eta": limit["eta"], "contact_link": link},
            **{"pair_contact": len(integers["contact_pair"]) + 1, "pair_link": link + 1, "pair_search": 0},
            **{"link_kind": limit["kind"], "link_o": limit["o"], "link_f": limit["f"], "link_pair": pair},
            **{"link_group": -1, "link_parameters": start},
            "link_condition": integers["link_condition"][-1],
        }
        for name, value in rows.items():
            integers[name].append(value)
        for name in ("side_shape", "side_parameters", "side_numbers"):
            integers[name] += [0, 0]
        integers["side_table"] += [-1, -1]
