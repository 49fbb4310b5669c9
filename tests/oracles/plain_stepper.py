"""The C core's logic once more, slow and plain: dense matrices, every active set tried, SciPy's integrator.

Assembly, complementarity problems, modes, event search, impacts and the correction of the contact parameters
are its own; it shares the kernels with the program, and the speeds below which a bounce counts as none:

    M u' = F + J^T f,   0 <= f, 0 <= d'' = J u' + Gamma2,   complementary, over the closed contacts,
    M (u+ - u-) = J^T P,   0 <= P, 0 <= d'+ + e d'-,   complementary, where closed contacts approach.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from scipy.integrate import solve_ivp

from modelgen.codegen.library import Library
from modelgen.runtime.accuracy import Accuracy
from tests.oracles.plain_rows import PlainScene, Rows

TOUCHING = 1e-8  # of L: contacts closed at the start
ROUNDS = 5  # corrections that bring the start onto d = 0
RTOL, ATOL = 1e-13, 1e-14

Function = Callable[[float, np.ndarray], float]


@dataclass(frozen=True)
class Change:
    """A change of mode, named as an event of a Trajectory."""

    t: float
    kind: str
    contact: str


def complementary(A: np.ndarray, b: np.ndarray) -> np.ndarray:
    """z of 0 <= z, 0 <= A z + b, z.(A z + b) = 0: the first of all active sets that fits."""
    n, slack = len(b), 1e-11 * np.abs(b).max(initial=0.0)
    for count in range(n + 1):
        for chosen in combinations(range(n), count):
            held = list(chosen)
            z = np.zeros(n)
            z[held] = np.linalg.solve(A[np.ix_(held, held)], -b[held])
            if (z >= 0).all() and (A @ z + b >= -slack).all():
                return z
    raise AssertionError("no active set is complementary")


class PlainStepper:
    """One run from the instance's start.

    `feature_pairs` (contacts,) says which one each contact is on, `eta` (n_eta,) guesses the closest points.
    """

    def __init__(self, library: Library, feature_pairs: np.ndarray, eta: np.ndarray) -> None:
        self.scene = PlainScene(library, feature_pairs)
        instance = library.manifest.instance
        scales, accuracy = instance["scales"], Accuracy.tight()
        self.near = TOUCHING * scales["length"]
        self.rest = accuracy.rest_speed * scales["length"] / scales["time"]
        self.slack = accuracy.thresholds.rest_acceleration * scales["length"] / scales["time"] ** 2
        self.restitution = np.array([contact["restitution"] for contact in self.scene.contacts])
        self.t = 0.0
        start = [instance["initial_q"], instance["initial_u"], eta, [0.0]]
        self.x = np.concatenate([np.asarray(part, float) for part in start])
        self.closed: set[int] = set()
        self.active: list[int] = []
        self.changes: list[Change] = []
        self._begin()

    def run(self, until: float) -> np.ndarray:
        """To `until`; returns the state there."""
        while self.t < until:
            self._piece(until)
        return self.x

    # the smooth part

    def _weights(self, rows: Rows, held: list[int]) -> tuple[np.ndarray, np.ndarray]:
        """M^-1 J^T and J M^-1 J^T over the held contacts."""
        weighed = self.scene.inverse_mass @ rows.J[held].T
        return weighed, rows.J[held] @ weighed

    def _forces(self, rows: Rows) -> np.ndarray:
        """The forces that hold d'' = 0 at every active contact, N."""
        force, held = np.zeros(len(rows.d)), self.active
        own = rows.J @ rows.free + rows.bias
        force[held] = np.linalg.solve(self._weights(rows, held)[1], -own[held])
        return force

    def _rows(self, t: float, x: np.ndarray) -> Rows:
        return self.scene.rows(t, self.scene.corrected(t, x, 1))

    def _slope(self, t: float, x: np.ndarray) -> np.ndarray:
        rows = self._rows(t, x)
        force = self._forces(rows)
        accel = rows.free + self.scene.inverse_mass @ rows.J.T @ force
        return np.concatenate([rows.qdot, accel, rows.eta_dot, [rows.load_power - force @ rows.driven]])

    # modes

    def _begin(self) -> None:
        self.x = self.scene.corrected(self.t, self.x)
        rows = self.scene.rows(self.t, self.x)
        self.closed = set(np.flatnonzero((rows.d <= self.near) & (rows.rate <= self.rest)))
        for _ in range(ROUNDS):
            held, rows = sorted(self.closed), self.scene.rows(self.t, self.x)
            weighed, A = self._weights(rows, held)
            shift = weighed @ np.linalg.solve(A, -rows.d[held])
            self.x = self.scene.corrected(self.t, self.scene.moved(self.x, shift))
        self._impact()
        self._choose(set())

    def _emit(self, kind: str, contact: int, after: float = 0.0) -> None:
        self.changes.append(Change(self.t + after, kind, self.scene.contacts[contact]["name"]))

    def _impact(self) -> None:
        """Newton's law over the closed contacts; those that rebound open."""
        held, rows = sorted(self.closed), self.scene.rows(self.t, self.x)
        fast = rows.rate < -self.rest
        weighed, A = self._weights(rows, held)
        leaves = -self.restitution * rows.rate > self.rest
        aim = rows.rate * np.where(leaves, 1.0 + self.restitution, 1.0)
        impulse = complementary(A, aim[held])
        after = rows.rate + rows.J @ weighed @ impulse
        self.x[self.scene.u] += weighed @ impulse
        self.x[-1] += impulse @ ((rows.rate + after) / 2 - rows.driven)[held]
        for contact in held:
            if after[contact] > self.rest:
                self._emit("impact" if fast[contact] else "lift-off", contact)
                self.closed.discard(contact)
        self._hold()

    def _hold(self) -> None:
        """What is left of the rates of closed contacts, too slow to open them, is removed."""
        held, rows = sorted(self.closed), self.scene.rows(self.t, self.x)
        weighed, A = self._weights(rows, held)
        self.x[self.scene.u] += weighed @ np.linalg.solve(A, -rows.rate[held])

    def _choose(self, vanished: set[int]) -> None:
        """Which closed contacts carry force; the others lift off, those of `vanished` force if they may."""
        rows = self.scene.rows(self.t, self.x)
        own = rows.J @ rows.free + rows.bias
        for skipped in (vanished, set[int]()):
            held = sorted(self.closed - skipped)
            weighed, A = self._weights(rows, held)
            force = complementary(A, own[held])
            apart = own + rows.J @ weighed @ force
            if all(apart[contact] >= -self.slack for contact in skipped):
                break
        self.active = [contact for contact, amount in zip(held, force, strict=True) if amount > 0]
        for contact in sorted(self.closed - set(self.active)):
            assert contact in skipped or apart[contact] > self.slack, "a contact neither pushes nor leaves"
            self.closed.discard(contact)
            self._emit("lift-off", contact)

    def _touch(self, contact: int) -> None:
        """A gap closes: an impact, and a touch-down if the contact stays, when its last bounces would end."""
        rows = self.scene.rows(self.t, self.x)
        accel = rows.free + self.scene.inverse_mass @ rows.J.T @ self._forces(rows)
        pull, e = -(rows.J @ accel + rows.bias)[contact], self.restitution[contact]
        self.closed.add(contact)
        self._impact()
        if contact in self.closed:
            bounces = pull > self.slack and e < 1
            self._emit(
                "touch-down", contact, -2 * e * rows.rate[contact] / (pull * (1 - e)) if bounces else 0
            )

    # events

    def _gap(self, contact: int) -> Function:
        return lambda t, x: float(self._rows(t, x).d[contact])

    def _mean_rate(self, contact: int, began: float) -> Function:
        """Of a contact that has just opened: d / (t - began), which is not zero at the beginning."""

        def value(t: float, x: np.ndarray) -> float:
            rows = self._rows(t, x)
            return float(rows.rate[contact] if t == began else rows.d[contact] / (t - began))

        return value

    def _force(self, contact: int) -> Function:
        return lambda t, x: float(self._forces(self._rows(t, x))[contact])

    def _events(self) -> list[Function]:
        """One falling function a contact: the force of an active one, the gap of an open one."""
        d, functions = self.scene.rows(self.t, self.x).d, []
        for contact in range(len(d)):
            if contact in self.active:
                function = self._force(contact)
            elif abs(d[contact]) < self.near:
                function = self._mean_rate(contact, self.t)
            else:
                function = self._gap(contact)
            function.__dict__.update(terminal=True, direction=-1)
            functions.append(function)
        return functions

    def _polish(self, contact: int) -> None:
        """From the interpolant's event to d = 0: the time of a slow flight hangs on its last digit."""
        rows = self.scene.rows(self.t, self.x)
        late = rows.d[contact] / rows.rate[contact]
        self.x = self.scene.corrected(self.t - late, self.x - late * self._slope(self.t, self.x))
        self.t -= late

    def _piece(self, until: float) -> None:
        """Integrates one mode to its end or to `until`, and changes the mode there."""
        span, events = (self.t, until), self._events()
        run = solve_ivp(self._slope, span, self.x, method="DOP853", rtol=RTOL, atol=ATOL, events=events)
        assert run.success, run.message
        self.t = float(run.t[-1])
        self.x = self.scene.corrected(self.t, self.scene.normalised(run.y[:, -1]))
        fired = [contact for contact, times in enumerate(run.t_events) if len(times)]
        vanished = {contact for contact in fired if contact in self.closed}
        for contact in set(fired) - vanished:
            self._polish(contact)
            self._touch(contact)
        if fired:
            self._choose(vanished)
