"""A survey of the extremes as a person reads it."""

from __future__ import annotations

from collections.abc import Sequence

from rich.console import Console
from rich.text import Text

from modelgen.benchmark.extreme_trials import Extreme, Found
from modelgen.benchmark.extremes_survey import EXTREMES, Survey

HEAD = ("extreme", "driven", "safe", "warned", "refused", "law of loss", "worst", "holds")


def print_survey(found: Survey, console: Console) -> None:
    """A line an extreme, and the values at which it does not hold."""
    cells = [HEAD, *(_row(each, found.of(each)) for each in EXTREMES if found.of(each))]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    for number, row in enumerate(cells):
        line = "  ".join(text.ljust(width) for text, width in zip(row, widths, strict=True)).rstrip()
        console.print(Text(line, style="" if number else "bold"), soft_wrap=True)
    for each in found.found:
        if not each.holds:
            console.print(Text(_failure(each)), soft_wrap=True)
    if found.interrupted:
        console.print("interrupted: what was found is above, the same command begins anew", soft_wrap=True)


def _row(extreme: Extreme, found: Sequence[Found]) -> tuple[str, ...]:
    """The worst is the largest error over its law."""
    shares = [each.trial.error / each.allowed for each in found if each.trial.error is not None]
    verdicts = ("safe", "warned", "refused")
    ranges = [_ranges(found, verdict) for verdict in verdicts]
    worst = f"{max(shares):.0e} of it" if shares else "-"
    holds = "yes" if all(each.holds for each in found) else "NO"
    return (extreme.name, extreme.of, *ranges, extreme.law, worst, holds)


def _ranges(found: Sequence[Found], verdict: str) -> str:
    """The values with this verdict by size, as runs `1e-09 .. 0.001`; between two, others have another."""
    runs: list[list[float]] = []
    for each in sorted(found, key=lambda each: each.value):
        if each.trial.verdict == verdict:
            runs = runs or [[]]
            runs[-1].append(each.value)
        elif runs and runs[-1]:
            runs.append([])
    return ", ".join(_range(run) for run in runs if run) or "-"


def _range(run: Sequence[float]) -> str:
    return f"{run[0]:g}" if len(run) == 1 else f"{run[0]:g} .. {run[-1]:g}"


def _failure(found: Found) -> str:
    error = "no result" if found.trial.error is None else f"error {found.trial.error:.2e}"
    told = "; ".join(found.trial.told) or "nothing"
    wanted = f"{found.extreme.expected(found.value)}, {found.allowed:.2e}"
    what = f"{found.extreme.name} at {found.value:g}: {found.trial.verdict}, {error}"
    return f"{what}, expected {wanted}; told: {told}"
