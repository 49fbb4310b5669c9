"""What a run costs: CPU time of the core alone, the least of several runs, beside a yardstick."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from statistics import median

REPEATS, ENOUGH_S = 9, 0.15  # runs of one setting, and the time after which three are enough
BRIEF_S, MOST = 0.02, 200  # brief runs are repeated until they have taken so long, or so often
YARD = 400  # steps of the yardstick


@dataclass(frozen=True, slots=True)
class Cost:
    """CPU time of one run, s: the least; its noise; and the least of the yardstick in between, s."""

    seconds: float
    noise: float | None  # median over least, less one; None for a single run
    yard: float


def cost_of(run: Callable[[], float], yard: Callable[[], float]) -> Cost:
    """Runs and yardstick in turn, so that a slower machine slows both; few runs where one is long."""
    spent, yards = [run()], [yard()]
    while _goes_on(spent):
        spent.append(run())
        yards.append(yard())
    noise = median(spent) / min(spent) - 1 if len(spent) > 1 else None
    return Cost(min(spent), noise, min(yards))


def _goes_on(spent: list[float]) -> bool:
    n, total = len(spent), sum(spent)
    if n >= REPEATS:
        return total < BRIEF_S and n < MOST
    return (total < ENOUGH_S or n < 3) and total < 10 * ENOUGH_S
