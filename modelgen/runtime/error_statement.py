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
        velocity: (n,) m/s, of the velocity of a body's centre.
        spin: (n,) rad/s, of a body's angular velocity.
        gap: m, up to the last sample that is predicted, as `force` and `events`; None where the run has none,
            as they are.
        force: of the normal forces of contacts, root mean square, relative; with what rounding may change.
        events: s, of the times of events; of later ones where none comes before that sample. How many events
            have no like in the companion is `events_unmatched`.
        events_doubt: why the events are not certain, in words, though the motion may be; "" if they are.
        predicted: how many samples are predicted, at least one.
        horizon: s, the last of them, if there are others: later errors exceed
            `Accuracy.thresholds.prediction_error_max`.
        uncertified: what the companion cannot show: reasons, each in words.
        rhs_evals: evaluations of the right-hand side that the companion took.
        interrupted: whether Ctrl-C fell into the companion run.
    """

    position: Array
    rotation: Array
    velocity: Array
    spin: Array
    gap: float | None
    force: float | None
    events: float | None
    events_unmatched: int | None
    predicted: int
    horizon: float | None
    uncertified: tuple[str, ...]
    rhs_evals: int
    events_doubt: str = ""
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
        units = {"m": self.position, "rad": self.rotation, "m/s": self.velocity, "rad/s": self.spin}
        known = [f"{errors[last]:.2g} {unit}" for unit, errors in units.items() if errors[last]]
        parts = [f"estimated error {', '.join(known)}"]
        if self.horizon is not None:
            parts = [f"beyond predictable horizon ({self.horizon:.6g} s)", f"{parts[0]} up to there"]
        parts += [f"uncertified: {reason}" for reason in self.uncertified]
        return "; ".join([*parts, *([self.events_doubt] if self.events_doubt else [])])

    def as_json(self) -> dict[str, Any]:
        """The entry `estimate` of a summary; errors of samples are those at the last that is predicted."""
        last = self.predicted - 1
        known = bool(np.isfinite(self.position[last]))
        samples = {key: getattr(self, key)[last] for key in ("position", "rotation", "velocity", "spin")}
        return {
            "status": self.status,
            "statement": self.statement,
            **{key: float(error) if known else None for key, error in samples.items()},
            "gap": self.gap,
            "force": self.force,
            "events": self.events,
            "events_unmatched": self.events_unmatched,
            "events_doubt": self.events_doubt,
            "horizon": self.horizon,
            "uncertified": list(self.uncertified),
            "rhs_evals": self.rhs_evals,
        }
