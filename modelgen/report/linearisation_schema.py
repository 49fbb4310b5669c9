"""The JSON Schemas of what `linearise` prints with `--json`: every entry's meaning and unit."""

from __future__ import annotations

from typing import Any

from modelgen.report.run_schema import BODY_STATE
from modelgen.report.schema_parts import NUMBER, entry, numbers, record

_SHAPE = entry(
    "object",
    "each dynamic body's part, the largest entry 1",
    additionalProperties=record(
        "of a body", {"v": numbers(3, "world axes"), "w": numbers(3, "body axes, rad")}
    ),
)
_HELD = {
    "force": entry(
        "object", "of each contact that touches, along its normal, N", additionalProperties={"type": NUMBER}
    ),
    "friction": entry(
        "object",
        "of each contact that touches and has friction",
        additionalProperties=record(
            "of a contact that sticks",
            {
                "force": numbers(3, "along the surfaces on the second body of the pair, N, world axes"),
                "share": entry(
                    NUMBER, "of its static friction, or of the resistance that is taken up most; at most 1"
                ),
            },
        ),
    ),
    "redundant": entry(
        "integer",
        "rows of the contacts that touch beyond their rank; above 0 the forces are not unique: those of "
        "minimum norm, or others where friction holds no such",
    ),
}


def _bodies(when: str, *keys: str) -> dict[str, Any]:
    """Of each dynamic body, parts of its state."""
    states = record(when, {key: BODY_STATE["properties"][key] for key in keys})
    return entry("object", f"each dynamic body {when}", additionalProperties=states)


_RATES = {
    "kind": entry("string", "oscillation, growth, decay, or neutral (it may be moved along)"),
    "frequency": entry(NUMBER, "rad/s"),
    "hertz": entry(NUMBER, "frequency / 2 pi, Hz"),
    "growth": entry(NUMBER, "1/s; negative where it dies out"),
}
_LINEARISED = {
    "scene": entry("string", "name of the scene"),
    "bodies": _bodies("at rest", "p", "quaternion"),
    **_HELD,
    "modes": entry(
        "array",
        "small motions exp(growth t) (shape cos(frequency t) - quadrature sin(frequency t)), by frequency; "
        "none where contacts hold all bodies",
        items=record(
            "a small motion",
            {
                **_RATES,
                "shape": _SHAPE,
                "quadrature": _SHAPE,
            },
        ),
    ),
}
_STEADY = {
    "scene": entry("string", "name of the scene"),
    "bodies": _bodies("in the steady motion", "p", "quaternion", "v", "w"),
    **_HELD,
    "symmetries": entry("integer", "independent directions along which the scene does not change"),
    "modes": entry(
        "array",
        "small motions exp(growth t) (shape cos(frequency t) - quadrature sin(frequency t)) of places, and "
        "with rate of velocities, seen by axes that the steady motion carries along; by frequency",
        items=record(
            "a small motion",
            {
                **_RATES,
                "shape": _SHAPE,
                "quadrature": _SHAPE,
                "rate": _SHAPE,
                "rate_quadrature": _SHAPE,
            },
        ),
    ),
}
_STABILITY = {
    "scene": entry("string", "name of the scene"),
    "parameter": entry("string", "the parameter that varies"),
    "stable": entry("array", "ranges of it in which no small motion grows", items=numbers(2, "from, to")),
    "values": entry("array", "of the parameter, ascending", items={"type": NUMBER}),
    "refused": entry(
        "array",
        "values without such a motion, and why",
        items={"type": "array", "prefixItems": [{"type": NUMBER}, {"type": "string"}]},
    ),
    "eigenvalues": entry(
        "array",
        "at each value those of the small motions, 1/s, in the order of the value before",
        items={"type": "array", "items": numbers(2, "real part, imaginary part")},
    ),
    "plot": entry(["string", "null"], "the file that holds the picture, or null"),
}


def linearised_schema() -> dict[str, Any]:
    """JSON Schema (draft 2020-12) of the object that `linearise --json` prints."""
    return record("The object that `modelgen linearise --json` prints. SI units, world axes.", _LINEARISED)


def steady_schema() -> dict[str, Any]:
    """JSON Schema (draft 2020-12) of the object that `linearise --steady --json` prints."""
    return record(
        "The object that `modelgen linearise --steady --json` prints. SI units, world axes.", _STEADY
    )


def stability_schema() -> dict[str, Any]:
    """JSON Schema (draft 2020-12) of the object that `linearise --vary --json` prints."""
    return record("The object that `modelgen linearise --vary --json` prints. SI units.", _STABILITY)
