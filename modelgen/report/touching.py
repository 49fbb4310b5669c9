"""A scene with the contacts that touch at its start held closed, and its motion linearised at rest.

The right-hand side gives qdot = B u, eta_dot = E u and udot. A small motion xi along u moves the contact
points with it, so that at u = 0 it changes udot by D xi, D = udot_q B + udot_eta E; derivatives are exact.
The contacts stay closed under the motions with J xi = 0.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import casadi as ca
import numpy as np
from scipy.linalg import block_diag, qr

from modelgen.codegen.library import Library
from modelgen.derive import Derivation
from modelgen.dynamics.closed_form import right_hand_side
from modelgen.errors import SimulationError
from modelgen.model import ContactEntry, LinkEntry, Model, PairEntry
from modelgen.notation import ETA_SIZE
from modelgen.runtime.accuracy import Accuracy
from modelgen.runtime.session import Session
from modelgen.scene.types import Restitution

Array = np.ndarray[Any, np.dtype[np.float64]]

DEPENDENT = 1e-9  # part of a row of J that the others leave, against the largest row
NEWTON = 20  # corrections of the contact points


@dataclass(frozen=True)
class Place:
    """The motion linearised at one place; coordinates: of each body v in world, then w in body axes."""

    q: Array  # (n_q,)
    etas: tuple[Array, ...]  # of each contact
    gaps: Array  # (m,) m
    J: Array  # (m, n)
    B: Array  # (n_q, n) qdot by u
    C: Array  # (n, n) 1/s, udot by u
    D: Array  # (n, n) 1/s^2, udot by xi
    udot: Array  # (n,)
    free: Array  # (n,) udot without contact forces
    mass: Array  # (n, n)
    motions: Array  # (n, k) that keep the contacts closed; motions^T mass motions = 1

    @property
    def push(self) -> Array:
        """(k,) what accelerates the motions."""
        return np.asarray(self.motions.T @ self.mass @ self.udot)

    @property
    def stiffness(self) -> Array:
        """(k, k) 1/s^2."""
        return np.asarray(-self.motions.T @ self.mass @ self.D @ self.motions)

    @property
    def damping(self) -> Array:
        """(k, k) 1/s."""
        return np.asarray(-self.motions.T @ self.mass @ self.C @ self.motions)


@dataclass(frozen=True)
class Contact:
    """One that touches at the start, on one link for good."""

    name: str
    link: LinkEntry
    rates: ca.Function
    place: ca.Function
    eta: Array  # at the start

    def settled(self, sides: list[Array], eta: Array) -> tuple[Array, float]:
        """eta on the extremum, and the gap there, m."""
        for _ in range(NEWTON):
            following, gap, *_ = _call(self.place, *sides, eta, np.array(self.link.parameters))
            done = np.array_equal(following, eta)
            eta = following
            if done:
                break
        return eta, float(gap[0])

    def row(self, sides: list[Array], eta: Array, model: Model) -> Array:
        """Its row of J."""
        still, row = np.zeros(6), np.zeros(model.n_u)
        found = _call(self.rates, sides[0], still, sides[1], still, eta, np.array(self.link.parameters))
        for body, part in zip((self.link.o, self.link.f), found[1:3], strict=True):
            row[model.bodies[body].u :][: len(part)] = part
        return row


class Touching:
    """A scene at rest whose contacts are those that touch at the start."""

    def __init__(self, derivation: Derivation, library: Library) -> None:
        self.model = model = derivation.model
        self.functions = {formula.name: formula.function for formula in derivation.formulas}
        _refuse(model)
        self.library = library
        self.contacts = self._at_start()
        self.mass_inverse = _mass_inverse(model)
        self.mass: Array = np.asarray(np.linalg.inv(self.mass_inverse), dtype=float)
        q = np.array(model.initial_q)
        J = self._rows(q, tuple(contact.eta for contact in self.contacts))
        self.held = _independent(J)
        self.motion = self._motion(self.held)
        self.unheld = self._motion([])

    def at(self, q: Array, etas: tuple[Array, ...]) -> Place:
        """The place q with the contact points brought onto their extrema from `etas`."""
        found = [
            contact.settled(self._sides(contact.link, q), eta)
            for contact, eta in zip(self.contacts, etas, strict=True)
        ]
        etas, gaps = tuple(eta for eta, _ in found), np.array([gap for _, gap in found])
        J, still = self._rows(q, etas), np.zeros(self.model.n_u)
        B, C, D, udot = self.motion(q, still, np.concatenate([*(etas[k] for k in self.held), np.zeros(0)]))
        free = self.unheld(q, still, [])[3]
        return Place(
            q, etas, gaps, J, np.array(B), np.array(C), np.array(D), np.array(udot).ravel(),
            np.array(free).ravel(), self.mass, _motions(J, self.mass_inverse),
        )  # fmt: skip

    def stands(self, q: Array) -> bool:
        """Whether as many contacts as at the start touch at q, and nothing interpenetrates."""
        try:
            session = self._at_rest(q)
        except SimulationError:
            return False
        return int(session.closed[: session.n_contact].sum()) == len(self.contacts)

    def _at_rest(self, q: Array) -> Session:
        session = Session(self.library, replace(Accuracy.tight(), planar=False))
        session.x[: len(q)] = q
        session.x[len(q) : len(q) + self.model.n_u] = 0.0
        session.begin()
        return session

    def _at_start(self) -> tuple[Contact, ...]:
        model, session = self.model, self._at_rest(np.array(self.model.initial_q))
        found = []
        for k, entry in enumerate(model.contacts):
            if not session.closed[k]:
                continue
            link = model.links[int(session.link[k])]
            size = sum(ETA_SIZE[carrier] for carrier in session.layout(k))
            eta = np.array(session.eta[entry.eta : entry.eta + size], dtype=float)
            found.append(
                Contact(entry.name, link, self._kernel(link, "rates"), self._kernel(link, "place"), eta)
            )
        return tuple(found)

    def _kernel(self, link: LinkEntry, role: str) -> ca.Function:
        return self.functions[f"mg_{self.model.contact_kinds[link.kind].name}_{role}"]

    def _rows(self, q: Array, etas: tuple[Array, ...]) -> Array:
        rows = [
            contact.row(self._sides(contact.link, q), eta, self.model)
            for contact, eta in zip(self.contacts, etas, strict=True)
        ]
        return np.array(rows).reshape(len(rows), self.model.n_u)

    def _sides(self, link: LinkEntry, q: Array) -> list[Array]:
        return [self._pose(link.o, q), self._pose(link.f, q)]

    def _pose(self, index: int, q: Array) -> Array:
        body = self.model.bodies[index]
        kind = self.model.body_kinds[body.kind]
        if kind.motion == "fixed":
            return np.array(body.parameters)
        if kind.motion == "point":
            return np.concatenate([q[body.q : body.q + 3], np.eye(3).ravel()])
        return _call(self.functions[f"mg_{kind.name}_pose"], q[body.q : body.q + 7])[0]

    def _motion(self, held: list[int]) -> ca.Function:
        """(q, u, eta of the held contacts) -> B, C, D, udot."""
        model = _holding([self.contacts[k] for k in held], self.model)
        rhs = right_hand_side(model, self.functions)
        q, u, eta = (ca.SX.sym(name, rhs.numel_in(name)) for name in ("q", "u", "eta"))
        blocks = (model.bodies, model.links, model.loads)
        parameters = [value for block in blocks for entry in block for value in entry.parameters]
        qdot, udot, eta_dot, _ = rhs(0.0, q, u, eta, ca.DM(model.scene.gravity), ca.DM(parameters))
        B, E, C = ca.jacobian(qdot, u), ca.jacobian(eta_dot, u), ca.jacobian(udot, u)
        D = ca.jacobian(udot, q) @ B + ca.jacobian(udot, eta) @ E
        return ca.Function("motion", [q, u, eta], [B, C, D, udot])


def _holding(held: list[Contact], model: Model) -> Model:
    """The model in which each of these contacts is a pair of its own, and there are no others."""
    links = tuple(replace(each.link, pair=k, conditions=()) for k, each in enumerate(held))
    pairs = tuple(
        PairEntry(each.name, (k, k + 1), (k, k + 1), "never", Restitution()) for k, each in enumerate(held)
    )
    offsets = np.cumsum([0, *(len(each.eta) for each in held)])
    contacts = tuple(
        ContactEntry(each.name, k, int(offsets[k]), len(each.eta), k) for k, each in enumerate(held)
    )
    return replace(model, links=links, pairs=pairs, contacts=contacts, n_eta=int(offsets[-1]))


def _refuse(model: Model) -> None:
    """Raises SimulationError where a body is driven, or a contact has friction, which has no derivative."""
    where = f"{model.scene.name}: linearise"
    for body in model.bodies:
        if model.body_kinds[body.kind].motion == "driven":
            found, allowed = f"body {body.name!r} is driven", "fixed and dynamic bodies have an equilibrium"
            raise SimulationError(where, found, allowed, "make it fixed")
    for link in model.links:
        if model.contact_kinds[link.kind].rows > 1:
            found = f"contact {model.pairs[link.pair].name!r} has friction"
            allowed = "contacts without friction, whose motions near rest are smooth"
            raise SimulationError(where, found, allowed, "leave its friction out")


def _call(function: ca.Function, *arguments: Array) -> list[Array]:
    """The outputs (n,) of a kernel, its arguments cut to the length that it takes."""
    given = [ca.DM(value[: function.numel_in(k)]) for k, value in enumerate(arguments)]
    return [np.array(value).ravel() for value in function.call(given)]


def _mass_inverse(model: Model) -> Array:
    """(n, n)."""
    blocks = []
    for body in model.bodies:
        motion = model.body_kinds[body.kind].motion
        if motion in ("point", "free"):
            blocks.append(body.mass_inverse[0] * np.eye(3))
        if motion == "free":
            blocks.append(np.reshape(body.mass_inverse[1:], (3, 3)))
    return np.asarray(block_diag(*blocks)) if blocks else np.zeros((0, 0))


def _independent(J: Array) -> list[int]:
    """The rows that span all, in order."""
    if not J.size:
        return []
    _, triangle, order = qr(J.T, mode="economic", pivoting=True)
    sizes = np.abs(np.diag(triangle))
    return sorted(order[: len(sizes)][sizes > DEPENDENT * sizes.max()].tolist())


def _motions(J: Array, mass_inverse: Array) -> Array:
    """(n, k) with J motions = 0 and motions^T M motions = 1."""
    root = np.linalg.cholesky(mass_inverse)
    _, sizes, vectors = np.linalg.svd(np.vstack([J @ root, np.zeros((1, len(root)))]))
    rank = int((sizes > DEPENDENT * sizes.max(initial=0.0)).sum())
    return np.asarray(root @ vectors[rank:].T)
