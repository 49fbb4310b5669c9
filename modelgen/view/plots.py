"""The curves over time of a page: energy, forces, sensors and others; some are open at first."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from modelgen.errors import ModelgenError
from modelgen.name_suggestions import nearest
from modelgen.report.run_record import Array, Record
from modelgen.view.packing import packed

CURVES = 24  # of one plot, at most
SOURCES = 200  # of one plot of a page that computes its run, which shows those that are not zero
NOISE = 1e-9  # a range so small against the scale of its plot is rounding, and is not spread over the plot
PLOTS = (
    *("energy", "unexplained energy", "speed", "angular speed", "position", "normal force", "friction"),
    *("slip", "gap", "joint force", "joint coordinates", "sensors"),
)
ENERGIES = (("value", "energy", 0, 1), ("value", "work", 0, 1))
UNEXPLAINED = (("unexplained", "energy", 0, 1),)
ALWAYS_OPEN = ("energy", "speed", "normal force", "sensors")


# how a curve is computed of a sample of the core: what, of which column, from which entry on, of how many; of
# a patch its number and the entry
Source = tuple[str, str, int, int]


@dataclass(frozen=True, slots=True)
class _Plot:
    title: str
    unit: str
    names: Sequence[str]
    curves: Sequence[Array]  # (n,) each
    sources: Sequence[Source]
    scale: float = 0.0  # of what the curves are part of


@dataclass(frozen=True, slots=True)
class Shown:
    """Of what there are curves: numbers of bodies, contacts and patches; whether there is friction."""

    bodies: Sequence[int]
    contacts: Sequence[int]
    patches: Sequence[int]
    has_friction: bool


def shown_in(record: Record) -> Shown:
    """What moved, touched and rested in a run."""
    return Shown(record.moving, shown_contacts(record), record.rested, record.has_friction)


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
    plots = _sorted(record, size, shown_in(record))
    return [
        {
            **_described(plot, record, opened, CURVES),
            "curves": [packed(curve[chosen]) for curve in plot.curves[:CURVES]],
        }
        for plot in plots
    ]


def plots_to_come(
    record: Record, size: float, shown: Shown, opened: tuple[str, ...] | None
) -> list[dict[str, Any]]:
    """The plots of a page that computes its run: the sources of their curves. Arguments as of `plots_of`;
    `record` is a run of the scene, from which scales are taken."""
    return [
        {**_described(plot, record, opened, SOURCES), "curves": [], "sources": list(plot.sources[:SOURCES])}
        for plot in _sorted(record, size, shown)
    ]


def _sorted(record: Record, size: float, shown: Shown) -> list[_Plot]:
    order = {title: k for k, title in enumerate(PLOTS)}
    plots = [plot for plot in _all(record, size, shown) if len(plot.curves)]
    return sorted(plots, key=lambda plot: order[plot.title])


def _described(plot: _Plot, record: Record, opened: tuple[str, ...] | None, most: int) -> dict[str, Any]:
    usual = (*ALWAYS_OPEN, *(() if record.sensor_names else ("joint coordinates", "gap")))
    return {
        "title": plot.title,
        "unit": plot.unit,
        "open": plot.title in (usual if opened is None else opened),
        "floor": NOISE * plot.scale,
        "names": list(plot.names)[:most],
    }


def _all(record: Record, size: float, shown: Shown) -> list[_Plot]:
    columns, moving = record.columns, shown.bodies
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
    coordinates, sensors = columns["coordinates"].T, columns["sensors"].T
    return [
        _Plot("energy", "J", ("energy", "work"), (energy, work), ENERGIES, _largest([energy])),
        _Plot("unexplained energy", "J", ("energy - start - work",), (energy - start - work,), UNEXPLAINED),
        _Plot("speed", "m/s", bodies, speeds, _lengths("twist", moving, 6), pace),
        _Plot("angular speed", "rad/s", bodies, spins, _lengths("twist", moving, 6, 3), pace / size),
        _Plot(
            *("position", "m", [name for name, _ in places], [curve for _, curve in places]),
            [("value", "pose", 12 * i + k, 1) for i in moving for k in range(3)],
            size,
        ),
        *_of_contacts(record, size, pace, shown),
        _Plot(
            *("joint force", "N", record.joint_names, list(joint_forces.T)),
            _lengths("joint_wrench", range(len(record.joint_names)), 6),
            _largest([joint_forces]),
        ),
        _Plot(
            *("joint coordinates", "rad, m", record.coordinate_names, list(coordinates)),
            _of_coordinates(record),
        ),
        _Plot(
            *("sensors", "SI", record.sensor_names, list(sensors)),
            [("value", "sensors", k, 1) for k in range(len(sensors))],
        ),
    ]


def _of_contacts(record: Record, size: float, pace: float, shown: Shown) -> list[_Plot]:
    columns, listed, resting = record.columns, shown.contacts, shown.patches
    names = [record.contact_names[k] for k in listed]
    patches = [record.patch_names[k] for k in resting]
    forces = [columns["force"][:, k] for k in listed] + [_of_patch(record, k, "force") for k in resting]
    rubbing = [np.linalg.norm(columns["friction"][:, k], axis=1) for k in listed]
    rubbing += [_of_patch(record, k, "friction") for k in resting]
    slips = [np.linalg.norm(columns["slip"][:, k], axis=1) for k in listed]
    slips += [_of_patch(record, k, "slip") for k in resting]
    most = _largest(forces)
    found = [
        _Plot(
            *("normal force", "N", [*names, *patches], forces),
            [
                *[("value", "force", k, 1) for k in listed],
                *[("value of patch", "pressure", k, 0) for k in resting],
            ],
            most,
        ),
        _Plot(
            *("gap", "m", names, [columns["gap"][:, k] for k in listed]),
            [("value", "gap", k, 1) for k in listed],
            size,
        ),
    ]
    if shown.has_friction:
        for title, unit, curves, scale, entry in (
            ("friction", "N", rubbing, most, 0),
            ("slip", "m/s", slips, pace, 4),
        ):
            of_faces = [("length of patch", "patch_friction", k, entry) for k in resting]
            sources = [*_lengths(title, listed, 3), *of_faces]
            found.append(_Plot(title, unit, [*names, *patches], curves, sources, scale))
    return found


def _lengths(column: str, numbers: Iterable[int], width: int, first: int = 0) -> list[Source]:
    """The lengths of vectors: of each number, three entries of its `width`, from `first` on."""
    return [("length", column, width * k + first, 3) for k in numbers]


def _of_coordinates(record: Record) -> list[Source]:
    """The core has three entries a joint."""
    counts = dict.fromkeys(record.joint_names, 0)
    found: list[Source] = []
    for name in record.coordinate_names:
        joint, _, coordinate = name.rpartition(".")
        entry = 3 * record.joint_names.index(joint) + counts[joint]
        found.append(("angle" if coordinate.startswith("angle") else "value", "coordinate", entry, 1))
        counts[joint] += 1
    return found


def _of_patch(record: Record, patch: int, column: str) -> Array:
    """(n,) the size of a quantity of a patch, 0 where it does not rest."""
    values = record.columns[f"patch_{column}"]
    sizes = np.linalg.norm(values, axis=-1) if values.ndim == 3 else values
    total: Array = np.where(record.columns["patch"] == patch, sizes, 0.0).sum(axis=1)
    return total


def _largest(curves: Sequence[Array]) -> float:
    return max((float(np.nanmax(np.abs(curve), initial=0.0)) for curve in curves if curve.size), default=0.0)
