"""The JSON Schemas of what `measure` and `tune` print with `--json`: every entry's meaning and unit."""

from __future__ import annotations

from typing import Any

from modelgen.report.schema_parts import NUMBER, TEXTS, entry, record

_ERRORS = entry(
    "object",
    "position m, rotation rad, force (root mean square, over the reference's), events s with the number that "
    "has no like, energy, gap and joints (over the length) of the whole run; beyond: of distributions after "
    "the horizon",
)
_SETTINGS = entry("object", "the value of each knob that matters, as the keys of [run]")
_COST = entry(NUMBER, "CPU time of the core, ns per simulated second; null: no run that counts")
_POINT = record(
    "one setting",
    {
        "settings": _SETTINGS,
        "error": entry(
            NUMBER, "largest distance of body points from the reference up to the horizon, over the length"
        ),
        "cost_ns_per_s": _COST,
        "errors": _ERRORS,
        "costs": entry(
            "object",
            "noise (spread of repeats, relative), yard_s (the yardstick beside it), steps, rhs_evals, "
            "instructions_per_s (per simulated second, by callgrind as compiled for Haswell; of points on "
            "the front; null: not counted, as long double and runs beyond 0.2 s are not), binary_bytes, "
            "compile_s (null: compiled before); of a peer noise and yard_s",
        ),
        "remark": entry("string", "why there is no error, or empty"),
    },
)
_POINTS = {"type": "array", "items": _POINT}
_REFERENCE = record(
    "what errors are measured against",
    {
        "made_by": entry("array", "forms and settings of the two runs", items={"type": "string"}),
        "error": entry("number", "their largest distance up to the horizon, over the length"),
        "horizon": entry(NUMBER, "s; null: the whole span can be predicted"),
        "reason": entry("string", "of the horizon, or empty"),
        "growth": entry("number", "of one rounding of double precision, up to the horizon"),
        "end": entry("number", "where the runs ended, s"),
        "ending": entry("string", "why, if before the end of the span"),
        "spread": entry("object", "beyond the horizon, between the distributions of the two"),
    },
)
_PEER = record(
    "another simulator",
    {
        "version": entry("string", "of the simulator"),
        "cannot": TEXTS | {"description": "what of the scene it cannot represent; then it has no points"},
        "differs": TEXTS | {"description": "what it represents otherwise"},
        "knobs": TEXTS | {"description": "its settings that were varied"},
        "advantage": entry(
            ["object", "null"],
            "at its best error within 1 s of CPU time per simulated second: both costs, how many times "
            "cheaper the scene runs here at no more error, the digits gained at no more cost; null: "
            "no such point, or --knobs names none of its knobs",
        ),
        "front": _POINTS,
        "points": _POINTS,
    },
)


def measured_schema() -> dict[str, Any]:
    """JSON Schema (draft 2020-12) of the object that `measure --json` prints."""
    return record(
        "what accuracy of a scene costs",
        {
            "scene": entry("string", "name of the scene"),
            "until": entry("number", "span, s"),
            "samples": entry("integer", "output intervals that are compared"),
            "length": entry("number", "characteristic length that errors are relative to, m"),
            "knobs": entry("object", "the knobs that were turned, with their values"),
            "left_out": entry("object", "the knobs that were not: what they trade"),
            "reference": _REFERENCE,
            "reference_error": entry("number", "the error of the reference; none below it is claimed"),
            "horizon": entry(NUMBER, "s, up to which trajectories are compared; null: the whole span"),
            "noise": entry(NUMBER, "median spread of repeated runs, relative; null: none was repeated"),
            "not_counted": entry("string", "why no instructions are counted, or empty"),
            "front": _POINTS | {"description": "the settings that none beats, by rising cost"},
            "points": _POINTS | {"description": "all settings, in the order in which they were tried"},
            "peers": entry("object", "by name", additionalProperties=_PEER),
            "interrupted": entry("string", "why it stopped early, or empty"),
            "reused": entry("integer", "points that were remembered, and not measured anew"),
            "plot": entry(["string", "null"], "the file that holds the picture, or null"),
        },
    )


def tuned_schema() -> dict[str, Any]:
    """JSON Schema (draft 2020-12) of the object that `tune --json` prints."""
    return record(
        "a setting that met its demand on a fresh run",
        {
            "scene": entry("string", "name of the scene"),
            "error": entry("number", "of the fresh run, over the length"),
            "cost_ns_per_s": _COST,
            "settings": _SETTINGS,
            "errors": _ERRORS,
            "reference_error": entry("number", "the error of the reference"),
            "horizon": entry(NUMBER, "s; null: the whole span can be predicted"),
            "length": entry("number", "characteristic length that errors are relative to, m"),
            "interrupted": entry("string", "why not all settings were tried, or empty"),
            "file": entry("string", "the scene with these settings in [run]"),
        },
    )
