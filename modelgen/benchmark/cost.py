"""Cost of a run: CPU time of the core alone, relative to a yardstick that is run beside it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from statistics import median

REPEATS, ENOUGH_S = 9, 0.15  # runs of one setting, and the time after which three are enough
BRIEF_S, MOST = 0.02, 200  # brief runs are repeated until they have taken so long, or so often
YARD = 400  # steps of the yardstick


@dataclass(frozen=True, slots=True)
class Cost:
    """CPU time of one run where the yardstick takes `yard`, s, and its noise."""

    seconds: float
    noise: float | None  # median over least, less one; None for a single run
    yard: float  # the least


def cost_of(run: Callable[[], float], yard: Callable[[], float]) -> Cost:
    """Runs and yardstick in turn, few where one is long; the median of their ratios counts: a machine that is
    slow for a while slows both."""
    spent, yards = [run()], [yard()]
    while _goes_on(spent):
        spent.append(run())
        yards.append(yard())
    shares = [one / beside for one, beside in zip(spent, yards, strict=True)]
    noise = median(shares) / min(shares) - 1 if len(shares) > 1 else None
    return Cost(median(shares) * min(yards), noise, min(yards))


def _goes_on(spent: list[float]) -> bool:
    n, total = len(spent), sum(spent)
    if n >= REPEATS:
        return total < BRIEF_S and n < MOST
    return (total < ENOUGH_S or n < 3) and total < 10 * ENOUGH_S
