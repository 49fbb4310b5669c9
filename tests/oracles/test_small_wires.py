"""A ring or a disc falls onto a wire down to a thousandth of its size, open or closed, and touches it.

Judge: straight above or below each point of the wire the plane of the disc has one point; the heights
between them, and where the wire passes under the rim, by roots along it. Ends of the wire touch nothing:
members in which one is below the disc first are left out. No member may be wrong and trusted.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import hypot, sqrt

import numpy as np
import pytest
from scipy.optimize import brentq, minimize_scalar
from scipy.spatial.transform import Rotation

from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Shape
from tests.oracles.pieces import G, ran

Array = np.ndarray[tuple[int, ...], np.dtype[np.float64]]
PARTS = 2000  # of the wire


@dataclass(frozen=True)
class Wire:
    """A curve about the origin, seen from the centre of a ring of radius 1 m at orientation R from `at`."""

    size: float  # m
    a: float
    b: float
    c: float
    end: float
    is_closed: bool
    R: Array
    at: Array

    def point(self, t: float | Array) -> Array:
        """(..., 3) m, from the centre of the ring."""
        x, y = np.cos(t) + self.c * np.cos(2 * t), self.a * np.sin(t)
        return self.at + self.size * np.stack([x, y, self.b * np.sin(2 * t + 1)], axis=-1)

    def offset(self, t: float | Array) -> Array:
        """Of the point of the plane of the ring straight above or below that point, from the centre, m."""
        x = self.point(t)
        x[..., 2] = -(x[..., :2] @ self.R[:2, 2]) / self.R[2, 2]
        return x

    def height(self, t: float | Array) -> Array:
        """Of that point above the wire, m."""
        return np.asarray(self.offset(t)[..., 2] - self.point(t)[..., 2])

    def beside(self, t: float | Array) -> Array:
        """Distance from the rim in the plane of the ring, negative within, m."""
        return np.asarray(np.linalg.norm(self.offset(t), axis=-1) - 1)

    def first_height(self, is_disc: bool) -> float:
        """At which a ring or a disc touches the wire first, m; inf where that is an end of the wire, or
        nowhere."""
        t = np.linspace(0, self.end, PARTS + 1)
        out, heights = self.beside(t), self.height(t)
        crossings = np.flatnonzero(out[:-1] * out[1:] < 0)
        found = [float(self.height(brentq(self.beside, t[k], t[k + 1], xtol=1e-15))) for k in crossings]
        if is_disc:
            lowest = (heights[1:-1] <= np.minimum(heights[:-2], heights[2:])) & (out[1:-1] < 0)
            for k in np.flatnonzero(lowest) + 1:
                bounds = float(t[k - 1]), float(t[k + 1])
                found.append(float(minimize_scalar(self.height, bounds=bounds, options={"xatol": 1e-13}).fun))
        first = min(found, default=np.inf)
        ends = heights[[0, -1]][out[[0, -1]] < 0] if is_disc and not self.is_closed else heights[:0]
        return first if first < ends.min(initial=np.inf) else np.inf

    @property
    def shape(self) -> Shape:
        return make.curve(
            "s*(cos(t) + c*cos(2*t))", "s*a*sin(t)", "s*b*sin(2*t + 1)", domain=[0.0, self.end],
            periodic=self.is_closed, parameters={"s": self.size, "a": self.a, "b": self.b, "c": self.c},
        )  # fmt: skip


def drawn(rng: np.random.Generator) -> Wire:
    """Some of it is straight below or above the rim, or beside that by a part of its size."""
    size, is_closed = 10 ** rng.uniform(-3, 0), bool(rng.integers(2))
    end = 2 * np.pi if is_closed else rng.uniform(2, 5)
    a, b, c = rng.uniform(0.2, 0.6), 10 ** rng.uniform(-1.5, 0), rng.uniform(-0.3, 0.3)
    R, angle = Rotation.random(random_state=rng).as_matrix(), rng.uniform(0, 2 * np.pi)
    wire = Wire(size, a, b, c, float(end), is_closed, R, np.zeros(3))
    at = R @ [np.cos(angle), np.sin(angle), 0] - wire.point(rng.uniform(0, end))
    at += 0.3 * size * rng.normal(size=3) * [1, 1, 0]
    return Wire(size, a, b, c, float(end), is_closed, R, at)


@pytest.mark.cases(20)
@pytest.mark.parametrize("is_disc", [False, True])
@pytest.mark.parametrize("seed", range(400))
def test_a_ring_or_a_disc_touches_a_small_wire_in_time(seed: int, is_disc: bool) -> None:
    rng = np.random.default_rng([is_disc, seed])
    wire = drawn(rng)
    while abs(wire.R[2, 2]) < 0.1 or wire.first_height(is_disc) == np.inf:
        wire = drawn(rng)
    drop = wire.size * 10 ** rng.uniform(-1, 1)
    x, y, z, w = map(float, Rotation.from_matrix(wire.R).as_quat())
    above = float(drop - wire.first_height(is_disc) - wire.at[2])
    ring = make.dynamic(
        "ring", make.disc(1.0) if is_disc else make.circle(1.0), mass=1.0, inertia=[0.4] * 3,
        position=[float(-wire.at[0]), float(-wire.at[1]), above], quaternion=[w, x, y, z],
    )  # fmt: skip
    contact = [{"between": ["ring", "wire"]}]
    path = ran([make.fixed("wire", wire.shape), ring], 1.1 * sqrt(2 * drop / G), contact)
    touched = [event.t for event in path.events if event.kind in ("touch-down", "impact")]
    if path.is_trusted:
        assert touched
        assert G * touched[0] ** 2 / 2 == pytest.approx(drop, abs=1e-8 * hypot(1.0, drop))
