"""The JSON Schema of what `simulate` prints with `--json`: every entry's meaning and unit."""

from __future__ import annotations

from typing import Any

from modelgen.report.schema_parts import NUMBER, entry, numbers, record
from modelgen.runtime.trajectory import DOUBT_KINDS, EVENT_KINDS

_EVENT = record(
    "a change of mode",
    {
        "t": entry(NUMBER, "s"),
        "kind": entry("string", "kind of the event, as in the glossary", enum=list(EVENT_KINDS)),
        "contact": entry("string", "name of the contact"),
        "speed": entry(NUMBER, "approach speed, m/s; 0 where it has no meaning"),
        "features": entry("string", "that touch after the event, where the shapes have several"),
    },
)
_PASSAGE = record(
    "a pair of shapes",
    {
        "between": {
            "type": "array",
            "items": {"type": "string"},
            "minItems": 2,
            "maxItems": 2,
            "description": "as `between` of [[contact]] names them",
        },
        "t": entry(NUMBER, "when an overlap was first seen, s"),
    },
)
_UNKNOWN = "nulls where `observe` leaves the turning out"
BODY_STATE = record(
    "a body at t_end, world axes",
    {
        "p": numbers(3, "centre of mass, m"),
        "quaternion": numbers(4, f"orientation of the body axes (w, x, y, z), unit; {_UNKNOWN}"),
        "v": numbers(3, "velocity of the centre of mass, m/s"),
        "w": numbers(3, f"angular velocity, rad/s; {_UNKNOWN}"),
    },
)
_JOINT = record(
    "a joint at t_end, world axes",
    {
        "force": numbers(3, "on its second body, N"),
        "torque": numbers(3, "on its second body about the origin of the joint's frame in it, N m"),
        "coordinates": entry(
            "object", "angles (rad, whole turns counted) and displacements (m) by name",
            additionalProperties={"type": NUMBER},
        ),
    },
)  # fmt: skip
_PATCH = record(
    "a face that rests on another at t_end",
    {
        "force": entry(NUMBER, "that presses them together, N"),
        "centre_of_pressure": numbers(3, "where it acts, m, world axes"),
        "friction": numbers(3, "on the second face, N, world axes"),
        "torque": entry(NUMBER, "of friction on it about the normal through the centre of pressure, N m"),
        "slip": numbers(3, "of the second face past the first there, m/s, world axes"),
        "spin": entry(NUMBER, "of it past the first about the normal from the first to it, rad/s"),
        "shares": entry(
            "object",
            "where several pairs of shapes rest as one: the part of the force on each by the pressure, N",
            additionalProperties={"type": "number"},
        ),
    },
)
_ESTIMATE = record(
    "the estimated global error of the run, by a second, finer run; null where none was asked for",
    {
        "status": entry(
            "string",
            "or uncertified: something may be wrong that a second run cannot show",
            enum=["estimated", "beyond predictable horizon", "uncertified"],
        ),
        "statement": entry("string", "all of it in words"),
        "position": entry(NUMBER, "of a body's centre up to the last sample that is predicted, m"),
        "rotation": entry(NUMBER, "of a body's rotation, rad"),
        "velocity": entry(NUMBER, "of the velocity of a body's centre, m/s"),
        "spin": entry(NUMBER, "of a body's angular velocity, rad/s"),
        "gap": entry(NUMBER, "m"),
        "force": entry(NUMBER, "root mean square over that of the forces"),
        "events": entry(NUMBER, "of event times, s; of those after the horizon if none comes before"),
        "events_unmatched": entry(["integer", "null"], "events that one of the two runs has alone"),
        "events_doubt": entry("string", "why the events are not certain; empty if they are"),
        "horizon": entry(NUMBER, "the last sample that is predicted, s; null: all are"),
        "uncertified": {
            "type": "array",
            "items": {"type": "string"},
            "description": "reasons, such as closest points that no contact could follow",
        },
        "rhs_evals": entry("integer", "evaluations of the right-hand side that it took", minimum=0),
    },
) | {"type": ["object", "null"]}
_CONTACT = record(
    "what a contact carries",
    {
        "force": entry(NUMBER, "along its normal, N"),
        "friction": numbers(3, "N, world axes, on the second body of its kind"),
    },
)
_PROPERTIES = {
    "scene": entry("string", "name of the scene"),
    "parameters": entry(
        "object", "the scene's parameters, their values in this run", additionalProperties={"type": NUMBER}
    ),
    "inputs": entry(
        "object", "the scene's inputs, their values in this run", additionalProperties={"type": NUMBER}
    ),
    "t_end": entry(NUMBER, "time that the run reached, s"),
    "outcome": entry("string", "done, interrupted, or what stopped the run"),
    "advice": entry("string", "what the outcome means and what to do about it"),
    "outcome_contact": entry("string", "the contact that the outcome speaks of, or empty"),
    "outcome_function": entry(
        "string", "the load, path or motion that is not finite where the run ends, or empty"
    ),
    "accuracy": entry("string", "the Accuracy that was used"),
    "warnings": {
        "type": "array",
        "items": {"type": "string"},
        "description": "what the user should know of the run, such as a margin that fell low",
    },
    "estimate": _ESTIMATE,
    "trusted": entry("boolean", "whether nothing speaks against the run"),
    "doubts": {
        "type": "array",
        "items": {"type": "string"},
        "description": "reasons why the run cannot be trusted; empty if it can",
    },
    "doubt_kinds": {
        "type": "array",
        "items": {"type": "string", "enum": list(DOUBT_KINDS)},
        "description": "what the figures of the run itself speak against, without a second run",
    },
    "steps": entry("integer", "accepted integration steps", minimum=0),
    "rejected": entry("integer", "steps repeated with a smaller size", minimum=0),
    "rhs_evals": entry("integer", "evaluations of the right-hand side", minimum=0),
    "solver": entry("string", "what solves for forces and impulses"),
    "solves": {
        "type": "object",
        "additionalProperties": {"type": "integer", "minimum": 1},
        "description": "how many complementarity problems each solver has solved, corrections of positions "
        "among them",
    },
    "solve_residual_max": entry(
        NUMBER, "largest residual of one, of the largest velocity or acceleration in it", minimum=0
    ),
    "wall_s": entry(NUMBER, "wall-clock time of the run, s"),
    "energy_drift": entry(
        NUMBER,
        "max |E - E0 - work - corrections| / max kinetic energy; of what rests, / characteristic energy",
    ),
    "correction_energy": entry(
        NUMBER,
        "sum of the amounts by which corrections of positions in time-stepping changed the energy, over it",
        minimum=0,
    ),
    "gap_max": entry(NUMBER, "largest |d| of a closed contact at an accepted step, m"),
    "penetration_max": entry(
        NUMBER, "deepest penetration of a pair of bodies with a contact, at an accepted step, m"
    ),
    "penetration_t": entry(NUMBER, "time of the deepest penetration, s"),
    "penetration_pair": entry("string", "the pair that penetrates deepest, or empty"),
    "joint_error_max": entry(
        NUMBER, "largest deviation from the equations of the joints at the start and at accepted steps, m"
    ),
    "complementarity_max": entry(
        NUMBER,
        "largest |min(gap / L, force / (M L / T^2))| at an accepted step; L, M, T: model scales",
    ),
    "margin_min": entry(
        NUMBER, "smallest dimensionless distance of a closed contact to singularity, at most 1"
    ),
    "redundant_max": entry(
        "integer",
        "most force-carrying contacts beyond the rank of their rows; their forces are those of minimum norm, "
        "each weighted by the square root of its diagonal entry of J M^-1 J^T",
    ),
    "indeterminate_t": entry(
        ["number", "null"],
        "s, first time at which another motion was found under friction forces that are not unique, or could "
        "not be sought, or at which a load that jumps left the motion open; or null",
    ),
    "indeterminate_load": entry("string", "that load, or empty"),
    "indeterminate_contact": entry(
        "string", "the contact at which the other motion that was found differs most, or empty"
    ),
    "indeterminate_part": entry(
        "number", "change of the acceleration there, as a part of the largest without forces"
    ),
    "unfollowed_minima": entry(
        "integer",
        "how often a search found closest points of a pair within reach that no contact of it was free to "
        "follow; above 0 the pair may penetrate there, see `points` of [[contact]]",
    ),
    "incomplete_searches": entry(
        "integer",
        "searches for the closest points of two features that were given up before all were found, as where "
        "surfaces conform; above 0 a contact may be missed",
    ),
    "search_effort": entry(
        "integer", "pairs of cells of surfaces and curves looked at in searches for closest points", minimum=0
    ),
    "undeclared": entry(
        "array",
        "pairs of shapes that no contact lists and that passed through each other, in order of time",
        items=_PASSAGE,
    ),
    "over_edges": entry(
        "array",
        "shapes with an open edge or end, which touches nothing, and those that it passed through, by time",
        items=_PASSAGE,
    ),
    "events": entry("array", "changes of mode in order of time", items=_EVENT),
    "contacts": entry(
        "object",
        "each contact that presses at the last sample, and limit struck",
        additionalProperties=_CONTACT,
    ),
    "joints": entry("object", "each joint at the last sample", additionalProperties=_JOINT),
    "patches": entry("object", "each pair of faces that rest on each other", additionalProperties=_PATCH),
    "sensors": entry(
        "object",
        "each component of a sensor at the last sample, null where it is not known",
        additionalProperties={"type": ["number", "null"]},
    ),
    "final": entry("object", "each body at the last sample", additionalProperties=BODY_STATE),
    "kinds": entry("array", "names of the kinds the model uses", items={"type": "string"}),
    "instructions": entry(
        "object", "instructions of each generated function", additionalProperties={"type": "integer"}
    ),
    "out": entry(["string", "null"], "the file that holds the run, or null"),
    "plot": entry(["string", "null"], "the file that holds its picture, or null"),
}


def result_schema() -> dict[str, Any]:
    """JSON Schema (draft 2020-12) of the object that `simulate --json` prints."""
    return record("The object that `modelgen simulate --json` prints. SI units, world axes.", _PROPERTIES)
