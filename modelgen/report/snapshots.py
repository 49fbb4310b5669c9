"""Pictures of the bodies at chosen times of a run."""

from __future__ import annotations

from typing import Any

import numpy as np

from modelgen.report.run_record import Array, Record

GRID = 9  # lines of a plane that is cut to the view, each way
ROOM = 1.25  # of the view, against the reach of the bodies
WIDE = 3.0  # a surface that reaches so many times farther is cut


def frame_samples(record: Record, count: int) -> list[int]:
    """The samples of `count` pictures: the start, the first change of mode that is nearer to a later sample,
    and on from there evenly to the end; evenly from the start where there is no such change."""
    t = record.columns["t"]
    after = float(np.mean(t[:2]))
    changes = [event["t"] for event in record.summary["events"] if event["t"] > after]
    times = np.linspace(t[0], t[-1], count)
    if changes and count > 2:
        times = np.concatenate([t[:1], np.linspace(min(changes), t[-1], count - 1)])
    return [int(np.abs(t - time).argmin()) for time in times]


def draw_frames(record: Record, samples: list[int], panels: list[Any]) -> None:
    """One picture a sample, all to one scale, each about the bodies that move."""
    meshes = _meshes_by_body(record)
    sizes = [_view(record, meshes, sample) for sample in samples]
    half = ROOM * max((size for _, size in sizes), default=0.0)
    for axes, sample, (centre, _) in zip(panels, samples, sizes, strict=True):
        axes.set_title(f"t = {record.columns['t'][sample]:.4g} s")
        for body, grids in meshes.items():
            for grid in grids:
                _wire(axes, _cut(_placed(record, body, sample, grid), centre, half), body in record.moving)
        _look(axes, centre, half)


def _meshes_by_body(record: Record) -> dict[int, list[Array]]:
    """The surfaces of the contacts by body, each once."""
    found: dict[int, dict[bytes, Array]] = {}
    for key, mesh in record.meshes.items():
        contact, side = key.split("_")
        body = int(record.pairs[int(contact), "of".index(side)])
        found.setdefault(body, {})[np.round(mesh, 12).tobytes()] = mesh
    return {body: list(grids.values()) for body, grids in found.items()}


def _placed(record: Record, body: int, sample: int, grid: Array) -> Array:
    """A grid of a body in the world at a sample; not turned where its turning was left out."""
    w, *axis = np.nan_to_num(record.columns["quaternion"][sample, body])
    inner = 2.0 * np.cross(axis, grid)
    placed: Array = grid + w * inner + np.cross(axis, inner) + record.columns["p"][sample, body]
    return placed


def _view(record: Record, meshes: dict[int, list[Array]], sample: int) -> tuple[Array, float]:
    """Centre and half size of what moves, at a sample."""
    moving = [body for body in record.moving if body in meshes] or list(meshes)
    points = np.vstack(
        [_placed(record, body, sample, grid).reshape(-1, 3) for body in moving for grid in meshes[body]]
    )
    low, high = np.nanmin(points, axis=0), np.nanmax(points, axis=0)
    return (low + high) / 2, float((high - low).max()) / 2


def _cut(grid: Array, centre: Array, half: float) -> Array:
    """The grid; of a plane much wider than the view, the part before it."""
    points = grid.reshape(-1, 3)
    points = points[np.isfinite(points).all(axis=1)]
    middle = points.mean(axis=0)
    reach = np.abs(points - middle).max()
    if reach <= WIDE * half:
        return grid
    _, spread, axes = np.linalg.svd(points - middle, full_matrices=False)
    if spread[2] > 1e-9 * spread[0]:
        return grid
    foot = centre - axes[2] * float(axes[2] @ (centre - middle))
    u, v = np.meshgrid(*2 * [np.linspace(-half, half, GRID)])
    return np.asarray(foot + u[..., None] * axes[0] + v[..., None] * axes[1])


def _wire(axes: Any, grid: Array, moves: bool) -> None:
    axes.plot_wireframe(
        *np.moveaxis(grid, -1, 0), linewidth=0.5, color="tab:blue" if moves else "0.7", rcount=100, ccount=100
    )


def _look(axes: Any, centre: Array, half: float) -> None:
    for setter, middle in zip((axes.set_xlim, axes.set_ylim, axes.set_zlim), centre, strict=True):
        setter(middle - half, middle + half)
    axes.set_box_aspect((1, 1, 1))
    axes.view_init(elev=15, azim=-70)
    axes.locator_params(nbins=3)
    axes.tick_params(labelsize="x-small")
