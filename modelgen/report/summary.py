"""The summary of a run as a person reads it."""

from __future__ import annotations

from math import hypot, isnan
from typing import Any

from rich.console import Console

from modelgen.report.printed_rounding import NOISE, largest, noise_of_joints, vector_text

FIRST, LAST = 15, 5  # events printed from the start and the end; those between are counted


def print_summary(summary: dict[str, Any], console: Console) -> None:
    """Print the summary of `simulate`, from the facts of `simulate --json`."""
    console.print(
        f"{summary['scene']}: {summary['outcome']} at t = {summary['t_end']:.9g} s ({summary['accuracy']})",
        markup=False,
        soft_wrap=True,
    )
    for given in ("parameters", "inputs"):
        if summary[given]:
            told = ", ".join(f"{name} = {value:.9g}" for name, value in summary[given].items())
            console.print(f"{given}: {told}", markup=False, highlight=False, soft_wrap=True)
    console.print(
        f"{summary['steps']} steps, {summary['rejected']} rejected, {summary['rhs_evals']} evaluations, "
        f"{summary['wall_s']:.3g} s",
        soft_wrap=True,
    )
    console.print(
        f"energy drift {summary['energy_drift']:.2e}, largest gap {summary['gap_max']:.2e} m, "
        f"deepest penetration {summary['penetration_max']:.2e} m, "
        f"complementarity {summary['complementarity_max']:.2e}, smallest margin {summary['margin_min']:.2e}",
        soft_wrap=True,
    )
    if summary["estimate"]:
        console.print(summary["estimate"]["statement"], markup=False, highlight=False, soft_wrap=True)
    if summary["joints"]:
        console.print(f"joints hold within {summary['joint_error_max']:.2e} m", soft_wrap=True)
    for warning in summary["warnings"]:
        console.print(f"warning: {warning}", markup=False, soft_wrap=True)
    _print_events(summary["events"], console)
    _print_bodies(summary["final"], console)
    print_contacts(summary["contacts"], console)
    _print_patches(summary["patches"], largest(summary["final"], "p"), console)
    _print_joints(summary["joints"], largest(summary["final"], "p"), console)
    shown = [f"{name} {value:.6g}" for name, value in summary["sensors"].items() if value is not None]
    if shown:
        console.print(f"sensors: {', '.join(shown)}", markup=False, soft_wrap=True)
    for key in ("out", "plot"):
        if summary[key] is not None:
            print_written(summary[key], console)
    _print_trust(summary, console)


def _print_trust(summary: dict[str, Any], console: Console) -> None:
    """The last line: whether the run can be trusted, and why not."""
    doubts, unknown = summary["doubts"], "" if summary["estimate"] else "; its error was not estimated"
    line = f"not trusted: {'; '.join(doubts)}" if doubts else "trusted"
    console.print(line + unknown, markup=False, highlight=False, soft_wrap=True)


def print_written(file: object, console: Console) -> None:
    """The name of a file that was written."""
    console.print(f"written: {file}", markup=False, highlight=False, soft_wrap=True)


def _print_bodies(final: dict[str, Any], console: Console) -> None:
    keys = ("p", "quaternion", "v", "w")
    noise = {key: NOISE * largest(final, key) for key in keys}
    for name, state in final.items():
        moves = any(state["v"]) or any(state["w"])
        known = [key for key in (keys if moves else keys[:2]) if not isnan(state[key][0])]
        parts = [f"{key} ({vector_text(state[key], noise[key])})" for key in known]
        parts += [] if moves else ["at rest"]
        console.print(f"{name}: {', '.join(parts)}", markup=False, soft_wrap=True)


def print_contacts(contacts: dict[str, Any], console: Console) -> None:
    """Normal force, and the size of friction, N; those in excess are counted."""
    for name, contact in list(contacts.items())[: FIRST + LAST]:
        line = f"{name}: force {contact['force']:.6g}"
        friction = hypot(*contact["friction"])
        line += f", friction {friction:.6g}" if friction > NOISE * contact["force"] else ""
        console.print(line, markup=False, soft_wrap=True)
    more = len(contacts) - FIRST - LAST
    if more > 0:
        console.print(f"... {more} more contacts press; --json and --out hold all", soft_wrap=True)


def _print_patches(patches: dict[str, Any], length: float, console: Console) -> None:
    for name, patch in patches.items():
        at, noise = vector_text(patch["centre_of_pressure"], NOISE * length), NOISE * patch["force"]
        line = f"{name}: rests, force {patch['force']:.6g}, centre_of_pressure ({at})"
        torque = patch["torque"] if abs(patch["torque"]) > noise * length else 0.0
        if torque or hypot(*patch["friction"]) > noise:
            line += f", friction ({vector_text(patch['friction'], noise)}), torque {torque:.6g}"
        console.print(line, markup=False, soft_wrap=True)


def _print_joints(joints: dict[str, Any], length: float, console: Console) -> None:
    noise = noise_of_joints(joints, length)
    for name, joint in joints.items():
        acting = [f"{key} ({vector_text(joint[key], noise[key])})" for key in ("force", "torque")]
        standing = [f"{key} {value:.6g}" for key, value in joint["coordinates"].items()]
        console.print(f"{name}: {', '.join(acting + standing)}", markup=False, soft_wrap=True)


def _print_events(events: list[dict[str, Any]], console: Console) -> None:
    between = max(len(events) - FIRST - LAST, 0)
    for k, event in enumerate(events):
        if between and k == FIRST:
            console.print(f"... {between} more in between; --json and --out hold all", soft_wrap=True)
        if not between or not FIRST <= k < len(events) - LAST:
            speed = f" at {event['speed']:.6g} m/s" if event["speed"] else ""
            console.print(
                f"{event['t']:.9f} s  {event['kind']}{_contact(event)}{speed}",
                markup=False,
                soft_wrap=True,
            )


def _contact(event: dict[str, Any]) -> str:
    """` of ` its name, and the features that it is between where that does not say; empty without contact."""
    name, features = event["contact"], event["features"]
    if not name:
        return ""
    return f" of {name}" if name.endswith(features) else f" of {name} ({features})"
