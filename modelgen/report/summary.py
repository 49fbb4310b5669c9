"""The summary of a run as a person reads it, and the verdict on it as every output states it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import hypot, isnan
from typing import Any

from modelgen.report.printed_rounding import NOISE, largest, noise_of_joints, vector_text

FIRST, LAST = 15, 5  # events printed from the start and the end; those between are counted


def summary_lines(summary: dict[str, Any]) -> Iterator[str]:
    """The summary of `simulate`, from the facts of `simulate --json`."""
    yield (
        f"{summary['scene']}: {summary['outcome']} at t = {summary['t_end']:.9g} s ({summary['accuracy']})"
    )
    for given in ("parameters", "inputs"):
        if summary[given]:
            told = ", ".join(f"{name} = {value:.9g}" for name, value in summary[given].items())
            yield f"{given}: {told}"
    yield (
        f"{summary['steps']} steps, {summary['rejected']} rejected, {summary['rhs_evals']} evaluations, "
        f"{summary['wall_s']:.3g} s"
    )
    if summary["solves"]:
        by = ", ".join(f"{count} by {name}" for name, count in summary["solves"].items())
        yield f"complementarity problems: {by}, largest residual {summary['solve_residual_max']:.1e}"
    yield (
        f"energy drift {summary['energy_drift']:.2e}, by corrections {summary['correction_energy']:.2e}, "
        f"largest gap {summary['gap_max']:.2e} m, "
        f"deepest penetration {summary['penetration_max']:.2e} m, "
        f"complementarity {summary['complementarity_max']:.2e}, smallest margin {summary['margin_min']:.2e}"
    )
    if summary["estimate"]:
        yield summary["estimate"]["statement"]
    if summary["joints"]:
        yield f"joints hold within {summary['joint_error_max']:.2e} m"
    for warning in summary["warnings"]:
        yield f"warning: {warning}"
    yield from _event_lines(summary["events"])
    yield from _body_lines(summary["final"])
    yield from contact_lines(summary["contacts"])
    yield from _patch_lines(summary["patches"], largest(summary["final"], "p"))
    yield from _joint_lines(summary["joints"], largest(summary["final"], "p"))
    shown = [f"{name} {value:.6g}" for name, value in summary["sensors"].items() if value is not None]
    if shown:
        yield f"sensors: {', '.join(shown)}"
    for key in ("out", "plot"):
        if summary[key] is not None:
            yield written_line(summary[key])
    yield verdict_line(summary)


def verdict_line(summary: Mapping[str, Any]) -> str:
    """`trusted`, or `not trusted` with all reasons; why its events are not certain where these alone are not,
    and that the error was not estimated where it was not."""
    doubts, estimate = summary["doubts"], summary["estimate"]
    verdict = f"not trusted: {'; '.join(doubts)}" if doubts else "trusted"
    if not estimate:
        return f"{verdict}; its error was not estimated"
    events = estimate["events_doubt"]
    return f"{verdict}, but not all of its events: {events}" if events and not doubts else verdict


def verdict_title(summary: Mapping[str, Any]) -> str:
    """For a heading: `not trusted` without an error, or `trusted` with it where it was estimated."""
    if summary["doubts"]:
        return "not trusted"
    estimate = summary["estimate"]
    return f"trusted, error {estimate['position']:.1g} m" if estimate else "trusted, error not estimated"


def horizon_of(summary: Mapping[str, Any]) -> float | None:
    """The time beyond which nothing is predicted, s; None where all is, or nothing is estimated."""
    estimate = summary["estimate"]
    return estimate["horizon"] if estimate else None


def written_line(file: object) -> str:
    """The name of a file that was written."""
    return f"written: {file}"


def _body_lines(final: dict[str, Any]) -> Iterator[str]:
    keys = ("p", "quaternion", "v", "w")
    noise = {key: NOISE * largest(final, key) for key in keys}
    for name, state in final.items():
        moves = any(state["v"]) or any(state["w"])
        known = [key for key in (keys if moves else keys[:2]) if not isnan(state[key][0])]
        parts = [f"{key} ({vector_text(state[key], noise[key])})" for key in known]
        parts += [] if moves else ["at rest"]
        yield f"{name}: {', '.join(parts)}"


def contact_lines(contacts: dict[str, Any]) -> Iterator[str]:
    """Normal force, and the size of friction, N; those in excess are counted."""
    for name, contact in list(contacts.items())[: FIRST + LAST]:
        line = f"{name}: force {contact['force']:.6g}"
        friction = hypot(*contact["friction"])
        line += f", friction {friction:.6g}" if friction > NOISE * contact["force"] else ""
        yield line
    more = len(contacts) - FIRST - LAST
    if more > 0:
        yield f"... {more} more contacts press; --json and --out hold all"


def _patch_lines(patches: dict[str, Any], length: float) -> Iterator[str]:
    for name, patch in patches.items():
        at, noise = vector_text(patch["centre_of_pressure"], NOISE * length), NOISE * patch["force"]
        line = f"{name}: rests, force {patch['force']:.6g}, centre_of_pressure ({at})"
        torque = patch["torque"] if abs(patch["torque"]) > noise * length else 0.0
        if torque or hypot(*patch["friction"]) > noise:
            line += f", friction ({vector_text(patch['friction'], noise)}), torque {torque:.6g}"
        yield line
        shares = [f"{pair} {force:.6g}" for pair, force in list(patch["shares"].items())[: FIRST + LAST]]
        more = len(patch["shares"]) - FIRST - LAST
        shares += [f"... {more} more; --json and --out hold all"] if more > 0 else []
        if shares:
            yield f"{name}: of its force on {', '.join(shares)}"


def _joint_lines(joints: dict[str, Any], length: float) -> Iterator[str]:
    noise = noise_of_joints(joints, length)
    for name, joint in joints.items():
        acting = [f"{key} ({vector_text(joint[key], noise[key])})" for key in ("force", "torque")]
        standing = [f"{key} {value:.6g}" for key, value in joint["coordinates"].items()]
        yield f"{name}: {', '.join(acting + standing)}"


def _event_lines(events: list[dict[str, Any]]) -> Iterator[str]:
    between = max(len(events) - FIRST - LAST, 0)
    for k, event in enumerate(events):
        if between and k == FIRST:
            yield f"... {between} more in between; --json and --out hold all"
        if not between or not FIRST <= k < len(events) - LAST:
            speed = f" at {event['speed']:.6g} m/s" if event["speed"] else ""
            yield f"{event['t']:.9f} s  {event['kind']}{_contact(event)}{speed}"


def _contact(event: dict[str, Any]) -> str:
    """` of ` its name, and the features that it is between where that does not say; empty without contact."""
    name, features = event["contact"], event["features"]
    if not name:
        return ""
    return f" of {name}" if name.endswith(features) else f" of {name} ({features})"
