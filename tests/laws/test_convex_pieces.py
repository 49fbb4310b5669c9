"""A polygon as convex pieces: they have its area, turn left everywhere, and have no corner that is flat."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from modelgen.geometry.composites.convex_pieces import convex_pieces

Array = np.ndarray
POLYGONS = {  # of the first ones, corners lie on the lines through others
    "notch": np.array([[0, 0], [1, 0], [0.6, 0.4], [1, 1], [0, 1]]),
    "stairs": np.array([[0, 0], [3, 0], [3, 1], [2, 1], [2, 2], [1, 2], [1, 3], [0, 3]], dtype=float),
    "slot": np.array([[0, 0], [3, 0], [3, 2], [2, 2], [2, 1], [1, 1], [1, 2], [0, 2]], dtype=float),
    "comb": np.array([[0, 0], [5, 0], [5, 2], [4, 1], [3, 2], [2, 1], [1, 2], [0, 1]], dtype=float),
    **{
        f"star of {points}": np.array(
            [[r * np.cos(a), r * np.sin(a)] for k in range(points) for r, a in ((1, 2 * k * pi / points),
             (0.4, (2 * k + 1) * pi / points))]
        )
        for points in (4, 5, 6, 7)
    },
}  # fmt: skip


def area(points: Array) -> float:
    x, y = points.T
    return float(x @ np.roll(y, -1) - y @ np.roll(x, -1)) / 2


def turns(points: Array) -> Array:
    before, after = points - np.roll(points, 1, axis=0), np.roll(points, -1, axis=0) - points
    sizes = np.linalg.norm(before, axis=1) * np.linalg.norm(after, axis=1)
    return (before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]) / sizes


@pytest.mark.parametrize("name", POLYGONS)
@given(
    decade=st.floats(-3, 3),
    angle=st.one_of(st.just(0.0), st.floats(0, 2 * pi)),
    shift=st.tuples(st.floats(-2, 2), st.floats(-2, 2)),
)
def test_convex_pieces_are_the_polygon(
    name: str, decade: float, angle: float, shift: tuple[float, float]
) -> None:
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    polygon = 10**decade * ((POLYGONS[name] + np.array(shift)) @ turn.T)
    pieces = [polygon[piece] for piece in convex_pieces(polygon)]
    assert np.isclose(sum(map(area, pieces)), area(polygon), rtol=1e-9)
    assert min(turns(piece).min() for piece in pieces) > 1e-6
