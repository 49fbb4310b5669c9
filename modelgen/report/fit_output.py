"""Output of `fit`: what was fitted with its confidence, what is left, and what the data cannot tell."""

from __future__ import annotations

from typing import Any

from rich.console import Console

from modelgen.identification.confidence import LEVEL
from modelgen.identification.fit import Fit
from modelgen.identification.least_squares import SAME
from modelgen.report.schema_parts import NUMBER, TEXTS, entry, record


def fit_facts(found: Fit) -> dict[str, Any]:
    """The object that `fit --json` prints."""
    sure = found.confidence
    return {
        "scene": found.scene,
        "converged": found.converged,
        "message": found.message,
        "unknowns": [
            {
                "name": name,
                "value": float(found.values[k]),
                "first": float(found.first[k]),
                "deviation": float(sure.deviation[k]),
                "half_width": float(sure.half_width[k]),
            }
            for k, name in enumerate(found.names)
        ],
        "level": LEVEL,
        "correlation": sure.correlation.tolist(),
        "unseen": list(found.unseen),
        "notes": list(found.notes),
        "noise": found.noise,
        "reduced_chi_square": sure.reduced,
        "degrees_of_freedom": sure.degrees,
        "recordings": [
            {"name": left.name, "rows": len(left.t), "rms": left.rms, "start": start}
            for left, start in zip(found.residuals, found.starts, strict=True)
        ],
        "derivatives": {
            "certain": found.counts.certain,
            "confirmed": found.counts.confirmed,
            "differences": found.counts.differences,
            "kept": found.counts.kept,
            "reasons": found.counts.reasons,
        },
        "attempts": [
            {"first": each.first.tolist(), "found": each.found.tolist(), "cost": each.cost}
            for each in found.attempts
        ],
        "runs": found.simulated,
    }


def print_fit(facts: dict[str, Any], console: Console) -> None:
    """The same for people."""

    def say(text: str) -> None:
        console.print(text, markup=False, highlight=False, soft_wrap=True)

    rows = sum(each["rows"] for each in facts["recordings"])
    state = "fitted" if facts["converged"] else "not converged"
    many = len(facts["recordings"])
    files = f"{many} recordings" if many > 1 else "one recording"
    say(f"{facts['scene']}: {state} to {rows} rows of {files} in {facts['runs']} runs")
    width = max(len(each["name"]) for each in facts["unknowns"])
    for each in facts["unknowns"]:
        known = f"+- {each['half_width']:.2g}" if each["half_width"] < float("inf") else "not seen"
        say(f"{each['name']:{width}}  {each['value']:.6g} {known}  (first guess {each['first']:.6g})")
    say(f"intervals: {100 * facts['level']:.0f} %, {facts['degrees_of_freedom']} degrees of freedom")
    for name, size in facts["noise"].items():
        say(f"noise of {name}: {size:.3g}")
    for each in facts["recordings"]:
        left = ", ".join(f"{name} {size:.3g}" for name, size in each["rms"].items())
        say(f"left of {each['name']} (root mean square): {left}")
    for text in facts["unseen"]:
        say(f"the data cannot tell: {text}")
    for text in facts["notes"]:
        say(f"note: {text}")
    if len(facts["attempts"]) > 1:
        good, several = _as_good(facts["attempts"]), len(facts["attempts"])
        say(f"first guesses: {several}, of which {good} led to the least cost")


def _as_good(attempts: list[dict[str, Any]]) -> int:
    least = min(each["cost"] for each in attempts)
    return sum(each["cost"] <= least * (1 + SAME) for each in attempts)


def fitted_schema() -> dict[str, Any]:
    """The JSON Schema of that object."""
    by_name = {"additionalProperties": {"type": NUMBER}}
    number_list = {"type": "array", "items": {"type": NUMBER}}
    unknown = {
        "name": entry("string", "of an unknown; of a start in several recordings: and the recording"),
        "value": entry(NUMBER, "SI units; of an orientation: turn from the first guess, rad, body axes"),
        "first": entry(NUMBER, "the first guess"),
        "deviation": entry(NUMBER, "standard deviation; null: not seen"),
        "half_width": entry(NUMBER, "of the interval; null: not seen"),
    }
    recording = {
        "name": entry("string", "file"),
        "rows": entry("integer", "times"),
        "rms": entry("object", "root mean square of what is left, by quantity", **by_name),
        "start": entry("object", "start of the bodies that move freely", additionalProperties=number_list),
    }
    attempt = {
        "first": {**number_list, "description": "a first guess of all unknowns"},
        "found": {**number_list, "description": "where it led; nulls where it has no run"},
        "cost": entry(NUMBER, "half the sum of squares over noise before it was estimated; null: no run"),
    }
    kinds = {
        "certain": entry("integer", "rows whose derivatives hold"),
        "confirmed": entry("integer", "rows where they are not certain, and agree with differences of runs"),
        "differences": entry("integer", "rows where differences of runs took their place"),
        "kept": entry("integer", "rows where differences of runs are not clear either"),
        "reasons": entry("object", "why, with rows", additionalProperties={"type": "integer"}),
    }
    return record(
        "what `fit --json` prints",
        {
            "scene": entry("string", "name of the scene"),
            "converged": entry("boolean", "whether the minimisation ended by itself"),
            "message": entry("string", "of the minimisation"),
            "unknowns": {"type": "array", "items": record("an unknown", unknown)},
            "level": entry("number", "of the intervals"),
            "correlation": {"type": "array", "items": number_list, "description": "of the unknowns"},
            "unseen": {**TEXTS, "description": "what the data cannot tell"},
            "notes": {**TEXTS, "description": "what limits the result"},
            "noise": entry("object", "standard deviations by column or quantity", **by_name),
            "reduced_chi_square": entry(NUMBER, "sum of squares over noise, over degrees of freedom"),
            "degrees_of_freedom": entry("integer", "measured numbers less unknowns that are seen"),
            "recordings": {"type": "array", "items": record("a recording", recording)},
            "derivatives": record("of all derivatives that were taken, in rows", kinds),
            "attempts": {"type": "array", "items": record("a first guess", attempt)},
            "runs": entry("integer", "simulations"),
            "plot": entry(["string", "null"], "file of the picture"),
        },
    )
