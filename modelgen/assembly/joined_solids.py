"""Shapes that are fixed or welded together and touch the same partner are one solid for it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import isfinite
from typing import NamedTuple

import numpy as np

from modelgen.assembly.welded_bodies import Stand
from modelgen.geometry.convex_cells import Cell, cells_of
from modelgen.geometry.exposed_features import exposed, is_hidden
from modelgen.geometry.extent import bounding_ball
from modelgen.geometry.face_regions import to_axes
from modelgen.geometry.shape_features import features_of
from modelgen.scene.pose_arithmetic import compose, to_outer
from modelgen.scene.scene_types import Feature, Pose, Scene, Shape

Partner = tuple[str, str]  # the names of a body and of its shape


class _Placed(NamedTuple):
    """A shape, where it stands among those that are fixed to it, and what these have in common."""

    shape: Shape
    pose: Pose
    body: int  # the first of those that are welded to each other, or FIXED


class JoinedSolids:
    """The features of shapes that are left beside the shapes that are fixed to them."""

    def __init__(self, scene: Scene, stands: Sequence[Stand], flush: float) -> None:
        """`stands`: of the bodies; `flush`: m, height up to which surfaces are one."""
        self._flush = flush
        self._placed = {  # in the order of the scene
            (body.name, shape.name): _Placed(shape, compose(pose, shape.pose), first)
            for body, (first, pose) in zip(scene.bodies, stands, strict=True)
            for shape in body.shapes
        }
        touching: dict[Partner, set[Partner]] = {}
        for pair in scene.contacts:
            for one, other in (pair.between, pair.between[::-1]):
                touching.setdefault(one, set()).add(other)
        self._joined: dict[tuple[Partner, int], tuple[Partner, ...]] = {}  # that a partner may touch, by body
        for name, each in self._placed.items():
            for partner in touching.get(name, ()):
                self._joined[partner, each.body] = (*self._joined.get((partner, each.body), ()), name)
        self._known: dict[tuple[Partner, tuple[Partner, ...]], tuple[Feature, ...] | None] = {}

    def features_left(self, shape: Partner, partner: Partner) -> tuple[Feature, ...] | None:
        """The features of a shape that a partner can touch; None where all are left as they are."""
        joined = self._joined[partner, self._placed[shape].body] if shape in self._placed else ()
        if len(joined) < 2:
            return None
        if (shape, joined) not in self._known:
            self._known[shape, joined] = self._left(shape, joined)
        return self._known[shape, joined]

    def told(self) -> Iterator[str]:
        """What of shapes nothing touches, in words."""
        for (name, _), left in self._known.items():
            if left is not None:
                hidden = sum(map(is_hidden, left))
                yield f"{name[0]}/{name[1]}: {hidden} faces, edges and corners, joined to what is beside it"

    def _left(self, name: Partner, joined: Sequence[Partner]) -> tuple[Feature, ...] | None:
        own = self._placed[name]
        features = features_of(own.shape).features
        if own.shape.cavity or len(features) < 2:
            return None
        flush = self._flush
        near = [each for each in joined if each != name and _are_near(own, self._placed[each], flush)]
        first = [each for each in near if joined.index(each) < joined.index(name)]
        left = exposed(features, self._cells(own, near), self._cells(own, first), flush)
        is_whole = len(left) == len(features) and all(a is b for a, b in zip(left, features, strict=True))
        return None if is_whole else left

    def _cells(self, own: _Placed, others: Sequence[Partner]) -> list[Cell]:
        """The material of other shapes in the axes of a shape."""
        return [
            cell.placed(to_axes(own.pose, self._placed[each].pose))
            for each in others
            for cell in cells_of(replace(self._placed[each].shape, pose=Pose()))
        ]


def _are_near(a: _Placed, b: _Placed, flush: float) -> bool:
    """Whether balls around two shapes meet."""
    (at_a, radius_a), (at_b, radius_b) = (bounding_ball(replace(each.shape, cavity=False)) for each in (a, b))
    apart = np.linalg.norm(to_outer(a.pose, at_a) - to_outer(b.pose, at_b))
    return not isfinite(radius_a + radius_b) or bool(apart <= radius_a + radius_b + flush)
