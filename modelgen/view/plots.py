"""The curves over time of a page: energy, forces, sensors and others; some are open at first."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from modelgen.errors import ModelgenError, nearest
from modelgen.report.run_record import Array, Record
from modelgen.view.packing import packed

CURVES = 24  # of one plot, at most
NOISE = 1e-9  # a range so small against the scale of its plot is rounding, and is not spread over the plot
PLOTS = (
    *("energy", "unexplained energy", "speed", "angular speed", "position", "normal force", "friction"),
    *("slip", "gap", "joint force", "joint coordinates", "sensors"),
)
ALWAYS_OPEN = ("energy", "speed", "normal force", "sensors")


@dataclass(frozen=True, slots=True)
class _Plot:
    title: str
    unit: str
    names: Sequence[str]
    curves: Sequence[Array]  # (n,) each
    scale: float = 0.0  # of what the curves are part of


def shown_contacts(record: Record) -> list[int]:
    """Contacts with shapes that touched: they carried force or had an event."""
    count = len(record.pairs)
    force = record.columns["force"][:, :count]
    struck = {event["contact"] for event in record.summary["events"]}
    return [k for k in range(count) if force[:, k].any() or record.contact_names[k] in struck]


def check_plots(text: str) -> tuple[str, ...]:
    """Titles of plots between commas. Raises ModelgenError for one that is none."""
    titles = tuple(title.strip() for title in text.split(",") if title.strip())
    for title in titles:
        if title not in PLOTS:
            known = "known: " + ", ".join(PLOTS)
            raise ModelgenError(f"--plots {title}", "no such plot", known, nearest(title, PLOTS))
    return titles


def plots_of(
    record: Record, size: float, chosen: slice, opened: tuple[str, ...] | None
) -> list[dict[str, Any]]:
    """The plots that have curves, in the order of PLOTS.

    Args:
        record: the run.
        size: of the space in which bodies move, m.
        chosen: the samples of the page.
        opened: titles of the plots that are open at first; those that suit the run where None.
    """
    plots = [plot for plot in _all(record, size) if len(plot.curves)]
    order = {title: k for k, title in enumerate(PLOTS)}
    usual = (*ALWAYS_OPEN, *(() if record.sensor_names else ("joint coordinates", "gap")))
    first = usual if opened is None else opened
    return [
        {
            "title": plot.title,
            "unit": plot.unit,
            "open": plot.title in first,
            "floor": NOISE * plot.scale,
            "names": list(plot.names)[:CURVES],
            "curves": [packed(curve[chosen]) for curve in plot.curves[:CURVES]],
        }
        for plot in sorted(plots, key=lambda plot: order[plot.title])
    ]


def _all(record: Record, size: float) -> list[_Plot]:
    columns, moving = record.columns, record.moving
    bodies = [record.body_names[i] for i in moving]
    speeds = [np.linalg.norm(columns["v"][:, i], axis=1) for i in moving]
    spins = [np.linalg.norm(columns["w"][:, i], axis=1) for i in moving]
    pace = _largest(speeds) + size * _largest(spins)
    energy, work = columns["energy"], columns["work"]
    start = energy[0] if len(energy) else 0.0
    places = [
        (f"{record.body_names[i]} {axis}", columns["p"][:, i, k])
        for i in moving
        for k, axis in enumerate("xyz")
    ]
    joint_forces = np.linalg.norm(columns["joint_force"], axis=-1)
    return [
        _Plot("energy", "J", ("energy", "work"), (energy, work), _largest([energy])),
        _Plot("unexplained energy", "J", ("energy - start - work",), (energy - start - work,)),
        _Plot("speed", "m/s", bodies, speeds, pace),
        _Plot("angular speed", "rad/s", bodies, spins, pace / size),
        _Plot("position", "m", [name for name, _ in places], [curve for _, curve in places], size),
        *_of_contacts(record, size, pace),
        _Plot("joint force", "N", record.joint_names, list(joint_forces.T), _largest([joint_forces])),
        _Plot("joint coordinates", "rad, m", record.coordinate_names, list(columns["coordinates"].T)),
        _Plot("sensors", "SI", record.sensor_names, list(columns["sensors"].T)),
    ]


def _of_contacts(record: Record, size: float, pace: float) -> list[_Plot]:
    columns, shown = record.columns, shown_contacts(record)
    names = [record.contact_names[k] for k in shown]
    patches = [record.patch_names[k] for k in record.rested]
    forces = [columns["force"][:, k] for k in shown] + [_of_patch(record, k, "force") for k in record.rested]
    rubbing = [np.linalg.norm(columns["friction"][:, k], axis=1) for k in shown]
    rubbing += [_of_patch(record, k, "friction") for k in record.rested]
    slips = [np.linalg.norm(columns["slip"][:, k], axis=1) for k in shown]
    slips += [_of_patch(record, k, "slip") for k in record.rested]
    most = _largest(forces)
    found = [
        _Plot("normal force", "N", [*names, *patches], forces, most),
        _Plot("gap", "m", names, [columns["gap"][:, k] for k in shown], size),
    ]
    if record.has_friction:
        found.append(_Plot("friction", "N", [*names, *patches], rubbing, most))
        found.append(_Plot("slip", "m/s", [*names, *patches], slips, pace))
    return found


def _of_patch(record: Record, patch: int, column: str) -> Array:
    """(n,) the size of a quantity of a patch, 0 where it does not rest."""
    values = record.columns[f"patch_{column}"]
    sizes = np.linalg.norm(values, axis=-1) if values.ndim == 3 else values
    total: Array = np.where(record.columns["patch"] == patch, sizes, 0.0).sum(axis=1)
    return total


def _largest(curves: Sequence[Array]) -> float:
    return max((float(np.nanmax(np.abs(curve), initial=0.0)) for curve in curves if curve.size), default=0.0)
