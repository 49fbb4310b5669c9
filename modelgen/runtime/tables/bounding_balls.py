"""Tables of the broad phase: the balls around shapes, and the pairs of shapes that each two of them have."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

FEW_PAIRS = 400  # up to so many, all pairs that contacts list are followed all the time

Ball = tuple[int, float, float, float, float]  # body; centre, m, in its axes; radius, m, -1 where unbounded


class BallTables:
    """Each ball once; pairs by their two balls, those of one ball in the order of the other."""

    def __init__(self, instance: Mapping[str, Any]) -> None:
        pairs, limits = instance["pairs"], instance["limits"]
        index: dict[Ball, int] = {}
        of_pairs = [
            [index.setdefault(ball, len(index)) for ball in _balls_of(instance, pair)] for pair in pairs
        ]
        partners: list[list[tuple[int, int]]] = [[] for _ in index]
        for k, (o, f) in enumerate(of_pairs):
            partners[min(o, f)].append((max(o, f), k))
        ordered = [sorted(each) for each in partners]
        begin = [0]
        for each in ordered:
            begin.append(begin[-1] + len(each))
        is_large = int(len(pairs) + len(limits) > FEW_PAIRS)
        self.count = len(index)
        self.integers = {
            "pair_is_candidate": [
                *(is_large or int(pair.get("candidate", False)) for pair in pairs),
                *([0] * len(limits)),
            ],
            "pair_balls": [*(ball for both in of_pairs for ball in both), *([-1, -1] * len(limits))],
            "ball_body": [ball[0] for ball in index],
            "ball_partner_begin": begin,
            "ball_partner": [other for each in ordered for other, _ in each],
            "ball_pair": [pair for each in ordered for _, pair in each],
        }
        self.reals = {"ball": [value for ball in index for value in ball[1:]]}


def _balls_of(instance: Mapping[str, Any], pair: Mapping[str, Any]) -> tuple[Ball, Ball]:
    first = instance["feature_pairs"][pair["feature_pairs"][0]]
    o, f = (
        (body, *ball["centre"], -1.0 if ball["radius"] is None else ball["radius"])
        for body, ball in zip((first["o"], first["f"]), pair["bounding_balls"], strict=True)
    )
    return o, f
