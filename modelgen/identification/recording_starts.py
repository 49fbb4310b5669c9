"""Where the run of a recording starts: as the scene says, as the recording shows, or as fitted."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from modelgen.codegen.library import Library
from modelgen.errors import SimulationError
from modelgen.identification.recordings import Array, Recording
from modelgen.identification.unknowns import Unknown
from modelgen.name_suggestions import nearest
from modelgen.notation import component_names
from modelgen.runtime.sensitivity import outputs_of
from modelgen.runtime.sensitivity_directions import QUANTITIES, body_entry, turned
from modelgen.runtime.tables.library_tables import library_tables

ROWS = 5  # of a recording, from which its start is guessed
SIZES = {"position": 3, "orientation": 4, "velocity": 3, "angular_velocity": 3}


@dataclass(frozen=True)
class Start:
    """Numbers of the state that take the place of the scene's, and the unknowns among them."""

    given: dict[int, float]  # by place in the state
    unknowns: tuple[Unknown, ...]
    _places: tuple[int, ...]  # of the unknowns; of a turn: of the quaternion

    def write(self, state: Array, values: Sequence[float] | Array) -> None:
        """Write the start into a state (n_x,), with values of the unknowns."""
        for place, value in self.given.items():
            state[place] = value
        for place, turn in self._turns(values).items():
            state[place : place + 4] = _product(state[place : place + 4], _exponential(turn))
        for unknown, place, value in zip(self.unknowns, self._places, values, strict=True):
            if unknown.direction.quantity != "orientation":
                state[place] = value

    def rows(self, values: Sequence[float] | Array, n_x: int, state: Array) -> Array:
        """Derivatives (n, n_x) of what `write` wrote into `state`, by the unknowns."""
        found = np.zeros((len(self.unknowns), n_x))
        turns = self._turns(values)
        for row, (unknown, place) in enumerate(zip(self.unknowns, self._places, strict=True)):
            if unknown.direction.quantity == "orientation":
                body_turn = _right_jacobian(turns[place])[:, unknown.direction.axis]
                quaternion = state[place : place + 4]
                found[row, place : place + 4] = sum(body_turn[k] * turned(quaternion, k) for k in range(3))
            else:
                found[row, place] = 1.0
        return found

    @property
    def overwritten(self) -> list[int]:
        """Places in the state that the scene does not decide."""
        plain = [
            place
            for unknown, place in zip(self.unknowns, self._places, strict=True)
            if unknown.direction.quantity != "orientation"
        ]
        return sorted({*self.given, *plain})

    def _turns(self, values: Sequence[float] | Array) -> dict[int, Array]:
        """The turn (3,) of each quaternion that is fitted, by its place."""
        turns: dict[int, Array] = {}
        for unknown, place, value in zip(self.unknowns, self._places, values, strict=True):
            if unknown.direction.quantity == "orientation":
                turns.setdefault(place, np.zeros(3))[unknown.direction.axis] = value
        return turns


def start_of(
    library: Library, recording: Recording, unknowns: Sequence[Unknown], bodies: Sequence[str]
) -> tuple[Start, list[Unknown]]:
    """The start of a recording, and its unknowns with first guesses: from the recording where it shows the
    body, else from the scene. Components that are not fitted stay the scene's, unless all three of a quantity
    are. `bodies`: that start as the recording shows, fitted or not."""
    state = np.array(library_tables(library).start, dtype=float)
    fitted = [(each.direction.owner, each.direction.quantity) for each in unknowns]
    whole = {pair for pair in fitted if fitted.count(pair) == 3}
    whole |= {_of_start(library, recording, name) for name in recording.start}
    whole |= {(body, quantity) for body in bodies for quantity in _quantities(library, body)}
    given: dict[int, float] = {}
    guess = state.copy()
    for body, quantity in sorted({*fitted, *whole}):
        place = _place(library, body, quantity)
        part = slice(place, place + SIZES[quantity])
        shown = shown_at_start(recording, body, quantity)
        if shown is not None and (quantity != "orientation" or (body, quantity) in whole):
            guess[part] = shown
        if (shown is not None and (body, quantity) in whole) or quantity == "orientation":
            given |= {place + k: float(value) for k, value in enumerate(guess[part])}
    places = tuple(_place_of(library, each) for each in unknowns)
    guessed = [
        each if each.direction.quantity == "orientation" else replace(each, first=float(guess[at]))
        for each, at in zip(unknowns, places, strict=True)
    ]
    return Start(given, tuple(guessed), places), guessed


def _quantities(library: Library, body: str) -> tuple[str, ...]:
    bodies = {each["name"]: each for each in library.manifest.instance["bodies"]}
    if body not in bodies or bodies[body]["motion"] not in ("free", "point"):
        free = ", ".join(name for name, each in bodies.items() if each["motion"] in ("free", "point"))
        raise SimulationError("start", repr(body), f"bodies that move freely: {free or 'none'}")
    return QUANTITIES if bodies[body]["motion"] == "free" else ("position", "velocity")


def _normal(values: Array, quantity: str) -> Array:
    return np.asarray(values / np.linalg.norm(values) if quantity == "orientation" else values)


def _of_start(library: Library, recording: Recording, name: str) -> tuple[str, str]:
    """Body and quantity; SimulationError where there is no such quantity, or it has another size."""
    outputs = outputs_of(library.manifest.instance)
    known = [each for each, parts in outputs.items() if parts[0].state >= 0]
    where = f"{recording.name}: start of {name!r}"
    if name not in known:
        raise SimulationError(where, "unknown", f"known: {', '.join(known)}", nearest(name, known))
    size = len(outputs[name])
    if recording.start[name].shape != (size,) or not np.all(np.isfinite(recording.start[name])):
        found = f"an array of shape {recording.start[name].shape}"
        raise SimulationError(where, found, f"{size} finite numbers")
    body, _, quantity = name.rpartition(".")
    return body, quantity


def _place(library: Library, body: str, quantity: str) -> int:
    entry: Any = body_entry(library, body)
    velocities = int(library.manifest.instance["n_q"]) + int(entry["u"])
    places = {"position": entry["q"], "velocity": velocities, "orientation": entry["q"] + 3}
    return int(places.get(quantity, velocities + 3))


def _place_of(library: Library, unknown: Unknown) -> int:
    direction = unknown.direction
    first = _place(library, direction.owner, direction.quantity)
    return first if direction.quantity == "orientation" else first + direction.axis


def shown_at_start(recording: Recording, body: str, quantity: str) -> Array | None:
    """What a recording says of a body at t = 0, or shows in its first rows; None where it does not.

    Velocities that were not recorded are slopes of parabolas through positions and turns. Raises
    SimulationError where the recording begins later.
    """
    if f"{body}.{quantity}" in recording.start:
        return _normal(recording.start[f"{body}.{quantity}"], quantity)
    t, values = _first_rows(recording, f"{body}.{quantity}", SIZES[quantity])
    if values is not None:
        if quantity == "orientation":
            return _normal(values[0], quantity)
        return np.asarray(_parabola(t, values)[0])
    derived = {"velocity": "position", "angular_velocity": "orientation"}.get(quantity)
    if derived is None:
        return None
    t, values = _first_rows(recording, f"{body}.{derived}", SIZES[derived])
    if values is None or len(t) == 1:
        return None
    return np.asarray(_parabola(t, values if derived == "position" else _turns_from_first(values))[1])


def _first_rows(recording: Recording, name: str, size: int) -> tuple[Array, Array | None]:
    names = component_names([(name, size)])
    if not set(names) <= set(recording.columns):
        return recording.t, None
    values = recording.values[:, [recording.columns.index(each) for each in names]]
    rows = np.flatnonzero(np.isfinite(values).all(axis=1))[:ROWS]
    if not len(rows):
        return recording.t, None
    if recording.t[rows[0]] > 0:
        found = f"{name} is first measured at {recording.t[rows[0]]:.6g} s"
        remedy = "subtract the first time from t, or start as the scene says"
        raise SimulationError(recording.name, found, "a start at t = 0 s", remedy)
    return recording.t[rows], values[rows]


def _parabola(t: Array, values: Array) -> Array:
    """Value and slope at t = 0 (2, n) of the parabola nearest to values (nt, n), a line for two."""
    coefficients = np.polynomial.polynomial.polyfit(t, values, min(2, len(t) - 1))
    return np.vstack([coefficients, np.zeros((1, values.shape[1]))])[:2]


def _turns_from_first(quaternions: Array) -> Array:
    """Rotation vectors (nt, 3), rad, body axes, from the first of unit quaternions (nt, 4)."""
    inverse = quaternions[0] * [1.0, -1.0, -1.0, -1.0]
    relative = np.array([_product(inverse, each) for each in quaternions])
    relative *= np.where(relative[:, :1] < 0, -1.0, 1.0)
    sines = np.linalg.norm(relative[:, 1:], axis=1, keepdims=True)
    angles = 2 * np.arctan2(sines, relative[:, :1])
    return np.asarray(relative[:, 1:] * np.where(sines > 0, angles / np.where(sines > 0, sines, 1.0), 2.0))


def _product(a: Array, b: Array) -> Array:
    w, vector = a[0] * b[0] - a[1:] @ b[1:], a[0] * b[1:] + b[0] * a[1:] + np.cross(a[1:], b[1:])
    return np.concatenate([[w], vector])


def _exponential(turn: Array) -> Array:
    """The unit quaternion of a rotation vector."""
    half = float(np.linalg.norm(turn)) / 2
    return np.concatenate([[np.cos(half)], np.sinc(half / np.pi) * turn / 2])


def _right_jacobian(turn: Array) -> Array:
    """(3, 3): the change of exp(turn) in its own axes by that of the turn."""
    angle = float(np.linalg.norm(turn))
    cross = np.array([[0, -turn[2], turn[1]], [turn[2], 0, -turn[0]], [-turn[1], turn[0], 0]])
    first = np.sinc(angle / (2 * np.pi)) ** 2 / 2  # (1 - cos a) / a^2
    second = (1 - np.sinc(angle / np.pi)) / angle**2 if angle > 1e-3 else 1 / 6 - angle**2 / 120
    return np.asarray(np.eye(3) - first * cross + second * cross @ cross)
