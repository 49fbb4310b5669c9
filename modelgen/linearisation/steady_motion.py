"""The steady motion near the start of a scene, and the equations of the small motions about it.

A steady motion goes along a symmetry: each body shifts and turns at constant rates that the scene does not
notice, as those of a wheel that rolls straight ahead, or of a top that spins about its axis while that axis
goes round. With the field f of the motion and that of the symmetries, c_k xi_k, it is a zero of f - c_k xi_k,
and a small change y of the state, carried along by the symmetry, follows

    y_dot = D(f - c_k xi_k) y

with constant coefficients. Changes along symmetries alter nothing but the time and place of the same motion
(ignorable coordinates); what is left of all changes that keep joints and contacts is the reduced system.

Source: J. E. Marsden, Lectures on Mechanics (1992), ch. 4: relative equilibria.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import block_diag

from modelgen.errors import SimulationError
from modelgen.linearisation.moving_linearisation import Moving, MovingState
from modelgen.linearisation.rest_linearisation import DEPENDENT, NoPlaceError, Touching, moved, size_of
from modelgen.linearisation.symmetries import Generators
from modelgen.linearisation.touching_contact import Array

STEPS = 50  # of Newton's method towards the steady motion
FARTHEST = 0.2  # of one step, rad or characteristic lengths, and rates of them
STEADY = 1e-11  # part of the accelerations that no symmetry accounts for, dimensionless
SPREAD, SEED = 0.1, 20070808  # of states at which symmetries are told: how far from the start
NEARER = 4  # times that a state which cannot be brought onto the constraints is halved
SYMMETRIC = 1e-9  # relative, what is rounding in the conditions of a symmetry


@dataclass(frozen=True)
class SteadyMotion:
    """A steady motion; changes of a state are (xi time, du) in the units of `scale`."""

    state: MovingState
    rates: Array  # (generators,) m/s and rad/s
    changes: Array  # (2 n, r) that keep what is held, without those along symmetries; orthonormal
    symmetries: int  # independent symmetries at the state
    system: Array  # (r, r) 1/s, of the changes
    scale: Array  # (2 n, 2 n) (xi, du) of such a change


class SteadySearch:
    """The symmetries of a scene near its start, and the search for a steady motion along them."""

    def __init__(self, touching: Touching, like: SteadySearch | None = None) -> None:
        """`like`: of the same scene with other values of parameters."""
        self.touching, self.model = touching, touching.model
        self.moving: Moving = Moving(touching, like.moving if like else None)
        self.generators = Generators(
            tuple((body.u, size) for body in self.model.bodies if (size := size_of(self.model, body.kind)))
        )
        time = self.model.scales.time
        self.scale = block_diag(touching.root * time, touching.root)
        self.unscale = np.linalg.inv(self.scale)

    def steady(self) -> SteadyMotion:
        """The steady motion near the start. Raises SimulationError if there is none."""
        try:
            found = self._sought()
        except NoPlaceError:
            found = None
        if found is not None and self.touching.stands(found.state.q, found.state.u):
            return found
        raise SimulationError(
            f"{self.model.scene.name}: linearise",
            "no steady motion near the start",
            "a motion along shifts and turns that the scene does not notice, with all contacts closed",
            "start near such a motion",
        )

    def _sought(self) -> SteadyMotion | None:
        state = self.start
        for _ in range(STEPS):
            found, missed = self._about(state)
            if np.abs(missed).max(initial=0.0) < STEADY:
                return found
            step = found.changes @ np.linalg.lstsq(-found.system, missed / self._time, rcond=DEPENDENT)[0]
            step = self.scale @ (step * self._unit)
            n = len(state.u)
            size = max(np.abs(step[:n]).max(initial=0.0), np.abs(step[n:]).max(initial=0.0) * self._time)
            step *= min(1.0, FARTHEST / size if size else 1.0)
            q = moved(state.q, state.B @ step[:n], self.model)
            state = self.moving.onto(q, state.u + step[n:], state.etas)
        return None

    @cached_property
    def start(self) -> MovingState:
        etas = tuple(contact.eta for contact in self.touching.contacts)
        return self.moving.onto(np.array(self.model.initial_q), np.array(self.model.initial_u), etas)

    @property
    def _time(self) -> float:
        return float(self.model.scales.time)

    @property
    def _unit(self) -> float:
        """Of changes."""
        scales = self.model.scales
        return float(np.sqrt(scales.mass) * scales.length / scales.time)

    def _about(self, state: MovingState) -> tuple[SteadyMotion, Array]:
        """The reduced system at a state as if it were steady, and what is missing, dimensionless."""
        n, generators, turns = len(state.u), self.generators, self.touching.turns_of_dynamic(state.q)
        shifts = generators.shifts(self._centres(state.q), turns)
        every = self.unscale @ np.vstack([shifts, generators.carried(state.u)])
        along, least = every @ self.algebra, DEPENDENT * np.abs(every).max(initial=0.0)
        field = self.unscale @ np.concatenate([state.u, state.udot])
        rates = self._rates(along, field, least)
        c, left = self.algebra @ rates, field - along @ rates
        D = np.block(
            [
                [-generators.turning(c, turns), np.eye(n)],
                [state.udot_by_place, state.udot_by_velocity - generators.rotating(c)],
            ]
        )
        kept = np.block(
            [
                [state.J[state.places], np.zeros((int(state.places.sum()), n))],
                [state.rate_by_place, state.J],
            ]
        )
        kept = kept @ self.scale
        tangent = _null_space(kept, DEPENDENT * np.abs(kept).max(initial=0.0))
        orbit = _range(tangent.T @ along, least)
        changes = tangent @ _null_space(orbit.T, DEPENDENT)
        system = changes.T @ self.unscale @ D @ self.scale @ changes
        missed = changes.T @ left * self._time / self._unit
        return SteadyMotion(state, c, changes, orbit.shape[1], system, self.scale), missed

    def _rates(self, along: Array, field: Array, least: float) -> Array:
        """(k,) of the symmetries, that come nearest to the field. Where symmetries do the same, as those of a
        top that stands upright do, with the least turning of the axes that are carried along. Singular values
        up to `least` count as zero."""
        same = _null_space(along, least)
        others = _null_space(same.T, DEPENDENT)
        found = others @ np.linalg.lstsq(along @ others, field, rcond=None)[0]
        turning = self.algebra[self.generators.left_turns]
        return np.asarray(found - same @ np.linalg.lstsq(turning @ same, turning @ found, rcond=DEPENDENT)[0])

    @cached_property
    def algebra(self) -> Array:
        """(generators, k) combinations that are symmetries; orthonormal.

        They meet the conditions of as many states about the start as it takes until another state, drawn at
        random, excludes none of them.
        """
        random = np.random.default_rng(SEED)
        found = np.eye(self.generators.count)
        lengths, before = self._lengths(), found.shape[1] + 1
        while 0 < found.shape[1] < before:
            before = found.shape[1]
            for conditions in self._conditions(self._sample(random)):
                size = np.abs(conditions * lengths).max(initial=0.0)
                found = found @ _null_space(conditions * lengths @ found, SYMMETRIC * size)
        return _range(lengths[:, None] * found, 0.0)

    def _lengths(self) -> Array:
        """(generators,) the unit of each: the characteristic length, or rad."""
        sizes = [9 if size == 6 else 6 for _, size in self.generators.bodies]
        return np.concatenate([[self.model.scales.length] * 3 + [1.0] * (size - 3) for size in sizes] + [[]])

    def _conditions(self, state: MovingState) -> tuple[Array, Array, Array]:
        """(rows, generators) each that vanish for symmetries: of places, rates, accelerations."""
        generators, root = self.generators, self.touching.root
        s = generators.shifts(self._centres(state.q), self.touching.turns_of_dynamic(state.q))
        rho, of_accelerations = generators.carried(state.u), generators.carried(state.udot)
        speeds = state.udot_by_place @ s + state.udot_by_velocity @ rho - of_accelerations
        return (
            state.J[state.places] @ s,
            state.rate_by_place @ s + state.J @ rho,
            np.asarray(np.linalg.solve(root, speeds)),
        )

    def _sample(self, random: np.random.Generator) -> MovingState:
        """A state that keeps what is held, about the start."""
        start, scales = self.start, self.model.scales
        sizes = np.concatenate(
            [[scales.length] * 3 + [1.0] * (size - 3) for _, size in self.generators.bodies]
        )
        xi, du = (SPREAD * sizes * random.standard_normal(len(sizes)) for _ in range(2))
        for _ in range(NEARER):
            try:
                q = moved(start.q, start.B @ xi, self.model)
                return self.moving.onto(q, start.u + du / scales.time, start.etas)
            except NoPlaceError:
                xi, du = xi / 2, du / 2
        raise NoPlaceError

    def _centres(self, q: Array) -> list[Array]:
        model = self.model
        return [q[body.q : body.q + 3] for body in model.bodies if size_of(model, body.kind)]


def _null_space(A: Array, least: float) -> Array:
    """(n, k) orthonormal columns with A times them zero; singular values up to `least` count as zero."""
    _, sizes, vectors = np.linalg.svd(np.vstack([A, np.zeros((1, A.shape[1]))]))
    return np.asarray(vectors[int((sizes > least).sum()) :].T)


def _range(A: Array, least: float) -> Array:
    """(m, k) orthonormal columns that span those of A; singular values up to `least` count as zero."""
    vectors, sizes, _ = np.linalg.svd(A, full_matrices=False)
    return np.asarray(vectors[:, sizes > least])
