"""Names that the expressions of a scene may use for numbers: its parameters and its constants."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from modelgen.scene.expression import CONSTANTS, Expression, parse_expression
from modelgen.scene.expression_functions import FUNCTIONS
from modelgen.scene.scalar_types import NUMBER, ExpressionText, Text
from modelgen.scene.source_location import Kink, Motion, Place
from modelgen.scene.table_types import NamedNumbers

VARIABLES = ("t", "u", "v", "x", "y", "z", "vx", "vy", "vz", "wx", "wy", "wz", "qw", "qx", "qy", "qz")
RESERVED = (*VARIABLES, *CONSTANTS, *FUNCTIONS)
NAMED = NamedNumbers(
    rf"^(?!({'|'.join(RESERVED)})$)[A-Za-z](?!.*__)[A-Za-z0-9_]{{0,31}}$",
    f"a letter, then letters, digits, single _ are allowed, but not {' '.join(RESERVED)}",
)
NAME_OF_CONSTANT = Text(NAMED.pattern, NAMED.allowed)
_TEXT = ExpressionText("expression of other constants")


def with_constants(place: Place, written: object, parameters: Mapping[str, float]) -> Place:
    """The place of a scene, whose expressions may use its parameters and the constants in its table.

    Raises SceneError.
    """
    constants = dict(parameters)
    following = {name: frozenset((name,)) for name in parameters}
    if isinstance(written, Mapping) and "constants" in written:
        at = place.key("constants")
        parsed = _parsed(written["constants"], replace(at, constants=constants))
        for name in parsed:
            _find(name, parsed, constants, (), at)
        following |= _following(parsed, following)
    return replace(place, constants=constants, following=following)


def along(place: Place, written: object, parameter: str, step: float) -> Place:
    """The place of a scene, whose numbers move by `step` times their derivatives by a parameter.

    Raises SceneError.
    """
    motion = Motion({parameter: 1.0}, step, [], [])
    if isinstance(written, Mapping) and "constants" in written:
        at = place.key("constants")
        texts = NAMED.named(written["constants"], at)
        rates: dict[str, float] = {parameter: 1.0}
        for name in texts:
            _find_rate(name, texts, parameter, rates, at, motion)
        motion = replace(motion, rates=rates)
    return replace(place, motion=motion)


def _find_rate(
    name: str, texts: Mapping[str, object], parameter: str, rates: dict[str, float], at: Place, motion: Motion
) -> None:
    """Add the derivative of a constant that follows from a parameter, those that it is made of first."""
    if name in rates or parameter not in at.following.get(name, ()):
        return
    place = at.key(name)
    expression = parse_expression(_TEXT.read(texts[name], place), at.constants)
    for other in sorted(expression.names):
        _find_rate(other, texts, parameter, rates, at, motion)
    found = place.tangent(expression, rates)
    rates[name] = found.rate
    if found.is_kink:
        motion.kinks.append(Kink(place.path, found.is_lost))


def _parsed(written: object, place: Place) -> Mapping[str, Expression]:
    """The constants in the table of a scene as expressions of each other, whatever their order."""
    texts = {name: _TEXT.read(each, place.key(name)) for name, each in NAMED.named(written, place).items()}
    return {name: place.key(name).expression(text, tuple(texts)) for name, text in texts.items()}


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


def _following(
    parsed: Mapping[str, Expression], parameters: Mapping[str, frozenset[str]]
) -> dict[str, frozenset[str]]:
    """The parameters that each constant follows from, of those that follow from any."""
    found: dict[str, frozenset[str]] = {}

    def of(name: str) -> frozenset[str]:
        if name not in found:
            others = (of(other) for other in parsed[name].names)
            found[name] = (parsed[name].constants & parameters.keys()).union(*others)
        return found[name]

    return {name: of(name) for name in parsed if of(name)}
