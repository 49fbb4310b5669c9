"""A solid of the user's own: faces, edges and vertices by name, and the conditions that join them.

What is checked: every name exists and is answered (an edge that a face ends at has a wing into that face, a
vertex that an edge ends at a direction along it), directions have length 1, edges lie where their faces end,
vertices where their edges end.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import hypot
from typing import Any

from modelgen.name_suggestions import nearest
from modelgen.scene.custom_solid_checks import check_places
from modelgen.scene.pose_input import VECTOR
from modelgen.scene.scalar_types import NUMBER, Switch, Text, Type
from modelgen.scene.scene_types import Composite, Condition, Feature, Shape
from modelgen.scene.source_location import Place
from modelgen.scene.table_types import Field, Sequence, Several, Table, Tagged

UNIT = 1e-6  # departure of a direction's length from 1, as written in decimals

_NAME = Text(r"^[A-Za-z][A-Za-z0-9_]{0,31}$", "a letter, then up to 31 letters, digits or _ are allowed")
_NEXT = Field("next", _NAME, "the feature beyond; nothing is there if absent")

_QUADRIC = Field(
    "numbers", Sequence(NUMBER, 10),
    "[c, bx, by, bz, Qxx, Qyy, Qzz, Qxy, Qxz, Qyz]: c + b.x + Qxx x^2 + ... >= 0 at x in the shape frame, m",
    required=True,
)  # fmt: skip
_PARAMETER = Field(
    "numbers", Sequence(NUMBER, 3),
    "[index, sign, bound]: sign (u - bound) >= 0, of u or t for index 0, of v for index 1", required=True,
)  # fmt: skip
_WING = Field(
    "numbers", Sequence(NUMBER, 2),
    "[a, b]: the unit vector a T x z + b z points from the edge of tangent T into the face `next`, along it; "
    "z is the third axis of the edge's shape frame", required=True,
)  # fmt: skip
_DIRECTION = Field(
    "numbers", VECTOR, "unit vector from the vertex along the edge `next`, frame of the solid", required=True
)
_CONDITIONS = {
    "quadric": Table((_QUADRIC, _NEXT)),
    "parameter": Table((_PARAMETER, _NEXT)),
    "wing": Table((_WING, _NEXT)),
    "direction": Table((_DIRECTION, _NEXT)),
}
_ALLOWED = {
    "face": ("quadric", "parameter"),
    "edge": ("wing", "parameter", "quadric"),
    "vertex": ("direction",),
}


def own_fields(face: Type, edge: Type) -> tuple[Field, ...]:
    """The fields of a solid whose faces and edges have shapes of these types."""
    at = Field("at", VECTOR, "[x, y, z] in the frame of the solid, m", required=True)
    return (
        Field(
            "face",
            _part("face", Field("shape", face, "its surface", required=True)),
            "its faces",
            required=True,
        ),
        Field(
            "edge", _part("edge", Field("shape", edge, "its curve", required=True)), "its edges", default=()
        ),
        Field("vertex", _part("vertex", at), "its vertices", default=()),
        Field("convex", Switch(), "whether the material is convex", default=False),
    )


def _part(noun: str, what: Field) -> Several:
    conditions = Tagged(
        "kind", "what the condition is about", {kind: _CONDITIONS[kind] for kind in _ALLOWED[noun]}
    )
    name = Field("name", _NAME, f"name of the {noun}, unique in the solid", required=True)
    listed = Field("conditions", Several(conditions), f"each >= 0 on the {noun}", default=())
    return Several(Table((name, what, listed)), label=noun)


def read_solid(
    values: Mapping[str, Any], place: Place, read_shape: Callable[[Mapping[str, Any], Place], Shape]
) -> dict[str, Any]:
    """The features from the values of their tables; raises SceneError."""
    parts: list[tuple[Place, Feature]] = []
    for dimension, noun in ((2, "face"), (1, "edge"), (0, "vertex")):
        for at, each in values[noun]:
            if dimension:
                shape = read_shape(each["shape"], at.key("shape"))
                _check_smooth(shape, at.key("shape"))
            else:
                shape = Shape("point", tuple(zip("xyz", each["at"], strict=True)), name="point")
            conditions = tuple(_condition(one, spot) for spot, one in each["conditions"])
            parts.append((at, Feature(each["name"], dimension, shape, conditions)))
    _check_names(parts, place)
    _check_targets(parts)
    _check_answers(parts)
    check_places(parts)
    return {"solid": Composite(tuple(feature for _, feature in parts), values["convex"])}


def _check_smooth(shape: Shape, place: Place) -> None:
    if shape.chart is not None and any(pole for ends in shape.chart.poles for pole in ends):
        raise place.key("poles").error(
            "a face with poles",
            "a face of a solid is one regular chart",
            "leave the poles outside of the face",
        )


def _condition(values: Mapping[str, Any], place: Place) -> Condition:
    kind, numbers = values["kind"], values["numbers"]
    at = place.key("numbers")
    if kind in ("wing", "direction"):
        if values["next"] is None:
            raise place.error(f"a {kind} that leads nowhere", "it points into a feature", "add next")
        length = hypot(*numbers)
        if abs(length - 1) > UNIT:
            raise at.error(f"a {kind} of length {length:.9g}", f"length 1 (to {UNIT:g}) is allowed")
        numbers = tuple(number / length for number in numbers)
    elif kind == "parameter" and not (numbers[0] in (0, 1) and abs(numbers[1]) == 1):
        found = f"index {numbers[0]:g} and sign {numbers[1]:g}"
        raise at.error(found, "index 0 or 1 and sign 1 or -1 are allowed")
    elif kind == "quadric" and not any(numbers[1:]):
        raise at.error("a quadric that is the same everywhere", "it must change its sign at the boundary")
    return Condition(kind, numbers, values["next"])


def _check_names(parts: list[tuple[Place, Feature]], place: Place) -> None:
    if not any(feature.dimension == 2 for _, feature in parts):
        raise place.key("face").error("a solid without a face", "", "add a face")
    names = [feature.name for _, feature in parts]
    for index, (at, feature) in enumerate(parts):
        if feature.name in names[:index]:
            raise at.error(f"a second feature named {feature.name!r}", "", "give it another name")
        for condition in feature.conditions:
            if condition.next is not None and condition.next not in names:
                raise at.error(
                    f"next = {condition.next!r}, which is no feature", "features: " + ", ".join(names),
                    nearest(condition.next, names),
                )  # fmt: skip
            if condition.next == feature.name:
                raise at.error(f"a condition that leads from {feature.name!r} to itself")


def _check_targets(parts: list[tuple[Place, Feature]]) -> None:
    dimensions = {feature.name: feature.dimension for _, feature in parts}
    for at, feature in parts:
        for condition in feature.conditions:
            if condition.kind == "wing" and dimensions[str(condition.next)] != 2:
                raise at.error(f"a wing into {condition.next!r}", "wings point into faces")
            if condition.kind == "direction" and dimensions[str(condition.next)] != 1:
                raise at.error(f"a direction along {condition.next!r}", "directions point along edges")


def _check_answers(parts: list[tuple[Place, Feature]]) -> None:
    """Check that adjacency is mutual: the neighbour across a condition leads back by the corresponding kind
    of condition."""
    features = {feature.name: feature for _, feature in parts}
    for at, feature in parts:
        for condition in feature.conditions:
            if condition.next is None:
                continue
            other = features[condition.next]
            needed = {(2, 1): "wing", (1, 0): "direction"}.get((feature.dimension, other.dimension))
            back = [each for each in other.conditions if each.next == feature.name]
            if not any(needed is None or each.kind == needed for each in back):
                raise at.error(
                    f"{feature.name!r} leads to {other.name!r}, which does not lead back",
                    f"a {needed or 'condition'} of {other.name!r} must have next = {feature.name!r}",
                )
