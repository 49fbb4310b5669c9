"""The command `view`: a page that plays a run, or a run that plays in the browser while it is computed."""

from __future__ import annotations

from pathlib import Path
from threading import Thread
from typing import TYPE_CHECKING, Annotated, Any

import click

import modelgen
from modelgen.cli.command import Argument, Option
from modelgen.cli.option_reading import read_option
from modelgen.cli.options import AsJson
from modelgen.cli.output import check_file, exit_with, print_facts, print_lines
from modelgen.cli.pipeline import read_scene, ready_library, run_scene
from modelgen.cli.run_options import CommonRunOptions
from modelgen.errors import ModelgenError

if TYPE_CHECKING:
    from modelgen.report.run_record import Record
    from modelgen.runtime.trajectory import Trajectory

RunOrScene = Annotated[Path, Argument(metavar="RUN.npz|SCENE", help="a run, or a scene to run first")]
PageFile = Annotated[
    Path | None,
    Option("--out", "-o", help="FILE.html; without it a scene runs live", metavar="FILE"),
]
Plots = Annotated[str | None, Option(help="plots that are open at first: energy,sensors", metavar="NAMES")]
Port = Annotated[str | None, Option(help="of the live page; default: 8080", metavar="NUMBER")]
SUFFIXES = (".html", ".htm")
PORT = 8080
STOPPING_S = 1.0  # s, longest wait for the server to end


def view(
    source: RunOrScene,
    run: CommonRunOptions,
    out: PageFile = None,
    plots: Plots = None,
    port: Port = None,
    as_json: AsJson = False,
) -> None:
    """Write a page that plays a run: bodies, contacts, forces, events, curves; or run a scene live."""
    settings = run.settings()
    if out is None:
        _run_live(source, settings, PORT if port is None else read_option("port", port))
        return
    from modelgen.report.summary import written_line
    from modelgen.view.page import write_page
    from modelgen.view.plots import check_plots

    check_page(out)
    opened = None if plots is None else check_plots(plots)
    record, trajectory = recorded(source, settings)
    write_page(record, out, plots=opened)
    facts = {"file": str(out), "scene": record.summary["scene"], "outcome": record.summary["outcome"]}
    print_facts(facts, as_json, lambda: print_lines([written_line(out)]))
    if trajectory is not None:
        exit_with(trajectory)


def check_page(out: Path) -> None:
    """Raise ModelgenError for a page that cannot be written, before anything is computed."""
    from modelgen.report.run_files import check_suffix

    check_suffix(out, SUFFIXES)
    check_file(out)


def recorded(source: Path, settings: dict[str, Any]) -> tuple[Record, Trajectory | None]:
    """The record of a file of a run; or of a scene that is run now, with its trajectory. Raises ModelgenError
    for settings of a run that is over."""
    from modelgen.report.run_files import FORMATS, load
    from modelgen.report.run_record import record_of

    if source.suffix in FORMATS:
        if settings:
            raise _over(source, settings)
        return load(source), None
    scene = read_scene(source, None)
    trajectory, library = run_scene(source, None, settings)
    return record_of(trajectory, library, scene), trajectory


def _over(source: Path, settings: dict[str, Any]) -> ModelgenError:
    found = f"{', '.join(settings)} of a run that is over"
    return ModelgenError(str(source), found, "", "name its scene to run it anew, or leave them out")


def _run_live(source: Path, settings: dict[str, Any], port: int) -> None:
    """Run a scene in the browser until Ctrl-C."""
    from modelgen.report.run_files import FORMATS

    if source.suffix in FORMATS:
        raise ModelgenError(str(source), "a run that is over", "", "write a page of it: --out page.html")
    from modelgen.view.live_server import Live

    until = settings.pop("until", None)
    model = modelgen.require(read_scene(source, None))
    with ready_library(source, None) as library:
        live = Live(library, model, port=port, **settings)
    click.echo(f"{live.address} plays {source}; Ctrl-C ends it")
    try:
        live.run(until)
    except KeyboardInterrupt:  # which may have left a lock of the server taken
        stopping = Thread(target=live.stop, daemon=True)
        stopping.start()
        stopping.join(STOPPING_S)
