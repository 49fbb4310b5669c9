"""Contact parameters to start from: the two surfaces are sampled, the likeliest pairs refined by Newton.

A pair of samples is likely when the points are near each other and the normals opposed; around the likeliest
the surfaces are sampled again, finer. Of all extrema found, the one with the smallest |d| is taken.
"""

from __future__ import annotations

import ctypes
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from modelgen.errors import SimulationError
from modelgen.runtime.session import Session
from modelgen.runtime.tables import Array, address

GRID = 17  # samples along each coordinate of a chart
ZOOMS = 2  # finer samplings around the likeliest pair
STARTS = 6  # pairs refined by Newton
SHRINK = 0.2  # size of a finer window against the one before


@dataclass(frozen=True)
class Patch:
    """Samples of one surface: parameters (n, 2), points in the shape frame and the world, normals (n, 3)."""

    uv: Array
    local: Array
    points: Array
    normals: Array


class Surface:
    """One side of a contact: its kernel, its pose in the world, and the window in which it is sampled."""

    def __init__(self, session: Session, side: Mapping[str, Any], pose: Array, layout: str) -> None:
        kind = session.library.manifest.kinds["shape"][side["kind"]]
        self.name: str = kind["name"]
        self.domain: Sequence[Sequence[float | None]] = kind["domain"]
        self.bounding: float | None = side["bounding"]
        self.layout = layout
        self._function = getattr(session.library.cdll, f"mg_{kind['name']}_surface")
        dtype = session.tables.dtype
        self._in = np.zeros(2, dtype=dtype)
        self._parameters = np.array([*([] if kind["folded"] else side["parameters"]), 0.0], dtype=dtype)
        self._out = np.zeros((2, 3), dtype=dtype)
        inputs = [address(self._in), address(self._parameters)]
        outputs = [address(self._out), address(self._out[1])]
        self._arguments = ((ctypes.c_void_p * 2)(*inputs), (ctypes.c_void_p * 2)(*outputs), None, None, 0)
        place = np.asarray(side["placement"], dtype=float)
        rotation, local = pose[3:].reshape(3, 3).T, place[3:].reshape(3, 3).T
        self.rotation = rotation @ local
        self.origin = pose[:3] + rotation @ place[:3]

    def window(self, reach: float) -> Array:
        """((u_min, u_max), (v_min, v_max)), unbounded coordinates cut at `reach` m."""
        return np.array([[-reach if a is None else a, reach if b is None else b] for a, b in self.domain])

    def sample(self, window: Array) -> Patch:
        """A grid over the window; points where the chart has no normal are left out."""
        axes = [np.linspace(low, high, GRID) for low, high in window]
        uv = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, 2)
        raw = np.empty((len(uv), 2, 3))
        for row, pair in zip(raw, uv, strict=True):
            self._in[:] = pair
            self._function(*self._arguments)
            row[:] = self._out
        kept = np.isfinite(raw).all(axis=(1, 2))
        raw, uv = raw[kept], uv[kept]
        return Patch(uv, raw[:, 0], self.origin + raw[:, 0] @ self.rotation.T, raw[:, 1] @ self.rotation.T)

    def eta(self, patch: Patch, index: int) -> Array:
        """This side's contact parameters at one sample."""
        columns = {"point": patch.local, "chart": patch.uv, "none": patch.uv[:, :0]}
        row: Array = columns[self.layout][index]
        return row


def find_closest(session: Session) -> None:
    """Writes the closest points of every contact into session.eta, at the start's poses.

    Raises:
        SimulationError: no extremum was found from any start; names the contact.
    """
    poses = session.poses()
    for index, contact in enumerate(session.sentence["contacts"]):
        layout = session.layout(index)
        if layout == ["none", "none"]:
            continue
        o = Surface(session, contact["shape_o"], poses[contact["o"]], layout[0])
        f = Surface(session, contact["shape_f"], poses[contact["f"]], layout[1])
        best = _best(session, index, _starts(o, f))
        if best is None:
            raise SimulationError(
                f"contact {contact['name']!r}",
                "no pair of closest points was found at the start",
                "surfaces with a nearest pair there",
                "start the bodies nearer to each other, or away from a symmetric position",
            )
        session.eta[contact["eta"] : contact["eta"] + len(best)] = best


def _starts(o: Surface, f: Surface) -> list[Array]:
    """Contact parameters of the likeliest pairs, finest first."""
    apart = float(np.linalg.norm(f.origin - o.origin))
    reach = apart + max(o.bounding or 0.0, f.bounding or 0.0, 1e-3 * apart)
    windows = o.window(2 * reach), f.window(2 * reach)
    starts: list[Array] = []
    for _ in range(ZOOMS + 1):
        patches = o.sample(windows[0]), f.sample(windows[1])
        pairs = _likeliest(*patches)
        starts = [np.concatenate([o.eta(patches[0], i), f.eta(patches[1], j)]) for i, j in pairs] + starts
        i, j = pairs[0]
        windows = _around(windows[0], patches[0].uv[i]), _around(windows[1], patches[1].uv[j])
    return starts


def _around(window: Array, centre: Array) -> Array:
    half = SHRINK / 2 * (window[:, 1] - window[:, 0])
    return np.stack([centre - half, centre + half], -1)


def _likeliest(o: Patch, f: Patch) -> list[tuple[int, int]]:
    """Indices of the STARTS pairs with the least |P_f - P_o| + size (1 + n_o.n_f)."""
    span = f.points[None, :] - o.points[:, None]
    distance = np.sqrt((span**2).sum(-1))
    size = min(np.ptp(o.points, axis=0).max(), np.ptp(f.points, axis=0).max())
    merit = distance + size * (1.0 + o.normals @ f.normals.T)
    flat = np.argpartition(merit.ravel(), STARTS)[:STARTS]
    ordered = flat[np.argsort(merit.ravel()[flat])]
    return [(int(k) // len(f.points), int(k) % len(f.points)) for k in ordered]


def _best(session: Session, index: int, starts: list[Array]) -> Array | None:
    found: list[tuple[float, Array]] = []
    for start in starts:
        result = session.settle(index, start)
        regular = min(result["margin"]) > session.accuracy.lost
        if result["steps"] >= 0 and regular and np.isfinite(result["d"]):
            found.append((abs(float(result["d"])), result["eta"]))
    return min(found, key=lambda pair: pair[0])[1] if found else None
