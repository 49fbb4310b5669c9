"""A measurement as a person reads it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from rich.console import Console
from rich.text import Text

from modelgen.benchmark.callgrind_counts import why_not_counted
from modelgen.benchmark.measurement import SHOWN, Measurement
from modelgen.benchmark.peers import PeerPoints
from modelgen.benchmark.tuning import BAND, Tuned
from modelgen.benchmark.work_precision_front import Point, spaced

KINDS = {  # of errors, with the heads of their columns
    "position": "position m",
    "rotation": "rotation rad",
    "force": "force rel",
    "events": "events s",
    "energy": "energy rel",
    "gap": "gap rel",
    "joints": "joints rel",
}

COSTS = {  # beside CPU time: head of the column, and its unit
    "instructions_per_s": ("kinstr per s", 1e3),
    "binary_bytes": ("kB", 1e3),
    "compile_s": ("compile s", 1.0),
}


def print_measurement(found: Measurement, console: Console) -> None:
    """Print the reference, the knobs and the front by rising cost."""
    _print_reference(found, console)
    noise = "unknown" if found.noise is None else f"{100 * found.noise:.0f} %"
    console.print(
        f"{len(found.points)} settings ({found.reused} remembered), knobs: {_turned(found.knobs)}; "
        f"repeats scatter by {noise}; error: "
        f"largest distance of body points over the length {found.length:.6g} m",
        markup=False,
        soft_wrap=True,
    )
    cited = [point for peer in found.peers for point in peer.cited(found.points)]
    _print_front(found.subject.scene.name, found.front, found.knobs, cited, console)
    for peer in found.peers:
        _print_peer(peer, found, console)
    if why_not_counted():
        console.print(why_not_counted(), markup=False, soft_wrap=True)
    if found.interrupted:
        console.print(found.interrupted, markup=False, soft_wrap=True)


def _turned(knobs: dict[str, list[Any]]) -> str:
    """The names of those that are turned; those that are not, with their value."""
    return ", ".join(
        name if len(values) > 1 else f"{name} {values[0]} (not turned)" for name, values in knobs.items()
    )


def _print_reference(found: Measurement, console: Console) -> None:
    facts = found.reference
    first, second = facts["made_by"]
    console.print(
        f"{found.subject.scene.name}, {found.subject.until:g} s against {first}; "
        f"{second} differs by {facts['error']:.1e}; a rounding grows {facts['growth']:.2g} times",
        markup=False,
        soft_wrap=True,
    )
    if facts["ending"]:
        console.print(
            f"the runs end at {facts['end']:.6g} s: {facts['ending']}", markup=False, soft_wrap=True
        )
    if facts["horizon"] is not None:
        spread = ", ".join(f"{name} {value:.1e}" for name, value in facts["spread"].items())
        console.print(
            f"horizon {facts['horizon']:.6g} s: {facts['reason']}. Trajectories are compared up to it; "
            f"beyond it energy and gap count, and distributions; those of the references differ by: {spread}",
            markup=False,
            soft_wrap=True,
        )


def _print_front(
    title: str,
    points: Sequence[Point],
    knobs: dict[str, list[Any]],
    cited: Sequence[Point],
    console: Console,
) -> None:
    """Rows of the front, those cited among them, each with the knobs that are not at their first value."""
    shown = spaced(points, SHOWN, cited)
    kinds = [kind for kind in KINDS if any(point.errors.get(kind) is not None for point in shown)]
    costs = [cost for cost in COSTS if any(point.costs.get(cost) is not None for point in shown)]
    heads = (*(COSTS[cost][0] for cost in costs), *(KINDS[kind] for kind in kinds))
    rows = [("error", "µs per s", *heads, "settings")]
    for point in shown:
        errors = ["-" if point.errors.get(kind) is None else f"{point.errors[kind]:.1e}" for kind in kinds]
        spent = ["-" if point.costs.get(c) is None else f"{point.costs[c] / COSTS[c][1]:.3g}" for c in costs]
        cost = (point.cost_ns_per_s or 0.0) / 1e3
        rows.append((f"{point.error:.1e}", f"{cost:.4g}", *spent, *errors, settings_text(point, knobs)))
    _print_rows(title, rows, console)


def _print_rows(title: str, rows: Sequence[tuple[str, ...]], console: Console) -> None:
    """Aligned columns, numbers to the right and the last to the left; a terminal wraps what is too long."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    console.print(Text(title, style="italic"), soft_wrap=True)
    for number, row in enumerate(rows):
        cells = [cell.rjust(width) for cell, width in zip(row[:-1], widths, strict=False)]
        console.print(Text("  ".join([*cells, row[-1]]), style="" if number else "bold"), soft_wrap=True)


def settings_text(point: Point, knobs: dict[str, list[Any]]) -> str:
    """`tolerance 1e-08, form implicit`: ladders, and what is turned from its first value."""
    turned = [
        f"{name} {value}"
        for name, value in point.settings.items()
        if isinstance(value, float) or name not in knobs or value != knobs[name][0]
    ]
    return ", ".join(turned)


def _print_peer(peer: PeerPoints, found: Measurement, console: Console) -> None:
    if peer.cannot:
        console.print(f"{peer.name} cannot represent this scene: {'; '.join(peer.cannot)}", soft_wrap=True)
        return
    first = {name: [value] for point in reversed(peer.points) for name, value in point.settings.items()}
    cited = peer.cited(found.points)
    _print_front("; ".join([peer.name, *peer.differs]), peer.front, first, cited, console)
    if peer.left:
        others = ", ".join(name for name in peer.left if name not in peer.turned)
        console.print(
            f"--knobs names none of the settings of {peer.name}: {', '.join(peer.turned)} alone is varied, "
            "so that its cost says nothing of the two programs; add some of "
            f"{others or ', '.join(peer.left)} to --knobs, or leave --knobs out",
            soft_wrap=True,
        )
    facts = peer.advantage(found.points)
    if facts:
        console.print(
            f"at the best error of {peer.name} within 1 s per simulated second, {facts['error']:.1e} at "
            f"{facts['their_cost_ns_per_s'] / 1e3:.4g} µs: {facts['cheaper']:.3g} times cheaper here "
            f"({facts['our_cost_ns_per_s'] / 1e3:.4g} µs); {facts['digits']:.1f} more digits at its cost",
            soft_wrap=True,
        )


def print_tuned(tuned: Tuned, console: Console) -> None:
    """Print the chosen settings with their verified error and cost."""
    point = tuned.point
    cost = (point.cost_ns_per_s or 0.0) / 1e3
    name = tuned.measurement.subject.scene.name
    console.print(
        f"{name}: error {point.error:.2e} at {cost:.4g} µs per simulated second", markup=False, soft_wrap=True
    )
    if tuned.over:
        console.print(
            f"{tuned.over / 1e3:.2g} µs over the budget, within the {BAND:.0%} band", soft_wrap=True
        )
    console.print(settings_text(point, {}), markup=False, soft_wrap=True)
    if tuned.measurement.interrupted:
        console.print(f"not all settings were tried; {tuned.measurement.interrupted}", soft_wrap=True)
