"""The equations of a scene at one instant, assembled densely: kernels called one by one, matrices in full.

Of the program it uses the kernels (through `library.kernel`) and the manifest's instance.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from modelgen.codegen.library import Library

RESIDUAL = 1e-14  # Newton's goal for the contact parameters
NEWTON_MAX = 30
MOVING = ("point", "free")

Entry = dict[str, Any]


def followed(library: Library, feature_pairs: np.ndarray) -> list[Entry]:
    """The contacts that are on a feature pair (-1: none), with the entries of feature pair and pair."""
    instance = library.manifest.instance
    restitution = [pair["restitution"] for pair in instance["pairs"]]
    return [
        {**instance["feature_pairs"][feature_pair], **contact, "restitution": restitution[contact["pair"]]}
        for contact, feature_pair in zip(instance["contacts"], feature_pairs, strict=True)
        if feature_pair >= 0
    ]


@dataclass
class Rows:
    """One row a contact over the velocities u of the moving bodies, and what goes with it."""

    d: np.ndarray  # gap, m
    rate: np.ndarray  # d', m/s
    bias: np.ndarray  # d'' without the moving bodies' accelerations: Gamma2 and the driven bodies' share
    J: np.ndarray  # (contacts, n_u)
    driven: np.ndarray  # the driven bodies' share of d', m/s
    qdot: np.ndarray
    free: np.ndarray  # u' without contact forces
    eta_dot: np.ndarray
    load_power: float  # W
    normal: np.ndarray  # (contacts, 3), from the first to the second body of a contact's kind


@dataclass
class Bodies:
    """Pose (12), twist (6) and given acceleration (6; of driven bodies) of every body."""

    pose: list[np.ndarray]
    twist: list[np.ndarray]
    accel: list[np.ndarray]


class PlainScene:
    """The scene of a library as functions of time and state x = [q, u, eta, work].

    `feature pairs` (contacts,) says which feature pair each contact is on, all along.
    """

    def __init__(self, library: Library, feature_pairs: np.ndarray) -> None:
        self.library, self.instance = library, library.manifest.instance
        self.kinds = library.manifest.kinds
        self.bodies: list[Entry] = self.instance["bodies"]
        self.contacts = followed(library, feature_pairs)
        self.n_q, self.n_u = self.instance["n_q"], self.instance["n_u"]
        self.u = slice(self.n_q, self.n_q + self.n_u)
        self.gravity = np.array(self.instance["gravity"], float)
        self.inverse_mass = self._inverse_mass()

    def _call(self, name: str, *values: np.ndarray | list[float]) -> tuple[np.ndarray, ...]:
        """The kernel of that name, its arguments cut to the manifest's shapes."""
        kernel = self.library.kernel(f"mg_{name}")
        shaped = zip(values, kernel.inputs, strict=True)
        return kernel(*(np.array(value, float)[: shape[0]] for value, (_, shape) in shaped))

    def _inverse_mass(self) -> np.ndarray:
        inverse = np.zeros((self.n_u, self.n_u))
        for body in self.bodies:
            values, at = body["mass_inverse"], body["u"]
            if body["motion"] in MOVING:
                inverse[at : at + 3, at : at + 3] = values[0] * np.eye(3)
            if body["motion"] == "free":
                inverse[at + 3 : at + 6, at + 3 : at + 6] = np.reshape(values[1:], (3, 3)).T
        return inverse

    def kind(self, group: str, entry: Entry) -> Entry:
        """The kind of a body, contact or load."""
        found: Entry = self.kinds[group][entry["kind"]]
        return found

    def own(self, body: Entry, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The body's q and u."""
        kind, q, u = self.kind("body", body), body["q"], self.n_q + body["u"]
        return x[q : q + kind["n_q"]], x[u : u + kind["n_u"]]

    def states(self, t: float, x: np.ndarray) -> Bodies:
        """Where the bodies are and how they move."""
        n = len(self.bodies)
        found = Bodies(*([np.zeros(size) for _ in range(n)] for size in (12, 6, 6)))
        for index, body in enumerate(self.bodies):
            name, motion = self.kind("body", body)["name"], body["motion"]
            if motion == "fixed":
                found.pose[index][:] = body["parameters"]
            elif motion == "driven":
                path = self._call(f"{name}_path", [t], body["parameters"])
                found.pose[index], found.twist[index], found.accel[index] = path
            else:
                q, u = self.own(body, x)
                found.twist[index][: len(u)] = u
                found.pose[index][:3], found.pose[index][[3, 7, 11]] = q[:3], 1.0
                if motion == "free":
                    (found.pose[index],) = self._call(f"{name}_pose", q)
        return found

    def eta_of(self, contact: Entry) -> slice:
        """Where a contact's parameters stand in x."""
        start = self.n_q + self.n_u + contact["eta"]
        return slice(start, start + self.kind("contact", contact)["n_eta"])

    def corrected(self, t: float, x: np.ndarray, rounds: int = NEWTON_MAX) -> np.ndarray:
        """x with every contact's parameters after that many Newton steps at most."""
        x, pose = x.copy(), self.states(t, x).pose
        for contact in self.contacts:
            at, name = self.eta_of(contact), self.kind("contact", contact)["name"]
            for _ in range(rounds if at.stop > at.start else 0):
                sides = pose[contact["o"]], pose[contact["f"]]
                x[at], _, residual = self._call(f"{name}_place", *sides, x[at], contact["parameters"])[:3]
                if np.abs(residual).max() < RESIDUAL:
                    break
        return x

    def _loads(self, t: float, bodies: Bodies) -> tuple[np.ndarray, float]:
        """Wrench on each body, and the power that the loads put into the moving ones."""
        wrenches, power = np.zeros((len(self.bodies), 6)), 0.0
        for load in self.instance["loads"]:
            ends = load["bodies"]
            sides = [side[end] for end in (ends[0], ends[-1]) for side in (bodies.pose, bodies.twist)]
            pair = self._call(f"{self.kind('load', load)['name']}_wrench", [t], *sides, load["parameters"])
            for body, wrench in zip(ends, pair, strict=False):
                n = self.kind("body", self.bodies[body])["n_u"]
                wrenches[body, :n] += wrench[:n]
                power += wrench[:n] @ bodies.twist[body][:n]
        return wrenches, power

    def rows(self, t: float, x: np.ndarray) -> Rows:
        """All that the laws need at one instant."""
        bodies = self.states(t, x)
        wrenches, power = self._loads(t, bodies)
        qdot, free = np.zeros(self.n_q), np.zeros(self.n_u)
        for body, wrench in zip(self.bodies, wrenches, strict=True):
            if body["motion"] in MOVING:
                name, q, u = self.kind("body", body)["name"], body["q"], body["u"]
                rates = self._call(
                    f"{name}_motion", *self.own(body, x), wrench, self.gravity, body["parameters"]
                )
                qdot[q : q + len(rates[0])], free[u : u + len(rates[1])] = rates
        n = len(self.contacts)
        J, eta_dot = np.zeros((n, self.n_u)), np.zeros(self.instance["n_eta"])
        rows = Rows(*np.zeros((3, n)), J, np.zeros(n), qdot, free, eta_dot, power, np.zeros((n, 3)))
        for index, contact in enumerate(self.contacts):
            self._row(rows, index, contact, x, bodies)
        return rows

    def _row(self, rows: Rows, index: int, contact: Entry, x: np.ndarray, bodies: Bodies) -> None:
        o, f = contact["o"], contact["f"]
        sides = bodies.pose[o], bodies.twist[o], bodies.pose[f], bodies.twist[f]
        name = self.kind("contact", contact)["name"]
        d, J_o, J_f, gamma, eta_dot, rows.normal[index] = self._call(
            f"{name}_rates", *sides, x[self.eta_of(contact)], contact["parameters"]
        )
        rows.d[index], rows.bias[index] = d[0], gamma[0]
        rows.eta_dot[contact["eta"] : contact["eta"] + len(eta_dot)] = eta_dot
        for body, half in ((o, J_o), (f, J_f)):
            n, motion, at = len(half), self.bodies[body]["motion"], self.bodies[body]["u"]
            rows.rate[index] += half @ bodies.twist[body][:n]
            if motion in MOVING:
                rows.J[index, at : at + n] += half
            if motion == "driven":
                rows.bias[index] += half @ bodies.accel[body][:n]
                rows.driven[index] += half @ bodies.twist[body][:n]

    def energy(self, x: np.ndarray) -> float:
        """Kinetic and potential energy of the moving bodies, J."""
        total = 0.0
        for body in self.bodies:
            if body["motion"] in MOVING:
                name = self.kind("body", body)["name"]
                parts = self._call(f"{name}_energy", *self.own(body, x), self.gravity, body["parameters"])
                total += float(parts[0][0] + parts[1][0])
        return total

    def normalised(self, x: np.ndarray) -> np.ndarray:
        """x with quaternions of unit length."""
        x = x.copy()
        for body in self.bodies:
            if body["motion"] == "free":
                e = x[body["q"] + 3 : body["q"] + 7]
                e /= np.linalg.norm(e)
        return x

    def moved(self, x: np.ndarray, shift: np.ndarray) -> np.ndarray:
        """x displaced by `shift` in the coordinates of u."""
        x = x.copy()
        for body in self.bodies:
            q, u = body["q"], body["u"]
            if body["motion"] in MOVING:
                x[q : q + 3] += shift[u : u + 3]
            if body["motion"] == "free":
                e, turn = x[q + 3 : q + 7].copy(), shift[u + 3 : u + 6] / 2
                x[q + 3] -= e[1:] @ turn
                x[q + 4 : q + 7] += e[0] * turn + np.cross(e[1:], turn)
        return self.normalised(x)
