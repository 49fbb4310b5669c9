"""Output of `sensitivity`: derivatives of a run, their errors and verdicts, and differences of runs."""

from __future__ import annotations

from typing import Any

from rich.console import Console
from rich.table import Table

from modelgen.report.schema_parts import NUMBER, entry, record
from modelgen.runtime.sensitivity import DOUBTS, SIDES, VERDICTS, Sensitivity
from modelgen.runtime.tables.ctypes_structures import Array


def sensitivity_facts(found: Sensitivity, differences: Array | None) -> dict[str, Any]:
    """The object that `sensitivity --json` prints."""
    return {
        "t": found.t.tolist(),
        "of": list(found.of),
        "by": list(found.by),
        "value": found.value.tolist(),
        "jacobian": found.jacobian.tolist(),
        "sides": found.sides.tolist(),
        "error": None if found.error is None else found.error.tolist(),
        "differences": None if differences is None else differences.tolist(),
        "verdicts": [
            {"kind": each.kind, "reason": each.reason, "t": each.t, "contact": each.contact}
            for each in found.verdicts
        ],
        "events": [{"t": each.t, "contact": each.contact, "by": each.by.tolist()} for each in found.events],
        "outcome": "done" if found.outcome is None else found.outcome.name.lower(),
    }


def print_sensitivity(facts: dict[str, Any], console: Console) -> None:
    """The same for people."""
    for k, t in enumerate(facts["t"]):
        console.print(_table_at(facts, k, t), soft_wrap=True)
        verdict = facts["verdicts"][k]
        where = f" at {verdict['contact']}" if verdict["contact"] else ""
        told = f": {verdict['reason']}, t = {verdict['t']:.6g} s{where}" if verdict["reason"] else ""
        console.print(f"{verdict['kind']}{told}\n", highlight=False, soft_wrap=True)


def _table_at(facts: dict[str, Any], k: int, t: float) -> Table:
    """The values and derivatives at one of the times."""
    table = Table(title=f"t = {t:g} s", title_justify="left", box=None, pad_edge=False)
    columns = {"derivative": (facts["jacobian"], ".8g")}
    columns |= {"error": (facts["error"], ".1e")} if facts["error"] else {}
    columns |= {"differences": (facts["differences"], ".8g")} if facts["differences"] else {}
    sides = facts["sides"][k]
    if any(side != SIDES[0] for row in sides for side in row):
        columns |= {"holds for": (facts["sides"], "")}
    for heading in ("", "value", "by", *columns):
        table.add_column(heading, justify="left" if heading in ("", "by") else "right", no_wrap=True)
    for i, name in enumerate(facts["of"]):
        for j, by in enumerate(facts["by"]):
            row = [name, f"{facts['value'][k][i]:.8g}"] if not j else ["", ""]
            row += [by, *(f"{values[k][i][j]:{form}}" for values, form in columns.values())]
            table.add_row(*row)
    return table


def sensitivity_schema() -> dict[str, Any]:
    """The JSON Schema of that object."""

    def nested(depth: int, meaning: str, of: Any = NUMBER, **more: Any) -> dict[str, Any]:
        items: dict[str, Any] = {"type": of}
        for _ in range(depth):
            items = {"type": "array", "items": items}
        return items | {"description": meaning} | more

    array_or_null = {"type": ["array", "null"]}
    verdict = {
        "kind": entry("string", "whether the derivatives hold up to the time", enum=list(VERDICTS)),
        "reason": entry("string", "the first cause of doubt, or empty", enum=list(DOUBTS)),
        "t": entry("number", "time of that cause, s"),
        "contact": entry("string", "its contact, or the number of the scene that is on a kink; or empty"),
    }
    event = {
        "t": entry("number", "time of an event, s"),
        "contact": entry("string", "its contact"),
        "by": nested(1, "derivatives of that time, by each of `by`"),
    }
    names = {"type": "array", "items": {"type": "string"}}
    return record(
        "what `sensitivity --json` prints. SI units",
        {
            "t": nested(1, "times, s"),
            "of": {**names, "description": "components that are differentiated"},
            "by": {**names, "description": "numbers by which they are differentiated"},
            "value": nested(2, "by time and component; null: the run ended before"),
            "jacobian": nested(3, "derivatives by time, component and number; null: the run ended before"),
            "sides": nested(
                3, f"for changes to which side each derivative holds: {', '.join(SIDES)}", "string"
            ),
            "error": nested(
                3, "estimated errors of them; null: the companion run ended early", **array_or_null
            ),
            "differences": nested(
                3, "the same by differences of runs; null without --check", **array_or_null
            ),
            "verdicts": {"type": "array", "items": record("up to a time", verdict)},
            "events": {"type": "array", "items": record("an event whose time is differentiated", event)},
            "outcome": entry("string", "how the run ended"),
        },
    )
