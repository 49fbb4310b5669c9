"""Samples of the two sides of a contact, surfaces and curves alike, from their compiled kernels."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from modelgen.runtime.session import ETA_SIZE, Session
from modelgen.runtime.tables import Array, address

GRID = 17  # samples along each coordinate of a chart; GRID^2 along a curve
DOUBLINGS = 30  # of the window of a curve without ends, until it leaves the reach


@dataclass(frozen=True)
class Patch:
    """Samples: parameters (n, 2) or (n, 1), points in the shape frame and the world, unit normals or
    tangents in the world (n, 3)."""

    uv: Array
    local: Array
    points: Array
    directions: Array

    @property
    def is_curve(self) -> bool:
        return bool(self.uv.shape[1] == 1)


class Sampled:
    """One side of a contact: its kernel and its pose in the world."""

    def __init__(self, session: Session, side: Mapping[str, Any], pose: Array, layout: str) -> None:
        kind = session.library.manifest.kinds["shape"][side["kind"]]
        self.domain: Sequence[Sequence[float | None]] = kind["domain"]
        self.bounding: float | None = side["bounding"]
        self.is_curve = len(self.domain) == 1
        self.layout = layout
        role = "curve" if self.is_curve else "surface"
        self._function = getattr(session.library.cdll, f"mg_{kind['name']}_{role}")
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

    def _at(self, uv: Array) -> Array:
        """Point and normal or derivative (2, 3) at one parameter."""
        self._in[: len(uv)] = uv
        self._function(*self._arguments)
        return self._out

    def window(self, reach: float) -> Array:
        """Bounds (1 or 2, 2); where there are none, the coordinate is cut at `reach` m."""
        far = self._extent(reach) if self.is_curve else reach
        return np.array([[-far if a is None else a, far if b is None else b] for a, b in self.domain])

    def _extent(self, reach: float) -> float:
        """The parameter at which a curve without ends is farther than `reach` on both sides."""
        far = reach / float(np.linalg.norm(self._at(np.zeros(1))[1]))
        for _ in range(DOUBLINGS):
            ends = [float(np.linalg.norm(self._at(np.array([t]))[0])) for t in (-far, far)]
            if min(ends) >= reach:
                break
            far *= 2
        return far

    def sample(self, window: Array) -> Patch:
        """A grid over the window; points where a chart has no normal are left out."""
        axes = [np.linspace(low, high, GRID**2 if self.is_curve else GRID) for low, high in window]
        uv = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, len(window))
        raw = np.stack([self._at(pair).astype(float) for pair in uv])
        kept = np.isfinite(raw).all(axis=(1, 2))
        raw, uv = raw[kept], uv[kept]
        directions = raw[:, 1] / np.linalg.norm(raw[:, 1], axis=1, keepdims=True)
        return Patch(uv, raw[:, 0], self.origin + raw[:, 0] @ self.rotation.T, directions @ self.rotation.T)

    def eta(self, patch: Patch, index: int) -> Array:
        """This side's contact parameters at one sample; signs of a curve positive."""
        row: Array = patch.local[index] if self.layout == "point" else patch.uv[index]
        return np.append(row, [1.0, 1.0]) if self.layout == "signed_curve" else row[: ETA_SIZE[self.layout]]
