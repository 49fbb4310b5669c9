"""What is fitted: parameters and inputs of all recordings, and starts of bodies in each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import inf
from typing import Any

from modelgen.errors import SimulationError
from modelgen.notation import component_names
from modelgen.runtime.arguments import input_range, is_number, names_in
from modelgen.runtime.inputs import is_beyond, refused_value
from modelgen.runtime.sensitivity_directions import Direction, directions_of

ALL = -1  # recordings


@dataclass(frozen=True)
class Unknown:
    """One number that is fitted."""

    direction: Direction
    recording: int  # index, or ALL
    first: float  # of an orientation: turn from the first guess, rad
    low: float
    high: float
    scale: float  # a change that matters

    @property
    def name(self) -> str:
        return self.direction.name


def unknowns_of(
    instance: Mapping[str, Any], by: Sequence[str], n_recordings: int, inputs: Mapping[str, float]
) -> list[Unknown]:
    """The unknowns that `by` names, at the values of the instance of a manifest and of the inputs; starts are
    0 until the recordings are looked at.

    Raises SimulationError where a name is unknown or comes twice, or nothing is named.
    """
    names = names_in("by", by)
    if not names:
        known = ", ".join(each["name"] for each in instance.get("parameters", ()))
        allowed = f"names of parameters ({known or 'the scene has none'}), inputs, or starts of bodies"
        raise SimulationError("by", "nothing to fit", allowed, 'write by=["friction"]')
    directions = [direction for name in names for direction in _directions(instance, name)]
    names = [direction.name for direction in directions]
    for name in names:
        if names.count(name) > 1:
            raise SimulationError("by", f"{name!r} twice", "", "leave one out")
    common = [_of_all(instance, each, inputs) for each in directions if each.kind != "start"]
    starts = [
        _start(instance, each, k) for k in range(n_recordings) for each in directions if each.kind == "start"
    ]
    return common + starts


def _directions(instance: Mapping[str, Any], name: str) -> tuple[Direction, ...]:
    """Those of a name, which may be a component of a start, as `ball.velocity_x`."""
    whole, letter = name[:-2], name[-1:]
    if "." in name and name[-2:-1] == "_" and name in component_names([(whole, 3)]):
        return tuple(each for each in directions_of(instance, [whole]) if each.name.endswith(letter))
    return directions_of(instance, [name])


def _of_all(instance: Mapping[str, Any], direction: Direction, inputs: Mapping[str, float]) -> Unknown:
    if direction.kind == "input":
        kind = next(each for each in instance["inputs"] if each["name"] == direction.owner)
        given, (low, high) = inputs.get(direction.owner, kind["default"]), input_range(kind)
        if not is_number(given) or is_beyond(given, low, high):
            raise refused_value(kind, f"input {direction.owner!r}", given, True)
        first = float(given)
    else:
        kind = next(each for each in instance["parameters"] if each["name"] == direction.owner)
        first, (low, high) = float(kind["value"]), input_range(kind)
    if not low < high:
        raise SimulationError("by", f"{direction.name!r} with the range {low:g} to {high:g}", "a wider range")
    return Unknown(direction, ALL, first, low, high, _scale(first, low, high))


def _scale(first: float, low: float, high: float) -> float:
    return abs(first) or (high - low if high - low < inf else 1.0)


def _start(instance: Mapping[str, Any], direction: Direction, recording: int) -> Unknown:
    length, time = float(instance["scales"]["length"]), float(instance["scales"]["time"])
    scale = {"position": length, "velocity": length / time, "orientation": 1.0}
    return Unknown(direction, recording, 0.0, -inf, inf, scale.get(direction.quantity, 1 / time))
