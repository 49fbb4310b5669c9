"""A scene with its joints and the contacts that touch at its start held, and its motion linearised at rest.

M u_dot = f + J^T force with J u = 0, where J has the row along N of each contact that touches, the rows that
friction and resistances hold there, and those of the joints, qdot = B u and eta_dot = E u. A small motion xi
with J xi = 0 moves the contact points with it. Along the motions Z, J Z = 0, where the change of the forces
does no work, only f and J change:

    Z^T M y_dot = Z^T d(f + J^T force) with the force of the equilibrium, d = (d/dq B + d/deta E) xi + d/du u.

The derivatives are exact. Rows that roll without slip are no derivatives of positions: their part of the
stiffness Z^T d(J^T force) Z need not be symmetric.

Source: Ju. I. Neimark, N. A. Fufaev, Dynamics of Nonholonomic Systems (1972).
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace
from functools import cached_property
from typing import ClassVar

import casadi as ca
import numpy as np
from scipy.linalg import block_diag

from modelgen.codegen.library import Library
from modelgen.composition.all_sticking_dynamics import pushed
from modelgen.composition.contact_mode import held_mode
from modelgen.composition.scene_symbols import parameter_values
from modelgen.derivation import Derivation
from modelgen.errors import SimulationError
from modelgen.linearisation.touching_contact import Array, Contact, Facing, call, moving
from modelgen.model import ContactEntry, FeaturePairEntry, Model, PairEntry
from modelgen.notation import ETA_SIZE
from modelgen.runtime.accuracy import Accuracy
from modelgen.runtime.core_session import Session
from modelgen.runtime.start import begin
from modelgen.scene.scene_types import Restitution

KINDS = ("slip", "spin", "roll")
DEPENDENT = 1e-9  # part of a row of J that the others leave, against the largest row


class NoPlaceError(ArithmeticError):
    """A contact has no point there, or a load no value."""


@dataclass(frozen=True, kw_only=True)
class HeldState:
    """What is held at a state; coordinates: of each body v in world, then w in body axes."""

    called: ClassVar[tuple[str, str]]  # for messages: what it is, and in short
    q: Array  # (n_q,)
    etas: tuple[Array, ...]  # of each contact
    facings: tuple[Facing, ...]  # of each contact
    J: Array  # (m, n) the rows that are held, those of the joints last
    joint_rows: int  # number of the latter
    value: Array  # (m,) m or rad, of rows along normals and of joints; 0 of others
    B: Array  # (n_q, n) qdot by u
    free: Array  # (n,) udot without forces of contacts and joints, less udot in the state sought
    mass: Array  # (n, n)
    root: Array  # (n, n), root root^T = mass^-1
    motions: Array  # (n, k) that keep what is held; motions^T mass motions = 1

    @property
    def contact_J(self) -> Array:
        """(m - joint_rows, n) the rows of J that contacts hold."""
        return self.J[: len(self.J) - self.joint_rows]

    @cached_property
    def joint_motions(self) -> Array:
        """(n, j) all motions that the joints leave; joint_motions^T mass joint_motions = 1."""
        return motions_along(self.J[len(self.J) - self.joint_rows :], self.root)

    @property
    def redundant(self) -> int:
        """Rows of contacts beyond their rank among the motions that the joints leave."""
        return int(self.motions.shape[1]) + len(self.contact_J) - int(self.joint_motions.shape[1])


@dataclass(frozen=True, kw_only=True)
class Place(HeldState):
    """The motion linearised at one place, at rest there."""

    called = ("at the equilibrium near the start", "at rest")
    C: Array  # (n, n) 1/s, udot by u, under the forces that hold
    D: Array  # (n, n) 1/s^2, udot by xi, under them

    @property
    def push(self) -> Array:
        """(k,) what accelerates the motions."""
        return np.asarray(self.motions.T @ self.mass @ self.free)

    @property
    def stiffness(self) -> Array:
        """(k, k) 1/s^2."""
        return np.asarray(-self.motions.T @ self.mass @ self.D @ self.motions)

    @property
    def damping(self) -> Array:
        """(k, k) 1/s."""
        return np.asarray(-self.motions.T @ self.mass @ self.C @ self.motions)


class Touching:
    """A scene at rest whose contacts are those that touch at the start, with its joints."""

    def __init__(self, derivation: Derivation, library: Library, still: Collection[str] = KINDS) -> None:
        """`still`: the kinds of friction constraints that must not move at the start."""
        self.model = model = derivation.model
        self.functions = {formula.name: formula.function for formula in derivation.formulas}
        _refuse(model)
        self.library = library
        self.contacts = self._at_start()
        inverse = _mass_inverse(model)
        self.root: Array = np.asarray(np.linalg.cholesky(inverse), dtype=float)  # of the bodies alone
        self.mass: Array = np.asarray(np.linalg.inv(inverse), dtype=float)
        self.held: list[int] = []  # rows among those of all contacts
        for contact, first in zip(self.contacts, self.first, strict=True):
            self.held += [first + row for row in contact.held]
        self.contact_rows = sum(contact.rows for contact in self.contacts)
        self.joint_rows = sum(joint.rows for joint in model.joints)
        self.held += range(self.contact_rows, self.contact_rows + self.joint_rows)
        facings = self.facings(np.array(model.initial_q), tuple(contact.eta for contact in self.contacts))
        _refuse_moving(model, self.contacts, facings, still)

    @cached_property
    def first(self) -> list[int]:
        """The first row of each contact among those of all."""
        return list(np.cumsum([0, *(contact.rows for contact in self.contacts)])[:-1])

    def at(self, q: Array, etas: tuple[Array, ...]) -> Place:
        """The place q with the contact points brought onto their extrema from `etas`.

        Raises NoPlaceError where they have none.
        """
        etas, gaps = self.settled(q, etas)
        facings, still = self.facings(q, etas), np.zeros(self.model.n_u)
        force = np.zeros(self.contact_rows + self.joint_rows)
        eta = np.concatenate([*etas, np.zeros(0)])
        *_, udot, values, of_joints = self._motion(q, still, eta, force)
        free = np.array(udot).ravel()
        rows = np.vstack([*(facing.J for facing in facings), np.array(of_joints)])
        J = rows[self.held]
        if not (np.isfinite(rows).all() and np.isfinite(free).all()):
            raise NoPlaceError
        mass, root = self.mass_at(q)
        wanted = -root.T @ mass @ free
        force[self.held] = np.linalg.lstsq((J @ root).T, wanted, rcond=DEPENDENT)[0]
        B, C, D = (np.array(each) for each in self._motion(q, still, eta, force)[:3])
        return Place(
            q=q, etas=etas, facings=facings, J=J, joint_rows=self.joint_rows,
            value=self.values(gaps, np.array(values)), B=B, C=C, D=D, free=free, mass=mass,
            root=root, motions=motions_along(J, root),
        )  # fmt: skip

    def mass_at(self, q: Array) -> tuple[Array, Array]:
        """(n, n) the mass matrix at a place, to which the armature of joints adds, and root, root root^T =
        mass^-1."""
        if not any(joint.armature for joint in self.model.joints):
            return self.mass, self.root
        mass = np.array(self._mass(q))
        return mass, np.asarray(np.linalg.cholesky(np.linalg.inv(mass)), dtype=float)

    @cached_property
    def _mass(self) -> ca.Function:
        """q -> the mass matrix."""
        rhs, q = self.pushed, ca.SX.sym("q", self.model.n_q)
        given = {name: ca.SX(ca.DM(value)) for name, value in self.settings.items() if name in rhs.name_in()}
        others = {name: ca.SX(rhs.numel_in(name), 1) for name in rhs.name_in() if name != "q"}
        return ca.Function("mass", [q], [rhs.call(others | given | {"q": q})["mass"]])

    def values(self, gaps: list[float], of_joints: Array) -> Array:
        """(m,) of the rows that are held: gaps along normals, m, what joints hold at zero; 0 of others."""
        found = np.zeros(self.contact_rows + self.joint_rows)
        found[self.first] = gaps
        found[self.contact_rows :] = of_joints.ravel()
        return found[self.held]

    def settled(self, q: Array, etas: tuple[Array, ...]) -> tuple[tuple[Array, ...], list[float]]:
        """The contact points at q, found from `etas`, and the gaps there, m."""
        found = [
            contact.settled(self._sides(contact.feature_pair, q), eta)
            for contact, eta in zip(self.contacts, etas, strict=True)
        ]
        return tuple(eta for eta, _ in found), [gap for _, gap in found]

    def stands(self, q: Array, u: Array | None = None) -> bool:
        """Whether as many contacts as at the start touch at q, and nothing interpenetrates."""
        try:
            session = self._begun(q, u)
        except SimulationError:
            return False
        return int(session.closed[: session.n_contact].sum()) == len(self.contacts)  # no limit is reached

    def _begun(self, q: Array, u: Array | None = None) -> Session:
        """At q with velocities u, or at rest."""
        session = Session(self.library, replace(Accuracy.tight(), planar_contacts=False))
        session.x[: len(q)] = q
        session.x[len(q) : len(q) + self.model.n_u] = 0.0 if u is None else u
        begin(session)
        return session

    def _at_start(self) -> tuple[Contact, ...]:
        model, session = self.model, self._begun(np.array(self.model.initial_q))
        for k, limit in enumerate(model.limits, start=len(model.contacts)):
            if session.closed[k]:
                name, where = model.joints[limit.joint].name, f"{model.scene.name}: linearise"
                raise SimulationError(
                    where,
                    f"joint {name!r} is at its limit",
                    "joints within their limits",
                    "start it elsewhere",
                )
        contacts = []
        for k, entry in enumerate(model.contacts):
            if not session.closed[k]:
                continue
            feature_pair = model.feature_pairs[int(session.feature_pair[k])]
            size = sum(ETA_SIZE[parametrisation] for parametrisation in session.layout(k))
            eta = np.array(session.eta[entry.eta : entry.eta + size], dtype=float)
            constraints = model.pairs[entry.pair].friction
            rates, place = (self._kernel(feature_pair, role) for role in ("rates", "place"))
            contacts.append(Contact(entry.name, feature_pair, constraints, rates, place, eta))
        return tuple(contacts)

    def _kernel(self, feature_pair: FeaturePairEntry, role: str) -> ca.Function:
        return self.functions[f"mg_{self.model.contact_kinds[feature_pair.kind].name}_{role}"]

    def facings(self, q: Array, etas: tuple[Array, ...]) -> tuple[Facing, ...]:
        return tuple(
            contact.facing(self._sides(contact.feature_pair, q), eta, self.model)
            for contact, eta in zip(self.contacts, etas, strict=True)
        )

    def turns(self, q: Array) -> list[Array]:
        """The rotation (3, 3) of each body."""
        poses = [self._pose(index, q) for index in range(len(self.model.bodies))]
        return [np.reshape(pose[3:12], (3, 3)).T for pose in poses]

    def turns_of_dynamic(self, q: Array) -> list[Array]:
        """The rotation (3, 3) of each dynamic body."""
        sizes = [size_of(self.model, body.kind) for body in self.model.bodies]
        return [turn for turn, size in zip(self.turns(q), sizes, strict=True) if size]

    def turning(self, q: Array) -> Array:
        """(n, n) orthogonal, to u from u with v in body axes."""
        found = np.eye(self.model.n_u)
        for body, turn in zip(self.model.bodies, self.turns(q), strict=True):
            if self.model.body_kinds[body.kind].motion == "free":
                found[body.u : body.u + 3, body.u : body.u + 3] = turn
        return found

    def _sides(self, feature_pair: FeaturePairEntry, q: Array) -> list[Array]:
        return [self._pose(feature_pair.o, q), self._pose(feature_pair.f, q)]

    def _pose(self, index: int, q: Array) -> Array:
        body = self.model.bodies[index]
        kind = self.model.body_kinds[body.kind]
        if kind.motion == "fixed":
            return np.array(body.parameters)
        if kind.motion == "point":
            return np.concatenate([q[body.q : body.q + 3], np.eye(3).ravel()])
        return call(self.functions[f"mg_{kind.name}_pose"], q[body.q : body.q + 7])[0]

    @cached_property
    def pushed(self) -> ca.Function:
        """The accelerations under given forces of what is held."""
        model = _holding(self.contacts, self.model)
        return pushed(model, self.functions, held_mode(model))

    @property
    def settings(self) -> dict[str, list[float]]:
        """Arguments of `pushed` that do not change: gravity, parameters, inputs at their default values."""
        model = _holding(self.contacts, self.model)
        inputs = [part for each in model.scene.inputs for part in (each.default, 0.0, 0.0)]
        return {"gravity": [*model.scene.gravity], "parameters": parameter_values(model), "inputs": inputs}

    @cached_property
    def _motion(self) -> ca.Function:
        """(q, u, eta of the contacts, forces along all their rows and those of the joints) -> B, C, D, udot,
        values and J of the rows of the joints."""
        rhs = self.pushed
        given = {name: ca.SX(ca.DM(value)) for name, value in self.settings.items() if name in rhs.name_in()}
        given["t"] = ca.SX(0.0)
        q, u, eta, force = (ca.SX.sym(name, rhs.numel_in(name)) for name in ("q", "u", "eta", "force"))
        results = rhs.call(given | {"q": q, "u": u, "eta": eta, "force": force})
        qdot, udot, eta_dot = (results[name] for name in ("qdot", "udot", "eta_dot"))
        B, E, C = ca.jacobian(qdot, u), ca.jacobian(eta_dot, u), ca.jacobian(udot, u)
        D = ca.jacobian(udot, q) @ B + ca.jacobian(udot, eta) @ E
        joints = [results["joint_value"], results["joint_J"]]
        return ca.Function("motion", [q, u, eta, force], [B, C, D, udot, *joints])


def _holding(held: tuple[Contact, ...], model: Model) -> Model:
    """The model in which each of these contacts is a pair of its own, without others and without limits."""
    feature_pairs = tuple(replace(each.feature_pair, pair=k, conditions=()) for k, each in enumerate(held))
    pairs = tuple(
        PairEntry(each.name, each.feature_pair.bodies, (k, k + 1), (k, k + 1), "never", Restitution())
        for k, each in enumerate(held)
    )
    offsets = np.cumsum([0, *(len(each.eta) for each in held)])
    contacts = tuple(
        ContactEntry(each.name, k, int(offsets[k]), len(each.eta), k) for k, each in enumerate(held)
    )
    return replace(
        model, feature_pairs=feature_pairs, pairs=pairs, contacts=contacts, limits=(), n_eta=int(offsets[-1])
    )


def _refuse(model: Model) -> None:
    """Raises SimulationError where a body is driven, or the motion of a joint is prescribed."""
    where = f"{model.scene.name}: linearise"
    for body in model.bodies:
        if model.body_kinds[body.kind].motion == "driven":
            found, allowed = f"body {body.name!r} is driven", "fixed and dynamic bodies have an equilibrium"
            raise SimulationError(where, found, allowed, "make it fixed")
    for joint in model.joints:
        if model.joint_kinds[joint.kind].motion is not None:
            found, allowed = f"the motion of joint {joint.name!r} is prescribed", "joints that move freely"
            raise SimulationError(where, found, allowed, "leave its motion out, or use a weld")


def _refuse_moving(
    model: Model, contacts: tuple[Contact, ...], facings: tuple[Facing, ...], still: Collection[str]
) -> None:
    """Raises SimulationError where what friction or a resistance should hold moves at the start."""
    u, scales, least = np.array(model.initial_u), model.scales, Accuracy.balanced().slip_speed
    for contact, facing in zip(contacts, facings, strict=True):
        for constraint, speed in moving(contact, facing.J @ u):
            unit = "m/s" if constraint.kind == "slip" else "rad/s"
            if (
                constraint.kind in still
                and speed > least * (scales.length if constraint.kind == "slip" else 1.0) / scales.time
            ):
                raise SimulationError(
                    f"{model.scene.name}: linearise",
                    f"contact {contact.name!r} {constraint.kind}s at the start, at {speed:.3g} {unit}",
                    "contacts with friction that stick",
                    "start it at rest, or leave its friction out",
                )


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


def size_of(model: Model, kind: int) -> int:
    """Coordinates of a body in u."""
    return {"point": 3, "free": 6}.get(model.body_kinds[kind].motion, 0)


def moved(q: Array, step: Array, model: Model) -> Array:
    """q after a step (n_q,), with unit quaternions."""
    q = q + step
    for body in model.bodies:
        if model.body_kinds[body.kind].motion == "free":
            turn = slice(body.q + 3, body.q + 7)
            q[turn] /= np.linalg.norm(q[turn])
    return np.asarray(q)


def motions_along(J: Array, root: Array) -> Array:
    """(n, k) with J motions = 0 and motions^T M motions = 1."""
    _, sizes, vectors = np.linalg.svd(np.vstack([J @ root, np.zeros((1, len(root)))]))
    rank = int((sizes > DEPENDENT * sizes.max(initial=0.0)).sum())
    return np.asarray(root @ vectors[rank:].T)
