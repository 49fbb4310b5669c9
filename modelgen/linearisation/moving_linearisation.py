"""A scene in motion with its joints and the contacts that touch at its start held, and derivatives of its
accelerations.

M u_dot = f + J^T force and J u_dot + gamma = 0, where J has the row along N of each contact that touches, the
rows that friction and resistances hold there, and those of the joints. A change (xi, du) of place and
velocity
that keeps all of them, dg xi = 0 and J du + d(J u) xi = 0, changes u_dot by

    d u_dot = Z Z^T M d(M^-1 (f + J^T force)) - Q d(J u_dot + gamma),

where Z are motions with J Z = 0, Z^T M Z = 1, Q is the inverse of J of least norm in M^-1 J^T, and d holds
forces and accelerations. It does not depend on which forces are taken where J has dependent rows.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from modelgen.errors import SimulationError
from modelgen.linearisation.rest_linearisation import (
    DEPENDENT,
    HeldState,
    NoPlaceError,
    Touching,
    motions_along,
    moved,
)
from modelgen.linearisation.touching_contact import Array

Bools = np.ndarray[Any, np.dtype[np.bool_]]

CORRECTIONS = 20  # of a state back onto what is held
KEPT = 1e-12  # gaps and rates that remain, dimensionless


@dataclass(frozen=True, kw_only=True)
class MovingState(HeldState):
    """A state in motion."""

    called = ("in the steady motion near the start", "in it")
    u: Array  # (n,)
    places: Bools  # (m,) rows along normals and of joints
    udot: Array  # (n,)
    rate_by_place: Array  # (m, n) J u by xi
    udot_by_place: Array  # (n, n) by xi
    udot_by_velocity: Array  # (n, n) by du


class Moving:
    """The states of a scene in motion."""

    def __init__(self, touching: Touching, like: Moving | None = None) -> None:
        """`like`: of the same scene with other values of parameters, whose functions serve here too where the
        same contacts touch."""
        self.touching = touching
        self.model = touching.model
        held = np.array(touching.held)
        self._places: Bools = np.isin(held, touching.first) | (held >= touching.contact_rows)
        shared = like is not None and _is_alike(like.touching, touching)
        functions = (like._rows, like._derivatives) if like and shared else self._written()
        self._rows: ca.Function = functions[0]
        self._derivatives: ca.Function = functions[1]

    def onto(self, q: Array, u: Array, etas: tuple[Array, ...]) -> MovingState:
        """The state brought back onto what is held, the velocities by the least kinetic energy.

        Raises NoPlaceError where there is none near.
        """
        scales = self.model.scales
        for _ in range(CORRECTIONS):
            etas, B, value, J, *_ = self._held(q, u, etas)
            rate = J @ u
            off = max(
                np.abs(value).max(initial=0.0) / scales.length,
                np.abs(rate).max(initial=0.0) * scales.time / scales.length,
            )
            if off < KEPT:
                return self.at(q, u, etas)
            root = self.touching.mass_at(q)[1]
            G = J[self._places] @ root
            back = root @ np.linalg.lstsq(G, value[self._places], rcond=DEPENDENT)[0]
            u = u - root @ np.linalg.lstsq(J @ root, rate, rcond=DEPENDENT)[0]
            q = moved(q, B @ -back, self.model)
        raise NoPlaceError

    def at(self, q: Array, u: Array, etas: tuple[Array, ...]) -> MovingState:
        """The state with the contact points brought onto their extrema from `etas`."""
        touching, held = self.touching, self.touching.held
        mass, root = touching.mass_at(q)
        etas, B, value, J, gamma, free = self._held(q, u, etas)
        Z, Q = motions_along(J, root), root @ np.linalg.pinv(J @ root, rcond=DEPENDENT)
        udot = Z @ (Z.T @ mass @ free) - Q @ gamma
        force = np.zeros(touching.contact_rows + touching.joint_rows)
        force[held] = np.linalg.lstsq((J @ root).T, root.T @ mass @ (udot - free), rcond=DEPENDENT)[0]
        eta = np.concatenate([*etas, np.zeros(0)])
        by_place, by_velocity, rate, row_place, row_velocity = self._call(
            self._derivatives, q, u, eta, force, udot
        )
        along = Z @ Z.T @ mass
        return MovingState(
            q=q, etas=etas, facings=touching.facings(q, etas), J=J, joint_rows=touching.joint_rows,
            value=value, B=B, free=free - udot, mass=mass, root=root, motions=Z,
            u=u, places=self._places, udot=udot, rate_by_place=rate[held],
            udot_by_place=along @ by_place - Q @ row_place[held],
            udot_by_velocity=along @ by_velocity - Q @ row_velocity[held],
        )  # fmt: skip

    def _held(self, q: Array, u: Array, etas: tuple[Array, ...]) -> tuple[Any, ...]:
        """The etas on their extrema; B; of the rows that are held value, J, gamma; udot without forces."""
        touching = self.touching
        etas, gaps = touching.settled(q, etas)
        eta = np.concatenate([*etas, np.zeros(0)])
        B, values, J, gamma, free = self._call(self._rows, q, u, eta)
        J, gamma, free = J[touching.held], gamma.ravel()[touching.held], free.ravel()
        if not all(np.isfinite(each).all() for each in (J, free, gamma)):
            raise NoPlaceError
        return etas, B, touching.values(gaps, values), J, gamma, free

    def _call(self, function: ca.Function, *arguments: Array) -> list[Array]:
        return [np.array(value) for value in function(*arguments, *self._settings)]

    @cached_property
    def _settings(self) -> list[ca.DM]:
        given, last = self.touching.settings, self._rows.name_in()[3:]
        return [ca.DM(given[name]) for name in last]

    def _written(self) -> tuple[ca.Function, ca.Function]:
        """(q, u, eta, settings) -> B, values of joints, J, gamma, udot without forces; (q, u, eta, force,
        accelerations, settings) -> udot by xi and by u; J u by xi; J u_dot + gamma by xi and by u."""
        rhs = self.touching.pushed
        q, u, eta, force = (ca.SX.sym(name, rhs.numel_in(name)) for name in ("q", "u", "eta", "force"))
        t, a = ca.SX.sym("t"), ca.SX.sym("a", self.model.n_u)
        names = [name for name in self.touching.settings if name in rhs.name_in()]
        settings = {name: ca.SX.sym(name, rhs.numel_in(name)) for name in names}
        given = {"t": t, "q": q, "u": u, "eta": eta} | settings
        free = rhs.call(given | {"force": ca.DM(force.numel(), 1)})["udot"]
        results = rhs.call(given | {"force": force})
        qdot, udot, eta_dot, rate = (results[name] for name in ("qdot", "udot", "eta_dot", "rate"))
        B, E, J = ca.jacobian(qdot, u), ca.jacobian(eta_dot, u), ca.jacobian(rate, u)
        rows = ca.mtimes(J, a) + results["gamma"]

        def by_place(expression: ca.SX) -> ca.SX:
            return ca.mtimes(ca.jacobian(expression, q), B) + ca.mtimes(ca.jacobian(expression, eta), E)

        held = [B, results["joint_value"], J, results["gamma"], free]
        derivatives = [
            by_place(udot), ca.jacobian(udot, u), by_place(rate), by_place(rows), ca.jacobian(rows, u)
        ]  # fmt: skip
        if ca.depends_on(ca.veccat(*held, *derivatives), t):
            self._refuse_time()
        place = {"q": q, "u": u, "eta": eta}
        under = place | {"force": force, "udot": a}
        return _function("held", place | settings, held), _function(
            "derivatives", under | settings, derivatives
        )

    def _refuse_time(self) -> None:
        raise SimulationError(
            f"{self.model.scene.name}: linearise",
            "loads or joints depend on time",
            "a steady motion is one of a scene that stays as it is",
            "leave them out",
        )


def _function(name: str, arguments: dict[str, ca.SX], results: list[ca.SX]) -> ca.Function:
    names = [f"result_{k}" for k in range(len(results))]
    return ca.Function(name, list(arguments.values()), results, list(arguments), names, {"cse": True})


def _is_alike(one: Touching, other: Touching) -> bool:
    """Whether the same rows are held, with as many settings."""
    same_sizes = all(len(one.settings[name]) == len(other.settings[name]) for name in other.settings)
    return same_sizes and np.array_equal(one.held, other.held) and np.array_equal(one.first, other.first)
