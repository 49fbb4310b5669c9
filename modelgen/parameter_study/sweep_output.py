"""Output of `sweep`: how many runs ended how, and where the table is."""

from __future__ import annotations

from typing import Any

import numpy as np
from rich.console import Console

from modelgen.parameter_study.outcome_table import Sweep
from modelgen.parameter_study.rows import ERRORS
from modelgen.parameter_study.sweep_folder import RUNS, TABLE
from modelgen.report.schema_parts import NUMBER, TEXTS, entry, record

FIRST = 5  # failed runs that are told


def sweep_facts(found: Sweep) -> dict[str, Any]:
    """The object that `sweep --json` prints, less the picture."""
    plan, failed = found.plan, np.flatnonzero(found.failed).tolist()
    return {
        "scene": plan["scene"],
        "design": plan["design"]["design"],
        "seed": plan["design"]["seed"],
        "runs": plan["runs"],
        "known": found.known,
        "varied": {
            name: {"least": _end(found, name, np.min), "greatest": _end(found, name, np.max)}
            for name in found.varied
        },
        "outcomes": dict(found.outcomes),
        "trusted": int(np.nansum(found["trusted"])),
        "failed": [
            {
                "run": row["run"],
                "numbers": {name: row[name] for name in found.varied},
                "outcome": row["outcome"],
                "message": row["message"],
            }
            for row in found.rows(failed[:FIRST])
        ],
        "errors": {name: _largest(found, f"error.{name}") for name in ERRORS[:4]},
        "rhs_evals": int(np.nansum(found["rhs_evals"]) + np.nansum(found["error.rhs_evals"])),
        "table": None if found.folder is None else str(found.folder / TABLE),
        "kept": str(found.folder / RUNS) if found.folder and plan["keep"] else None,
    }


def print_sweep(facts: dict[str, Any], console: Console) -> None:
    """The same for people."""

    def say(text: str) -> None:
        console.print(text, markup=False, highlight=False, soft_wrap=True)

    told = ", ".join(f"{count} {name}" for name, count in facts["outcomes"].items())
    before = f", {facts['known']} of them before" if facts["known"] else ""
    say(f"{facts['scene']}: {facts['runs']} runs ({facts['design']}){before}: {told}")
    for name, ends in facts["varied"].items():
        say(f"{name}  from {ends['least']:.6g} to {ends['greatest']:.6g}")
    units = zip(facts["errors"].values(), ("m", "rad", "m/s", "rad/s"), strict=True)
    known = [f"{error:.2g} {unit}" for error, unit in units if error is not None]
    if known:
        say(f"largest estimated errors at the end: {', '.join(known)}")
    say(f"trusted: {facts['trusted']} of {facts['runs']}")
    for each in facts["failed"]:
        numbers = ", ".join(f"{name} = {value:.6g}" for name, value in each["numbers"].items())
        say(f"run {each['run']} ({numbers}): {each['outcome']}: {each['message']}")
    more = sum(count for name, count in facts["outcomes"].items() if name != "done") - len(facts["failed"])
    if more > 0:
        say(f"... {more} more failed; the table holds all")
    written = [facts["table"], facts.get("plot")]
    say(f"written: {', '.join(file for file in written if file)}")


def swept_schema() -> dict[str, Any]:
    """The JSON Schema of that object."""
    by_name = {"additionalProperties": {"type": NUMBER}}
    ends = record(
        "a number that varies",
        {"least": entry("number", "of its values"), "greatest": entry("number", "of them")},
    )
    failed = {
        "run": entry("integer", "its number, from 0 on"),
        "numbers": entry("object", "those that vary, its values", **by_name),
        "outcome": entry("string", "refused, or what stopped it"),
        "message": entry("string", "why"),
    }
    return record(
        "what `sweep --json` prints",
        {
            "scene": entry("string", "name of the scene"),
            "design": entry("string", "grid, sobol, latin or random"),
            "seed": entry("integer", "of the draws"),
            "runs": entry("integer", "in the table"),
            "known": entry("integer", "of them, done before this command"),
            "varied": {
                "type": "object",
                "description": "columns of the numbers that vary",
                "additionalProperties": ends,
            },
            "outcomes": entry("object", "how many runs ended how", additionalProperties={"type": "integer"}),
            "trusted": entry("integer", "runs against which nothing speaks"),
            "failed": {"type": "array", "items": record("one of the first failed runs", failed)},
            "errors": entry("object", "largest estimated errors of final states; null: not known", **by_name),
            "rhs_evals": entry("integer", "evaluations of the right-hand side, with companions"),
            "table": entry("string", "the file of the table"),
            "kept": entry(["string", "null"], "the folder of whole runs"),
            "columns": {**TEXTS, "description": "of the table"},
            "plot": entry(["string", "null"], "file of the picture"),
        },
    )


def _end(found: Sweep, name: str, which: Any) -> float:
    return float(which(found[name]))


def _largest(found: Sweep, name: str) -> float | None:
    """The largest of the known values of a column."""
    values = found[name]
    finite = values[np.isfinite(values)]
    return float(finite.max()) if finite.size else None
