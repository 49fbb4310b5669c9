"""The mode of a scene: which contacts carry force, on which features, what sticks, what slips.

A `ContactMode` fixes it when a function is made. In a function for all modes, a vector of numbers gives it
(`mode_vector`), and only the features are fixed.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal

from modelgen.errors import ModelgenError
from modelgen.model import ENDS, ContactEntry, FrictionConstraint, LimitEntry, Model, PairEntry

Vector = tuple[float, float, float]
FrictionState = Literal["off", "sticks", "slips"]
SUPPORT_POINTS, PATCH_FRICTION_ROWS = 3, 3
DIRECTION, OF_FRICTION = 3, 5  # numbers of the direction of a constraint, and of all of it in a mode vector
NO_FEATURE_PAIR = -1


@dataclass(frozen=True, slots=True)
class FrictionMode:
    """Mode of a friction constraint.

    `direction`: of slip or rolling, unit vector in world axes; of spin +-1 in the first entry. It tells the
    way of friction while the slip is too slow to do so.
    """

    state: FrictionState = "off"
    direction: Vector = (1.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class PatchMode:
    """A flat patch that rests, held by up to three points of its second body."""

    patch: int
    holds: tuple[bool, bool, bool]
    points: tuple[Vector, Vector, Vector]  # m, axes of the second body
    sticks: bool = False


@dataclass(frozen=True, slots=True)
class ContactMode:
    """What the equations of motion depend on beside the state.

    Attributes:
        feature_pairs: of each contact with shapes the feature pair that it follows, or -1.
        active: of each contact with shapes and then each limit of a joint, whether it carries force.
        friction: of the friction constraints of all contacts, contact by contact.
        patches: that rest.
        reference: forces by row, from which forces that are not unique deviate least; none: zero.
        redundant: whether rows that hold are dependent, so that forces are not unique.
    """

    feature_pairs: tuple[int, ...]
    active: tuple[bool, ...]
    friction: tuple[FrictionMode, ...] = ()
    patches: tuple[PatchMode, ...] = ()
    reference: tuple[float, ...] = ()
    redundant: bool = False


def contact_count(model: Model) -> int:
    """Contacts with shapes and limits of joints."""
    return len(model.contacts) + len(model.limits)


def contact_entries(model: Model) -> tuple[ContactEntry | LimitEntry, ...]:
    """The contacts with shapes, then the limits of joints."""
    return (*model.contacts, *model.limits)


def friction_of_contacts(model: Model) -> list[tuple[int, FrictionConstraint]]:
    """All friction constraints with the index of their contact, contact by contact."""
    return [
        (index, constraint)
        for index, contact in enumerate(model.contacts)
        for constraint in model.pairs[contact.pair].friction
    ]


def lone_feature_pairs(model: Model, pair: PairEntry) -> list[int]:
    """The feature pairs of a pair that are no coaxial supports."""
    return [k for k in range(*pair.feature_pairs) if not model.feature_pairs[k].is_coaxial_support]


def own_feature_pairs(model: Model) -> tuple[int, ...]:
    """Of each contact the one feature pair that it can follow, or -1 where there are several; coaxial
    supports are left out.

    Of contacts of one pair that compete for its feature pair, the first follows it.
    """
    found, taken = [], set()
    for contact in model.contacts:
        lone = lone_feature_pairs(model, model.pairs[contact.pair])
        own = contact.feature_pair if contact.feature_pair >= 0 or len(lone) > 1 else lone[0]
        found.append(own if own not in taken else NO_FEATURE_PAIR)
        taken.add(own)
    return tuple(found)


def held_mode(model: Model) -> ContactMode:
    """All contacts that have one feature pair carry force, all friction sticks, limits are free."""
    pairs = own_feature_pairs(model)
    active = (*(pair >= 0 for pair in pairs), *[False] * len(model.limits))
    friction = [FrictionMode("sticks" if active[k] else "off") for k, _ in friction_of_contacts(model)]
    return ContactMode(pairs, active, tuple(friction))


def mode_size(model: Model, rows: int) -> int:
    """Numbers of a mode vector of a scene with that many rows."""
    return contact_count(model) + OF_FRICTION * len(friction_of_contacts(model)) + rows


def mode_numbers(mode: ContactMode, rows: int) -> list[float]:
    """The mode as numbers, for a function of all modes with the same feature pairs.

    1 or 0 for each contact; of each friction constraint 1 or 0 for sticking, 1 or 0 for slipping, and its
    direction; the reference forces of the rows.

    Raises ModelgenError where a patch rests, which a mode vector cannot tell.
    """
    if mode.patches:
        raise ModelgenError(
            "mode", "a flat face rests on three points", "contacts at points", "make a function for this mode"
        )
    numbers = [float(value) for value in mode.active]
    for constraint in mode.friction:
        states = [float(constraint.state == state) for state in ("sticks", "slips")]
        numbers += [*states, *constraint.direction]
    return [*numbers, *(mode.reference or [0.0] * rows)]


def check_mode(model: Model, mode: ContactMode) -> None:
    """Raises ModelgenError where a mode is none of the model."""
    where = f"{model.scene.source}: mode"
    for what, found, allowed in (
        ("feature_pairs", len(mode.feature_pairs), len(model.contacts)),
        ("active", len(mode.active), contact_count(model)),
        ("friction", len(mode.friction), len(friction_of_contacts(model))),
    ):
        if found != allowed:
            raise ModelgenError(f"{where}: {what}", f"{found} entries", f"the scene has {allowed}")
    for index, (contact, pair) in enumerate(zip(model.contacts, mode.feature_pairs, strict=True)):
        first, end = model.pairs[contact.pair].feature_pairs
        if pair != NO_FEATURE_PAIR and not first <= pair < end:
            raise ModelgenError(
                f"{where}: contact {contact.name!r}",
                f"feature pair {pair}",
                f"{first} to {end - 1}, or {ENDS}",
            )
        if mode.active[index] and pair == NO_FEATURE_PAIR:
            raise ModelgenError(
                f"{where}: contact {contact.name!r}", "it carries force on no feature pair", "",
                "name the features that it touches with",
            )  # fmt: skip


def named_feature_pairs(model: Model, named: Iterable[tuple[str, str]]) -> Sequence[int]:
    """The feature pairs of contacts by their names, as events print them.

    Raises ModelgenError where a contact or a feature pair is unknown.
    """
    found = list(own_feature_pairs(model))
    names = [contact.name for contact in model.contacts]
    for contact, features in named:
        if contact not in names:
            raise ModelgenError("feature_pairs", f"no contact {contact!r}", f"known: {', '.join(names)}")
        index = names.index(contact)
        range_ = range(*model.pairs[model.contacts[index].pair].feature_pairs)
        known = {model.feature_pairs[k].name: k for k in range_}
        if features not in known:
            raise ModelgenError(
                f"feature_pairs: {contact}", f"no features {features!r}", f"known: {', '.join(known)}"
            )
        found[index] = known[features]
    return found
