"""The forces of contacts in an equilibrium or steady motion: which press, and hold within friction's bounds.

Where they are not unique, those of minimum norm are taken if they do, others else. Whether any do is a convex
question: the least of |free + M^-1 J^T z|_M over the cones is zero (Gauss's principle), where free is the
acceleration without these forces less that of the motion. Joints take what they must: all of this is asked of
the motions R that they leave, R^T J^T z = -R^T M free.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NoReturn

import numpy as np
from scipy.linalg import block_diag
from scipy.optimize import nnls

from modelgen.errors import SimulationError
from modelgen.linearisation.rest_linearisation import DEPENDENT, HeldState, Touching
from modelgen.linearisation.touching_contact import Array, cone, share
from modelgen.runtime.friction import FrictionProblem, Outcome, relaxation

SAME = 1e-9  # relative, what is rounding in unique forces
BALANCED = 1e-8  # relative, of forces that hold
WITHIN = 1e-6  # relative, of forces sought in the cones
MOST = 1e9  # times its friction that a contact may lack


@dataclass(frozen=True, slots=True)
class Friction:
    """Friction of a contact that sticks; the array is read-only."""

    force: Array  # (3,) N, world axes, on the second body of the pair
    share: float  # of its static friction, or of the resistance that is taken up most; at most 1


@dataclass(frozen=True)
class Held:
    """Forces that the contacts must provide at a place, in rows turned to the axes of friction."""

    touching: Touching
    place: HeldState
    axes: Array  # (rows, rows) of all contacts: from t1, t2 to the axes

    def of(self, contact: int, z: Array) -> Array:
        first = self.touching.first[contact]
        return z[first : first + self.touching.contacts[contact].rows]

    def plain(self) -> Array:
        """(rows,) of minimum norm, whatever the bounds are."""
        held, rows = np.zeros(len(self.axes)), len(self.place.contact_J)
        columns = (self.place.contact_J @ self.place.joint_motions).T
        held[self.touching.held[:rows]] = np.linalg.lstsq(columns, wanted(self.place), rcond=DEPENDENT)[0]
        return np.asarray(self.axes @ held)

    def shares(self, z: Array) -> list[tuple[float, str]]:
        """Share of its bounds that each contact's forces need, and the constraint concerned; rounding counts
        as zero."""
        clean = np.where(np.abs(z) > BALANCED * np.abs(z).max(initial=0.0), z, 0.0)
        return [share(contact, self.of(k, clean)) for k, contact in enumerate(self.touching.contacts)]

    def pulls(self, z: Array) -> bool:
        return bool(z[self.touching.first].min(initial=0.0) < -BALANCED * np.abs(z).max(initial=0.0))

    def within(self, factor: float) -> Array | None:
        """(rows,) in the cones widened by a factor; None where there are none."""
        J = self.axes @ np.vstack([facing.J for facing in self.place.facings]) @ self.place.joint_motions
        needed, contacts = wanted(self.place), self.touching.contacts
        problem = FrictionProblem(
            J @ J.T, -J @ needed, np.array(self.touching.first, dtype=np.intc),
            np.array([contact.rows for contact in contacts], dtype=np.intc),
            factor * np.array([cone(contact) for contact in contacts]),
        )  # fmt: skip
        answer = relaxation(problem, self.touching.library)
        z = np.asarray(answer.z, dtype=float)
        left = np.linalg.norm(J.T @ z - needed)
        solved = answer.outcome is Outcome.SOLVED and left <= WITHIN * np.linalg.norm(needed)
        return z if solved else None


def resting_forces(touching: Touching, place: HeldState) -> tuple[dict[str, float], dict[str, Friction]]:
    """N of each contact, and what friction holds at those that have it.

    Raises SimulationError if contacts would have to pull, or to hold more than their friction does.
    """
    contacts = touching.contacts
    if not any(contact.friction for contact in contacts):
        return {c.name: float(f) for c, f in zip(contacts, _pressing(touching, place), strict=True)}, {}
    turns = touching.turns(place.q)
    axes = [f.axes(c, turns) for f, c in zip(place.facings, contacts, strict=True)]
    held = Held(touching, place, block_diag(*axes))
    z = _holding(held)
    force, friction = {}, {}
    for k, (contact, (used, _)) in enumerate(zip(contacts, held.shares(z), strict=True)):
        own = axes[k].T @ held.of(k, z)
        force[contact.name] = float(own[0])
        if contact.friction:
            sign = -1.0 if contact.feature_pair.swapped else 1.0
            friction[contact.name] = Friction(
                sign * (own[1:3] @ place.facings[k].tangents), float(min(used, 1.0))
            )
    return force, friction


def wanted(place: HeldState) -> Array:
    """(j,) what the forces of the contacts must be along the motions that the joints leave."""
    return np.asarray(-place.joint_motions.T @ place.mass @ place.free)


def _pressing(touching: Touching, place: HeldState) -> Array:
    """>= 0 and of minimum norm."""
    needed, columns = wanted(place), (place.contact_J @ place.joint_motions).T
    force = least_pressing(columns, needed)
    if len(force) and np.linalg.norm(columns @ force - needed) > BALANCED * np.linalg.norm(needed):
        _refuse_pulling(touching, place)
    return force


def _holding(held: Held) -> Array:
    """(rows,) along the axes of friction."""
    z = held.plain()
    if held.place.redundant:
        return _among(held, z)
    if held.pulls(z):
        _refuse_pulling(held.touching, held.place)
    for k, contact in enumerate(held.touching.contacts):
        if contact.friction and not held.of(k, z)[0] > BALANCED * np.abs(z).max(initial=0.0):
            _refuse(held.touching, f"contact {contact.name!r} presses with no force, so nothing sticks at it",
                    "take its pair out, or start where it presses")  # fmt: skip
    if _most(held, z) > 1 + SAME:
        _refuse_slipping(held, z, _most(held, z))
    return z


def _among(held: Held, z: Array) -> Array:
    """Forces that are not unique: those of minimum norm, or some in the cones."""
    if not held.pulls(z) and _most(held, z) <= 1 + SAME:
        return z
    found = held.within(1.0)
    return _refuse_lacking(held) if found is None else found


def _refuse_lacking(held: Held) -> NoReturn:
    """Raise SimulationError with the factor by which the bounds are too narrow, found by bisection."""
    enough = 2.0
    while held.within(enough) is None:
        enough *= 2
        if enough > MOST:
            _refuse_pulling(held.touching, held.place)
    lacking = enough / 2
    while enough - lacking > WITHIN * enough:
        middle = (enough + lacking) / 2
        enough, lacking = (middle, lacking) if held.within(middle) is not None else (enough, middle)
    best = held.within(enough)
    assert best is not None
    _refuse_slipping(held, best, enough)


def _most(held: Held, z: Array) -> float:
    return max(used for used, _ in held.shares(z))


def _refuse_pulling(touching: Touching, place: HeldState) -> NoReturn:
    _refuse(touching, f"a contact would have to pull {place.called[0]}",
            "start near one in which they do", "contacts press")  # fmt: skip


def _refuse_slipping(held: Held, z: Array, factor: float) -> NoReturn:
    shares = held.shares(z)
    worst = int(np.argmax([used for used, _ in shares]))
    contact, (_, kind) = held.touching.contacts[worst], shares[worst]
    name = {"slip": "static friction", "spin": "spinning resistance", "roll": "rolling resistance"}[kind]
    what = f"contact {contact.name!r} would {kind} {held.place.called[1]}"
    found = f"{what}: it takes {factor:.6g} times its {name}"
    _refuse(held.touching, found, "raise it as much, or start where less is needed")


def _refuse(touching: Touching, found: str, remedy: str, allowed: str = "contacts that stick") -> NoReturn:
    raise SimulationError(f"{touching.model.scene.name}: linearise", found, allowed, remedy)


def least_pressing(A: Array, b: Array) -> Array:
    """f >= 0 of minimum norm with A f = b; where there is none, some f >= 0 that misses it least.

    Source: Lawson and Hanson, Solving Least Squares Problems, ch. 23: least distance programming.
    """
    if not A.shape[1]:
        return np.zeros(0)
    feasible = nnls(A, b)[0]
    plain = np.linalg.lstsq(A, b, rcond=None)[0]
    if np.linalg.norm(A @ feasible - b) > SAME * np.linalg.norm(b) or plain.min() >= 0:
        return np.asarray(feasible if plain.min() < 0 else plain)
    _, sizes, vectors = np.linalg.svd(A)
    free = vectors[int((sizes > SAME * sizes.max()).sum()) :].T
    target = np.zeros(free.shape[1] + 1)
    target[-1] = 1.0
    rows = np.vstack([free.T, -plain[None, :] / np.linalg.norm(plain)])
    left = rows @ nnls(rows, target)[0] - target
    return np.asarray(np.maximum(plain - free @ left[:-1] / left[-1] * np.linalg.norm(plain), 0.0))
