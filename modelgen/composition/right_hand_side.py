"""The right-hand side of the equations of motion of a whole scene as one CasADi function."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca

from modelgen.composition.armature import whole_mass, with_armature
from modelgen.composition.constraint_forces import (
    ForcesAndAccelerations,
    SlipSpeeds,
    fixed_switches,
    held_forces,
    held_matrix,
    switched_forces,
    vector_switches,
)
from modelgen.composition.constraint_rows import RowBuilder, SceneRows
from modelgen.composition.contact_mode import (
    ContactMode,
    FrictionMode,
    check_mode,
    contact_entries,
    friction_of_contacts,
    mode_size,
)
from modelgen.composition.moving_bodies import (
    Functions,
    MovingBody,
    moving_bodies,
    times_inverse_body_mass,
)
from modelgen.composition.scene_symbols import (
    Expression,
    SceneSymbols,
    SplitParameters,
    scene_symbols,
    split_parameters,
)
from modelgen.model import Model

SLIP_SPEED = 1e-7  # relative to length and time of the scene


@dataclass(frozen=True)
class WrittenScene:
    """A scene as expressions."""

    model: Model
    symbols: SceneSymbols
    parameters: SplitParameters
    bodies: list[MovingBody]
    rows: SceneRows

    def times_inverse_mass(self, wrenches: Expression) -> Expression:
        """M^-1 times wrenches (n_u, k), the armature of joints being part of M."""
        responses = times_inverse_body_mass(self.bodies, wrenches)
        return with_armature(self.rows.armature, self.bodies, responses, curved=False)

    @property
    def mass(self) -> Expression:
        """M (n_u, n_u) of bodies and armature."""
        return whole_mass(self.rows.armature, self.bodies)

    @property
    def qdot(self) -> Expression:
        return ca.vertcat(ca.DM(0, 1), *(body.qdot for body in self.bodies))

    @property
    def free(self) -> Expression:
        """Accelerations without forces of the rows."""
        bodies = ca.vertcat(ca.DM(0, 1), *(body.accel for body in self.bodies if body.columns))
        return with_armature(self.rows.armature, self.bodies, bodies, curved=True)

    @property
    def eta_dot(self) -> Expression:
        """By contact; zero for what follows no feature pair."""
        parts = []
        for entry, touch in zip(contact_entries(self.model), self.rows.contacts, strict=True):
            own = touch.eta_dot if touch else ca.DM(0, 1)
            parts += [own, ca.DM(entry.room - int(own.numel()), 1)]
        return ca.vertcat(ca.DM(0, 1), *parts)

    @property
    def gaps(self) -> list[Expression]:
        """Of contacts with shapes and of limits; infinite of those that follow no feature pair."""
        return [touch.gap if touch else ca.DM(ca.inf) for touch in self.rows.contacts]


def written_scene(model: Model, functions: Functions, mode: ContactMode, symbol: Any) -> WrittenScene:
    """A scene on the feature pairs of a mode, over symbols of ca.SX or ca.MX."""
    check_mode(model, mode)
    symbols = scene_symbols(model, symbol)
    parameters = split_parameters(model, symbols.parameters)
    bodies = moving_bodies(model, symbols, parameters, functions)
    rows = RowBuilder(model, symbols, parameters, bodies, functions).scene_rows(mode)
    return WrittenScene(model, symbols, parameters, bodies, rows)


def slip_speeds(model: Model, slip_speed: float = SLIP_SPEED) -> SlipSpeeds:
    """The speeds below which slip counts as sticking, from the setting `slip_speed` of a run."""
    return SlipSpeeds(slip_speed * model.scales.length / model.scales.time, slip_speed / model.scales.time)


@dataclass(frozen=True)
class SolvedScene:
    """A scene with the forces of its rows, in one mode or in all modes."""

    scene: WrittenScene
    found: ForcesAndAccelerations
    mode: Expression | None  # mode vector, of all modes

    @property
    def arguments(self) -> dict[str, Expression]:
        """t, q, u, eta, gravity, parameters, inputs and mode, as far as there are any."""
        return self.scene.symbols.arguments | ({} if self.mode is None else {"mode": self.mode})

    def function(self, name: str, outputs: dict[str, Expression]) -> ca.Function:
        """A function of all arguments."""
        values = [ca.densify(value) for value in outputs.values()]
        if isinstance(self.scene.symbols.t, ca.SX):
            values = ca.cse(values)
        return ca.Function(name, list(self.arguments.values()), values, list(self.arguments), list(outputs))


def in_mode(
    model: Model, functions: Functions, mode: ContactMode, slow: SlipSpeeds, symbol: Any
) -> SolvedScene:
    """A scene in a fixed mode."""
    scene = written_scene(model, functions, mode, symbol)
    switches = fixed_switches(model, mode, scene.rows, scene.parameters.friction, slow)
    found = held_forces(model, scene.rows, switches, scene.times_inverse_mass, scene.free, mode.redundant)
    return SolvedScene(scene, found, None)


def in_all_modes(
    model: Model, functions: Functions, feature_pairs: Sequence[int], slow: SlipSpeeds
) -> SolvedScene:
    """A scene with these feature pairs and a mode vector (`mode_numbers`): what has force, sticks, slips."""
    off = tuple(FrictionMode() for _ in friction_of_contacts(model))
    none = ContactMode(tuple(feature_pairs), (False,) * len(contact_entries(model)), off)
    scene = written_scene(model, functions, none, ca.MX)
    vector = ca.MX.sym("mode", mode_size(model, len(scene.rows.rows)))
    switches = vector_switches(model, vector, scene.rows, scene.parameters.friction, slow)
    found = switched_forces(model, scene.rows, switches, scene.times_inverse_mass, scene.free)
    return SolvedScene(scene, found, vector)


def right_hand_side(solved: SolvedScene) -> ca.Function:
    """`rhs`: (t, q, u, eta, gravity, parameters, inputs, mode) -> (qdot, udot, eta_dot, force).

    `force` is by row: the normal forces of contacts and limits, N, then friction, joints, and the points
    that hold faces (`row_names`).
    """
    scene, found = solved.scene, solved.found
    outputs = {"qdot": scene.qdot, "udot": found.udot, "eta_dot": scene.eta_dot, "force": found.forces}
    return solved.function("rhs", outputs)


def held_rows_matrix(model: Model, functions: Functions, mode: ContactMode, slow: SlipSpeeds) -> ca.Function:
    """Of the arguments of `rhs`: the matrix whose rank is that of the rows that hold (`held_matrix`)."""
    scene = written_scene(model, functions, mode, ca.MX)
    switches = fixed_switches(model, mode, scene.rows, scene.parameters.friction, slow)
    matrix = held_matrix(scene.rows, switches, scene.times_inverse_mass)
    arguments = scene.symbols.arguments
    return ca.Function("held", list(arguments.values()), [ca.densify(matrix)], list(arguments), ["matrix"])
