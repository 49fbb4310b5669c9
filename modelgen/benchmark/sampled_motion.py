"""A run as measurements see it, whoever made it: samples of bodies and forces, events and invariants."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from modelgen.runtime.trajectory import Event, Trajectory

Array = np.ndarray[Any, Any]


@dataclass(frozen=True, slots=True)
class Bodies:
    """The bodies that move, and the scale that errors are measured against."""

    length: float  # m
    moving: tuple[int, ...]  # indices among all bodies
    turning: tuple[bool, ...]  # of those: whether their rotation is followed
    mass: tuple[float, ...]  # kg, of those

    @classmethod
    def of(cls, instance: Mapping[str, Any]) -> Bodies:
        """The bodies of a manifest's instance."""
        bodies = [(k, b) for k, b in enumerate(instance["bodies"]) if b["motion"] in ("point", "free")]
        return cls(
            length=instance["scales"]["length"],
            moving=tuple(k for k, _ in bodies),
            turning=tuple(b["motion"] == "free" for _, b in bodies),
            mass=tuple(1 / b["mass_inverse"][0] for _, b in bodies),
        )


@dataclass(frozen=True, slots=True)
class Motion:
    """Samples at times t (n,) of the nb bodies that move."""

    t: Array  # s
    p: Array  # (n, nb, 3) m
    rotation: Array  # (n, nb, 4) quaternions (w, x, y, z)
    v: Array  # (n, nb, 3) m/s
    force: Array | None  # (n, nc) N
    events: Sequence[Event] | None
    invariants: Mapping[str, float]  # by name: energy (relative), gap and joints (over the length)


def uninterrupted(path: Trajectory) -> Trajectory:
    """The run; Ctrl-C in it, or in its companion, is Ctrl-C again."""
    if path.interrupted:
        raise KeyboardInterrupt
    return path


def motion_of(path: Trajectory, bodies: Bodies) -> Motion:
    """The motion of a run of this program."""
    chosen = list(bodies.moving)
    return Motion(
        t=path.t,
        p=path.p[:, chosen],
        rotation=path.quaternion[:, chosen],
        v=path.v[:, chosen],
        force=path.force,
        events=path.events,
        invariants={
            "energy": path.energy_drift,
            "gap": path.gap_max / bodies.length,
            **({"joints": path.joint_error_max / bodies.length} if path.joint_names else {}),
        },
    )
