"""Friction constraints of contacts: slip in the tangent plane, spin about the normal, rolling."""

from __future__ import annotations

from modelgen.model import FrictionConstraint, Rows
from modelgen.scene.scene_types import ContactPair

SPIN, ROLL = 2, 3  # rows below the normal one


def rows_of(pair: ContactPair) -> Rows:
    """The rows that the contacts of a pair need."""
    if pair.friction is None:
        return 1
    return 6 if pair.rolling_resistance or pair.spinning_resistance else 3


def has_friction(pair: ContactPair) -> bool:
    """Whether the friction of a pair is integrated over the contact patch of faces that lie on each other.

    It must be alike in all directions, and no resistance besides.
    """
    resists = pair.rolling_resistance or pair.spinning_resistance
    return pair.friction is not None and pair.friction.direction is None and not resists


def friction_constraints_of(pair: ContactPair, first: int) -> tuple[FrictionConstraint, ...]:
    """The friction constraints of each contact of a pair. `first`: the index of its first body."""
    if pair.friction is None:
        return ()
    static, kinetic, direction = pair.friction.static, pair.friction.kinetic, pair.friction.direction
    slip = FrictionConstraint("slip", 0, 2, static, kinetic)
    if direction is not None:
        slip = FrictionConstraint("slip", 0, 2, static, kinetic, first, direction)
    spin, roll = ((m, m) for m in (pair.spinning_resistance, pair.rolling_resistance))
    constraints = (
        slip,
        FrictionConstraint("spin", SPIN, 1, spin, spin),
        FrictionConstraint("roll", ROLL, 2, roll, roll),
    )
    return tuple(constraint for constraint in constraints if constraint.kinetic[0])
