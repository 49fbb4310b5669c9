"""What of a run is compared with which columns of a recording."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from modelgen.errors import SimulationError
from modelgen.identification.recordings import Array, Recording
from modelgen.name_suggestions import nearest
from modelgen.runtime.sensitivity import outputs_of

QUATERNION = 4  # components of an orientation, which is compared by the turn from measured to computed
TURN = ("about x", "about y", "about z")


@dataclass(frozen=True)
class Comparison:
    """The deviations of a run from a recording: one a column, three for an orientation (rad, body axes)."""

    of: tuple[str, ...]  # what a run has to show
    names: tuple[str, ...]  # of the deviations
    groups: tuple[str, ...]  # the quantity of each: what has one noise
    _plain: tuple[tuple[int, int], ...]  # (column, component shown)
    _turned: tuple[tuple[tuple[int, ...], tuple[int, ...]], ...]  # four of each

    def deviations(self, recording: Recording, shown: Array) -> Array:
        """(nt, n): NaN where nothing was measured. `shown`: (nt, n_of) values of a run."""
        values = recording.values[: len(shown)]
        parts = [shown[:, at] - values[:, column] for column, at in self._plain]
        for columns, at in self._turned:
            parts += list(_turn(values[:, columns], shown[:, at])[0].T)
        return np.stack(parts, axis=1)

    def derivatives(self, recording: Recording, shown: Array, jacobian: Array) -> Array:
        """(nt, n, n_by) derivatives of the deviations from those (nt, n_of, n_by) of what is shown."""
        values = recording.values[: len(shown)]
        parts = [jacobian[:, at] for _, at in self._plain]
        for columns, at in self._turned:
            matrix = _turn(values[:, columns], shown[:, at])[1]
            parts += list(np.moveaxis(matrix @ jacobian[:, at], 1, 0))
        return np.stack(parts, axis=1)


def _turn(measured: Array, shown: Array) -> tuple[Array, Array]:
    """The vector part, twice, of the quaternion that turns measured (nt, 4) to shown, and its derivative
    (nt, 3, 4) by the latter: for small angles the rotation vector, rad, in body axes."""
    w, x, y, z = (measured / np.linalg.norm(measured, axis=1, keepdims=True)).T
    matrix = 2 * np.stack(
        [
            np.stack([-x, w, z, -y], axis=1),
            np.stack([-y, -z, w, x], axis=1),
            np.stack([-z, y, -x, w], axis=1),
        ],
        axis=1,
    )
    same = np.where(w * shown[:, 0] + x * shown[:, 1] + y * shown[:, 2] + z * shown[:, 3] < 0, -1.0, 1.0)
    matrix = matrix * same[:, None, None]
    return (matrix @ shown[:, :, None])[:, :, 0], matrix


def comparison_of(instance: Mapping[str, Any], recording: Recording) -> Comparison:
    """Which components of a run go with the columns; raises SimulationError for an unknown column, or an
    orientation of fewer than four."""
    outputs = outputs_of(instance)
    homes = {part.name: name for name, parts in outputs.items() for part in parts}
    for column in recording.columns:
        if column not in homes:
            known = ", ".join(homes) or "none"
            remedy = nearest(column, homes) or "leave the column out, or add a [[sensor]] to the scene"
            raise SimulationError(
                f"{recording.name}: column {column!r}", "unknown", f"known: {known}", remedy
            )
    of = tuple(dict.fromkeys(homes[column] for column in recording.columns))
    places = {part.name: k for k, part in enumerate(part for name in of for part in outputs[name])}
    turned = [name for name in of if len(outputs[name]) == QUATERNION]
    plain = [column for column in recording.columns if homes[column] not in turned]
    for name in turned:
        missing = [part.name for part in outputs[name] if part.name not in recording.columns]
        if missing:
            found = f"no column {missing[0]!r}"
            raise SimulationError(f"{recording.name}: {name}", found, "all four of an orientation")
    at = recording.columns.index
    parts_of = {name: [part.name for part in outputs[name]] for name in turned}
    return Comparison(
        of=of,
        names=(*plain, *(f"{name} {axis}" for name in turned for axis in TURN)),
        groups=(*(homes[column] for column in plain), *(name for name in turned for _ in TURN)),
        _plain=tuple((at(column), places[column]) for column in plain),
        _turned=tuple(
            (tuple(at(part) for part in parts), tuple(places[part] for part in parts))
            for parts in parts_of.values()
        ),
    )
