"""Solids above a table, and where their corners and rims are at a pose: geometry that knows of no contact."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from scipy.spatial.transform import Rotation

from modelgen import Accuracy, simulate
from modelgen.codegen.library import Library
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Shape
from tests.oracles.pieces import TABLE
from tests.running import library_of

HALF = np.array([0.1, 0.05, 0.03])  # of the box, m
RADIUS, LENGTH = 0.05, 0.12  # of the can, m
DROP = 0.05  # of the lowest point, m
TIGHT = Accuracy.tight()

Heights = dict[str, float]


def _corners() -> dict[str, np.ndarray]:
    words = (("left", "right"), ("front", "back"), ("bottom", "top"))
    return {
        "_".join(words[axis][sign[axis]] for axis in (2, 1, 0)): HALF * (2 * np.array(sign) - 1)
        for sign in product((0, 1), repeat=3)
    }


CORNERS = _corners()


def of_corners(p: np.ndarray, R: np.ndarray) -> Heights:
    """The height of every corner of the box, m."""
    return {name: float(p[2] + R[2] @ x) for name, x in CORNERS.items()}


def of_rims(p: np.ndarray, R: np.ndarray) -> Heights:
    """The height of the lowest point of each rim of the can, m; of three points of it where it lies flat."""
    across, found = float(np.hypot(R[2, 0], R[2, 1])), {}
    for rim, z in (("rim_top", LENGTH / 2), ("rim_bottom", -LENGTH / 2)):
        found[rim] = float(p[2] + R[2, 2] * z - RADIUS * across)
        turns = 2 * np.pi / 3 * np.arange(3) if across < TIGHT.thresholds.flat_angle else ()
        for k, turn in enumerate(turns):
            x = np.array([RADIUS * np.cos(turn), RADIUS * np.sin(turn), z])
            found[f"{rim}.{k + 1}"] = float(p[2] + R[2] @ x)
    return found


@dataclass(frozen=True)
class Solid:
    """What falls: its shape, and the heights of its features at a pose."""

    shape: Callable[[], Shape]
    heights: Callable[[np.ndarray, np.ndarray], Heights]

    def above_the_table(self, axis: Sequence[float], angle: float) -> Library:
        """At rest, turned about an axis, its lowest point at the height DROP."""
        turn = np.array(axis, float) / np.linalg.norm(axis) * angle
        low = min(self.heights(np.zeros(3), Rotation.from_rotvec(turn).as_matrix()).values())
        body = make.dynamic(
            "solid", self.shape(), density=500.0, position=[0.0, 0.0, DROP - low],
            axis_angle={"axis": list(map(float, axis)), "angle": float(angle)},
        )  # fmt: skip
        scene = make.scene("dropped", [TABLE, body], contact=[{"between": ["solid", "table"]}])
        return library_of(scene)

    def at(self, path: Trajectory, sample: int) -> Heights:
        """The heights at a sample of a run."""
        turn = Rotation.from_quat(np.roll(path.quaternion[sample, 1], -1)).as_matrix()
        return self.heights(path.p[sample, 1], turn)


BOX = Solid(lambda: make.box(*(2 * HALF)), of_corners)
CAN = Solid(lambda: make.cylinder(RADIUS, LENGTH), of_rims)


def touching(path: Trajectory, sample: int, within: float) -> set[str]:
    """Features whose contact with the table has a gap below `within` at a sample."""
    on_a_feature_pair = [k for k, feature_pair in enumerate(path.feature_pair[sample]) if feature_pair >= 0]
    return {
        path.feature_pair_names[path.feature_pair[sample, k]]
        for k in on_a_feature_pair
        if abs(path.gap[sample, k]) < within
    }


def run_until(library: Library, until: float, samples: int) -> Trajectory:
    return simulate(library, until=until, samples=samples, accuracy=TIGHT, estimate=False)


def heights_when(solid: Solid, library: Library, t: float) -> Heights:
    """The heights at one time, well before the end of a run, so that its steps are those of a longer one."""
    path = run_until(library, 2 * t, 2)
    assert path.t[1] == t
    return solid.at(path, 1)
