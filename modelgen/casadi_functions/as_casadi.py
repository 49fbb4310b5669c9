"""A scene as a CasADi function: its right-hand side, or a step, in one mode of its contacts or in all."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Literal

import casadi as ca
import numpy as np

from modelgen.assembly import require
from modelgen.casadi_functions.run_mode import run_mode
from modelgen.codegen.library import Library
from modelgen.composition.contact_mode import ContactMode, named_feature_pairs
from modelgen.composition.explicit_runge_kutta import TABLEAUS, Method, step_function
from modelgen.composition.right_hand_side import (
    SLIP_SPEED,
    SolvedScene,
    held_rows_matrix,
    right_hand_side,
    slip_speeds,
)
from modelgen.composition.scene_symbols import parameter_values
from modelgen.derivation import Derivation, derive
from modelgen.errors import ModelgenError
from modelgen.model import Model
from modelgen.name_suggestions import nearest
from modelgen.runtime.arguments import check_flag, check_positive, shown, values_by_name
from modelgen.runtime.stepped_simulation import Simulation
from modelgen.scene.parameter_rereading import SceneReader
from modelgen.scene.scene_types import Origin

DEPENDENT = 1e-9  # of the largest singular value of the rows: smaller ones count as zero
WHAT = ("rhs", "step")
Source = Model | Derivation | Library


def as_casadi(
    source: Source,
    what: Literal["rhs", "step"] = "rhs",
    *,
    mode: ContactMode | Simulation | None = None,
    feature_pairs: Mapping[str, str] | None = None,
    h: float | None = None,
    method: Method = "rk4",
    settle: bool = True,
) -> ca.Function:
    """A scene as one CasADi function with exact derivatives.

    "rhs": (t, q, u, eta, gravity, parameters, inputs) -> (qdot, udot, eta_dot, force), `inputs` only of a
    scene that has some. `force` is by row (`row_names`).
    "step": (x, u, p, t) -> (x_next, sensors), one step of an explicit method: x = [q, u, eta], u the value of
    each input, held over the step, p = [parameters, gravity]; `sensors` only of a scene that has some.

    Args:
        source: a model, a derivation, or a library of a scene with parameters.
        mode: what carries force, sticks and slips: a run, whose present mode is taken, or a ContactMode; the
            function then holds the kernels of that mode alone. None: a function of all modes, which takes a
            mode vector (`mode_of`) as its last argument; faces that rest on three points are not in it.
        feature_pairs: of a function of all modes, the features of contacts between shapes of several, by the
            name of the contact. A contact that could follow several and is not named stays open.
        h: step, s; None: an argument `h` after t.
        method: of a step: "euler", "rk4" or "dop853".
        settle: at the end of a step, normalise quaternions, and correct contact points by a Newton step.

    Raises:
        ModelgenError: the mode is none of the scene, or rubs over a whole face; a name is unknown; the
            library's scene cannot be read again.
    """
    for where, name, known in (("as_casadi", what, WHAT), ("as_casadi: method", method, tuple(TABLEAUS))):
        if not isinstance(name, str) or name not in known:
            raise ModelgenError(where, shown(name), f"known: {', '.join(known)}", nearest(name, known))
    check_flag("as_casadi: settle", settle)
    derivation = derivation_of(source)
    solved = _solved(derivation, mode, feature_pairs)
    if what == "rhs":
        return right_hand_side(solved)
    if h is not None:
        check_positive("as_casadi: h", h, "leave it out for an argument h", "number of seconds")
    return step_function(solved, derivation.functions(), method, h, settle)


def mode_of(source: Source, simulation: Simulation) -> ContactMode:
    """The mode of a run at its present state.

    Raises ModelgenError where it rubs over a whole face, or a face begins to roll from flat.
    """
    derivation, session = derivation_of(source), simulation.session
    model = derivation.model
    mode = run_mode(model, session)
    slow = slip_speeds(model, float(session.settings.slip_speed))
    matrix = held_rows_matrix(model, derivation.functions(), mode, slow)
    A = np.array(matrix.call([ca.DM(value) for value in rhs_arguments(model, simulation)])[0])
    values = np.linalg.svd(A, compute_uv=False)
    return replace(mode, redundant=bool((values <= DEPENDENT * values.max(initial=0.0)).any()))


def rhs_arguments(model: Model, simulation: Simulation) -> list[np.ndarray]:
    """The arguments of "rhs" at the present state of a run of the model, without a mode vector."""
    session = simulation.session
    x = np.array(session.x, dtype=float)
    q, u, eta = np.split(x[:-1], [model.n_q, model.n_q + model.n_u])
    given = [
        np.array([simulation.t]),
        q,
        u,
        eta,
        np.array(model.scene.gravity),
        np.array(parameter_values(model)),
    ]
    if model.scene.inputs:
        given.append(np.array(session.applied_input[:-1], dtype=float))
    return given


def step_arguments(model: Model, simulation: Simulation) -> list[np.ndarray]:
    """The arguments x, u, p, t of "step" at the present state of a run of the model."""
    t, q, v, eta, gravity, parameters, *inputs = rhs_arguments(model, simulation)
    u = inputs[0][::3] if inputs else np.zeros(0)
    return [np.concatenate([q, v, eta]), u, np.concatenate([parameters, gravity]), t]


def derivation_of(source: Source) -> Derivation:
    """The formulas of a model, derivation or library.

    Raises ModelgenError where the scene of a library cannot be read again, or is another now.
    """
    if isinstance(source, Derivation):
        return source
    if isinstance(source, Model):
        return derive(source)
    if isinstance(source, Library):
        return derive(_model_of(source))
    raise ModelgenError("as_casadi", type(source).__name__, "a model, a derivation or a library")


def _model_of(library: Library) -> Model:
    instance = library.manifest.instance
    origin = instance.get("origin")
    if origin is None:
        raise ModelgenError(
            str(library.path),
            "its scene cannot be read again",
            "libraries of scenes with [[parameter]] tables",
            "give the derivation in place of the library",
        )  # fmt: skip
    own = {each["name"]: each["value"] for each in instance["parameters"]}
    return require(SceneReader(instance["name"], instance["source"], Origin(**origin)).scene(own))


def _solved(
    derivation: Derivation, mode: ContactMode | Simulation | None, named: Mapping[str, str] | None
) -> SolvedScene:
    if isinstance(mode, Simulation):
        slip_speed = float(mode.session.settings.slip_speed)
        return derivation.solved(mode_of(derivation, mode), slip_speed=slip_speed)
    if mode is not None and not isinstance(mode, ContactMode):
        raise ModelgenError("as_casadi: mode", type(mode).__name__, "a run, a ContactMode, or None")
    pairs = (
        named_feature_pairs(derivation.model, values_by_name("feature_pairs", named).items())
        if mode is None
        else None
    )
    return derivation.solved(mode, pairs, SLIP_SPEED)
