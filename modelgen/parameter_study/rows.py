"""The row of a run in the table of a sweep, and the columns of that table."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from modelgen.notation import component_names
from modelgen.runtime.trajectory import EVENT_KINDS, Outcome, Trajectory

Row = dict[str, Any]
WHOLE, REAL, TEXT, TRUTH = "int64", "double", "string", "bool"  # types of columns
REFUSED = "refused"  # outcome of a run that could not start
STATES = (("p", "xyz"), ("quaternion", "wxyz"), ("v", "xyz"), ("w", "xyz"))
HEAD = {"run": WHOLE, "seed": WHOLE}
ENDING = {"outcome": TEXT, "message": TEXT, "trusted": TRUTH, "doubts": TEXT, "t_end": REAL}
ENERGY = {"energy": REAL, "work": REAL, "energy_drift": REAL}
LEDGER = ("gap_max", "penetration_max", "joint_error_max", "complementarity_max", "margin_min")
COST = ("steps", "rejected", "rhs_evals")
ERRORS = ("position", "rotation", "velocity", "spin", "gap", "force", "events")
COMPANION = {"error.events_unmatched": WHOLE, "error.rhs_evals": WHOLE}


def columns_of(instance: Mapping[str, Any], varied: Sequence[str]) -> dict[str, str]:
    """The columns of a table of a library's instance with their types, in order."""
    own = {
        **ENDING,
        **{name: REAL for body in _shown(instance) for name in _state_names(body)},
        **dict.fromkeys(("events", *(f"events.{kind}" for kind in EVENT_KINDS)), WHOLE),
        "error.status": TEXT,
        **{f"error.{name}": REAL for name in ERRORS},
        **COMPANION,
        **ENERGY,
        **dict.fromkeys(LEDGER, REAL),
        **dict.fromkeys(COST, WHOLE),
    }
    names = varied_columns(varied)
    sensors = dict.fromkeys(sensor_columns(instance), REAL)
    return {**HEAD, **dict.fromkeys(names, REAL), **ENDING, **sensors, **own}


def varied_columns(varied: Sequence[str]) -> list[str]:
    """The columns of the numbers that vary: their names, after `vary.` where another column has the name."""
    return [f"vary.{name}" if name in _TAKEN else name for name in varied]


def sensor_columns(instance: Mapping[str, Any]) -> list[str]:
    """The columns of the sensors: the names of their components, after `sensor.` where another column has
    the name."""
    names = component_names(instance["sensors"]["names"])
    return [f"sensor.{name}" if name in _TAKEN else name for name in names]


def row_of(path: Trajectory, instance: Mapping[str, Any]) -> Row:
    """The row of a run, without its number and the numbers that vary."""
    last, estimate = len(path.t) - 1, path.estimate
    kinds = [event.kind for event in path.events]
    row: Row = {
        "outcome": path.outcome.name.lower(),
        "message": "" if path.outcome is Outcome.DONE else _message(path),
        "trusted": path.is_trusted,
        "doubts": "; ".join(path.doubts),
        "t_end": path.t_end,
        "events": len(path.events),
        **{f"events.{kind}": kinds.count(kind) for kind in EVENT_KINDS},
        "energy_drift": path.energy_drift,
        **{name: float(getattr(path, name)) for name in LEDGER},
        **{name: getattr(path, name) for name in COST},
    }
    if estimate is not None:
        end = {name: float(getattr(path, f"{name}_error")[-1]) for name in ERRORS[:4]}
        others = {name: getattr(estimate, name) for name in ERRORS[4:]}
        row |= {"error.status": estimate.status}
        row |= {f"error.{name}": value for name, value in {**end, **others}.items()}
        row |= {name: getattr(estimate, name.partition(".")[2]) for name in COMPANION}
    if last >= 0:
        row |= dict(zip(sensor_columns(instance), map(float, path.sensors[last].tolist()), strict=True))
        row |= {"energy": float(path.energy[last]), "work": float(path.work[last])}
        for body in _shown(instance):
            index = path.body_names.index(body)
            values = [float(value) for key, _ in STATES for value in getattr(path, key)[last, index].tolist()]
            row |= dict(zip(_state_names(body), values, strict=True))
    return row


def refused_row(error: Exception) -> Row:
    """The row of a run that could not start."""
    return {"outcome": REFUSED, "message": str(error), "trusted": False, "doubts": "it could not start"}


def _shown(instance: Mapping[str, Any]) -> list[str]:
    return [body["name"] for body in instance["bodies"] if body["motion"] != "fixed"]


def _state_names(body: str) -> list[str]:
    return [f"{body}.{key}_{axis}" for key, axes in STATES for axis in axes]


def _message(path: Trajectory) -> str:
    named = path.outcome_contact or path.outcome_function
    return f"{named}: {path.outcome.value}" if named else path.outcome.value


_TAKEN = {*HEAD, *ENDING, *ENERGY, *LEDGER, *COST, "events"}
