"""One picture of a run: motion, forces, gaps, energy, and the contact curves on both surfaces."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from io import BytesIO
from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING, Any

import numpy as np

from modelgen.errors import ModelgenError, expect, install, path_of
from modelgen.file_writing import replaced, write_file
from modelgen.report.run_files import check_suffix
from modelgen.report.run_record import Array, Record
from modelgen.report.snapshots import draw_frames, frame_samples
from modelgen.report.summary import horizon_of, verdict_title

if TYPE_CHECKING:
    from modelgen.report.displayed_bodies import Stage

FORMATS = (".png", ".svg", ".gif", ".mp4")  # the last two are films
FILMS = FORMATS[2:]
STRIP = 4  # pictures of the bodies where no number is given
ROW, PAIR = 4, 2  # side by side: of them, and of curves
COARSE = 2e-2  # tolerance of their meshes, as a part of the size of a shape
CURVES = 4  # contacts whose curves are drawn, and faces whose pressure is
POINT = 1e-6  # half the box around a curve that is a point
CLEAR = 0.8  # of half the box: numbers nearer to its corners would overlap those of other axes
NOISE = 1e-9  # a range so small, against the values in it, is rounding, and not spread over a panel
ENTRIES = 20  # lines that a legend names
INSIDE = 6  # of them for which there is room beside the curves
STYLES = ("-", "--", ":")  # of the components x, y, z, where bodies have colours
DOUBTED = "tab:red"  # of what is not trusted
WORDS = 150  # most characters of a line below the panels
RESIDUAL: dict[str, Any] = {"linewidth": 0.8, "color": "tab:red", "alpha": 0.7}


def require_matplotlib() -> Any:
    """matplotlib's Figure class, or an error that names the extra, or what keeps it from starting.

    It reads a file `matplotlibrc` in the current folder, which may have come with a scene, and may name
    programs: so it is imported in another one.
    """
    try:
        with _in_folder_of_its_own():
            from matplotlib.figure import Figure
    except ImportError:
        raise ModelgenError("plot", "matplotlib is not installed", "", install("plot")) from None
    except ValueError as error:
        remedy = "correct the variable MPLBACKEND, or your own file matplotlibrc"
        raise ModelgenError("plot", f"matplotlib does not start: {error}", "", remedy) from None
    return Figure


@contextmanager
def _in_folder_of_its_own() -> Iterator[None]:
    """The folder of this file as the current one, unless matplotlib has been imported."""
    if "matplotlib" in sys.modules:
        yield
        return
    try:
        before = os.open(".", os.O_RDONLY)
    except OSError:  # it was removed
        yield
        return
    try:
        os.chdir(Path(__file__).parent)
        yield
    finally:
        os.fchdir(before)
        os.close(before)


def draw(record: Record, path: str | Path, frames: int | None = None) -> None:
    """Write the picture of a run, what `record_of` or `load` returned; the suffix says how (.png or .svg;
    .gif and .mp4: a film of the bodies alone).

    Above the curves stand `frames` pictures of the bodies: at the start, the first change of mode, and evenly
    on; 4 where the record holds its scene. Of a record that does not, surfaces in contact are drawn, and none
    unless asked for.

    Raises ModelgenError for another suffix, without matplotlib, or for a film without Pillow or ffmpeg.
    """
    expect("draw", record, Record)
    path = path_of("draw", path)
    check_suffix(path, FORMATS)
    if path.suffix in FILMS:
        from modelgen.report.film import SIZE, draw_film

        stage = _stage(record, "a film")
        draw_film(record, stage, path, require_matplotlib()(figsize=SIZE))
        return
    write_file(path, picture(record, path.suffix[1:], frames))


def save_figure(figure: Any, path: Path) -> None:
    """Write a figure of matplotlib; the suffix says how."""
    kind, metadata = path.suffix[1:], {"Date": None} if path.suffix == ".svg" else None
    with replaced(path) as scratch:
        figure.savefig(scratch, format=kind, dpi=130, metadata=metadata)


def picture(record: Record, kind: str, frames: int | None = None) -> bytes:
    """The picture of a run as `draw` writes it, as "png" or "svg"."""
    figure = _figure(record, frames)
    written = BytesIO()
    figure.savefig(written, format=kind, dpi=130, metadata={"Date": None} if kind == "svg" else None)
    return written.getvalue()


def _figure(record: Record, frames: int | None) -> Any:
    figure_class = require_matplotlib()
    curves = _curves(record)[: 2 * CURVES]
    panels = _panels(record)
    known = record.scene is not None
    count = (STRIP if known else 0) if frames is None else frames
    if frames and not known and not record.meshes:
        raise ModelgenError("frames", "no body of this run has a shape to draw", "", "leave the frames out")
    shown = frame_samples(record, count) if count and len(record.columns["t"]) else []
    wide = ROW if known else PAIR
    above, rows = -(-len(shown) // wide), -(-len(panels) // PAIR)
    heights = [1.0 if known else 1.7] * above + [1.0] * rows + [1.7] * -(-len(curves) // PAIR)
    figure = figure_class(figsize=(11.0, 2.8 * sum(heights)), layout="constrained")
    summary = record.summary
    reached = f"{summary['scene']}: {summary['outcome']} at t = {summary['t_end']:.6g} s"
    reasons = "".join(f"\n{fill(doubt, WORDS)}" for doubt in summary["doubts"])
    figure.suptitle(f"{reached}, {verdict_title(summary)}")
    if reasons:
        figure.supxlabel(f"not trusted:{reasons}", fontsize="small", color=DOUBTED)
    grid = figure.add_gridspec(len(heights), ROW, height_ratios=heights)

    def place(first: int, number: int, side_by_side: int) -> Any:
        """The place of one of several equal pictures from a row on."""
        row, column, width = first + number // side_by_side, number % side_by_side, ROW // side_by_side
        return grid[row, column * width : (column + 1) * width]

    if known:
        strips = [grid[row, :].subgridspec(1, ROW) for row in range(above)]
        _strip(record, shown, [figure.add_subplot(strips[k // ROW][k % ROW]) for k in range(len(shown))])
    else:
        panes = [figure.add_subplot(place(0, k, wide), projection="3d") for k in range(len(shown))]
        draw_frames(record, shown, panes)
    for k, panel in enumerate(panels):
        panel(record, figure.add_subplot(place(above, k, PAIR)))
    for k, (contact, side) in enumerate(curves):
        axes = figure.add_subplot(place(above + rows, k, PAIR), projection="3d")
        _curve(record, contact, side, axes)
    return figure


def _stage(record: Record, what: str) -> Stage:
    """The bodies of the scene that a record holds."""
    from modelgen.assembly import require
    from modelgen.report.displayed_bodies import stage_of

    return stage_of(record, require(record.scene_again(what)), COARSE)


def _strip(record: Record, samples: list[int], places: list[Any]) -> None:
    """Pictures of the bodies side by side."""
    from modelgen.report.body_pictures import draw_bodies

    if samples:
        stage = _stage(record, "frames")
        for sample, axes in zip(samples, places, strict=True):
            draw_bodies(axes, record, stage, sample)


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
    if max(len(record.moving), len(_contacts(record)), len(record.sensor_names)) > 10:
        axes.set_prop_cycle(color=[_colour(k) for k in range(20)])
    panel(record, axes)
    _finish(axes)
    horizon = horizon_of(record.summary)
    if horizon is not None:  # shaded where nothing is predicted
        axes.axvspan(horizon, record.summary["t_end"], color=DOUBTED, alpha=0.12, linewidth=0)


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
    if len(handles) > INSIDE:
        beside = {"loc": "upper left", "bbox_to_anchor": (1.0, 1.0), "borderaxespad": 0.2}
        axes.legend(handles, labels, fontsize="xx-small", **beside)
    elif handles:
        axes.legend(handles, labels, fontsize="x-small", loc="best")


def _components(record: Record, axes: Any, column: str, symbol: str) -> None:
    """The components of a vector of each body that moves; of many bodies each has a colour."""
    t, values, many = record.columns["t"], record.columns[column], 3 * len(record.moving) > ENTRIES // 2
    for number, i in enumerate(record.moving):
        for k, axis in enumerate("xyz"):
            if np.isnan(values[:, i, k]).all():
                continue
            name = record.body_names[i]
            style = {"color": _colour(number), "linestyle": STYLES[k]} if many else {}
            label = (name if k == 0 else None) if many else f"{name} {symbol}_{axis}"
            axes.plot(t, values[:, i, k], linewidth=1.0, label=label, **style)
    if many:
        for axis, dashes in zip("xyz", STYLES, strict=True):
            axes.plot([], [], dashes, color="0.3", linewidth=1.0, label=f"{symbol}_{axis}")


def _colour(number: int) -> Any:
    """Colours of lines, 20 different ones."""
    from matplotlib import colormaps

    return colormaps["tab20"](number % 20)


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
    axes.locator_params(nbins=5)
    for letter, centre in zip("xyz", middle, strict=True):
        getattr(axes, f"set_{letter}lim")(centre - half, centre + half)
        axis = getattr(axes, f"{letter}axis")
        ticks = axis.get_ticklocs()
        axis.set_ticks(ticks[np.abs(ticks - centre) < CLEAR * half])
    axes.set_box_aspect((1, 1, 1))
    axes.tick_params(labelsize=8)
