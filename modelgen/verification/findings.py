"""Findings of a check of a formula: proved by an identity, or compared on random configurations."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

Array = np.ndarray[Any, Any]
Status = Literal["proved", "tested", "failed"]
AGREE = 1e-8  # largest relative error of two routes in double precision, away from singularities


@dataclass(frozen=True, slots=True)
class Finding:
    """One quantity of a formula against an independent route."""

    quantity: str
    status: Status
    route: str  # in words: what it was compared with, or the identity
    n: int = 0  # configurations
    worst: float = 0.0  # relative error
    unit: str = "1"

    def as_dict(self) -> dict[str, Any]:
        names = ("quantity", "status", "route", "n", "worst")
        return {name: getattr(self, name) for name in names}


def compared(quantity: str, route: str, found: Array, wanted: Array) -> Finding:
    """Columns of `found` against those of `wanted`, relative to the larger of the column's size and the
    median size of all columns; numbers that are not finite count as failures."""
    found, wanted = np.atleast_2d(found), np.atleast_2d(wanted)
    n = wanted.shape[1]
    if not wanted.size:
        return Finding(quantity, "tested", route, n, 0.0)
    sizes = np.linalg.norm(wanted, axis=0)
    scale = np.maximum(np.maximum(sizes, np.median(sizes)), 1e-300)
    errors = np.linalg.norm(found - wanted, axis=0)
    exact = bool((errors == 0).all())
    worst = 0.0 if exact else float(np.max(errors / scale)) if np.isfinite(errors).all() else float("inf")
    return Finding(quantity, "tested" if n and worst < AGREE else "failed", route, n, worst)


def proved(quantity: str, route: str, holds: bool) -> Finding:
    """An identity that SymPy decided."""
    return Finding(quantity, "proved" if holds else "failed", route)
