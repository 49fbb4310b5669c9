"""The command `report`: one page about a run."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from modelgen.cli.command import Option
from modelgen.cli.option_reading import read_option
from modelgen.cli.options import AsJson, Frames, Verify
from modelgen.cli.output import exit_with, needed, print_facts, print_lines
from modelgen.cli.pipeline import derive_scene
from modelgen.cli.run_options import CommonRunOptions
from modelgen.cli.view import RunOrScene, check_page, recorded
from modelgen.file_writing import write_file

FRAMES = 4  # pictures of the bodies, where no number is given
PageFile = Annotated[Path | None, Option("--out", "-o", help="FILE.html, needed", metavar="FILE")]


def report(
    source: RunOrScene,
    run: CommonRunOptions,
    out: PageFile = None,
    frames: Frames = None,
    verify: Verify = None,
    as_json: AsJson = False,
) -> None:
    """Write a page about a run: its error, pictures, events, results, what the scene required, formulas."""
    from modelgen.report.run_page import run_page
    from modelgen.report.run_plot import require_matplotlib
    from modelgen.report.summary import written_line

    out = needed(out, "report.html")
    check_page(out)
    require_matplotlib()
    pictures, n = read_option("frames", frames), read_option("verify", verify) or 0
    record, trajectory = recorded(source, run.settings())
    derivation = derive_scene(record.scene_again("report"))
    write_file(out, run_page(record, derivation, FRAMES if pictures is None else pictures, n))
    facts = {"file": str(out), "scene": record.summary["scene"], "outcome": record.summary["outcome"]}
    print_facts(facts, as_json, lambda: print_lines([written_line(out)]))
    if trajectory is not None:
        exit_with(trajectory)
