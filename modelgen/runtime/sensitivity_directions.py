"""Directions along which a run is differentiated: parameters, inputs and start states, as changes of the
numbers that the core reads."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import inf
from typing import Any, NamedTuple

import numpy as np

from modelgen.codegen.library import Library
from modelgen.errors import SimulationError
from modelgen.name_suggestions import listed, nearest
from modelgen.notation import SETTING_SIZE
from modelgen.runtime.arguments import names_in
from modelgen.runtime.table_derivatives import Tables
from modelgen.runtime.tables.ctypes_structures import INTEGER, Array, address
from modelgen.runtime.tables.library_tables import library_tables

TABLES = (  # of mg_system
    *("parameters", "numbers", "restitution", "friction_static", "friction_kinetic", "patch_friction"),
)
QUANTITIES = ("position", "orientation", "velocity", "angular_velocity")
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
        raise SimulationError("by", repr(name), f"known: {listed(known)}", nearest(name, known))
    body, _, quantity = name.rpartition(".")
    return [Direction(f"{name}_{axis}", "start", body, quantity, k) for k, axis in enumerate("xyz")]


class NumberOnKink(NamedTuple):
    """A number of the scene that is on a kink where it moves with a parameter."""

    place: str
    is_lost: bool  # it has no derivative; else that for larger values of the parameter


@dataclass(frozen=True)
class DirectionRows:
    """Directions as the core reads them."""

    arrays: dict[str, Array]  # the fields of mg_directions, a row for each direction
    kinks: tuple[NumberOnKink | None, ...]  # of each direction the number of the scene that is on a kink


def direction_arrays(
    library: Library, directions: Sequence[Direction], inputs: Collection[str] = ()
) -> dict[str, Array]:
    """The arrays of `direction_rows`."""
    return direction_rows(library, directions, inputs).arrays


def direction_rows(
    library: Library, directions: Sequence[Direction], inputs: Collection[str] = ()
) -> DirectionRows:
    """The directions of a library at the values of its parameters.

    Args:
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
    kinks: list[NumberOnKink | None] = [None] * n
    for row, direction in enumerate(directions):
        if direction.kind == "parameter":
            change, kinks[row] = _table_derivatives(library, direction.owner)
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
    arrays |= {
        "moves_borders": np.ascontiguousarray(moved, dtype=INTEGER),
        "is_permitted": np.ascontiguousarray(permitted),
    }
    return DirectionRows(arrays, tuple(kinks))


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


def _table_derivatives(library: Library, name: str) -> tuple[dict[str, Array], NumberOnKink | None]:
    """Derivatives of all tables by a parameter, and the number of the scene that is on a kink."""
    from modelgen.codegen.library_with_parameters import library_along  # reads the scene again, with CasADi

    keys = (*TABLES, "gravity", "start", "defaults")
    tables = _tables(library)
    sizes = [len(tables[key]) for key in keys]
    moved = library_along(library, name)

    def read(step: float) -> Array:
        at = _tables(moved(step)) if step else tables
        return np.concatenate([np.asarray(at[key], dtype=float) for key in keys])

    kink = NumberOnKink(*moved.kink) if moved.kink else None
    if moved.unit == inf:  # no number moves
        return dict(zip(keys, map(np.zeros, sizes), strict=True)), kink
    found = Tables(read, moved.unit, moved.scale, float(np.finfo(library.dtype).eps)).derivative()
    kink = kink if found.is_smooth else NumberOnKink(f"what follows from {name}", True)
    return dict(zip(keys, np.split(found.value, np.cumsum(sizes)[:-1]), strict=True)), kink


def extrapolated(function: Callable[[float], Array], step: float, levels: int = 4) -> Array:
    """The value of `extrapolated_with_error`."""
    return extrapolated_with_error(function, step, levels)[0]


def extrapolated_with_error(
    function: Callable[[float], Array], step: float, levels: int
) -> tuple[Array, Array]:
    """Derivative at 0 by central differences with steps step, step/2, .., extrapolated (Richardson), and by
    how much the last extrapolation changes it; the first difference where it agrees with the second up to
    rounding, as for a linear function."""
    table: list[Array] = []
    for k in range(levels):
        h = step / 2**k
        above, below = function(h), function(-h)
        table.append((above - below) / (2 * h))
        rounding = ROUNDING * np.finfo(float).eps * np.maximum(np.abs(above), np.abs(below))
        if k == 1 and np.all(np.abs(table[1] - table[0]) * h <= rounding):
            return table[0], rounding / h
    change = np.zeros_like(table[0])
    for order in range(1, levels):
        factor, last = 4.0**order, table[-1]
        table = [(factor * b - a) / (factor - 1) for a, b in pairwise(table)]
        change = np.abs(table[-1] - last)
    return table[0], change


def extrapolated_from_one_side(
    function: Callable[[float], Array], step: float, levels: int
) -> tuple[Array, Array]:
    """Derivative at 0 by differences from 0 with steps step, step/2, .., extrapolated, to the side of the
    sign of the step, and by how much the last extrapolation changes it."""
    start = function(0.0)
    table = [(function(h) - start) / h for h in (step / 2**k for k in range(levels))]
    change = np.zeros_like(start)
    for order in range(1, levels):
        factor, last = 2.0**order, table[-1]
        table = [(factor * b - a) / (factor - 1) for a, b in pairwise(table)]
        change = np.abs(table[-1] - last)
    return table[0], change
