"""The command `view`: a page that plays a run."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

import modelgen
from modelgen.cli.options import AsJson, InputValues, Quality, SceneFile, Until, Values, read_values
from modelgen.cli.output import check_file, exit_with, guarded, print_facts
from modelgen.cli.pipeline import read_scene, run_scene, run_settings

PageFile = Annotated[
    Path, typer.Option("--out", "-o", help="FILE.html", metavar="FILE", readable=False, show_default=False)
]
SUFFIXES = (".html", ".htm")


@guarded
def view(
    scene: SceneFile,
    out: PageFile,
    until: Until = None,
    accuracy: Quality = None,
    values: Values = None,
    inputs: InputValues = None,
    as_json: AsJson = False,
) -> None:
    """Run a scene and write a page that plays it: bodies, contacts, forces, events and curves over time."""
    from modelgen.report.export import check_suffix
    from modelgen.report.run_record import record_of
    from modelgen.report.summary import print_written
    from modelgen.view.page import write_page

    check_suffix(out, SUFFIXES)
    check_file(out)
    model = modelgen.require(read_scene(scene, None))
    settings = run_settings(until, accuracy, None, None) | {
        "parameters": read_values(values, "--set"),
        "inputs": read_values(inputs, "--input"),
    }
    trajectory, library = run_scene(scene, None, settings)
    record = record_of(trajectory, library)
    write_page(record, model, out)
    facts = {"file": str(out), "scene": record.summary["scene"], "outcome": record.summary["outcome"]}
    print_facts(facts, as_json, lambda: print_written(out, Console()))
    exit_with(trajectory)
