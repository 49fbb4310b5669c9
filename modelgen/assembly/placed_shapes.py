"""Where shapes stand among those that are fixed or welded to them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import isfinite
from typing import NamedTuple

import numpy as np

from modelgen.assembly.welded_bodies import Stand
from modelgen.geometry.convex_cells import Cell, cells_of
from modelgen.geometry.extent import bounding_ball
from modelgen.geometry.face_regions import to_axes
from modelgen.scene.pose_arithmetic import compose, to_outer
from modelgen.scene.scene_types import Pose, Scene, Shape

Partner = tuple[str, str]  # the names of a body and of its shape
Partners = tuple[Partner, ...]


class _Placed(NamedTuple):
    """A shape, where it stands among those that are fixed to it, and what these have in common."""

    shape: Shape
    pose: Pose
    body: int  # the first of those that are welded to each other, or FIXED


class PlacedShapes:
    """The shapes of a scene and where they stand."""

    def __init__(self, scene: Scene, stands: Sequence[Stand], flush: float) -> None:
        """`stands`: of the bodies; `flush`: m, height up to which surfaces are one."""
        self.flush = flush
        self._placed = {  # in the order of the scene
            (body.name, shape.name): _Placed(shape, compose(pose, shape.pose), first)
            for body, (first, pose) in zip(scene.bodies, stands, strict=True)
            for shape in body.shapes
        }

    def __contains__(self, name: Partner) -> bool:
        return name in self._placed

    @property
    def names(self) -> Partners:
        """Those of all shapes, in the order of the scene."""
        return tuple(self._placed)

    def shape(self, name: Partner) -> Shape:
        """The shape of that name."""
        return self._placed[name].shape

    def solid(self, name: Partner) -> int:
        """The first of the bodies that are welded to that of a shape, or FIXED."""
        return self._placed[name].body

    def near(self, name: Partner, others: Partners) -> list[Partner]:
        """Those of other shapes whose bounding balls meet that of a shape."""
        return [each for each in others if each != name and self._are_near(name, each)]

    def seen_from(self, name: Partner, other: Partner) -> Pose:
        """The pose of another shape in the axes of a shape."""
        return to_axes(self._placed[name].pose, self._placed[other].pose)

    def cells(self, name: Partner, others: Sequence[Partner]) -> list[Cell]:
        """The material of other shapes in the axes of a shape."""
        return [
            cell.placed(self.seen_from(name, each))
            for each in others
            for cell in cells_of(replace(self.shape(each), pose=Pose()))
        ]

    def _are_near(self, one: Partner, other: Partner) -> bool:
        a, b = self._placed[one], self._placed[other]
        (at_a, radius_a), (at_b, radius_b) = (
            bounding_ball(replace(each.shape, cavity=False)) for each in (a, b)
        )
        apart = np.linalg.norm(to_outer(a.pose, at_a) - to_outer(b.pose, at_b))
        return not isfinite(radius_a + radius_b) or bool(apart <= radius_a + radius_b + self.flush)
