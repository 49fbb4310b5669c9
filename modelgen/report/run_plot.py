"""One picture of a run: motion, forces, gaps, energy, and the contact curves on both surfaces."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from modelgen.errors import ModelgenError, expect, path_of
from modelgen.report.export import check_suffix
from modelgen.report.run_record import Array, Record
from modelgen.report.snapshots import draw_frames, frame_samples

FORMATS = (".png", ".svg")
CURVES = 4  # contacts whose curves are drawn, and faces whose pressure is
POINT = 1e-6  # half the box around a curve that is a point
NOISE = 1e-9  # a range so small, against the values in it, is rounding, and not spread over a panel
ENTRIES = 8  # lines that a legend names
RESIDUAL: dict[str, Any] = {"linewidth": 0.8, "color": "tab:red", "alpha": 0.7}


def require_matplotlib() -> Any:
    """matplotlib's Figure class, or an error that names the extra."""
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise ModelgenError(
            "plot", "matplotlib is not installed", "", "install it with: pip install 'modelgen[plot]'"
        ) from None
    return Figure


def draw(record: Record, path: str | Path, frames: int = 0) -> None:
    """Write the picture of a run, what `record_of` or `load` returned; the suffix says how (.png or .svg).
    Above it stand `frames` pictures of the bodies: at the start, the first change of mode, and evenly on.

    Raises ModelgenError for another suffix, or without matplotlib.
    """
    expect("draw", record, Record)
    path = path_of("draw", path)
    check_suffix(path, FORMATS)
    figure_class = require_matplotlib()
    curves = _curves(record)[: 2 * CURVES]
    panels = _panels(record)
    if frames and not record.meshes:
        raise ModelgenError("frames", "no body of this run has a shape to draw", "", "leave the frames out")
    shown = frame_samples(record, frames) if frames and len(record.columns["t"]) and record.meshes else []
    above, rows = -(-len(shown) // 2), -(-len(panels) // 2)
    heights = [1.7] * above + [1.0] * rows + [1.7] * -(-len(curves) // 2)
    figure = figure_class(figsize=(11.0, 2.8 * sum(heights)), layout="constrained")
    summary = record.summary
    figure.suptitle(f"{summary['scene']}: {summary['outcome']} at t = {summary['t_end']:.6g} s")
    grid = figure.add_gridspec(len(heights), 2, height_ratios=heights)
    places = [figure.add_subplot(grid[k // 2, k % 2], projection="3d") for k in range(len(shown))]
    draw_frames(record, shown, places)
    for k, panel in enumerate(panels):
        panel(record, figure.add_subplot(grid[above + k // 2, k % 2]))
    for k, (contact, side) in enumerate(curves):
        place = grid[above + rows + k // 2, k % 2]
        _curve(record, contact, side, figure.add_subplot(place, projection="3d"))
    figure.savefig(path, dpi=130, metadata={"Date": None} if path.suffix == ".svg" else None)


def _panels(record: Record) -> tuple[Callable[[Record, Any], None], ...]:
    """What is drawn over time, two a row; force and gap where there are contacts, friction and slip
    where there is any, likewise of joints."""
    contacts = (_force, _gap) if _contacts(record) else (_force,) if record.contact_names else ()
    constraints = (_friction, _slip) if record.has_friction else ()
    joints = (_joint_force, _coordinates) if record.joint_names else ()
    sensors = (_sensors,) if record.sensor_names else ()
    over_time = (_position, _velocity, _rotation, *contacts, *constraints, *joints, *sensors, _energy)
    pressed = (partial(_pressure, patch=patch) for patch in record.rested[:CURVES])
    return (*(partial(_over_time, panel=panel) for panel in over_time), *pressed)


def _over_time(record: Record, axes: Any, panel: Callable[[Record, Any], None]) -> None:
    panel(record, axes)
    _finish(axes)


def _pressure(record: Record, axes: Any, patch: int) -> None:
    """The outline of a face, and where its centre of pressure went on it."""
    axes.set_title(f"{record.patch_names[patch]}: centre of pressure")
    frame = record.faces[f"{patch}_axes"]
    outline = (record.faces[f"{patch}_outline"] - frame[:3]) @ frame[3:9].reshape(2, 3).T
    curve = record.pressure_curve(patch)
    axes.plot(*outline.T, color="0.4", linewidth=1.0)
    axes.plot(*curve.T, color="tab:blue", linewidth=1.4)
    known = curve[np.isfinite(curve[:, 0])]
    for point, label, mark in zip(known[[0, -1]], ("first", "last"), "os", strict=True):
        axes.plot(*point, mark, color="tab:blue", markersize=4, label=label, fillstyle="none")
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_xlabel("x [m]")
    axes.set_ylabel("y [m]")
    axes.grid(alpha=0.3)
    axes.legend(fontsize="x-small", loc="best")


def _contacts(record: Record) -> list[int]:
    """The contacts that ever carried a force or an impact; all if none did and no face rested on another."""
    loaded = np.atleast_1d(record.columns["force"].any(axis=0))
    struck = {event["contact"] for event in record.summary["events"] if event["kind"] == "impact"}
    found = [k for k, name in enumerate(record.contact_names) if loaded[k] or name in struck]
    return found or ([] if record.rested else list(range(len(record.contact_names))))


def _curves(record: Record) -> list[tuple[int, str]]:
    """Those of them with each side, o or f, that has a surface to show or whose point moved on its body."""
    found = [k for k in _contacts(record) if k < len(record.pairs)] if len(record.columns["t"]) else []
    return [(k, side) for k in found for side in "of" if _is_more_than_a_point(record, k, side)]


def _is_more_than_a_point(record: Record, contact: int, side: str) -> bool:
    mesh = record.meshes.get(f"{contact}_{side}", np.zeros((0, 3)))
    return max(_extent(mesh.reshape(-1, 3)), _extent(record.contact_curve(contact, side))) > POINT


def _extent(curve: Array) -> float:
    known = curve[np.isfinite(curve).all(axis=1)]
    return float(np.ptp(known, axis=0).max()) if len(known) else 0.0


def _finish(axes: Any) -> None:
    axes.set_xlabel("t [s]")
    axes.grid(alpha=0.3)
    low, high = axes.get_ylim()
    size = max(abs(low), abs(high))
    if high - low < NOISE * max(size, NOISE):
        middle, half = (low + high) / 2, 0.1 * size if size > NOISE else NOISE
        axes.set_ylim(middle - half, middle + half)
    handles, labels = axes.get_legend_handles_labels()
    if len(handles) > ENTRIES:
        more = axes.plot([], [], " ", label=f"and {len(handles) - ENTRIES + 1} more")
        handles, labels = [*handles[: ENTRIES - 1], *more], [*labels[: ENTRIES - 1], more[0].get_label()]
    if handles:
        axes.legend(handles, labels, fontsize="x-small", loc="best")


def _components(record: Record, axes: Any, column: str, symbol: str) -> None:
    t, values = record.columns["t"], record.columns[column]
    for i in record.moving:
        for k, axis in enumerate("xyz"):
            if not np.isnan(values[:, i, k]).all():
                axes.plot(t, values[:, i, k], linewidth=1.0, label=f"{record.body_names[i]} {symbol}_{axis}")


def _position(record: Record, axes: Any) -> None:
    axes.set_title("position of the centre of mass")
    axes.set_ylabel("p [m]")
    _components(record, axes, "p", "p")


def _velocity(record: Record, axes: Any) -> None:
    axes.set_title("velocity of the centre of mass")
    axes.set_ylabel("v [m/s]")
    _components(record, axes, "v", "v")


def _rotation(record: Record, axes: Any) -> None:
    axes.set_title("angular velocity, world axes")
    axes.set_ylabel("w [rad/s]")
    _components(record, axes, "w", "w")


def _force(record: Record, axes: Any) -> None:
    axes.set_title("normal contact force")
    axes.set_ylabel("force [N]")
    if record.columns["force"].any() or not record.rested:
        _per_contact(record, axes, "force")
    for patch in record.rested:
        values = np.where(record.columns["patch"] == patch, record.columns["patch_force"], 0.0).sum(axis=1)
        axes.plot(record.columns["t"], values, linewidth=1.0, label=record.patch_names[patch])
    impacts = [event["t"] for event in record.summary["events"] if event["kind"] == "impact"]
    if impacts:
        axes.plot(impacts, np.zeros(len(impacts)), "|", color="tab:red", markersize=9, label="impacts")


def _gap(record: Record, axes: Any) -> None:
    axes.set_title("gap")
    axes.set_ylabel("d [m]")
    _per_contact(record, axes, "gap")


def _friction(record: Record, axes: Any) -> None:
    axes.set_title("friction force")
    axes.set_ylabel("|friction| [N]")
    _sizes(record, axes, "friction")


def _slip(record: Record, axes: Any) -> None:
    axes.set_title("slip")
    axes.set_ylabel("|slip| [m/s]")
    _sizes(record, axes, "slip")


def _sizes(record: Record, axes: Any, column: str) -> None:
    for k in _contacts(record):
        sizes = np.linalg.norm(record.columns[column][:, k], axis=-1)
        axes.plot(record.columns["t"], sizes, linewidth=1.0, label=record.contact_names[k])
    for patch in record.rested:
        of_slots = np.linalg.norm(record.columns[f"patch_{column}"], axis=-1)
        sizes = np.where(record.columns["patch"] == patch, of_slots, 0.0).sum(axis=1)
        axes.plot(record.columns["t"], sizes, linewidth=1.0, label=record.patch_names[patch])


def _per_contact(record: Record, axes: Any, column: str) -> None:
    for k in _contacts(record):
        values = record.columns[column][:, k]
        axes.plot(record.columns["t"], values, linewidth=1.0, label=record.contact_names[k])


def _joint_force(record: Record, axes: Any) -> None:
    axes.set_title("joint force")
    axes.set_ylabel("|force| [N]")
    sizes = np.linalg.norm(record.columns["joint_force"], axis=-1)
    for k, name in enumerate(record.joint_names):
        axes.plot(record.columns["t"], sizes[:, k], linewidth=1.0, label=name)


def _coordinates(record: Record, axes: Any) -> None:
    axes.set_title("joint coordinates")
    axes.set_ylabel("[rad], [m]")
    for k, name in enumerate(record.coordinate_names):
        axes.plot(record.columns["t"], record.columns["coordinates"][:, k], linewidth=1.0, label=name)


def _sensors(record: Record, axes: Any) -> None:
    axes.set_title("sensors")
    axes.set_ylabel("SI")
    for k, name in enumerate(record.sensor_names):
        axes.plot(record.columns["t"], record.columns["sensors"][:, k], linewidth=1.0, label=name)


def _energy(record: Record, axes: Any) -> None:
    t, energy, work = (record.columns[name] for name in ("t", "energy", "work"))
    axes.set_title("energy, and what work does not explain", loc="left")
    axes.set_ylabel("E [J]")
    axes.plot(t, energy, linewidth=1.0, label="E")
    axes.plot(t, work, linewidth=1.0, label="work")
    if len(energy):
        drift = axes.twinx()
        drift.plot(t, energy - energy[0] - work, **RESIDUAL)
        drift.set_ylabel("E - E0 - work [J]", color=RESIDUAL["color"])
        axes.plot([], [], label="E - E0 - work (right axis)", **RESIDUAL)
        axes.set_zorder(drift.get_zorder() + 1)  # the legend above the lines of both axes
        axes.patch.set_visible(False)


def _curve(record: Record, contact: int, side: str, axes: Any) -> None:
    body = record.body_names[int(record.pairs[contact, 0 if side == "o" else 1])]
    axes.set_title(f"{record.contact_names[contact]}: contact curve on {body}")
    curve = record.contact_curve(contact, side)
    mesh = record.meshes.get(f"{contact}_{side}")
    if mesh is not None:
        axes.plot_wireframe(*np.moveaxis(mesh, -1, 0), linewidth=0.3, color="0.6")
    for touching, style in ((True, "-"), (False, ":")):
        axes.plot(*_where(record, contact, curve, touching).T, style, linewidth=1.4, color="tab:blue")
    axes.set_xlabel("x [m]")
    axes.set_ylabel("y [m]")
    axes.set_zlabel("z [m]")
    _equal_box(axes, curve if mesh is None else np.vstack((mesh.reshape(-1, 3), curve)))


def _where(record: Record, contact: int, curve: Array, touching: bool) -> Array:
    """The curve where the contact carries force (or not), broken elsewhere."""
    loaded = record.columns["force"][:, contact] > 0
    return np.where((loaded == touching)[:, None], curve, np.nan)


def _equal_box(axes: Any, points: Array) -> None:
    low, high = np.nanmin(points, axis=0), np.nanmax(points, axis=0)
    middle = (low + high) / 2
    half = max(float((high - low).max()) / 2, POINT * (1.0 + float(np.abs(middle).max())))
    for setter, centre in zip((axes.set_xlim, axes.set_ylim, axes.set_zlim), middle, strict=True):
        setter(centre - half, centre + half)
    axes.set_box_aspect((1, 1, 1))
    axes.locator_params(nbins=4)
