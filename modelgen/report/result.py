"""The JSON Schemas of what `simulate` and `linearise` print with `--json`: every entry's meaning and unit."""

from __future__ import annotations

from typing import Any

_NUMBER = ["number", "null"]  # null: not finite


def _numbers(size: int, meaning: str) -> dict[str, Any]:
    return {
        "type": "array",
        "items": {"type": _NUMBER},
        "minItems": size,
        "maxItems": size,
        "description": meaning,
    }


def _entry(kind: str | list[str], meaning: str, **more: Any) -> dict[str, Any]:
    return {"type": kind, "description": meaning, **more}


def _object(meaning: str, properties: dict[str, Any]) -> dict[str, Any]:
    return _entry(
        "object", meaning, properties=properties, required=list(properties), additionalProperties=False
    )


_EVENT = _object(
    "a change of mode",
    {
        "t": _entry(_NUMBER, "s"),
        "kind": _entry(
            "string",
            "impact, touch-down, lift-off, margin (too near a singularity), walk (to other features), "
            "appear, vanish, flat (a face comes to rest on another) or tip (it turns over its edge)",
        ),
        "contact": _entry("string", "name of the contact"),
        "speed": _entry(_NUMBER, "approach speed, m/s; 0 where it has no meaning"),
        "features": _entry("string", "that touch after the event, where the shapes have several"),
    },
)
_STATE = _object(
    "a body at t_end, world axes",
    {
        "p": _numbers(3, "centre of mass, m"),
        "quaternion": _numbers(4, "orientation of the body axes (w, x, y, z), unit"),
        "v": _numbers(3, "velocity of the centre of mass, m/s"),
        "w": _numbers(3, "angular velocity, rad/s"),
    },
)
_JOINT = _object(
    "a joint at t_end, world axes",
    {
        "force": _numbers(3, "on its second body, N"),
        "torque": _numbers(3, "on its second body about the origin of the joint's frame in it, N m"),
        "coordinates": _entry(
            "object", "angles (rad, whole turns counted) and displacements (m) by name",
            additionalProperties={"type": _NUMBER},
        ),
    },
)  # fmt: skip
_PATCH = _object(
    "a face that rests on another at t_end",
    {
        "force": _entry(_NUMBER, "that presses them together, N"),
        "centre_of_pressure": _numbers(3, "where it acts, m, world axes"),
        "friction": _numbers(3, "on the second face, N, world axes"),
        "torque": _entry(_NUMBER, "of friction on it about the normal through the centre of pressure, N m"),
        "slip": _numbers(3, "of the second face past the first there, m/s, world axes"),
        "spin": _entry(_NUMBER, "of it past the first about the normal from the first to it, rad/s"),
    },
)
_ESTIMATE = _object(
    "the estimated global error of the run, by a second, finer run; null where none was asked for",
    {
        "status": _entry(
            "string",
            "or uncertified: something may be wrong that a second run cannot show",
            enum=["estimated", "beyond predictable horizon", "uncertified"],
        ),
        "statement": _entry("string", "all of it in words"),
        "position": _entry(_NUMBER, "of a body's centre up to the last sample that is predicted, m"),
        "rotation": _entry(_NUMBER, "of a body's rotation, rad"),
        "gap": _entry(_NUMBER, "m"),
        "force": _entry(_NUMBER, "root mean square over that of the forces"),
        "events": _entry(_NUMBER, "of event times, s"),
        "events_unmatched": _entry(["integer", "null"], "events that one of the two runs has alone"),
        "horizon": _entry(_NUMBER, "the last sample that is predicted, s; null: all are"),
        "uncertified": {
            "type": "array",
            "items": {"type": "string"},
            "description": "reasons, such as closest points that are sought by sampling",
        },
        "rhs_evals": _entry("integer", "evaluations of the right-hand side that it took", minimum=0),
    },
) | {"type": ["object", "null"]}
_SHAPE = _entry(
    "object",
    "each dynamic body's part, the largest entry 1",
    additionalProperties=_object(
        "of a body", {"v": _numbers(3, "world axes"), "w": _numbers(3, "body axes, rad")}
    ),
)
_LINEARISED = {
    "scene": _entry("string", "name of the scene"),
    "bodies": _entry(
        "object",
        "each dynamic body at rest",
        additionalProperties=_object(
            "at rest", {key: _STATE["properties"][key] for key in ("p", "quaternion")}
        ),
    ),
    "force": _entry("object", "of each contact that touches, N", additionalProperties={"type": _NUMBER}),
    "redundant": _entry(
        "integer", "contacts that touch beyond the rank of their rows; their forces are those of minimum norm"
    ),
    "modes": _entry(
        "array",
        "small motions exp(growth t) (shape cos(frequency t) - quadrature sin(frequency t)), by frequency",
        items=_object(
            "a small motion",
            {
                "kind": _entry("string", "oscillation, growth, decay, or neutral (it may be moved along)"),
                "frequency": _entry(_NUMBER, "rad/s"),
                "hertz": _entry(_NUMBER, "frequency / 2 pi, Hz"),
                "growth": _entry(_NUMBER, "1/s; negative where it dies out"),
                "shape": _SHAPE,
                "quadrature": _SHAPE,
            },
        ),
    ),
}
_PROPERTIES = {
    "scene": _entry("string", "name of the scene"),
    "t_end": _entry(_NUMBER, "time that the run reached, s"),
    "outcome": _entry("string", "done, interrupted, or what stopped the run"),
    "advice": _entry("string", "what the outcome means and what to do about it"),
    "outcome_contact": _entry("string", "the contact that the outcome speaks of, or empty"),
    "accuracy": _entry("string", "the Accuracy that was used"),
    "warnings": {
        "type": "array",
        "items": {"type": "string"},
        "description": "what the user should know of the run, such as a margin that fell low",
    },
    "estimate": _ESTIMATE,
    "steps": _entry("integer", "accepted integration steps", minimum=0),
    "rejected": _entry("integer", "steps repeated with a smaller size", minimum=0),
    "rhs_evals": _entry("integer", "evaluations of the right-hand side", minimum=0),
    "wall_s": _entry(_NUMBER, "wall-clock time of the run, s"),
    "energy_drift": _entry(
        _NUMBER,
        "max |E - E0 - work| / max kinetic energy; if nothing moved, over the characteristic energy",
    ),
    "gap_max": _entry(_NUMBER, "largest |d| of a closed contact at an accepted step, m"),
    "joint_error_max": _entry(
        _NUMBER, "largest deviation from the equations of the joints at the start and at accepted steps, m"
    ),
    "complementarity_max": _entry(
        _NUMBER,
        "largest |min(gap / L, force / (M L / T^2))| at an accepted step; L, M, T: model scales",
    ),
    "margin_min": _entry(
        _NUMBER, "smallest dimensionless distance of a closed contact to singularity, at most 1"
    ),
    "redundant_max": _entry(
        "integer",
        "most force-carrying contacts beyond the rank of their rows; their forces are those of minimum norm, "
        "each weighted by the square root of its diagonal entry of J M^-1 J^T",
    ),
    "events": _entry("array", "changes of mode in order of time", items=_EVENT),
    "joints": _entry("object", "each joint at the last sample", additionalProperties=_JOINT),
    "patches": _entry("object", "each pair of faces that rest on each other", additionalProperties=_PATCH),
    "final": _entry("object", "each body at the last sample", additionalProperties=_STATE),
    "kinds": _entry("array", "names of the kinds the model uses", items={"type": "string"}),
    "instructions": _entry(
        "object", "instructions of each generated function", additionalProperties={"type": "integer"}
    ),
    "out": _entry(["string", "null"], "the file that holds the run, or null"),
    "plot": _entry(["string", "null"], "the file that holds its picture, or null"),
}


def result_schema() -> dict[str, Any]:
    """JSON Schema (draft 2020-12) of the object that `simulate --json` prints."""
    return _object("The object that `modelgen simulate --json` prints. SI units, world axes.", _PROPERTIES)


def linearised_schema() -> dict[str, Any]:
    """JSON Schema (draft 2020-12) of the object that `linearise --json` prints."""
    return _object("The object that `modelgen linearise --json` prints. SI units, world axes.", _LINEARISED)
