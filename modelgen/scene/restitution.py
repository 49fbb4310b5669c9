"""The restitution of a contact pair: a coefficient, and what it is the coefficient of."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from modelgen.scene.scalar_types import Choice, Real, Schema
from modelgen.scene.scene_types import Restitution
from modelgen.scene.source_location import Place
from modelgen.scene.table_types import Field, Table

LAWS = ("newton", "poisson", "stronge")
VALUE = Real(0.0, 1.0)

_TABLE = Table(
    (
        Field("law", Choice(LAWS), "what is given back: speed, impulse or energy", default="newton"),
        Field("value", VALUE, "the coefficient; of stronge the root of the part of energy", required=True),
    )
)


@dataclass(frozen=True, slots=True)
class RestitutionValue:
    """Reads a number, in Newton's law, or a table, to Restitution."""

    def read(self, value: object, place: Place) -> Restitution:
        if isinstance(value, Mapping):
            values = _TABLE.read(value, place)
            return Restitution(values["value"], values["law"])
        return Restitution(VALUE.read(value, place))

    def schema(self) -> Schema:
        return {"anyOf": [VALUE.schema(), _TABLE.schema()]}
