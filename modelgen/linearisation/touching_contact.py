"""A contact that touches at the start: its rows at a place, and how much of its friction forces take."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from modelgen.model import FeaturePairEntry, FrictionConstraint, Model

Array = np.ndarray[Any, np.dtype[np.float64]]

NEWTON = 20  # corrections of the contact points
WIDTH = {"slip": 2, "spin": 1, "roll": 2}  # rows of a friction constraint
CONE = {"slip": slice(0, 2), "spin": slice(2, 3), "roll": slice(3, 4)}  # of a record with friction


@dataclass(frozen=True)
class Contact:
    """A contact that stays on one feature pair; its friction and resistances hold it at rest."""

    name: str
    feature_pair: FeaturePairEntry
    friction: tuple[FrictionConstraint, ...]
    rates: ca.Function
    place: ca.Function
    eta: Array  # at the start

    @property
    def rows(self) -> int:
        """1, 3 or 6: N; slip along t1, t2; spin about N, rolling about t1, t2."""
        return int(self.rates.numel_out("gamma"))

    @property
    def held(self) -> list[int]:
        """Which of them vanish at rest: that along N, and those that a friction constraint holds."""
        return [0, *(row for constraint in self.friction for row in _rows(constraint))]

    def settled(self, sides: list[Array], eta: Array) -> tuple[Array, float]:
        """eta on the extremum, and the gap there, m."""
        for _ in range(NEWTON):
            following, gap, *_ = call(self.place, *sides, eta, np.array(self.feature_pair.parameters))
            done = np.array_equal(following, eta)
            eta = following
            if done:
                break
        return eta, float(gap[0])

    def facing(self, sides: list[Array], eta: Array, model: Model) -> Facing:
        still = np.zeros(6)
        _, J_o, J_f, _, _, normal, *tangents = call(
            self.rates, sides[0], still, sides[1], still, eta, np.array(self.feature_pair.parameters)
        )
        J = np.zeros((self.rows, model.n_u))
        for body, part in zip((self.feature_pair.o, self.feature_pair.f), (J_o, J_f), strict=True):
            block = part.reshape(self.rows, -1) if part.size else np.zeros((self.rows, 0))
            J[:, model.bodies[body].u :][:, : block.shape[1]] = block
        return Facing(J, normal, np.reshape(tangents[0], (2, 3)) if tangents else np.zeros((2, 3)))


@dataclass(frozen=True)
class Facing:
    """A contact at a place."""

    J: Array  # (rows, n)
    normal: Array  # (3,) world, from o to f
    tangents: Array  # (2, 3) t1, t2, world

    def axes(self, contact: Contact, turns: list[Array]) -> Array:
        """(rows, rows) orthogonal: turns slip to the axes of friction that depends on the direction.

        `turns`: the rotation (3, 3) of each body.
        """
        found = np.eye(contact.rows)
        for constraint in contact.friction:
            if constraint.body >= 0:
                along = self.tangents @ (turns[constraint.body] @ np.array(constraint.direction))
                size = float(np.linalg.norm(along))
                x, y = along / size if size else (1.0, 0.0)
                found[1:3, 1:3] = [[x, y], [-y, x]]
        return found


def cone(contact: Contact) -> Array:
    """(4,) the static coefficients along the axes, of spinning, of rolling (m); zero where nothing holds."""
    found = np.zeros(4)
    for constraint in contact.friction:
        found[CONE[constraint.kind]] = constraint.static[
            : CONE[constraint.kind].stop - CONE[constraint.kind].start
        ]
    return found


def share(contact: Contact, force: Array) -> tuple[float, str]:
    """Largest ratio of a friction force (axes of friction) to its bound, and its friction constraint.
    Infinite where a force is needed and the normal force is zero."""
    found = [
        (_length(force[_rows(constraint)], constraint), constraint.kind) for constraint in contact.friction
    ]
    used, kind = max(found, default=(0.0, "slip"))
    if not used:
        return 0.0, kind
    return used / force[0] if force[0] > 0 else np.inf, kind


def moving(contact: Contact, rates: Array) -> list[tuple[FrictionConstraint, float]]:
    """The speed of each friction constraint, m/s or rad/s, from the rates along the contact's rows."""
    return [(constraint, float(np.linalg.norm(rates[_rows(constraint)]))) for constraint in contact.friction]


def _length(force: Array, constraint: FrictionConstraint) -> float:
    return float(np.linalg.norm(force / np.array(constraint.static)[: len(force)]))


def _rows(constraint: FrictionConstraint) -> list[int]:
    return [1 + constraint.row + k for k in range(WIDTH[constraint.kind])]


def call(function: ca.Function, *arguments: Array) -> list[Array]:
    """The outputs (n,) of a kernel, its arguments cut to the length that it takes."""
    given = [ca.DM(value[: function.numel_in(k)]) for k, value in enumerate(arguments)]
    return [np.array(value).ravel() for value in function.call(given)]
