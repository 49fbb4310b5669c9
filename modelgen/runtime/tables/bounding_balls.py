"""Tables of the broad phase: the balls around shapes, and the pairs of shapes that each two of them have."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

FEW_PAIRS = 400  # up to so many, all pairs that contacts list are followed all the time

Key = tuple[int, str]  # body, and the name of its shape: the same whatever the values of parameters


class BallTables:
    """Each ball once; pairs by their two balls, those of one ball in the order of the other.

    Pairs that sensors measure are followed all the time.
    """

    def __init__(self, instance: Mapping[str, Any]) -> None:
        pairs, limits = instance["pairs"], instance["limits"]
        balls: dict[Key, list[float]] = {}
        of_pairs = [_keys_of(instance, pair, balls) for pair in pairs]
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
        self.count = len(index)
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
    first = instance["feature_pairs"][pair["feature_pairs"][0]]
    o, f = (
        (body, ball["shape"])
        for body, ball in zip((first["o"], first["f"]), pair["bounding_balls"], strict=True)
    )
    for key, ball in zip((o, f), pair["bounding_balls"], strict=True):
        balls.setdefault(key, [*ball["centre"], -1.0 if ball["radius"] is None else ball["radius"]])
    return o, f
