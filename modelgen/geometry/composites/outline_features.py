"""Features of outlines of pieces: of the edge of a thin plate in z = 0, and of sides along z.

At a convex corner between two pieces the plate has a vertex, and there is an edge along z between the two
sides. A concave corner carries no contact. Pieces that meet without an angle lead to each other.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from modelgen.geometry.composites.feature_constructors import (
    TILT,
    at_least,
    at_most,
    edge,
    face,
    smooth,
    vertex,
    wing,
)
from modelgen.geometry.composites.moments import Moments, prism
from modelgen.scene.expression import Name, constant_expression
from modelgen.scene.expression_algebra import expression_of, substitute, times
from modelgen.scene.outline_piece_kinds import Outline, Piece, Side, direction, formulas_of, numbers_of
from modelgen.scene.pose_arithmetic import frame
from modelgen.scene.scene_types import Chart, Composite, Condition, Curve, Feature, Shape

SMOOTH = 1e-9  # sine of a corner that is none
NODES = 40  # of Gauss's rule on a piece, for moments
UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True)
class Corner:
    """Where `before` ends and `after` starts."""

    before: Side
    after: Side

    @property
    def directions(self) -> tuple[tuple[float, float], tuple[float, float]]:
        return direction(self.before.piece, 1.0), direction(self.after.piece, 0.0)

    @property
    def turn(self) -> float:
        """Sine of the angle to the left."""
        (a, b), (c, d) = self.directions
        return a * d - b * c

    @property
    def is_sharp(self) -> bool:
        return self.turn > SMOOTH

    def beyond(self, name: str, forward: bool) -> str | None:
        """What follows at the corner: the feature of that name, or the neighbour, or nothing."""
        if self.is_sharp:
            return name
        if self.turn < -SMOOTH:
            return None
        return self.after.name if forward else self.before.name


def outline(shape: Shape) -> Composite:
    """The pieces of an outline as curves, and its corners `corner_<piece that starts there>`."""
    sides = _sides(shape)
    corners = _corners(sides)
    features = []
    for k, side in enumerate(sides):
        start, end = corners[k], corners[(k + 1) % len(sides)]
        features.append(
            edge(
                side.name, _curve(side.piece),
                Condition("wing", (-1.0, TILT), None), Condition("wing", (-1.0, -TILT), None),
                at_least(0, 0.0, start.beyond(_corner_name(start), forward=False)),
                at_most(0, 1.0, end.beyond(_corner_name(end), forward=True)),
            )
        )  # fmt: skip
    return Composite((*features, *(_vertex(each) for each in corners if each.is_sharp)), convex=False)


def outline_wall(shape: Shape) -> Composite:
    """The sides over the pieces of an outline, and the edges between, `edge_<piece that starts there>`."""
    sides, length = _sides(shape), dict(shape.parameters)["length"]
    corners = _corners(sides)
    features = []
    for k, side in enumerate(sides):
        start, end = corners[k], corners[(k + 1) % len(sides)]
        features.append(
            face(
                side.name, _wall(side.piece, length),
                at_least(0, 0.0, start.beyond(_edge_name(start), forward=False)),
                at_most(0, 1.0, end.beyond(_edge_name(end), forward=True)),
                at_least(1, -0.5, None), at_most(1, 0.5, None),
            )
        )  # fmt: skip
    edges = (_edge(each, length) for each in corners if each.is_sharp)
    return Composite((*features, *edges), convex=False)


def outline_moments(shape: Shape) -> Moments:
    """Of the prism over the outline, by Gauss's rule on Green's theorem over each piece."""
    nodes, weights = np.polynomial.legendre.leggauss(NODES)
    samples = [
        (*side.piece.point((1 + t) / 2), *side.piece.velocity((1 + t) / 2), w / 2)
        for side in _sides(shape)
        for t, w in zip(nodes.tolist(), weights.tolist(), strict=True)
    ]
    x, y, dx, dy, w = np.array(samples).T
    swept = (x * dy - y * dx) * w
    area = float(swept.sum()) / 2
    r = np.array([x, y])
    arm = r @ swept / (3 * area)
    second = (r * swept) @ r.T / 4 - area * np.outer(arm, arm)
    return prism(area, arm, second, dict(shape.parameters)["length"])


def _sides(shape: Shape) -> Outline:
    assert shape.outline is not None
    return shape.outline


def _corners(sides: Outline) -> list[Corner]:
    """The corner at the start of each piece."""
    return [Corner(sides[k - 1], side) for k, side in enumerate(sides)]


def _corner_name(corner: Corner) -> str:
    return f"corner_{corner.after.name}"


def _edge_name(corner: Corner) -> str:
    return f"edge_{corner.after.name}"


def _curve(piece: Piece) -> Shape:
    x, y = formulas_of(piece)
    curve = Curve((x, y, constant_expression(0.0)), (0.0, 1.0))
    return Shape("curve", numbers_of(piece), curve=curve, name="curve")


def _wall(piece: Piece, length: float) -> Shape:
    """u runs along the piece, v from -1/2 to 1/2 along z."""
    x, y = (expression_of(substitute(each.tree, {"t": Name("u")})) for each in formulas_of(piece))
    z = expression_of(times(Name("v"), Name("length")))
    chart = Chart((x, y, z), ((0.0, 1.0), (-0.5, 0.5)))
    return Shape("chart", (*numbers_of(piece), ("length", length)), chart=chart, name="chart")


def _vertex(corner: Corner) -> Feature:
    (a, b), (c, d) = corner.directions
    return vertex(
        _corner_name(corner), (*corner.after.piece.point(0.0), 0.0),
        Condition("direction", (c, d, 0.0), corner.after.name),
        Condition("direction", (-a, -b, 0.0), corner.before.name),
    )  # fmt: skip


def _edge(corner: Corner, length: float) -> Feature:
    """Along z; the third axis of its frame is the normal of the side after it, whose direction is T x z."""
    (a, b), (c, d) = corner.directions
    pose = frame((*corner.after.piece.point(0.0), 0.0), UP, np.array([d, -c, 0.0]))
    return edge(
        _edge_name(corner), smooth("edge", pose, length=length),
        wing(1.0, 0.0, corner.after.name), wing(-(a * c + b * d), -(a * d - b * c), corner.before.name),
        at_least(0, -length / 2, None), at_most(0, length / 2, None),
    )  # fmt: skip
