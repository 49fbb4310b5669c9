"""Named constants of a scene: numbers that its expressions may use by name."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from modelgen.scene.expression import CONSTANTS, Expression
from modelgen.scene.expression_functions import FUNCTIONS
from modelgen.scene.list_types import NamedNumbers
from modelgen.scene.scalar_types import NUMBER, ExpressionText
from modelgen.scene.source_location import Place

VARIABLES = ("t", "u", "v", "x", "y", "z", "vx", "vy", "vz", "wx", "wy", "wz", "qw", "qx", "qy", "qz")
RESERVED = (*VARIABLES, *CONSTANTS, *FUNCTIONS)
NAMED = NamedNumbers(
    rf"^(?!({'|'.join(RESERVED)})$)[A-Za-z](?!.*__)[A-Za-z0-9_]{{0,31}}$",
    f"a letter, then letters, digits, single _ are allowed, but not {' '.join(RESERVED)}",
)
_TEXT = ExpressionText("expression of other constants")


def with_constants(place: Place, written: object) -> Place:
    """The place of a scene, whose expressions may use the constants in its table; raises SceneError."""
    if not isinstance(written, Mapping) or "constants" not in written:
        return place
    return replace(place, constants=constants_of(written["constants"], place.key("constants")))


def constants_of(written: object, place: Place) -> Mapping[str, float]:
    """The constants in the table of a scene, whatever their order; raises SceneError."""
    texts = {name: _TEXT.read(each, place.key(name)) for name, each in NAMED.named(written, place).items()}
    parsed = {name: place.key(name).expression(text, tuple(texts)) for name, text in texts.items()}
    known: dict[str, float] = {}
    for name in parsed:
        _find(name, parsed, known, (), place)
    return known


def _find(
    name: str, parsed: Mapping[str, Expression], known: dict[str, float], above: tuple[str, ...], place: Place
) -> None:
    """Add the value of a constant, those that it is made of first; `above` are those that wait for it."""
    if name in known:
        return
    if name in above:
        ring = " -> ".join((*above[above.index(name) :], name))
        raise place.key(name).error(
            f"a constant that depends on itself: {ring}",
            "constants follow from others",
            "write one as a number",
        )
    for other in sorted(parsed[name].names):
        _find(other, parsed, known, (*above, name), place)
    known[name] = NUMBER.read(place.key(name).value(parsed[name], known), place.key(name))
