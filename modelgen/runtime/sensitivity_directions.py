"""Directions along which a run is differentiated: parameters, inputs and start states, as changes of the
numbers that the core reads."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import inf
from typing import Any

import numpy as np

from modelgen.codegen.library import Library
from modelgen.errors import SimulationError
from modelgen.name_suggestions import nearest
from modelgen.notation import SETTING_SIZE
from modelgen.runtime.arguments import names_in, with_parameters
from modelgen.runtime.tables.ctypes_structures import INTEGER, Array, address
from modelgen.runtime.tables.library_tables import library_tables

TABLES = (  # of mg_system
    *("parameters", "numbers", "restitution", "friction_static", "friction_kinetic", "patch_friction"),
)
QUANTITIES = ("position", "orientation", "velocity", "angular_velocity")
RELATIVE_STEP = 1e-2  # of a parameter, in the differences of the tables
LEVELS = 4  # of the extrapolation of these differences
ROUNDING = 4  # units of rounding of a number in the tables


@dataclass(frozen=True)
class Direction:
    """What `by` names: one number."""

    name: str
    kind: str  # "parameter", "input", "start"
    owner: str  # parameter, input or body
    quantity: str = ""
    axis: int = 0


def directions_of(instance: Mapping[str, Any], names: Sequence[str]) -> tuple[Direction, ...]:
    """The directions with these names, of the instance of a manifest; three for a quantity of a body.

    Raises SimulationError for a name that is no parameter, no input, and no `BODY.position`, `.orientation`,
    `.velocity` or `.angular_velocity`.
    """
    return tuple(direction for name in names_in("by", names) for direction in _named(instance, name))


def known_names(instance: Mapping[str, Any]) -> list[str]:
    """Everything by which a run can be differentiated, of the instance of a manifest."""
    named = [each["name"] for key in ("parameters", "inputs") for each in instance.get(key, ())]
    return named + [
        f"{body['name']}.{quantity}" for body in instance["bodies"] for quantity in _quantities(body)
    ]


def _quantities(body: Mapping[str, Any]) -> tuple[str, ...]:
    return {"free": QUANTITIES, "point": ("position", "velocity")}.get(body["motion"], ())


def _named(instance: Mapping[str, Any], name: str) -> list[Direction]:
    if any(each["name"] == name for each in instance.get("parameters", ())):
        return [Direction(name, "parameter", name)]
    if any(each["name"] == name for each in instance["inputs"]):
        return [Direction(name, "input", name)]
    known = known_names(instance)
    if name not in known:
        raise SimulationError("by", repr(name), f"known: {', '.join(known)}", nearest(name, known))
    body, _, quantity = name.rpartition(".")
    return [Direction(f"{name}_{axis}", "start", body, quantity, k) for k, axis in enumerate("xyz")]


def direction_arrays(
    library: Library,
    directions: Sequence[Direction],
    parameters: Mapping[str, float],
    inputs: Collection[str] = (),
) -> dict[str, Array]:
    """The fields of mg_directions, a row for each direction.

    Args:
        parameters: those of the run.
        inputs: names of the inputs whose values are given to the run; the others have their defaults, which
            may follow from parameters.
    """
    shared = library_tables(library)
    n = len(directions)
    found: dict[str, Array] = {"start": np.zeros((n, len(shared.start)))}
    tables = _tables(library)
    found |= {name: np.zeros((n, len(tables[name]))) for name in (*TABLES, "gravity")}
    names = [each["name"] for each in library.manifest.instance["inputs"]]
    found["input"] = np.zeros((n, SETTING_SIZE * len(names)))
    at_default = np.array([name not in inputs for name in names], dtype=bool)
    for row, direction in enumerate(directions):
        if direction.kind == "parameter":
            change = _table_derivatives(library, direction.owner, parameters)
            defaults = change.pop("defaults")
            found["input"][row, ::SETTING_SIZE] = np.where(at_default, defaults, 0.0)
            for name, values in change.items():
                found[name][row] = values
        elif direction.kind == "input":
            found["input"][row, SETTING_SIZE * names.index(direction.owner)] = 1.0
        else:
            _change_start(library, shared.start, direction, found["start"][row])
    arrays: dict[str, Array] = {
        name: np.ascontiguousarray(values, dtype=shared.tables.dtype) for name, values in found.items()
    }
    moved = np.any(np.abs(found["numbers"]) > np.sqrt(np.finfo(float).eps), axis=1)
    permitted = np.array([each.kind == "start" for each in directions], dtype=INTEGER)
    return arrays | {
        "moves_borders": np.ascontiguousarray(moved, dtype=INTEGER),
        "is_permitted": np.ascontiguousarray(permitted),
    }


def body_entry(library: Library, name: str) -> Mapping[str, Any]:
    """The entry of a body in the instance."""
    return next(body for body in library.manifest.instance["bodies"] if body["name"] == name)


def _change_start(library: Library, start: Array, direction: Direction, row: Array) -> None:
    """A unit change of the start: of the centre of mass, world axes; of orientation and angular velocity in
    body axes, rad and rad/s."""
    body, axis = body_entry(library, direction.owner), direction.axis
    q, u = body["q"], library.manifest.instance["n_q"] + body["u"]
    if direction.quantity == "position":
        row[q + axis] = 1.0
    elif direction.quantity == "velocity":
        row[u + axis] = 1.0
    elif direction.quantity == "angular_velocity":
        row[u + 3 + axis] = 1.0
    else:
        row[q + 3 : q + 7] = turned(start[q + 3 : q + 7], axis)


def turned(quaternion: Array, axis: int) -> Array:
    """Derivative (4,) of a quaternion (w, x, y, z) by a rotation about a body axis, rad."""
    w, vector = float(quaternion[0]), np.asarray(quaternion[1:], dtype=float)
    half = np.zeros(3)
    half[axis] = 0.5
    return np.concatenate([[-vector @ half], w * half + np.cross(vector, half)])


def _tables(library: Library) -> dict[str, Array]:
    """The numbers that depend on parameters, by the name of their field."""
    shared = library_tables(library)
    by_address = {address(array): array for array in shared.arrays}
    tables = {name: by_address[getattr(shared.system, name)] for name in TABLES}
    defaults = np.array([each["default"] for each in library.manifest.instance["inputs"]], dtype=float)
    gravity = np.array(shared.system.gravity[:])
    return {**tables, "gravity": gravity, "start": shared.start, "defaults": defaults}


def _table_derivatives(library: Library, name: str, parameters: Mapping[str, float]) -> dict[str, Array]:
    """Derivatives of all tables by a parameter: differences of tables that are read again, extrapolated to
    order 2 LEVELS (Richardson)."""
    entry = next(each for each in library.manifest.instance["parameters"] if each["name"] == name)
    value = float(entry["value"])
    low = -inf if entry["minimum"] is None else float(entry["minimum"])
    high = inf if entry["maximum"] is None else float(entry["maximum"])
    step = min(RELATIVE_STEP * (abs(value) or 1.0), value - low, high - value)

    def read(change: float) -> Array:
        tables = _tables(with_parameters(library, {**parameters, name: value + change}))
        return np.concatenate([np.asarray(tables[key], dtype=float) for key in keys])

    keys = (*TABLES, "gravity", "start", "defaults")
    flat = _derivative(read, step, value, low, high)
    sizes = [len(_tables(library)[key]) for key in keys]
    return dict(zip(keys, np.split(flat, np.cumsum(sizes)[:-1]), strict=True))


def _derivative(read: Callable[[float], Array], step: float, value: float, low: float, high: float) -> Array:
    """By central differences; at the end of what the parameter or the scene permits, by those of one side."""
    whole = min(RELATIVE_STEP * (abs(value) or 1.0), high - low)
    try:
        return extrapolated(read, step) if step > 0 else _one_sided(read, whole if value <= low else -whole)
    except SimulationError:
        try:
            return _one_sided(read, -whole)
        except SimulationError:
            return _one_sided(read, whole)


def _one_sided(read: Callable[[float], Array], step: float) -> Array:
    """Derivative at 0 by differences with steps step, step/2, .., extrapolated to zero."""
    at_start = read(0.0)
    table: list[Array] = [(read(step / 2**k) - at_start) / (step / 2**k) for k in range(2 * LEVELS)]
    for order in range(1, len(table)):
        table = [(2.0**order * b - a) / (2.0**order - 1) for a, b in pairwise(table)]
    return table[0]


def extrapolated(function: Callable[[float], Array], step: float, levels: int = LEVELS) -> Array:
    """Derivative at 0 by central differences with steps step, step/2, .., extrapolated (Richardson); the
    first difference where it agrees with the second up to rounding, as for a linear function."""
    table: list[Array] = []
    for k in range(levels):
        h = step / 2**k
        above, below = function(h), function(-h)
        table.append((above - below) / (2 * h))
        rounding = ROUNDING * np.finfo(float).eps * np.maximum(np.abs(above), np.abs(below))
        if k == 1 and np.all(np.abs(table[1] - table[0]) * h <= rounding):
            return table[0]
    for order in range(1, levels):
        factor = 4.0**order
        table = [(factor * b - a) / (factor - 1) for a, b in pairwise(table)]
    return table[0]
