"""The JSON Schema of what `measure --extremes` prints with `--json`."""

from __future__ import annotations

from typing import Any

from modelgen.report.schema_parts import NUMBER, TEXTS, entry, record

_VERDICT = {"enum": ["safe", "warned", "refused"]}
_VALUE = record(
    "one value",
    {
        "value": entry("number", "of what is driven"),
        "error": entry(NUMBER, "as `measured` says; null: no result"),
        "allowed": entry("number", "by the law"),
        "verdict": _VERDICT | {"description": "what the user is told"},
        "expected": _VERDICT | {"description": "by the thresholds"},
        "told": TEXTS | {"description": "warnings, or why there is no result"},
        "holds": entry("boolean", "the verdict is the expected one, and the error within its law"),
    },
)
_EXTREME = record(
    "a number of a scene that is driven to its end",
    {
        "name": entry("string", "what is driven"),
        "of": entry("string", "which number that is, with its unit"),
        "law": entry("string", "how the error is expected to grow"),
        "measured": entry("string", "which error that is"),
        "warned": entry(NUMBER, "from this value on the user is warned; null: never"),
        "refused": entry(NUMBER, "from this value on there is no result; null: never"),
        "switched": entry(NUMBER, "from this value on another model takes over; null: never"),
        "switch": entry("string", "which, or empty"),
        "values": {"type": "array", "items": _VALUE},
    },
)


def surveyed_schema() -> dict[str, Any]:
    """JSON Schema (draft 2020-12) of the object that `measure --extremes --json` prints."""
    return record(
        "what happens at the ends of double precision",
        {
            "extremes": {"type": "array", "items": _EXTREME},
            "holds": entry("boolean", "all values hold"),
            "interrupted": entry("boolean", "there would be more"),
        },
    )
