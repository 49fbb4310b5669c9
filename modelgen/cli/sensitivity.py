"""The command `sensitivity`: derivatives of a run, with their verdict, and differences beside them."""

from __future__ import annotations

from typing import Annotated, Any

import click
from rich.console import Console

import modelgen
from modelgen.cli.command import Option
from modelgen.cli.option_reading import read_option, read_values
from modelgen.cli.options import AsJson, InputValues, Quality, SceneFile, Values
from modelgen.cli.output import FAILED, print_facts
from modelgen.cli.pipeline import (
    DERIVATIVES,
    build_derivation,
    derive_scene,
    folder_of,
    read_scene,
    removed_if_refused,
)
from modelgen.errors import ModelgenError

By = Annotated[
    str,
    Option(help="parameters, inputs, starts: mass,egg.velocity", metavar="A,B,..."),
]
Of = Annotated[
    str | None,
    Option(help="sensors, or egg.position and the like; default: all sensors", metavar="A,B,..."),
]
AtTimes = Annotated[str | None, Option("--at", help="times, s; default: the scene's end", metavar="T,T,...")]
Compared = Annotated[bool, Option("--check", help="beside them, differences of runs")]


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
    """Differentiate what a run shows by parameters, inputs and starts, through contacts and impacts.

    With --check, a derivative that differences of runs do not bear out is undecided.
    """
    from modelgen.report.sensitivity_output import print_sensitivity, sensitivity_facts
    from modelgen.runtime.sensitivity import check_names

    what = read_scene(scene, None)
    times = _times(at)
    settings: dict[str, Any] = {
        "of": None if of is None else _names("--of", of),
        "by": _names("--by", by),
        "parameters": read_values(values, "--set"),
        "inputs": read_values(inputs, "--input"),
        "accuracy": read_option("accuracy", accuracy),
    }
    with removed_if_refused(folder_of(what, DERIVATIVES)) as folder:
        library = build_derivation(
            derive_scene(what),
            folder,
            derivatives=True,
            check=lambda instance: check_names(instance, settings["by"], settings["of"]),
        )
        times = times or [float(library.manifest.instance["run"].get("until") or 1.0)]
        found = modelgen.sensitivity(library, times, **settings)
    differences = None
    if check:
        from modelgen.runtime.finite_differences import checked

        found, differences = checked(found, library, times, **settings)
    facts = sensitivity_facts(found, differences)
    print_facts(facts, as_json, lambda: print_sensitivity(facts, Console()))
    if found.outcome is not None:
        click.echo(f"{found.outcome.name.lower()}: {found.outcome.value}", err=True)
        raise click.exceptions.Exit(FAILED)


def _names(option: str, text: str) -> list[str]:
    names = [name.strip() for name in text.split(",") if name.strip()]
    if not names:
        raise ModelgenError(option, repr(text), "names, separated by commas")
    return names


def _times(text: str | None) -> list[float]:
    if text is None:
        return []
    try:
        return [float(part) for part in text.split(",")]
    except ValueError:
        raise ModelgenError("--at", repr(text), "times in s, 0.5,1.0") from None
