"""The JSON Schemas of what `measure` and `tune` print with `--json`: every entry's meaning and unit."""

from __future__ import annotations

from typing import Any

_NUMBER = ["number", "null"]
_TEXTS = {"type": "array", "items": {"type": "string"}}


def _entry(kind: str | list[str], meaning: str, **more: Any) -> dict[str, Any]:
    return {"type": kind, "description": meaning, **more}


def _object(meaning: str, properties: dict[str, Any]) -> dict[str, Any]:
    return _entry(
        "object", meaning, properties=properties, required=list(properties), additionalProperties=False
    )


_ERRORS = _entry(
    "object",
    "position m, rotation rad, force (root mean square, over the reference's), events s with the number that "
    "has no like, energy, gap and joints (over the length) of the whole run; beyond: of distributions after "
    "the horizon",
)
_SETTINGS = _entry("object", "the value of each knob that matters, as the keys of [run]")
_COST = _entry(_NUMBER, "CPU time of the core, ns per simulated second; null: no run that counts")
_POINT = _object(
    "one setting",
    {
        "settings": _SETTINGS,
        "error": _entry(
            _NUMBER, "largest distance of body points from the reference up to the horizon, over the length"
        ),
        "cost_ns_per_s": _COST,
        "errors": _ERRORS,
        "costs": _entry(
            "object",
            "noise (spread of repeats, relative), yard_s (the yardstick beside it), steps, rhs_evals, "
            "instructions_per_s (per simulated second, by callgrind as compiled for Haswell; of points on "
            "the front; null: not counted), binary_bytes, compile_s (null: compiled before); of a peer noise "
            "and yard_s",
        ),
        "remark": _entry("string", "why there is no error, or empty"),
    },
)
_POINTS = {"type": "array", "items": _POINT}
_REFERENCE = _object(
    "what errors are measured against",
    {
        "made_by": _entry("array", "forms and settings of the two runs", items={"type": "string"}),
        "error": _entry("number", "their largest distance up to the horizon, over the length"),
        "horizon": _entry(_NUMBER, "s; null: the whole span can be predicted"),
        "reason": _entry("string", "of the horizon, or empty"),
        "growth": _entry("number", "of one rounding of double precision, up to the horizon"),
        "end": _entry("number", "where the runs ended, s"),
        "ending": _entry("string", "why, if before the end of the span"),
        "spread": _entry("object", "beyond the horizon, between the distributions of the two"),
    },
)
_PEER = _object(
    "another simulator",
    {
        "version": _entry("string", "of the simulator"),
        "cannot": _TEXTS | {"description": "what of the scene it cannot represent; then it has no points"},
        "differs": _TEXTS | {"description": "what it represents otherwise"},
        "advantage": _entry(
            ["object", "null"],
            "at its best error within 1 s of CPU time per simulated second: both costs, how many times "
            "cheaper the scene runs here at no more error, the digits gained at no more cost; null: "
            "no such point",
        ),
        "front": _POINTS,
        "points": _POINTS,
    },
)


def measured_schema() -> dict[str, Any]:
    """JSON Schema (draft 2020-12) of the object that `measure --json` prints."""
    return _object(
        "what accuracy of a scene costs",
        {
            "scene": _entry("string", "name of the scene"),
            "until": _entry("number", "span, s"),
            "samples": _entry("integer", "output intervals that are compared"),
            "length": _entry("number", "characteristic length that errors are relative to, m"),
            "knobs": _entry("object", "the knobs that were turned, with their values"),
            "left_out": _entry("object", "the knobs that were not: what they trade"),
            "reference": _REFERENCE,
            "reference_error": _entry("number", "the error of the reference; none below it is claimed"),
            "horizon": _entry(_NUMBER, "s, up to which trajectories are compared; null: the whole span"),
            "noise": _entry(_NUMBER, "median spread of repeated runs, relative; null: none was repeated"),
            "not_counted": _entry("string", "why no instructions are counted, or empty"),
            "front": _POINTS | {"description": "the settings that none beats, by rising cost"},
            "points": _POINTS | {"description": "all settings, in the order in which they were tried"},
            "peers": _entry("object", "by name", additionalProperties=_PEER),
            "interrupted": _entry("string", "why it stopped early, or empty"),
            "reused": _entry("integer", "measurements that were remembered"),
            "plot": _entry(["string", "null"], "the file that holds the picture, or null"),
        },
    )


def tuned_schema() -> dict[str, Any]:
    """JSON Schema (draft 2020-12) of the object that `tune --json` prints."""
    return _object(
        "a setting that met its demand on a fresh run",
        {
            "scene": _entry("string", "name of the scene"),
            "error": _entry("number", "of the fresh run, over the length"),
            "cost_ns_per_s": _COST,
            "settings": _SETTINGS,
            "errors": _ERRORS,
            "reference_error": _entry("number", "the error of the reference"),
            "horizon": _entry(_NUMBER, "s; null: the whole span can be predicted"),
            "length": _entry("number", "characteristic length that errors are relative to, m"),
            "file": _entry("string", "the scene with these settings in [run]"),
        },
    )
