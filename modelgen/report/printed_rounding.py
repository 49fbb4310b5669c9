"""Numbers as a person reads them: what rounding leaves beside larger ones is 0."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import isnan
from typing import Any

NOISE = 1e-13  # numbers below this part of the largest of their kind are printed as 0


def vector_text(values: Iterable[float], noise: float = 0.0, digits: int = 5) -> str:
    """The components, those up to `noise` as 0."""
    return " ".join(f"{0.0 if abs(value) <= noise else value:.{digits}g}" for value in values)


def largest(named: Mapping[str, Any], key: str) -> float:
    """The largest component of the vectors `key` of all entries."""
    return max(
        (abs(value) for each in named.values() for value in each[key] if not isnan(value)), default=0.0
    )


def noise_of_joints(joints: Mapping[str, Any], length: float) -> dict[str, float]:
    """What rounding leaves of forces and torques of joints; `length`: m, of their lever arms."""
    force = largest(joints, "force")
    return {"force": NOISE * force, "torque": NOISE * max(force * length, largest(joints, "torque"))}
