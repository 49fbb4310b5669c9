"""The right-hand side of the equations of motion of a whole scene as one CasADi function."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca

from modelgen.composition.constraint_forces import (
    ForcesAndAccelerations,
    SlipSpeeds,
    fixed_switches,
    held_forces,
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
from modelgen.composition.moving_bodies import Functions, MovingBody, moving_bodies, times_inverse_mass
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
        """M^-1 times wrenches (n_u, k)."""
        return times_inverse_mass(self.bodies, wrenches)

    @property
    def qdot(self) -> Expression:
        return ca.vertcat(ca.DM(0, 1), *(body.qdot for body in self.bodies))

    @property
    def free(self) -> Expression:
        """Accelerations without forces of the rows."""
        return ca.vertcat(ca.DM(0, 1), *(body.accel for body in self.bodies if body.columns))

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


def in_mode(scene: WrittenScene, mode: ContactMode, slow: SlipSpeeds) -> ForcesAndAccelerations:
    """Forces and accelerations in a fixed mode."""
    switches = fixed_switches(scene.model, mode, scene.rows, scene.parameters.friction, slow)
    return held_forces(scene.model, scene.rows, switches, scene.times_inverse_mass, scene.free, mode.redundant)


def right_hand_side(
    model: Model, functions: Functions, mode: ContactMode, slow: SlipSpeeds, symbol: Any = ca.MX
) -> ca.Function:
    """`rhs`: (t, q, u, eta, gravity, parameters, inputs) -> (qdot, udot, eta_dot, force) in a fixed mode.

    `force` is by row: the normal forces of contacts and limits, N, then friction, joints, and the points
    that hold faces (`row_names`).
    """
    scene = written_scene(model, functions, mode, symbol)
    return _function("rhs", scene, in_mode(scene, mode, slow), {})


def switched_right_hand_side(
    model: Model, functions: Functions, feature_pairs: tuple[int, ...], slow: SlipSpeeds
) -> ca.Function:
    """The same with a further argument `mode` (`mode_numbers`): which contacts carry force, stick and slip."""
    fixed = ContactMode(feature_pairs, (False,) * len(contact_entries(model)), _all_off(model))
    scene = written_scene(model, functions, fixed, ca.MX)
    vector = ca.MX.sym("mode", mode_size(model, len(scene.rows.rows)))
    switches = vector_switches(model, vector, scene.rows, scene.parameters.friction, slow)
    found = switched_forces(model, scene.rows, switches, scene.times_inverse_mass, scene.free)
    return _function("rhs", scene, found, {"mode": vector})


def _all_off(model: Model) -> tuple[FrictionMode, ...]:
    return tuple(FrictionMode() for _ in friction_of_contacts(model))


def _function(
    name: str, scene: WrittenScene, found: ForcesAndAccelerations, more: dict[str, Expression]
) -> ca.Function:
    inputs = scene.symbols.arguments | more
    outputs = {
        "qdot": scene.qdot, "udot": found.udot, "eta_dot": scene.eta_dot, "force": found.forces
    }  # fmt: skip
    values = [ca.densify(value) for value in outputs.values()]
    if isinstance(scene.symbols.t, ca.SX):
        values = ca.cse(values)
    return ca.Function(name, list(inputs.values()), values, list(inputs), list(outputs))
