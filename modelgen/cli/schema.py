"""The command `schema`: the JSON Schema of scene files and of results."""

from __future__ import annotations

import json
from dataclasses import asdict
from typing import Annotated, Any

import click

from modelgen.cli.command import Argument
from modelgen.cli.manual import print_page
from modelgen.cli.options import AsJson


def schema(
    name: Annotated[
        str | None, Argument(metavar="KEY", help="a key, a table, or a kind of shape or joint")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Print the JSON Schema of scene files, or what it says of one KEY in words.

    `$defs` of the whole has the schemas of what the verbs print with --json.
    """
    if name is None:
        click.echo(json.dumps(_all_schemas(), indent=None if as_json else 2, allow_nan=False))
        return
    from modelgen.report.keys_page import page_of, sections_of

    if as_json:
        click.echo(json.dumps([asdict(section) for section in sections_of(name)]))
    else:
        print_page(page_of(name))


def _all_schemas() -> dict[str, Any]:
    """The JSON Schema of scene files, with those of results under `$defs`."""
    from modelgen.benchmark.extremes_result_schema import surveyed_schema
    from modelgen.benchmark.measurement_schema import measured_schema, tuned_schema
    from modelgen.parameter_study.sweep_output import swept_schema
    from modelgen.report.fit_output import fitted_schema
    from modelgen.report.linearisation_schema import linearised_schema, stability_schema, steady_schema
    from modelgen.report.run_schema import result_schema
    from modelgen.report.sensitivity_output import sensitivity_schema
    from modelgen.scene.json_schema import scene_schema

    document = scene_schema()
    results = {"result": result_schema(), "linearised": linearised_schema(), "fitted": fitted_schema()}
    results |= {
        "swept": swept_schema(),
        "linearised_steady": steady_schema(),
        "stability": stability_schema(),
        "sensitivity": sensitivity_schema(),
        "measured": measured_schema(),
        "surveyed": surveyed_schema(),
        "tuned": tuned_schema(),
    }
    document["$defs"] = {**document.get("$defs", {}), **results}
    return document
