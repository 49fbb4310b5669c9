"""What to say of a key that a table does not know: the word it has here, where it belongs, or what it is
like."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from modelgen.name_suggestions import nearest, synonym

_RUN = "it belongs to [run]"
_CONTACT = "it belongs to a [[contact]]"
ELSEWHERE: Mapping[str, str] = {  # keys that are often looked for in another table
    "gravity": "gravity stands at the top of the file, before the first table",
    **dict.fromkeys(("until", "samples", "accuracy", "tolerance", "method", "step"), _RUN),
    **dict.fromkeys(("friction", "mu", "restitution"), _CONTACT),
    **dict.fromkeys(("fixed", "static"), 'write motion = "fixed"'),
    "axis": "the axis of a joint is z of its frame: turn that with rpy, axis_angle or rotation",
    **dict.fromkeys(("color", "colour", "material"), "pictures take no colours from a scene: leave it out"),
}


def meant(key: str, known: Iterable[str]) -> str:
    """The remedy for an unknown key of a table with the keys `known`, or an empty text."""
    names = list(known)
    return synonym(key, names) or ELSEWHERE.get(key.lower(), "") or nearest(key, names)
