"""The Trajectory of an mg_run that has come to its end: its samples, with the ledger that the core kept."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

from modelgen.runtime.accuracy import Accuracy
from modelgen.runtime.by_name import ByName
from modelgen.runtime.core_session import Session
from modelgen.runtime.solver_choice import solver_of, solves_of
from modelgen.runtime.trajectory import Event, Outcome, Trajectory, doubt_kinds
from modelgen.runtime.warnings.time_stepping import fallback_step


class Ending(NamedTuple):
    """How a run ended."""

    outcome: Outcome
    events: Sequence[Event]
    interrupted: bool = False  # by Ctrl-C, maybe in the call of the core that came to the end


def trajectory_of(
    session: Session,
    run: Any,
    columns: Mapping[str, Any],
    ending: Ending,
    *,
    doubts: int,
    wall_s: float = 0.0,
    warnings: Sequence[str] = (),
    outcome_function: str = "",
    inputs: Mapping[str, float],
    instance: Mapping[str, Any] | None = None,
    accuracy: Accuracy | None = None,
) -> Trajectory:
    """The trajectory of an mg_run.

    Args:
        session: of the library of the run, whose names and accuracy are those of the run.
        run: the mg_run.
        columns: the samples, as `Recording.columns` gives them.
        doubts: what mg_doubts says of it.
        instance, accuracy: of the run, where they are not those of the session.
    """
    own, shared = session.instance if instance is None else instance, session.shared
    record = session.accuracy if accuracy is None else accuracy
    report = run.report
    failed, deepest = report.failed_contact, report.penetration_contact
    switch, paradox = report.indeterminate_switch, report.painleve_contact
    is_paradox = (
        report.indeterminate and switch < 0 <= paradox and report.painleve_t <= report.indeterminate_t
    )
    return Trajectory(
        scene=own["name"],
        **columns,
        body_names=shared.body_names,
        feature_pair_names=session.feature_pair_names,
        shares=shared.shares,
        joint_names=session.joints,
        coordinate_names=shared.coordinate_names,
        sensor_names=shared.sensor_names,
        events=tuple(in_order(ending.events)),
        outcome=ending.outcome,
        outcome_contact=session.contact_name(failed) if failed >= 0 else "",
        t_end=float(run.t),
        steps=int(run.steps),
        rejected=int(run.rejected),
        rhs_evals=int(run.rhs_evals),
        solver=solver_of(session.accuracy, session.instance),
        solves=solves_of(report, session.accuracy),
        solve_residual_max=float(report.lcp_residual_max),
        wall_s=wall_s,
        energy_drift=session.energy_drift(run),
        energy_rounding=session.energy_rounding(run),
        correction_energy=session.correction_energy(run),
        force_rounding=float(report.force_rounding),
        gap_max=float(report.gap_max),
        penetration_max=float(report.penetration_max),
        penetration_t=float(report.penetration_t),
        penetration_pair=session.contacts[deepest].partition("#")[0] if deepest >= 0 else "",
        joint_error_max=float(report.joint_error_max),
        complementarity_max=float(report.complementarity_max),
        margin_min=float(min(report.margin_min, 1.0)),
        redundant_max=int(report.redundant_max),
        doubt_kinds=doubt_kinds(doubts),
        indeterminate_t=float(report.indeterminate_t) if report.indeterminate else None,
        indeterminate_load=session.switching_loads[switch] if switch >= 0 else "",
        indeterminate_contact=session.contacts[report.indeterminate_contact]
        if report.indeterminate_contact >= 0
        else "",
        indeterminate_part=float(report.indeterminate_part),
        paradox_contact=session.contacts[paradox] if is_paradox else "",
        impact_gain=float(report.impact_gain_max),
        impact_gain_t=float(report.impact_gain_t),
        impact_gain_contact=session.contacts[gained] if (gained := report.impact_gain_contact) >= 0 else "",
        flush_t=float(report.flush_t),
        flush_contact=session.contacts[flush] if (flush := report.flush_contact) >= 0 else "",
        unfollowed_minima=int(report.unfollowed_minima),
        incomplete_searches=int(report.incomplete_searches),
        search_effort=int(run.search_effort),
        kinds=shared.kind_names,
        instructions=dict(shared.instructions),
        accuracy=record.name,
        warnings=tuple(warnings),
        jams=int(report.jams),
        fallback_time=float(report.fallback_time + report.chatter_time),
        unfollowed_pair=shared.slots.pair_name(report.unfollowed_pair),
        unfollowed_t=float(report.unfollowed_t),
        incomplete_pair=shared.slots.pair_name(report.incomplete_pair),
        incomplete_t=float(report.incomplete_t),
        fallback_step=fallback_step(report, record, own),
        outcome_function=outcome_function,
        stopped=ending.interrupted,
        parameters=ByName(((each["name"], each["value"]) for each in own.get("parameters", ())), "parameter"),
        inputs=ByName(inputs, "input"),
    )


def in_order(events: Sequence[Event]) -> list[Event]:
    """Events by time; at equal times a touch-down precedes the other events of its pair."""
    latest: dict[str, float] = {}
    told = []
    for event in events:
        pair = event.contact.partition("#")[0]
        latest[pair] = max(event.t, latest.get(pair, event.t))
        told.append(event if event.t == latest[pair] else replace(event, t=latest[pair]))
    return sorted(told, key=lambda event: event.t)
