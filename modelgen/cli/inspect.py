"""The command `inspect`: the formulas of a scene or of a kind of contact."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import click

from modelgen.cli.command import Argument, Option
from modelgen.cli.option_reading import read_configuration, read_option
from modelgen.cli.options import AsJson, At, Style, Verify
from modelgen.cli.output import FAILED, check_file, print_facts, print_text
from modelgen.cli.pipeline import derive_scene, read_scene


def inspect(
    source: Annotated[str, Argument(metavar="KIND|SCENE", help="a scene, or SHAPE-SHAPE[:FORM]")],
    formula: Annotated[
        str | None, Option(help="only this formula, role or quantity: mg_..._rates, rates, gamma")
    ] = None,
    style: Style = "text",
    at: At = None,
    verify: Verify = None,
    out: Annotated[Path | None, Option("--out", "-o", help="file to write the text into")] = None,
    as_json: AsJson = False,
) -> None:
    """Print the formulas of a scene or of a kind of contact: source, units, cost, tree, numbers, status."""
    from modelgen.report.formula_inspection import inspected, written

    if out is not None:
        check_file(out)
    writing, n = read_option("format", style), read_option("verify", verify)
    is_scene = source.endswith(".toml") or Path(source).exists()
    scene = read_scene(Path(source), None) if is_scene else None
    seed, given = read_configuration(at)
    facts = inspected(source, scene, formula, writing, (seed, given, n), derive_scene)
    print_facts(facts, as_json, lambda: print_text(written(facts, writing), out))
    if any(entry["status"] == "failed" for entry in facts["formulas"]):
        raise click.exceptions.Exit(FAILED)
