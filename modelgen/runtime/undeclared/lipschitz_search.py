"""Whether a function of Lipschitz constant 1 is negative at a point of a ball, or by how much it is not."""

from __future__ import annotations

from itertools import product
from typing import NamedTuple

import numpy as np

from modelgen.runtime.undeclared.point_depth import Array, Depth

FIRST = 4  # cells along each side of the cube that is searched first
CELLS = 128  # most cells that are divided at a time, the deepest ones
HALVES = np.array(list(product((-0.5, 0.5), repeat=3)))
DIAGONAL = 3**0.5


class Found(NamedTuple):
    """Whether there is a point deeper than asked for, or by how much all points can move without one."""

    is_deep: bool
    slack: float  # m


def deepest(depth: Depth, centre: Array, radius: float, deep: float) -> Found:
    """Search of the cube around a ball for a point x with depth(x) < -deep.

    A cell of half side s around c is dropped where depth(c) - sqrt(3) s > -deep, and divided otherwise, until
    its diagonal is shorter than `deep`: then the slack is 0.

    Args:
        depth: (n, 3) m -> (n,) m, with |depth(x) - depth(y)| <= |x - y|.
        centre: (3,) m.
        radius: m.
        deep: m, positive.
    """
    half, slack = radius / FIRST, np.inf
    ends = (np.arange(FIRST) - (FIRST - 1) / 2) * 2 * half
    cells = centre + np.array(list(product(ends, repeat=3)))
    while len(cells):
        value = depth(cells)
        if value.min() < -deep:
            return Found(True, 0.0)
        above = value - DIAGONAL * half + deep
        is_left = above <= 0
        slack = min(slack, float(above[~is_left].min(initial=np.inf)))
        if is_left.any() and DIAGONAL * half < deep:
            return Found(False, 0.0)
        cells, value = cells[is_left], value[is_left]
        if len(cells) > CELLS:
            slack, cells = 0.0, cells[np.argpartition(value, CELLS)[:CELLS]]
        half /= 2
        cells = (cells[:, None] + 2 * half * HALVES).reshape(-1, 3)
    return Found(False, slack)
