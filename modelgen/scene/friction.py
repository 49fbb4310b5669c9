"""The friction of a contact pair: one coefficient, a static and a kinetic one, or two along axes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from modelgen.scene.pose_input import VECTOR
from modelgen.scene.scalar_types import Real, Schema
from modelgen.scene.scene_types import Friction
from modelgen.scene.source_location import Place, describe
from modelgen.scene.table_types import Field, Sequence, Table

COEFFICIENT = Real(0.0, 1e6)
_AXES = Sequence(COEFFICIENT, 2)


@dataclass(frozen=True, slots=True)
class Coefficient:
    """A number, or [along the direction, across it]; reads to both."""

    def read(self, value: object, place: Place) -> tuple[float, float]:
        if isinstance(value, list | tuple):
            along, across = _AXES.read(value, place)
            if (along == 0) != (across == 0):
                raise place.error(f"{[along, across]}", "both positive, or both zero", "give both axes one")
            return along, across
        number = COEFFICIENT.read(value, place)
        return number, number

    def schema(self) -> Schema:
        return {"anyOf": [COEFFICIENT.schema(), _AXES.schema()]}


_TABLE = Table(
    (
        Field("static", Coefficient(), "before slip begins; the kinetic one if absent"),
        Field("kinetic", Coefficient(), "while it slips; the static one if absent"),
        Field(
            "direction", VECTOR,
            "of two coefficients: where the first holds, in axes of the first body of `between`",
        ),
    )
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class FrictionValue:
    """Reads a number or a table to Friction; None where there is none."""

    def read(self, value: object, place: Place) -> Friction | None:
        if isinstance(value, Mapping):
            return _from_table(_TABLE.read(value, place), place)
        if isinstance(value, list | tuple):
            remedy = (
                "write { static = ..., kinetic = ... }, or { kinetic = [..., ...], direction = [x, y, z] }"
            )
            raise place.error(describe(value), "a number or a table is allowed", remedy)
        number = COEFFICIENT.read(value, place)
        return Friction((number, number), (number, number)) if number else None

    def schema(self) -> Schema:
        return {"anyOf": [COEFFICIENT.schema(), _TABLE.schema()]}


def _from_table(values: Mapping[str, Any], place: Place) -> Friction | None:
    written = [values[key] for key in ("static", "kinetic") if values[key] is not None]
    if not written:
        raise place.error("no coefficient", "static, kinetic or both", "write friction = 0.3")
    s1, s2 = values["static"] or written[0]
    k1, k2 = values["kinetic"] or written[0]
    if s1 < k1 or s2 < k2:
        found = f"static {_shown(s1, s2)} below kinetic {_shown(k1, k2)}"
        raise place.error(found, "static friction is no less than kinetic", "exchange them")
    direction = values["direction"]
    _check_direction((s1, s2, k1, k2), direction, place)
    if not s1:
        return None
    return Friction(
        (s1, s2), (k1, k2), None if direction is None else (direction[0], direction[1], direction[2])
    )


def _check_direction(found: tuple[float, ...], direction: tuple[float, ...] | None, place: Place) -> None:
    s1, s2, k1, k2 = found
    elliptic = s1 != s2 or k1 != k2
    if elliptic and (direction is None or not any(direction)):
        raise place.error(
            "two coefficients without a direction",
            "a nonzero direction says where the first one holds",
            "add direction = [x, y, z] in the axes of the first body of `between`",
        )
    if direction is not None and not elliptic:
        raise place.key("direction").error(
            "a direction of one coefficient", "friction alike in all directions needs none", "remove it"
        )
    if (k1 == 0) != (s1 == 0):
        raise place.error("kinetic 0 and static above it", "both positive, or both zero", "raise kinetic")


def _shown(along: float, across: float) -> str:
    return f"{along:g}" if along == across else f"[{along:g}, {across:g}]"


_LENGTH = Real(minimum=0.0)
FRICTION_FIELDS = (
    Field(
        "friction", FrictionValue(),
        "coefficient of Coulomb friction, or a table of a static and a kinetic one; without it none",
    ),
    Field(
        "rolling_resistance", _LENGTH,
        "torque against rolling over the normal force, m; needs friction", default=0.0,
    ),
    Field(
        "spinning_resistance", _LENGTH,
        "torque against spinning about the normal over the normal force, m; needs friction", default=0.0,
    ),
)  # fmt: skip
