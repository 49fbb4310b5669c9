"""Inputs of a scene: numbers that expressions use by name and that the caller of a run sets while it runs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from modelgen.scene.constants import NAMED
from modelgen.scene.scalar_types import NUMBER, Choice, Text, words
from modelgen.scene.scene_types import Input
from modelgen.scene.source_location import Place
from modelgen.scene.table_types import Field, Several, Table

HOLDS = ("zero", "linear")

INPUT = Table(
    (
        Field("name", Text(NAMED.pattern, NAMED.allowed), "name in expressions", required=True),
        Field("default", NUMBER, "value until it is set", default=0.0),
        Field("minimum", NUMBER, "least value that may be set"),
        Field("maximum", NUMBER, "largest value that may be set"),
        Field(
            "hold", Choice(HOLDS),
            "between two settings: zero keeps the value; linear follows a line, whose rate may be set too",
            default="zero",
        ),
        Field("unit", words(40), "unit, in words", default=""),
    )
)  # fmt: skip
INPUTS = Several(INPUT, label="input")


def with_inputs(place: Place, written: object) -> Place:
    """The place of a scene, whose expressions may use the inputs in its tables; raises SceneError."""
    if not isinstance(written, Mapping) or "input" not in written:
        return place
    return replace(place, inputs=inputs_of(INPUTS.read(written["input"], place.key("input")), place))


def inputs_of(read: tuple[tuple[Place, Mapping[str, Any]], ...], scene: Place) -> tuple[Input, ...]:
    """The inputs of the values of their tables, each with a name of its own; raises SceneError."""
    found: dict[str, Input] = {}
    for place, values in read:
        each = Input(**values)
        if each.name in found or each.name in scene.constants:
            named = "parameter" if each.name in scene.following.get(each.name, ()) else "constant"
            other = "another input" if each.name in found else f"a {named}"
            raise place.key("name").error(
                f"the name {each.name!r}, which is that of {other}", "", "give it a name of its own"
            )
        _check_range(each, place)
        found[each.name] = each
    return tuple(found.values())


def _check_range(each: Input, place: Place) -> None:
    least, largest = each.range
    if not least <= largest:
        raise place.key("minimum").error(f"{least:g} above the maximum {largest:g}", "", "exchange the two")
    if not least <= each.default <= largest:
        raise place.key("default").error(
            f"the default {each.default:g}", f"{least:g} to {largest:g} is the range of this input",
            "change the default or the range",
        )  # fmt: skip


def remark_on_unused(inputs: tuple[Input, ...], used: frozenset[str], place: Place) -> None:
    """Keep a remark on each input that no expression uses."""
    for index, each in enumerate(inputs):
        if each.name not in used:
            place.key("input").item(index).remark(f"no expression uses the input {each.name!r}", "remove it")
