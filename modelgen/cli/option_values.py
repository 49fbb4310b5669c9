"""The values of options, whose texts are read by the rules of scene files."""

from __future__ import annotations

from contextlib import suppress
from typing import Any

from modelgen.cli.options import STYLES
from modelgen.errors import ModelgenError, SceneError
from modelgen.scene.run_choices import FORMS, REALS
from modelgen.scene.run_settings import RUN
from modelgen.scene.scalar_types import NUMBER, POSITIVE, Choice, Real, Type, Whole
from modelgen.scene.source_location import Place

TYPES: dict[str, Type] = {
    **{field.key: field.type for field in RUN.fields},
    "form": Choice(FORMS),
    "real": Choice(REALS),
    "format": Choice(STYLES),
    "verify": Whole(1, 100_000),
    "at": Whole(0, 2**31 - 1),
    "frames": Whole(1, 16),
    "starts": Whole(1, 1000),
    "seed": Whole(0, 2**31 - 1),
    "port": Whole(1, 65535),
    "runs": Whole(1, 10_000_000),
    "threads": Whole(1, 1024),
    "corners": Whole(4, 1000),
    "length": POSITIVE,
}


def value_of(name: str, text: str, told: str) -> Any:
    """The value of the type `name` of an option `told`. Raises ModelgenError where it stands."""
    kind = TYPES[name]
    try:
        return kind.read(_number(text) if isinstance(kind, Real | Whole) else text, Place(told))
    except SceneError as error:
        remedy = error.remedy or f"leave {told} out for the default"
        raise ModelgenError(error.where, error.found, error.allowed, remedy) from None


def number_of(text: str, told: str) -> float:
    """The number that an option `told` is given. Raises ModelgenError where it is none."""
    try:
        return NUMBER.read(_number(text), Place(told))
    except SceneError as error:
        raise ModelgenError(error.where, error.found, error.allowed, error.remedy) from None


def _number(text: str) -> float | str:
    """The number that a text is, or the text, which may be an expression such as 2*pi."""
    for kind in (int, float):
        with suppress(ValueError):
            return kind(text)
    return text
