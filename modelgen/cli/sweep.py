"""The command `sweep`: a scene run many times with other numbers."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import click
from rich.console import Console

import modelgen
from modelgen.cli.command import Option
from modelgen.cli.option_reading import named_values, read_option
from modelgen.cli.options import AsJson, Form, OutPicture, SceneFile
from modelgen.cli.output import FAILED, check_outputs, print_facts, print_lines
from modelgen.cli.pipeline import read_scene, ready_library
from modelgen.cli.progress import progress
from modelgen.cli.run_options import RunOptions
from modelgen.errors import ModelgenError

Varied = Annotated[
    list[str] | None,
    Option(
        help="values of a parameter, an input or a start: mass=0.5:2:4, mass=1,2, mass=0.5:2; repeat it",
        metavar="NAME=A:B:N",
    ),
]
Runs = Annotated[
    str | None,
    Option("--samples", help="number of runs that are drawn; default: a grid", metavar="NUMBER"),
]
Design = Annotated[str | None, Option(help="how values are chosen", metavar="[grid|sobol|latin|random]")]
Seed = Annotated[str | None, Option(help="of the draws", metavar="NUMBER")]
Threads = Annotated[
    str | None, Option(help="in which runs go; default: as many as processors", metavar="NUMBER")
]
Scheduler = Annotated[
    str | None, Option(help="runs go on the workers of this Dask scheduler", metavar="tcp://HOST:PORT")
]
Keep = Annotated[str | None, Option(help="what is kept beside the table: whole runs", metavar="trajectories")]
TableFolder = Annotated[
    Path | None,
    Option(
        "--out",
        help="folder of the table, in which the same command goes on",
        metavar="FOLDER",
    ),
]
Of = Annotated[
    str | None,
    Option(help="columns of a sweep that are drawn; default: the sensors", metavar="A,B,..."),
]


def sweep(
    scene: SceneFile,
    run: RunOptions,
    vary: Varied = None,
    samples: Runs = None,
    design: Design = None,
    seed: Seed = None,
    threads: Threads = None,
    scheduler: Scheduler = None,
    out: TableFolder = None,
    keep: Keep = None,
    form: Form = None,
    plot: OutPicture = None,
    of: Of = None,
    as_json: AsJson = False,
) -> None:
    """Run a scene many times with other numbers; write a table. After an interruption the command goes on."""
    from modelgen.parameter_study.outcome_plot import check_drawn, draw_sweep
    from modelgen.parameter_study.rows import columns_of
    from modelgen.parameter_study.sweep_folder import require_pyarrow
    from modelgen.parameter_study.sweep_output import print_sweep, sweep_facts

    require_pyarrow()
    check_picture(plot)
    drawn = columns_drawn(of, plot)
    if out is None:
        raise ModelgenError("--out", "no folder for the table", "", "write --out FOLDER")
    settings = run.settings() | {
        "samples": read_option("runs", samples, "samples"),
        "design": design,
        "seed": read_option("seed", seed) or 0,
        "threads": read_option("threads", threads),
        "scheduler": scheduler,
        "out": out,
        "keep": [] if keep is None else [name.strip() for name in keep.split(",")],
    }
    varied = named_values(vary, "--vary", "mass=0.5:2:4")
    with ready_library(scene, form) as library, progress("running") as report:
        if drawn is not None:
            check_drawn(drawn, list(columns_of(library.manifest.instance, list(varied))))
        kept = read_scene(scene, form) if settings["keep"] else None
        found = modelgen.sweep(library, varied, scene=kept, on_progress=report, **settings)
    if plot is not None:
        draw_sweep(found, plot, drawn)
    facts = sweep_facts(found) | {
        "columns": list(found.columns),
        "plot": None if plot is None else str(plot),
    }
    print_facts(facts, as_json, lambda: print_sweep(facts, Console()))
    if found.failed.all():
        click.echo("every run failed", err=True)
        raise click.exceptions.Exit(FAILED)


def check_picture(plot: Path | None) -> None:
    """Raise ModelgenError for a picture that cannot be written, before anything is computed."""
    if plot is None:
        return
    from modelgen.parameter_study.outcome_plot import PICTURES
    from modelgen.report.run_files import check_suffix

    check_suffix(plot, PICTURES)
    check_outputs(None, plot)


def columns_drawn(of: str | None, plot: Path | None) -> list[str] | None:
    """The columns that `--of` names; None where it does not."""
    if of is None:
        return None
    if plot is None:
        raise ModelgenError("--of", repr(of), "columns that a picture shows", "name its file with --plot")
    return [name.strip() for name in of.split(",") if name.strip()]


def plot_sweep(folder: Path, out: Path, of: str | None, as_json: bool) -> None:
    """Draw the outcomes in the folder of a sweep."""
    from modelgen.parameter_study.outcome_plot import draw_sweep
    from modelgen.report.summary import written_line

    check_picture(out)
    found = modelgen.load_sweep(folder)
    draw_sweep(found, out, columns_drawn(of, out))
    facts = {"file": str(out), "scene": found.plan["scene"], "outcome": dict(found.outcomes)}
    print_facts(facts, as_json, lambda: print_lines([written_line(out)]))
