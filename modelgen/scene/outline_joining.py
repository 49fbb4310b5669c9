"""Outlines made of the pieces of a scene: joined end to start, repeated about z, and closed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import atan2, hypot, pi
from typing import Any

from modelgen.scene.extrusion_profile import check_simple, signed_area
from modelgen.scene.outline_piece_kinds import (
    Arc,
    Involute,
    Line,
    Outline,
    Piece,
    Point,
    Side,
    parts_of,
    rotated,
)
from modelgen.scene.source_location import Place

CLOSURE = 1e-9  # distance of two ends that meet, against the size of the outline
SAMPLES = 16  # of a piece

Ends = tuple[Point | None, Point | None]


def read_outline(values: Mapping[str, Any], place: Place) -> Outline:
    """The sides of a closed outline from the values of its table; raises SceneError."""
    written = values["pieces"]
    if not written:
        raise place.key("pieces").error("an outline without pieces", "", "add a line, an arc or an involute")
    count, turn = values["repeat"], 2 * pi / values["repeat"]
    pieces = _joined(written, turn)
    _check_joined(pieces, [at for at, _ in written], turn)
    outline: list[Side] = []
    for copy in range(count):
        for index, ((_, each), piece) in enumerate(zip(written, pieces, strict=True)):
            name = (each["name"] or f"side{index}") + (f"_{copy}" if count > 1 else "")
            parts = parts_of(piece.turned(turn * copy) if copy else piece)
            outline += [
                Side(name + (f"_part{k}" if len(parts) > 1 else ""), part) for k, part in enumerate(parts)
            ]
    _check_names(outline, place.key("pieces"))
    points = [side.piece.point(k / SAMPLES) for side in outline for k in range(SAMPLES)]
    check_simple(points, place.key("pieces"))
    if signed_area(points) < 0:
        raise place.key("pieces").error(
            "an outline that runs clockwise", "the material is on the left of its pieces", "turn them round"
        )
    return tuple(outline)


def _joined(written: Sequence[tuple[Place, Mapping[str, Any]]], turn: float) -> list[Piece]:
    """The pieces of one period, what they leave open taken from those beside them."""
    ends = [_ends(each) for _, each in written]
    pieces = []
    for index, (place, each) in enumerate(written):
        before = ends[index - 1][1] if index else _turned(ends[-1][1], -turn)
        after = ends[index + 1][0] if index + 1 < len(ends) else _turned(ends[0][0], turn)
        start, end = ends[index]
        pieces.append(_piece(each, start or before, end or after, place))
    return pieces


def _turned(point: Point | None, angle: float) -> Point | None:
    return None if point is None else rotated(point, angle)


def _ends(each: Mapping[str, Any]) -> Ends:
    """The ends of a piece that it says itself."""
    if each["kind"] == "line":
        return each["from"], each["to"]
    if each["kind"] == "arc" and (each["angles"] is None or each["radius"] is None):
        return None, None
    piece = _whole(each)
    return piece.point(0.0), piece.point(1.0)


def _whole(each: Mapping[str, Any]) -> Piece:
    if each["kind"] == "arc":
        (cx, cy), (first, last) = each["center"], each["angles"]
        return Arc(cx, cy, each["radius"], first, last)
    return Involute(each["radius"], each["start"], *each["rolls"])


def _piece(each: Mapping[str, Any], start: Point | None, end: Point | None, place: Place) -> Piece:
    if each["kind"] == "involute":
        low, high = sorted(each["rolls"])
        if not low * high > 0:
            found = f"rolls from {each['rolls'][0]:g} to {each['rolls'][1]:g}"
            raise place.key("rolls").error(found, "both are positive or both negative: at 0 it has a cusp")
    elif start is None or end is None:
        which = "start" if start is None else "end"
        found = f"a {each['kind']} whose {which} is not known, nor that of the piece beside it"
        raise place.error(
            found, "of two pieces side by side one says where it ends", "add from, to or angles"
        )
    if each["kind"] == "line":
        assert start is not None
        assert end is not None
        if start == end:
            raise place.error("a line from a point to itself", "", "leave it out")
        return Line(*start, *end)
    if each["kind"] == "involute" or (each["angles"] is not None and each["radius"] is not None):
        piece = _whole(each)
        if isinstance(piece, Arc) and abs(piece.angle_1 - piece.angle_0) > (1 + CLOSURE) * 2 * pi:
            found = f"an arc that turns by {abs(piece.angle_1 - piece.angle_0):.6g} rad"
            raise place.key("angles").error(found, "a whole circle at most, 2*pi", "mend the angles")
        return piece
    assert start is not None
    assert end is not None
    return _arc_between(each, start, end, place)


def _arc_between(each: Mapping[str, Any], start: Point, end: Point, place: Place) -> Arc:
    (cx, cy), sign = each["center"], -1.0 if each["clockwise"] else 1.0
    radii = [hypot(x - cx, y - cy) for x, y in (start, end)]
    radius = each["radius"] or radii[0]
    if max(abs(radius - at) for at in radii) > CLOSURE * radius:
        found = (
            f"an arc of radius {radius:.9g} between points at {radii[0]:.9g} and {radii[1]:.9g} of its center"
        )
        raise place.error(found, "both are on the circle", "mend radius, center or the pieces beside it")
    if each["angles"] is not None:
        return Arc(cx, cy, radius, *each["angles"])
    first, last = (atan2(y - cy, x - cx) for x, y in (start, end))
    turn = (sign * (last - first)) % (2 * pi)
    return Arc(cx, cy, radius, first, first + sign * (turn or 2 * pi))


def _check_joined(pieces: Sequence[Piece], places: Sequence[Place], turn: float) -> None:
    size = max(hypot(*piece.point(t)) for piece in pieces for t in (0.0, 0.5, 1.0))
    for index, piece in enumerate(pieces):
        after = pieces[index + 1] if index + 1 < len(pieces) else pieces[0].turned(turn)
        (a, b), (c, d) = piece.point(1.0), after.point(0.0)
        if not hypot(a - c, b - d) <= CLOSURE * size:
            last = "the first one, a turn on" if index + 1 == len(pieces) else "the next one"
            found = f"a piece that ends {hypot(a - c, b - d):.3g} m from the start of {last}"
            raise places[index].error(found, "pieces follow each other end to start", "mend the two")


def _check_names(outline: Sequence[Side], place: Place) -> None:
    names = [side.name for side in outline]
    twice = next((name for index, name in enumerate(names) if name in names[:index]), None)
    if twice is not None:
        raise place.error(f"a second piece named {twice!r}", "", "give it another name")
