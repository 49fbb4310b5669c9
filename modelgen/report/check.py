"""`check`: the kinds and forms that a scene requires, why, and instruction counts, before anything is
compiled."""

from __future__ import annotations

from dataclasses import asdict, replace
from typing import Any

from rich.console import Console
from rich.text import Text

from modelgen.contact.form_table import contact_kernels, regular_forms
from modelgen.derivation import Derivation
from modelgen.joint.joint_equations import FORMS as JOINTS
from modelgen.model import ContactKind, Model
from modelgen.name_suggestions import listed
from modelgen.report.possible_resting_faces import patch_names, print_patches
from modelgen.runtime.warnings import hints

DECIDED = ("decision", "of", "taken", "instructions", "saved", "C text", "saved bytes", "states")
PARAMETERS = ("name", "value", "nominal", "range", "unit", "used by", "what it is")
SHOWN = 3  # contacts, or places, named in a row; the rest is counted


def check_facts(derivation: Derivation) -> dict[str, Any]:
    """The object that `check --json` prints, without `savings`."""
    model = derivation.model
    bodies, contacts, joints = _bodies(model), _contacts(model), _joints(model)
    patches, level = patch_names(model)
    return {
        "scene": model.scene.name,
        "kinds": _kind_names(model),
        "instructions": {formula.name: formula.function.n_instructions() for formula in derivation.formulas},
        "bodies": bodies,
        "contacts": contacts,
        "patches": patches,
        "patches_at_start": level,
        "joints": joints,
        "parameters": [asdict(each) for each in model.whole.parameters],
        "left_out": list(model.left_out),
        "joined": list(model.joined),
        "scales": asdict(model.scales),
        "states": {"q": model.n_q, "u": model.n_u, "eta": model.n_eta},
        "hints": [*model.warnings, *hints(bodies, [*contacts, *joints])],
    }


def print_check(facts: dict[str, Any], console: Console) -> None:
    """The same facts as tables."""
    states, scales = facts["states"], facts["scales"]
    console.print(
        f"[bold]{facts['scene']}[/]: q {states['q']}, u {states['u']}, eta {states['eta']} states",
        soft_wrap=True,
    )
    console.print(
        f"scales: {scales['length']:.6g} m, {scales['mass']:.6g} kg, {scales['time']:.6g} s", soft_wrap=True
    )
    _print_table(console, "bodies", ("name", "kind", "motion"), facts["bodies"])
    _print_table(console, "contacts", ("kind", "form", "contacts", "why"), _by_kind(facts["contacts"]))
    print_patches(console, facts["patches"], facts["patches_at_start"])
    columns = ("name", "kind", "between", "rows", "coordinates", "limits")
    _print_table(console, "joints", columns, [_joined_up(joint) for joint in facts["joints"]])
    _print_table(console, "parameters", PARAMETERS, [_as_row(each) for each in facts["parameters"]])
    counts = [{"function": name, "instructions": n} for name, n in facts["instructions"].items()]
    _print_table(console, "functions", ("function", "instructions"), counts)
    _print_table(console, "decisions", DECIDED, [_decided(each) for each in facts.get("savings", ())])
    for title in ("left_out", "joined"):
        for sentence in facts[title]:
            console.print(f"{title.replace('_', ' ')}: {sentence}", markup=False, soft_wrap=True)
    for hint in facts["hints"]:
        console.print(f"hint: {hint}", markup=False, soft_wrap=True)


def _as_row(parameter: dict[str, Any]) -> dict[str, Any]:
    """A parameter as texts; a range without an end is open there."""
    low, high = ("" if end is None else f"{end:g}" for end in (parameter["minimum"], parameter["maximum"]))
    return {
        "name": parameter["name"],
        "value": f"{parameter['value']:.9g}",
        "nominal": f"{parameter['nominal']:.9g}",
        "range": f"{low}..{high}" if low or high else "-",
        "unit": parameter["unit"] or "-",
        "used by": listed(parameter["uses"], SHOWN),
        "what it is": parameter["doc"] or "-",
    }


def _decided(saving: dict[str, Any]) -> dict[str, Any]:
    """One row: the sizes as they are, what the decision saves, or would save if it were taken."""
    size, saved = saving["size"], saving["saved"]
    return {
        "decision": saving["decision"],
        "of": saving["of"],
        "taken": "yes" if saving["taken"] else "no",
        "instructions": size["instructions"],
        "saved": saved["instructions"],
        "C text": size["bytes"] or "-",
        "saved bytes": saved["bytes"] or "-",
        "states": saved["states"],
    }


def _kind_names(model: Model) -> list[str]:
    return [
        *(kind.name for kind in model.body_kinds),
        *(kind.name for kind in model.contact_kinds),
        *(kind.name for kind in model.load_kinds),
        *(kind.name for kind in model.joint_kinds),
        *(kind.name for kind in model.limit_kinds),
    ]


def _bodies(model: Model) -> list[dict[str, Any]]:
    kinds = [model.body_kinds[body.kind] for body in model.bodies]
    return [
        {"name": body.name, "kind": kind.name, "motion": kind.motion}
        for body, kind in zip(model.bodies, kinds, strict=True)
    ]


def _contacts(model: Model) -> list[dict[str, Any]]:
    forms = [form_counts(kind) for kind in model.contact_kinds]
    return [
        {
            "name": ":".join(filter(None, (model.pairs[feature_pair.pair].name, feature_pair.name))),
            "kind": model.contact_kinds[feature_pair.kind].name,
            "form": model.contact_kinds[feature_pair.kind].form,
            "forms": forms[feature_pair.kind],
            "restitution": model.pairs[feature_pair.pair].restitution.value,
            "friction": [asdict(constraint) for constraint in model.pairs[feature_pair.pair].friction],
        }
        for feature_pair in model.feature_pairs
    ]


def _joints(model: Model) -> list[dict[str, Any]]:
    return [
        {
            "name": entry.name,
            "kind": model.joint_kinds[entry.kind].name,
            "between": [model.bodies[entry.a].name, model.bodies[entry.b].name],
            "rows": entry.rows,
            "coordinates": [each.name for each in JOINTS[model.joint_kinds[entry.kind].kind].coordinates],
            "limits": [limit.name for limit in model.limits if limit.joint == index],
        }
        for index, entry in enumerate(model.joints)
    ]


def _joined_up(joint: dict[str, Any]) -> dict[str, Any]:
    """Lists as text."""
    return {
        key: ", ".join(value) or "-" if isinstance(value, list) else value for key, value in joint.items()
    }


def form_counts(kind: ContactKind) -> dict[str, int]:
    """Instructions of the rates in each form that is regular for the pair; `auto` takes the fewest."""
    return {
        form: contact_kernels(replace(kind, form=form)).rates.n_instructions()
        for form in regular_forms(kind.o, kind.f)
    }


def _by_kind(contacts: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """One row a kind: its form, the contacts that have it, and the instruction counts that chose the form."""
    rows = []
    for kind in dict.fromkeys(contact["kind"] for contact in contacts):
        members = [contact for contact in contacts if contact["kind"] == kind]
        names = [contact["name"] for contact in members]
        counts = sorted(members[0]["forms"].items(), key=lambda item: item[1])
        why = ", ".join(f"{form} {count}" for form, count in counts)
        rows.append({"kind": kind, "form": members[0]["form"], "contacts": listed(names, SHOWN), "why": why})
    return rows


def _print_table(console: Console, title: str, columns: tuple[str, ...], rows: list[dict[str, Any]]) -> None:
    """Aligned columns; a line too long for the terminal is wrapped by it, so that no name is cut."""
    if not rows:
        return
    cells = [columns, *(tuple(str(row[column]) for column in columns) for row in rows)]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    console.print(f"[italic]{title}[/]", soft_wrap=True)
    for number, row in enumerate(cells):
        aligned = [
            text.rjust(width) if column == "instructions" else text.ljust(width)
            for column, text, width in zip(columns, row, widths, strict=True)
        ]
        line = Text("  ".join(aligned).rstrip(), style="" if number else "bold")
        console.print(line, soft_wrap=True)
