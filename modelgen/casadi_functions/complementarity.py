"""A scene as a program with complementarity constraints: the expressions that tools for these take."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import casadi as ca

from modelgen.casadi_functions.as_casadi import Source, derivation_of
from modelgen.composition.complementarity_system import complementarity_system
from modelgen.composition.contact_mode import friction_of_contacts, named_feature_pairs
from modelgen.composition.scene_symbols import parameter_values


def mpcc(source: Source, feature_pairs: Mapping[str, str] | None = None) -> dict[str, Any]:
    """A scene as complementarity system, expressions of CasADi symbols (SX).

    M v_dot = f_v + J_normal lambda_normal + J_tangent lambda_tangent + J_joint lambda_joint,
    q_dot = N(q) v, with 0 <= G, 0 <= H, G H = 0, and `equal` = 0.

    Args:
        source: a model, a derivation, or a library of a scene with parameters.
        feature_pairs: of contacts between shapes of several features, by the name of the contact.

    Returns:
        a dict. Symbols: `t`, `q`, `v`, `eta`, `x` = [q, v, eta], `u` (settings of the inputs, 3 each),
        `gravity`, `p` (parameters), `lambda_normal`, `lambda_joint`, `direction` of the friction, and
        `gamma`, the multiplier of each friction constraint, a speed. Expressions: `lambda_tangent` = mu
        lambda_normal direction, `M`, `invM`, `f_v`, `q_dot`, `eta_dot`, `eta_error` (zero where eta gives the
        closest points), `f_c` (gaps, m), `J_normal`, `J_tangent`, `J_joint` (columns are wrenches), `Gamma2`,
        `v_dot`, `joint_value`, `Gamma1`, the pairs `G` and `H`, and `equal`. Numbers: `x0`, `p0`, `g0` of the
        scene, `mu` (one column of two coefficients a friction constraint), `e` (restitution of each contact),
        `names` of the contacts.

    Raises:
        ModelgenError: a name is unknown, or the library's scene cannot be read again.
    """
    derivation = derivation_of(source)
    model = derivation.model
    pairs = tuple(named_feature_pairs(model, (feature_pairs or {}).items()))
    system = complementarity_system(model, derivation.functions(), pairs, ca.SX)
    scene, symbols, rows = system.scene, system.scene.symbols, system.scene.rows.rows
    places = {kind: [k for k, row in enumerate(rows) if row.kind == kind] for kind in ("friction", "joint")}
    entries: tuple[Any, ...] = (*model.contacts, *model.limits)
    return {
        "t": symbols.t,
        "q": symbols.q,
        "v": symbols.u,
        "eta": symbols.eta,
        "x": ca.vertcat(symbols.q, symbols.u, symbols.eta),
        "u": symbols.inputs,
        "gravity": symbols.gravity,
        "p": symbols.parameters,
        "lambda_normal": system.loads[list(system.contacts)],
        "direction": system.loads[places["friction"]],
        "lambda_tangent": system.forces[places["friction"]],
        "lambda_joint": system.loads[places["joint"]],
        "gamma": system.speeds,
        "M": system.mass,
        "invM": scene.times_inverse_mass(ca.SX.eye(model.n_u)),
        "f_v": system.load,
        "v_dot": system.udot,
        "q_dot": scene.qdot,
        "eta_dot": scene.eta_dot,
        "eta_error": system.eta_error,
        "f_c": system.gap,
        "J_normal": system.J_normal,
        "J_tangent": system.J_tangent,
        "J_joint": system.J_joint,
        "Gamma2": system.gamma,
        "joint_value": system.joint_value,
        "Gamma1": system.joint_gamma,
        "G": ca.vertcat(*system.first),
        "H": ca.vertcat(*system.second),
        "equal": ca.vertcat(ca.SX(0, 1), *system.equal),
        "x0": [*model.initial_q, *model.initial_u, *[0.0] * model.n_eta],
        "p0": parameter_values(model),
        "g0": list(model.scene.gravity),
        "mu": [each.kinetic for _, each in friction_of_contacts(model)],
        "e": [
            model.pairs[model.contacts[k].pair].restitution.value
            if k < len(model.contacts)
            else model.limits[k - len(model.contacts)].restitution
            for k in system.contacts
        ],
        "names": [entries[k].name for k in system.contacts],
    }
