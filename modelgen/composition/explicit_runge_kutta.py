"""One step of an explicit Runge-Kutta method over a whole scene, in a mode that does not change."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

import casadi as ca
import numpy as np
from scipy.integrate import DOP853

from modelgen.composition.contact_mode import contact_entries
from modelgen.composition.moving_bodies import Functions
from modelgen.composition.right_hand_side import (
    SolvedScene,
    WrittenScene,
    right_hand_side,
)
from modelgen.composition.scene_symbols import Expression, fitted
from modelgen.composition.sensor_expressions import sensors_of

Method = Literal["euler", "rk4", "dop853"]


@dataclass(frozen=True)
class Tableau:
    """An explicit method: stage i at time c[i] from slopes 0 .. i - 1 with weights A[i]; the end with b."""

    A: Sequence[Sequence[float]]
    b: Sequence[float]
    c: Sequence[float]


_END = 12  # stages of DOP853; scipy lists those of its dense output after them
TABLEAUS: dict[str, Tableau] = {
    "euler": Tableau([[]], [1.0], [0.0]),
    "rk4": Tableau([[], [0.5], [0, 0.5], [0, 0, 1.0]], [1 / 6, 1 / 3, 1 / 3, 1 / 6], [0, 0.5, 0.5, 1.0]),
    "dop853": Tableau(
        [list(np.asarray(DOP853.A)[i, :i]) for i in range(_END)],
        list(np.asarray(DOP853.B)[:_END]),
        list(np.asarray(DOP853.C)[:_END]),
    ),
}  # E. Hairer, S. P. Norsett, G. Wanner, Solving Ordinary Differential Equations I, 1993


def step_function(
    solved: SolvedScene, functions: Functions, method: Method, h: float | None, settle: bool
) -> ca.Function:
    """`step`: (x, u, p, t) -> (x_next, sensors): x = [q, u, eta], u the values of the inputs, held over the
    step, p = [parameters, gravity]; `sensors` are what the sensors show at its end.

    Without a number h, the step is an argument `h` after t; of a function of all modes, the mode vector is
    the argument `mode` after that.

    Args:
        settle: at the end, quaternions are normalised and contact points corrected by one Newton step, as
            after an accepted step of a run.
    """
    rhs, model = right_hand_side(solved), solved.scene.model
    sizes = (model.n_q, model.n_u, model.n_eta)
    inputs = {
        "x": ca.MX.sym("x", sum(sizes)),
        "u": ca.MX.sym("u", len(model.scene.inputs)),
        "p": ca.MX.sym("p", int(rhs.numel_in("parameters")) + 3),
        "t": ca.MX.sym("t"),
    }
    inputs |= {"h": ca.MX.sym("h")} if h is None else {}
    inputs |= {} if solved.mode is None else {"mode": ca.MX.sym("mode", solved.mode.numel())}
    span = inputs["h"] if h is None else ca.MX(h)

    def arguments(at: Expression, state: Expression) -> dict[str, Expression]:
        q, v, eta = ca.vertsplit(state, [0, *np.cumsum(sizes).tolist()])
        given = {
            "t": at,
            "q": q,
            "u": v,
            "eta": eta,
            "gravity": inputs["p"][-3:],
            "parameters": inputs["p"][:-3],
        }
        if model.scene.inputs:
            settings = [
                part for value in ca.vertsplit(inputs["u"]) for part in (value, ca.MX(0), inputs["t"])
            ]
            given["inputs"] = ca.vertcat(*settings)
        return given | ({} if solved.mode is None else {"mode": inputs["mode"]})

    def slope(at: Expression, state: Expression) -> Expression:
        found = rhs(**arguments(at, state))
        return ca.vertcat(found["qdot"], found["udot"], found["eta_dot"])

    x_next = explicit_step(TABLEAUS[method], slope, inputs["t"], inputs["x"], span)
    end = inputs["t"] + span
    if settle:
        settled = solved.function("settled", {"x": settled_state(solved.scene, functions)})
        x_next = settled(**arguments(end, x_next))["x"]
    outputs = {"x_next": x_next}
    if model.scene.sensors:
        observe = solved.function("observe", {"sensors": sensors_of(solved.scene, solved.found, functions)})
        outputs |= observe(**arguments(end, x_next))
    return ca.Function("step", list(inputs.values()), list(outputs.values()), list(inputs), list(outputs))


def explicit_step(
    tableau: Tableau,
    slope: Callable[[Expression, Expression], Expression],
    t: Expression,
    x: Expression,
    h: Expression,
) -> Expression:
    """The state after a step h of an explicit method from (t, x)."""
    slopes: list[Expression] = []
    for row, c in zip(tableau.A, tableau.c, strict=True):
        moved = [weight * found for weight, found in zip(row, slopes, strict=True) if weight]
        slopes.append(slope(t + c * h, x + h * sum(moved) if moved else x))
    return x + h * sum(weight * found for weight, found in zip(tableau.b, slopes, strict=True) if weight)


def settled_state(scene: WrittenScene, functions: Functions) -> Expression:
    """[q, u, eta] with unit quaternions, and eta after one Newton step of the extremality equations at the
    poses of q."""
    q = [scene.symbols.q[k] for k in range(scene.model.n_q)]
    for body in scene.bodies:
        if body.kind.motion == "free":
            first = body.entry.q + 3
            part = scene.symbols.q[first : first + 4]
            q[first : first + 4] = ca.vertsplit(part / ca.norm_2(part))
    eta = scene.symbols.eta
    parts = []
    for entry, touch in zip(contact_entries(scene.model), scene.rows.contacts, strict=True):
        own = eta[entry.eta : entry.eta + entry.room]
        if touch is None or not entry.room:
            parts.append(own)
            continue
        place = functions[touch.place]
        size = int(place.numel_in("eta"))
        sides = [scene.bodies[index].pose for index in touch.sides]
        found = place.call(fitted(place, [*sides, own[:size], touch.parameters]))
        parts.append(dict(zip(place.name_out(), found, strict=True))["eta_next"])
        parts.append(eta[entry.eta + size : entry.eta + entry.room])
    return ca.vertcat(*q, scene.symbols.u, *parts)
