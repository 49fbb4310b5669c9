"""The numbers of a scene that a sweep varies: parameters, inputs, and components of starts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import inf
from typing import Any

from modelgen.codegen.library import Library
from modelgen.errors import ModelgenError
from modelgen.name_suggestions import nearest
from modelgen.parameter_study.design import Variation
from modelgen.runtime.arguments import input_range

ANY = "a [[parameter]] of the scene may stand for any of its numbers"
QUANTITIES = {"point": ("position", "velocity"), "free": ("position", "velocity", "angular_velocity")}


@dataclass(frozen=True, slots=True)
class VariedNumber:
    """A number that differs from run to run."""

    name: str
    kind: str  # "parameter", "input", "start"
    low: float
    high: float
    place: int = -1  # of a start: in the state


def varied_numbers(
    library: Library, variations: Sequence[Variation], fixed: Mapping[str, object]
) -> tuple[VariedNumber, ...]:
    """What the variations name in a library.

    Raises ModelgenError for a name that is none, one among the `fixed` ones, or values out of its range.
    """
    known = _known(library)
    for each in variations:
        where = f"vary {each.name}={each.text}"
        if each.name not in known:
            remedy = _turn(each.name) or nearest(each.name, known) or ANY
            raise ModelgenError(where, f"no number {each.name!r}", _told(library), remedy)
        if each.name in fixed:
            raise ModelgenError(where, f"{each.name!r} has a fixed value too", "", "leave one of the two out")
        number = known[each.name]
        for value in (each.low, each.high):
            if not number.low <= value <= number.high:
                allowed = f"{number.kind} {each.name!r} goes from {number.low:g} to {number.high:g}"
                raise ModelgenError(where, f"the value {value:g}", allowed, "narrow the range")
    return tuple(known[each.name] for each in variations)


def _known(library: Library) -> dict[str, VariedNumber]:
    instance = library.manifest.instance
    found = {
        each["name"]: VariedNumber(each["name"], kind, *input_range(each))
        for kind, key in (("parameter", "parameters"), ("input", "inputs"))
        for each in instance.get(key, ())
    }
    for body in instance["bodies"]:
        for name, place in _places(instance, body):
            found[name] = VariedNumber(name, "start", -inf, inf, place)
    return found


def _places(instance: Mapping[str, Any], body: Mapping[str, Any]) -> list[tuple[str, int]]:
    """The components of the start of a body with their places in the state."""
    velocities = instance["n_q"] + body["u"]
    first = {"position": body["q"], "velocity": velocities, "angular_velocity": velocities + 3}
    return [
        (f"{body['name']}.{quantity}_{axis}", first[quantity] + k)
        for quantity in QUANTITIES.get(body["motion"], ())
        for k, axis in enumerate("xyz")
    ]


def _told(library: Library) -> str:
    """What may vary, in words."""
    instance = library.manifest.instance
    parts = [
        f"{word}: {', '.join(each['name'] for each in instance[key])}"
        for word, key in (("parameters", "parameters"), ("inputs", "inputs"))
        if instance.get(key)
    ]
    free = [body["name"] for body in instance["bodies"] if body["motion"] in QUANTITIES]
    if free:
        parts.append(f"starts such as {free[0]}.position_x or {free[0]}.velocity_x, of {', '.join(free)}")
    return "; ".join(parts) or "the scene has no number that may vary"


def _turn(name: str) -> str:
    """The remedy where an angle is meant."""
    quantity = name.rpartition(".")[2]
    is_turn = quantity.startswith(("orientation", "quaternion", "rpy"))
    return "write the angle as a [[parameter]] of the scene, and vary that" if is_turn else ""
