"""Motion that stays in a plane, proved on the composed right-hand side.

With what leads out of the plane at zero, its rates are zero identically.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from modelgen.model import Model

NORMALS = {"yz": 0, "xz": 1, "xy": 2}  # planes of the world by the axis across them


@dataclass(frozen=True, slots=True)
class InPlane:
    """A plane of the world that no body leaves, and what the motion in it takes."""

    axes: str
    instructions: int
    states: int


def in_a_plane(model: Model, rhs: ca.Function) -> InPlane | None:
    """The first of the world's planes that the scene stays in; None: none is found, or contacts have eta."""
    if model.n_eta:
        return None
    return next((found for axes, k in NORMALS.items() if (found := _in_plane(model, rhs, axes, k))), None)


def _in_plane(model: Model, rhs: ca.Function, axes: str, normal: int) -> InPlane | None:
    out_q, out_u = _leading_out(model, normal)
    start = [model.initial_q[k] for k in out_q] + [model.initial_u[k] for k in out_u]
    if any(start) or model.scene.gravity[normal] or not model.n_u:
        return None
    given = {name: ca.SX.sym(name, rhs.numel_in(name)) for name in rhs.name_in()}
    for name, out in (("q", out_q), ("u", out_u)):
        for k in out:
            given[name][k] = 0
    given["gravity"][normal] = 0
    found = rhs.call(given)
    parts = {"qdot": (found["qdot"], out_q), "udot": (found["udot"], out_u)}
    if not all(ca.simplify(value[k]).is_zero() for value, out in parts.values() for k in out):
        return None
    kept = [value[k] for value, out in parts.values() for k in range(value.numel()) if k not in out]
    symbols = [ca.vertcat(*ca.symvar(value)) for value in given.values()]
    outputs = ca.cse([ca.densify(ca.vertcat(*kept)), ca.densify(found["force"])])
    smaller = ca.Function("mg_rhs_plane", symbols, outputs)
    states = model.n_q + model.n_u - len(out_q) - len(out_u)
    return InPlane(axes, int(smaller.n_instructions()), states)


def _leading_out(model: Model, normal: int) -> tuple[list[int], list[int]]:
    """Entries of q and u that are zero in the plane: places and speeds across it, turns about axes in it."""
    out_q, out_u = [], []
    for body in model.bodies:
        motion = model.body_kinds[body.kind].motion
        if motion in ("point", "free"):
            out_q.append(body.q + normal)
            out_u.append(body.u + normal)
        if motion == "free":
            others = [k for k in range(3) if k != normal]
            out_q += [body.q + 4 + k for k in others]
            out_u += [body.u + 3 + k for k in others]
    return out_q, out_u
