"""The error estimate of a run and its statement in words."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

Array = np.ndarray[Any, Any]


@dataclass(frozen=True, slots=True, repr=False)
class Estimate:
    """The estimated global error of a run, from a companion run (`Accuracy.companion`).

    Attributes:
        position: (n,) m, the largest error of a body's centre up to each sample; infinite where the
            companion did not come.
        rotation: (n,) rad, of a body's rotation.
        gap, force, events: m; root mean square, relative; s, with `events_unmatched`, those without their
            like: up to the last sample that is predicted. None where the run has none.
        predicted: how many samples are predicted, at least one.
        horizon: s, the last of them, if there are others: later errors exceed
            `Accuracy.prediction_error_max`.
        uncertified: what the companion cannot show: reasons, each in words.
        rhs_evals: evaluations of the right-hand side that the companion took.
        interrupted: whether Ctrl-C fell into the companion run.
    """

    position: Array
    rotation: Array
    gap: float | None
    force: float | None
    events: float | None
    events_unmatched: int | None
    predicted: int
    horizon: float | None
    uncertified: tuple[str, ...]
    rhs_evals: int
    interrupted: bool = False

    def __repr__(self) -> str:
        return f"<Estimate: {self.statement}>"

    @property
    def status(self) -> str:
        """`estimated`, `beyond predictable horizon` or `uncertified`."""
        if self.uncertified:
            return "uncertified"
        return "estimated" if self.horizon is None else "beyond predictable horizon"

    @property
    def statement(self) -> str:
        """One line for the summary."""
        last = self.predicted - 1
        if not np.isfinite(self.position[last]):
            return "; ".join(f"uncertified: {reason}" for reason in self.uncertified)
        turned = f", {self.rotation[last]:.2g} rad" if self.rotation[last] else ""
        parts = [f"estimated error {self.position[last]:.2g} m{turned}"]
        if self.horizon is not None:
            parts = [f"beyond predictable horizon ({self.horizon:.6g} s)", f"{parts[0]} up to there"]
        return "; ".join([*parts, *(f"uncertified: {reason}" for reason in self.uncertified)])

    def as_json(self) -> dict[str, Any]:
        """The entry `estimate` of a summary; position and rotation at the last sample that is predicted."""
        last = self.predicted - 1
        known = bool(np.isfinite(self.position[last]))
        return {
            "status": self.status,
            "statement": self.statement,
            "position": float(self.position[last]) if known else None,
            "rotation": float(self.rotation[last]) if known else None,
            "gap": self.gap,
            "force": self.force,
            "events": self.events,
            "events_unmatched": self.events_unmatched,
            "horizon": self.horizon,
            "uncertified": list(self.uncertified),
            "rhs_evals": self.rhs_evals,
        }
