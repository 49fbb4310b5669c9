"""One HTML page about a run: its error, pictures, events, results, what the scene required, formulas."""

from __future__ import annotations

import json
from base64 import b64encode
from collections import Counter
from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

from modelgen.derivation import Derivation
from modelgen.report.check import check_facts
from modelgen.report.formula_list import View, statement_of
from modelgen.report.formula_text_and_latex import status_text
from modelgen.report.html_parts import STYLE, badge, document, sections_of, table
from modelgen.report.printed_rounding import NOISE, largest, noise_of_joints, vector_text
from modelgen.report.run_plot import picture
from modelgen.report.run_record import Record
from modelgen.report.summary import horizon_of, verdict_line, verdict_title

EVENTS = 400  # in the table; more are counted
MORE_STYLE = "img{max-width:100%}.kind{white-space:nowrap}ul{margin:.3rem 0}"
FIGURES = (
    ("steps", "accepted steps", ""), ("rejected", "rejected steps", ""),
    ("rhs_evals", "evaluations of the right-hand side", ""), ("wall_s", "computing time", "s"),
    ("energy_drift", "energy that work does not explain, against the largest kinetic energy", ""),
    ("gap_max", "largest gap of a closed contact", "m"),
    ("penetration_max", "deepest penetration", "m"),
    ("joint_error_max", "largest deviation of a joint", "m"),
    ("complementarity_max", "largest violation of complementarity, scaled", ""),
    ("margin_min", "smallest margin to a singular contact", ""),
    ("redundant_max", "most active contacts beyond the rank of their rows", ""),
)  # fmt: skip
ERRORS = (
    ("position", "position of a centre of mass", "m"), ("rotation", "rotation of a body", "rad"),
    ("velocity", "velocity of a centre of mass", "m/s"), ("spin", "angular velocity of a body", "rad/s"),
    ("gap", "gap", "m"), ("force", "contact force, root mean square", "relative"),
    ("events", "time of an event", "s"),
)  # fmt: skip


def run_page(record: Record, derivation: Derivation, frames: int = 4, n: int = 0) -> str:
    """The document; it loads nothing, from no network.

    Args:
        record: what `record_of` or `load` returned.
        derivation: of the scene of the run.
        frames: pictures of the bodies above the curves.
        n: configurations on which the status of each formula is computed; where 0, the status that it
            claims.

    Raises:
        ModelgenError: matplotlib, which draws the pictures, is not installed.
    """
    summary, facts = record.summary, check_facts(derivation)
    reached = f"{summary['outcome']} at t = {summary['t_end']:.6g} s"
    title = f"{summary['scene']}: {reached}, {verdict_title(summary)}"
    sections = [
        ("accuracy", "How exact it is", _accuracy(summary)),
        ("pictures", "Pictures", _pictures(record, frames)),
        ("events", "Events", _events(summary["events"])),
        ("end", "State at the end", _end(summary)),
        ("needs", "What the scene required", _needs(facts)),
        ("formulas", "Formulas", _formulas(derivation, n)),
        ("scene", "Scene", _scene(record)),
    ]
    return document(title, STYLE + MORE_STYLE, f"<h1>{escape(title)}</h1>{sections_of(sections)}")


def _accuracy(summary: Mapping[str, Any]) -> str:
    estimate, horizon = summary["estimate"], horizon_of(summary)
    said = [estimate["statement"]] if estimate else []
    given = [
        f"{kind}: " + ", ".join(f"{name} = {value:.9g}" for name, value in summary[kind].items())
        for kind in ("parameters", "inputs")
        if summary[kind]
    ]
    lines = [
        f"accuracy setting: {summary['accuracy']}",
        *said,
        verdict_line(summary),
        summary["advice"],
        *given,
    ]
    lines += [f"warning: {warning}" for warning in summary["warnings"]]
    text = "".join(f"<li>{escape(line)}</li>" for line in lines)
    figures = [(escape(what), _number(summary[key]), unit) for key, what, unit in FIGURES]
    errors = [
        (escape(what), _number(estimate[key]), unit)
        for key, what, unit in ERRORS
        if estimate and estimate[key] is not None
    ]
    until = "" if horizon is None else f" up to {horizon:.6g} s"
    return (
        f"<ul>{text}</ul>"
        + (table((f"estimated error{until}", "", "unit"), errors, (1,)) if errors else "")
        + table(("figure", "", "unit"), figures, (1,))
    )


def _pictures(record: Record, frames: int) -> str:
    data = b64encode(picture(record, "png", frames)).decode()
    return f'<img alt="curves of the run" src="data:image/png;base64,{data}">'


def _events(events: Sequence[Mapping[str, Any]]) -> str:
    if not events:
        return "<p>None.</p>"
    counts = Counter((event["kind"], event["contact"]) for event in events)
    rows = [(escape(kind), escape(contact), str(n)) for (kind, contact), n in counts.most_common()]
    listed = [
        (f"{event['t']:.9f}", f'<span class="kind">{escape(event["kind"])}</span>', escape(event["contact"]),
         escape(event["features"]), f"{event['speed']:.6g}" if event["speed"] else "")
        for event in events[:EVENTS]
    ]  # fmt: skip
    more = f"<p>and {len(events) - EVENTS} more</p>" if len(events) > EVENTS else ""
    head = ("t [s]", "kind", "contact", "features", "approach [m/s]")
    all_of_them = f"<summary>{len(events)} events</summary>{table(head, listed, (0, 4))}{more}"
    return table(("kind", "contact", "number"), rows, (2,)) + f"<details open>{all_of_them}</details>"


def _end(summary: Mapping[str, Any]) -> str:
    """The last sample; what rounding leaves is 0."""
    final, length = summary["final"], largest(summary["final"], "p")
    states = {key: NOISE * largest(final, key) for key in ("p", "quaternion", "v", "w")}
    of_joints = noise_of_joints(summary["joints"], length)
    bodies = [
        (escape(name), *(_vector(state[key], noise) for key, noise in states.items()))
        for name, state in final.items()
    ]
    contacts = [
        (escape(name), _number(each["force"]), _vector(each["friction"], NOISE * each["force"]))
        for name, each in summary["contacts"].items()
    ]
    patches = [
        (escape(name), _number(each["force"]), _vector(each["centre_of_pressure"], NOISE * length),
         _vector(each["friction"], NOISE * each["force"]))
        for name, each in summary["patches"].items()
    ]  # fmt: skip
    joints = [
        (escape(name), *(_vector(each[key], noise) for key, noise in of_joints.items()),
         ", ".join(f"{escape(key)} {value:.6g}" for key, value in each["coordinates"].items()))
        for name, each in summary["joints"].items()
    ]  # fmt: skip
    sensors = [(escape(name), _number(value)) for name, value in summary["sensors"].items()]
    parts = (
        (("body", "p [m]", "quaternion", "v [m/s]", "w [rad/s]"), bodies),
        (("contact", "force [N]", "friction [N]"), contacts),
        (("resting face", "force [N]", "centre of pressure [m]", "friction [N]"), patches),
        (("joint", "force [N]", "torque [N m]", "coordinates"), joints),
        (("sensor", "value, SI"), sensors),
    )
    return "".join(table(head, rows) for head, rows in parts if rows)


def _needs(facts: Mapping[str, Any]) -> str:
    scales, states = facts["scales"], facts["states"]
    said = (
        f"<p>States: q {states['q']}, u {states['u']}, eta {states['eta']}. Characteristic length "
        f"{scales['length']:.6g} m, mass {scales['mass']:.6g} kg, time {scales['time']:.6g} s.</p>"
    )
    forms = Counter((each["kind"], each["form"]) for each in facts["contacts"])
    why = {
        each["kind"]: ", ".join(f"{form} {n}" for form, n in each["forms"].items())
        for each in facts["contacts"]
    }
    parts = (
        (("body", "kind", "motion"), [tuple(map(escape, each.values())) for each in facts["bodies"]]),
        (("kind of contact", "form", "pairs of features", "instructions of each form"),
         [(escape(kind), escape(form), str(n), escape(why[kind])) for (kind, form), n in forms.items()]),
        (("faces that may rest",), [(escape(name),) for name in facts["patches"]]),
        (("joint", "kind", "between", "rows"),
         [(escape(each["name"]), escape(each["kind"]), escape(" – ".join(each["between"])), str(each["rows"]))
          for each in facts["joints"]]),
    )  # fmt: skip
    lines = [
        *(f"left out: {each}" for each in facts["left_out"]),
        *(f"hint: {each}" for each in facts["hints"]),
    ]
    notes = "".join(f"<li>{escape(line)}</li>" for line in lines)
    return (
        said
        + "".join(table(head, rows) for head, rows in parts if rows)
        + (f"<ul>{notes}</ul>" if notes else "")
    )


def _formulas(derivation: Derivation, n: int) -> str:
    view = View(n=n)
    rows = []
    for formula in derivation.formulas:
        verdict = view.verdict(formula, derivation)
        told = status_text(verdict).removeprefix(verdict["status"]).lstrip("; ")
        stated = statement_of(formula, derivation.model).split("\n\n")[0]
        rows.append(
            (escape(formula.name), escape(stated or formula.role), escape(formula.citation),
             str(formula.instructions), badge(verdict["status"]) + (f" {escape(told)}" if told else ""))
        )  # fmt: skip
    return table(("formula", "what it states", "source", "instructions", "status"), rows, (3,))


def _scene(record: Record) -> str:
    if record.scene is None:
        return ""
    tables = json.dumps(record.scene["tables"], indent=1, ensure_ascii=False)
    return (
        f"<details><summary>{escape(record.scene['source'])}</summary><pre>{escape(tables)}</pre></details>"
    )


def _number(value: float | None) -> str:
    return "" if value is None else f"{value:.6g}"


def _vector(values: Sequence[float], noise: float) -> str:
    return vector_text(values, noise, digits=6)
