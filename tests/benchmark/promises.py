"""What `tune` promises of a shipped scene, decade by decade, and whether a fresh run keeps it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from modelgen import measure, tune
from modelgen.benchmark.tuning import BAND
from modelgen.benchmark.work_precision_front import place
from modelgen.errors import ModelgenError
from tests.benchmark.cases import scene_named

DECADES = range(3, 11)
KNOBS = ("tolerance",)


@dataclass
class Promises:
    """What became of each demand on a scene: `kept` errors by decade, `refused` words, costs over budgets."""

    scene: str
    best: float  # error that was measured
    horizon: float | None
    reference_error: float
    kept: dict[int, float] = field(default_factory=dict)
    refused: dict[int, str] = field(default_factory=dict)
    over_budget: dict[float, float] = field(
        default_factory=dict
    )  # verified cost over the budget, by budget, ns/s

    @property
    def reachable(self) -> int:
        """The last decade of those that were kept without a gap."""
        last = 0
        for decade in DECADES:
            if decade not in self.kept:
                break
            last = decade
        return last

    @property
    def broken(self) -> list[str]:
        """What was promised and not kept, or refused without naming what can be had."""
        named = ("the reachable error is", "an error can be promised up to")
        missed = [f"1e-{k}: {error:.2g}" for k, error in self.kept.items() if error > 10.0**-k]
        silent = [f"1e-{k}: {text}" for k, text in self.refused.items() if not any(n in text for n in named)]
        dear = [f"{b:.3g} ns: {over:.2f}" for b, over in self.over_budget.items() if over > 1 + BAND]
        return missed + silent + dear


def promises(
    name: str,
    root: Path,
    until: float | None = None,
    decades: Sequence[int] = DECADES,
    budgets: Sequence[float] = (0.0, 0.5, 1.0),
) -> Promises:
    """Demands each decade of a scene, and what the points at these places of its front cost."""
    scene = scene_named(name)
    found = measure(scene, until=until, knobs=KNOBS, root=root)
    points = found.front
    best = place(points[-1])[1] if points else float("inf")
    result = Promises(name, best, found.reference["horizon"], found.reference["error"])
    for decade in decades:
        try:
            tuned = tune(scene, error=10.0**-decade, until=until, knobs=KNOBS, root=root)
        except ModelgenError as refusal:
            result.refused[decade] = str(refusal)
        else:
            result.kept[decade] = tuned.point.error or 0.0
    for share in budgets:
        budget = place(points[round(share * (len(points) - 1))])[0]
        try:
            tuned = tune(scene, budget=budget, until=until, knobs=KNOBS, root=root)
        except ModelgenError:
            result.over_budget[budget] = float("inf")
        else:
            result.over_budget[budget] = (tuned.point.cost_ns_per_s or 0.0) / budget
    return result
