"""Keys of an outline in the scene format: its pieces, and how often they are repeated."""

from __future__ import annotations

from modelgen.scene.scalar_types import NUMBER, POSITIVE, Switch, Text, Whole
from modelgen.scene.table_types import Field, Several, Table, Tagged
from modelgen.scene.table_types import Sequence as ListOf

_NEIGHBOUR = "that of the piece beside it if absent"

_NAME = Field(
    "name",
    Text(r"^[A-Za-z][A-Za-z0-9_]{0,31}$", "a letter, then up to 31 letters, digits or _ are allowed"),
    "name of its features, followed by _0, _1, ... where it is repeated; else side and its number",
)
_POINT = ListOf(NUMBER, 2)
_PIECES = {
    "line": Table(
        (
            _NAME,
            Field("from", _POINT, f"[x, y] of its start, m; {_NEIGHBOUR}"),
            Field("to", _POINT, f"[x, y] of its end, m; {_NEIGHBOUR}"),
        )
    ),
    "arc": Table(
        (
            _NAME,
            Field("radius", POSITIVE, "radius, m; the distance of the piece before if absent"),
            Field("center", _POINT, "[x, y] of its center, m", default=(0.0, 0.0)),
            Field("angles", _POINT, "where it starts and ends, rad; at the pieces beside it if absent"),
            Field("clockwise", Switch(), "without angles: whether it runs clockwise", default=False),
        )
    ),
    "involute": Table(
        (
            _NAME,
            Field("radius", POSITIVE, "radius of the base circle about the origin, m", required=True),
            Field("start", NUMBER, "angle at which the involute leaves the base circle, rad", required=True),
            Field(
                "rolls", _POINT,
                "roll angles of its ends, rad: the string is unwound counterclockwise, if negative clockwise",
                required=True,
            ),
        )
    ),
}  # fmt: skip

OUTLINE_FIELDS = (
    Field(
        "pieces", Several(Tagged("kind", "line, arc or involute", _PIECES)),
        "pieces of the outline in order, counterclockwise", required=True,
    ),
    Field("repeat", Whole(1, 1000), "how often the pieces follow each other around the origin", default=1),
)  # fmt: skip
