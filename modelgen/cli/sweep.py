"""The command `sweep`: a scene run many times with other numbers."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console

import modelgen
from modelgen.cli.options import (
    AsJson,
    Estimated,
    Fallback,
    Form,
    InputValues,
    Method,
    OutPicture,
    Quality,
    SceneFile,
    Scheme,
    Solver,
    Step,
    Tolerance,
    Until,
    Values,
    named_values,
    read_option,
    read_values,
)
from modelgen.cli.output import FAILED, check_outputs, guarded, print_facts
from modelgen.cli.pipeline import read_scene, ready_library, run_settings
from modelgen.cli.progress import progress
from modelgen.errors import ModelgenError

Varied = Annotated[
    list[str] | None,
    typer.Option(
        help="values of a parameter, an input or a start: mass=0.5:2:4, mass=1,2, mass=0.5:2; repeat it",
        metavar="NAME=A:B:N",
    ),
]
Runs = Annotated[
    str | None,
    typer.Option("--samples", help="number of runs that are drawn; default: a grid", metavar="NUMBER"),
]
Design = Annotated[
    str | None, typer.Option(help="how values are chosen", metavar="[grid|sobol|latin|random]")
]
Seed = Annotated[str | None, typer.Option(help="of the draws", metavar="NUMBER")]
Threads = Annotated[
    str | None, typer.Option(help="in which runs go; default: as many as processors", metavar="NUMBER")
]
Scheduler = Annotated[
    str | None, typer.Option(help="runs go on the workers of this Dask scheduler", metavar="tcp://HOST:PORT")
]
Keep = Annotated[
    str | None, typer.Option(help="what is kept beside the table: whole runs", metavar="trajectories")
]
TableFolder = Annotated[
    Path | None,
    typer.Option(
        "--out",
        help="folder of the table, in which the same command goes on",
        metavar="FOLDER",
        readable=False,
    ),
]
Of = Annotated[
    str | None, typer.Option(help="columns that --plot draws; default: the sensors", metavar="A,B,...")
]


@guarded
def sweep(
    scene: SceneFile,
    vary: Varied = None,
    samples: Runs = None,
    design: Design = None,
    seed: Seed = None,
    threads: Threads = None,
    scheduler: Scheduler = None,
    out: TableFolder = None,
    keep: Keep = None,
    until: Until = None,
    accuracy: Quality = None,
    tolerance: Tolerance = None,
    method: Method = None,
    step: Step = None,
    scheme: Scheme = None,
    solver: Solver = None,
    fallback: Fallback = None,
    estimate: Estimated = None,
    values: Values = None,
    inputs: InputValues = None,
    form: Form = None,
    plot: OutPicture = None,
    of: Of = None,
    as_json: AsJson = False,
) -> None:
    """Run a scene many times with other numbers; write a table of the outcomes. The same command goes on."""
    from modelgen.parameter_study.folder import require_pyarrow
    from modelgen.parameter_study.outcome_plot import draw_sweep
    from modelgen.parameter_study.sweep_output import print_sweep, sweep_facts

    require_pyarrow()
    check_outputs(None, plot)
    if out is None:
        raise ModelgenError("--out", "no folder for the table", "", "write --out FOLDER")
    settings: dict[str, Any] = run_settings(
        until, accuracy, tolerance, None,
        method=method, step=step, scheme=scheme, solver=solver, fallback=fallback, estimate=estimate,
    )  # fmt: skip
    del settings["samples"]
    settings |= {
        "samples": read_option("runs", samples, "samples"),
        "design": design,
        "seed": read_option("seed", seed) or 0,
        "threads": read_option("threads", threads),
        "scheduler": scheduler,
        "out": out,
        "keep": [] if keep is None else [name.strip() for name in keep.split(",")],
        "parameters": read_values(values, "--set"),
        "inputs": read_values(inputs, "--input"),
    }
    varied = named_values(vary, "--vary", "mass=0.5:2:4")
    with ready_library(scene, form) as library, progress("running") as report:
        kept = read_scene(scene, form) if settings["keep"] else None
        found = modelgen.sweep(library, varied, scene=kept, on_progress=report, **settings)
    if plot is not None:
        draw_sweep(found, plot, None if of is None else [name.strip() for name in of.split(",")])
    facts = sweep_facts(found) | {
        "columns": list(found.columns),
        "plot": None if plot is None else str(plot),
    }
    print_facts(facts, as_json, lambda: print_sweep(facts, Console()))
    if found.failed.all():
        typer.echo("every run failed", err=True)
        raise typer.Exit(FAILED)
