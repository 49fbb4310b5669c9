"""A survey of the extremes as a person reads it."""

from __future__ import annotations

from collections.abc import Sequence

from rich.console import Console
from rich.text import Text

from modelgen.measure.extremes import Extreme, Found
from modelgen.measure.survey import EXTREMES, Survey

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
    ranges = [_range([each.value for each in found if each.trial.verdict == verdict]) for verdict in verdicts]
    worst = f"{max(shares):.0e} of it" if shares else "-"
    holds = "yes" if all(each.holds for each in found) else "NO"
    return (extreme.name, extreme.of, *ranges, extreme.law, worst, holds)


def _range(values: Sequence[float]) -> str:
    if not values:
        return "-"
    ends = f"{values[0]:g}", f"{values[-1]:g}"
    return ends[0] if ends[0] == ends[1] else " .. ".join(ends)


def _failure(found: Found) -> str:
    error = "no result" if found.trial.error is None else f"error {found.trial.error:.2e}"
    told = "; ".join(found.trial.told) or "nothing"
    wanted = f"{found.extreme.expected(found.value)}, {found.allowed:.2e}"
    what = f"{found.extreme.name} at {found.value:g}: {found.trial.verdict}, {error}"
    return f"{what}, expected {wanted}; told: {told}"
