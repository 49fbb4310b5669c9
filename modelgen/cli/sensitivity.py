"""The command `sensitivity`: derivatives of a run, with their verdict, and differences beside them."""

from __future__ import annotations

from typing import Annotated, Any

import typer
from rich.console import Console
from rich.table import Table

import modelgen
from modelgen.cli.options import AsJson, InputValues, Quality, SceneFile, Values, read_option, read_values
from modelgen.cli.output import FAILED, guarded, print_facts
from modelgen.cli.pipeline import (
    DERIVATIVES,
    build_derivation,
    derive_scene,
    folder_of,
    read_scene,
    removed_if_refused,
)
from modelgen.errors import ModelgenError
from modelgen.runtime.sensitivity import Sensitivity

By = Annotated[
    str,
    typer.Option(help="parameters, inputs, starts: mass,egg.velocity", metavar="A,B,...", show_default=False),
]
Of = Annotated[
    str | None,
    typer.Option(help="sensors, or egg.position and the like; default: all sensors", metavar="A,B,..."),
]
AtTimes = Annotated[
    str | None, typer.Option("--at", help="times, s; default: the scene's end", metavar="T,T,...")
]
Compared = Annotated[bool, typer.Option("--check", help="beside them, differences of runs")]


@guarded
def sensitivity(
    scene: SceneFile,
    by: By,
    of: Of = None,
    at: AtTimes = None,
    accuracy: Quality = None,
    values: Values = None,
    inputs: InputValues = None,
    check: Compared = False,
    as_json: AsJson = False,
) -> None:
    """Differentiate what a run shows by parameters, inputs and starts, through contacts and impacts."""
    what = read_scene(scene, None)
    times = _times(at)
    settings: dict[str, Any] = {
        "of": None if of is None else _names(of),
        "by": _names(by),
        "parameters": read_values(values, "--set"),
        "inputs": read_values(inputs, "--input"),
        "accuracy": read_option("accuracy", accuracy),
    }
    with removed_if_refused(folder_of(what, DERIVATIVES)) as folder:
        library = build_derivation(derive_scene(what), folder, derivatives=True)
        times = times or [float(library.manifest.instance["run"].get("until") or 1.0)]
        found = modelgen.sensitivity(library, times, **settings)
    facts = _facts(found)
    if check:
        from modelgen.runtime.run_differences import run_differences

        facts["differences"] = run_differences(library, times, **settings).tolist()
    print_facts(facts, as_json, lambda: _print(facts, Console()))
    if found.outcome is not None:
        raise typer.Exit(FAILED)


def _names(text: str) -> list[str]:
    return [name.strip() for name in text.split(",") if name.strip()]


def _times(text: str | None) -> list[float]:
    if text is None:
        return []
    try:
        return [float(part) for part in text.split(",")]
    except ValueError:
        raise ModelgenError("--at", repr(text), "times in s, 0.5,1.0") from None


def _facts(found: Sensitivity) -> dict[str, Any]:
    return {
        "t": found.t.tolist(),
        "of": list(found.of),
        "by": list(found.by),
        "value": found.value.tolist(),
        "jacobian": found.jacobian.tolist(),
        "error": None if found.error is None else found.error.tolist(),
        "verdicts": [
            {"kind": each.kind, "reason": each.reason, "t": each.t, "contact": each.contact}
            for each in found.verdicts
        ],
        "events": [{"t": each.t, "contact": each.contact, "by": each.by.tolist()} for each in found.events],
        "outcome": None if found.outcome is None else found.outcome.name.lower(),
    }


def _print(facts: dict[str, Any], console: Console) -> None:
    for k, t in enumerate(facts["t"]):
        table = Table(title=f"t = {t:g} s", title_justify="left", box=None, pad_edge=False)
        headings = ["", "value", "by", "derivative", "error"] + ["differences"] * ("differences" in facts)
        for number, heading in enumerate(headings):
            table.add_column(heading, justify="left" if number in (0, 2) else "right", no_wrap=True)
        for i, name in enumerate(facts["of"]):
            for j, by in enumerate(facts["by"]):
                row = [name, f"{facts['value'][k][i]:.8g}"] if not j else ["", ""]
                row += [by, f"{facts['jacobian'][k][i][j]:.8g}", f"{facts['error'][k][i][j]:.1e}"]
                row += [f"{facts['differences'][k][i][j]:.8g}"] if "differences" in facts else []
                table.add_row(*row)
        console.print(table, soft_wrap=True)
        verdict = facts["verdicts"][k]
        where = f" at {verdict['contact']}" if verdict["contact"] else ""
        told = f": {verdict['reason']}, t = {verdict['t']:.6g} s{where}" if verdict["reason"] else ""
        console.print(f"{verdict['kind']}{told}\n", highlight=False, soft_wrap=True)
