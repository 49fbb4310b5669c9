"""Two bodies on random motions, and joints of every kind between them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import mpmath as mp
import numpy as np
from scipy.spatial.transform import Rotation

from modelgen.joint.joint_equations import FORMS
from modelgen.model import JointKind
from modelgen.scene.expression import parse_expression
from tests.laws.differenced import moved

MOTION = parse_expression("0.3 + 0.7*sin(2*t) - 0.2*t**3", ("t",))
KINDS = (
    *(JointKind(kind, kind) for kind in FORMS if kind != "rope"),
    *(JointKind(f"{kind}_moved", kind, MOTION) for kind, form in FORMS.items() if form.given),
)
SPRUNG = tuple(
    kind for kind, form in FORMS.items() if form.coordinates and kind not in ("planar", "spherical")
)
LENGTH = 0.37


@dataclass(frozen=True)
class Motion:
    """A body at t: pose (12), twist (6), and the rate of the twist (6)."""

    pose: np.ndarray
    twist: np.ndarray
    accel: np.ndarray

    def later(self, h: Any) -> list[Any]:
        """The pose a time h later, by the exponential series."""
        p, R = moved(self.pose, self.twist, self.accel, h)
        return [*p, *(R[i, j] for j in range(3) for i in range(3))]


def pose(rng: np.random.Generator, size: float = 1.0) -> np.ndarray:
    turn = Rotation.from_rotvec(rng.normal(size=3)).as_matrix()
    return np.concatenate([size * rng.normal(size=3), turn.ravel(order="F")])


def motion(rng: np.random.Generator) -> Motion:
    return Motion(pose(rng), rng.normal(size=6), rng.normal(size=6))


def parameters(kind: str, rng: np.random.Generator) -> np.ndarray:
    """Placements, length, and numbers of the kind."""
    own = {"screw": [0.2], "distance": [0.8]}.get(kind, [])
    if kind == "gear":
        own = [17, -5, *pose(rng)[3:], *pose(rng)[3:]]
    return np.array([*pose(rng, 0.3), *pose(rng, 0.3), LENGTH, *own])


def unit(h: int) -> Any:
    """10^-h."""
    return mp.mpf(10) ** -h
