"""Parameters of a scene: named numbers that a run may change."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from math import isfinite
from numbers import Real
from typing import Any

from modelgen.errors import SimulationError
from modelgen.name_suggestions import nearest
from modelgen.scene.constants import NAME_OF_CONSTANT
from modelgen.scene.scalar_types import HUGE, NUMBER, words
from modelgen.scene.scene_types import Parameter
from modelgen.scene.source_location import Place, Use
from modelgen.scene.table_types import Field, Several, Table

_WORDS = words(400)

PARAMETER = Table(
    (
        Field("name", NAME_OF_CONSTANT, "its name in the expressions of the scene", required=True),
        Field("value", NUMBER, "the number, in SI units", required=True),
        Field("nominal", NUMBER, "at which the scales of tolerances are taken; the value if absent"),
        Field("minimum", NUMBER, "the least value that a run may give it"),
        Field("maximum", NUMBER, "the greatest value that a run may give it"),
        Field("unit", _WORDS, "its unit in words", default=""),
        Field("doc", _WORDS, "what it is", default=""),
    )
)
PARAMETERS = Several(PARAMETER, label="parameter")


def parameters_of(written: object, place: Place) -> tuple[Parameter, ...]:
    """The parameters in the tables of a scene, as written; raises SceneError."""
    if not isinstance(written, Mapping) or "parameter" not in written:
        return ()
    known = written.get("constants")
    taken = dict.fromkeys(known, "a constant") if isinstance(known, Mapping) else {}
    found = []
    for at, values in PARAMETERS.read(written["parameter"], place.key("parameter")):
        name = values["name"]
        if name in taken:
            remedy = "give one of the two another name"
            raise at.key("name").error(f"the name {name!r}, which {taken[name]} has", "", remedy)
        taken[name] = "another parameter"
        found.append(_parameter(values, at))
    return tuple(found)


def _parameter(values: Mapping[str, Any], place: Place) -> Parameter:
    if values["nominal"] is None:
        values = {**values, "nominal": values["value"]}
    low, high = values["minimum"], values["maximum"]
    if low is not None and high is not None and not low < high:
        remedy = "exchange them, or write a constant"
        raise place.error(f"minimum {low:g}, maximum {high:g}", "the minimum is the smaller one", remedy)
    for key in ("value", "nominal"):
        if outside := out_of_range(values[key], low, high):
            raise place.key(key).error(f"the number {values[key]!r}", outside)
    numbers = {key: values[key] + 0.0 for key in ("value", "nominal")}  # no negative zero
    return Parameter(**{**values, **numbers})


def out_of_range(value: float, minimum: float | None, maximum: float | None) -> str:
    """What is allowed, in words, where a value is not in the range; else an empty text."""
    if (minimum is None or value >= minimum) and (maximum is None or value <= maximum):
        return ""
    if maximum is None:
        return f"at least {minimum:g} is allowed"
    return f"at most {maximum:g} is allowed" if minimum is None else f"{minimum:g} to {maximum:g} are allowed"


def checked_values(
    values: Mapping[str, object], ranges: Mapping[str, tuple[float | None, float | None]]
) -> dict[str, float]:
    """Values that a run gives to parameters with these minima and maxima; raises SimulationError."""
    return {name: _checked(name, value, ranges) for name, value in values.items()}


def _checked(name: str, value: object, ranges: Mapping[str, tuple[float | None, float | None]]) -> float:
    if name not in ranges:
        told = ", ".join(ranges) or "none; a scene names them in its [[parameter]] tables"
        raise SimulationError("parameters", f"no parameter {name!r}", f"known: {told}", nearest(name, ranges))
    where = f"parameters: {name}"
    if isinstance(value, bool) or not isinstance(value, Real):
        raise SimulationError(where, repr(value), "a number is allowed")
    number = float(value) + 0.0  # no negative zero, which equals zero and is another number
    if not isfinite(number) or abs(number) > HUGE:
        raise SimulationError(where, repr(number), f"a number from {-HUGE:g} to {HUGE:g} is allowed")
    if outside := out_of_range(number, *ranges[name]):
        raise SimulationError(where, f"the number {number!r}", outside)
    return number


def with_uses(parameters: Iterable[Parameter], uses: Iterable[Use], place: Place) -> tuple[Parameter, ...]:
    """The parameters with the places that follow from each; raises SceneError for one that nothing uses."""
    noted: dict[str, list[str]] = {}
    for use in uses:
        if not use.path.startswith("constants."):  # a constant alone changes nothing
            noted.setdefault(use.parameter, []).append(str(use))
    found = []
    for index, each in enumerate(parameters):
        if each.name not in noted:
            raise (
                place.key("parameter")
                .item(index)
                .error(
                    f"the parameter {each.name!r}, which nothing uses",
                    "a parameter stands for numbers of the scene",
                    f'write "{each.name}" where its number stands, or remove it',
                )
            )
        found.append(replace(each, uses=tuple(dict.fromkeys(noted[each.name]))))
    return tuple(found)
