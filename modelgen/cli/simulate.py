"""The command `simulate`: a run of a scene, its summary and its files."""

from __future__ import annotations

from modelgen.cli.option_reading import read_values
from modelgen.cli.options import (
    AsJson,
    Estimated,
    Fallback,
    Form,
    InputValues,
    Method,
    OutPicture,
    OutRun,
    Quality,
    Samples,
    SceneFile,
    Scheme,
    Solver,
    Step,
    Tolerance,
    Until,
    Values,
)
from modelgen.cli.output import check_outputs, exit_with, print_facts, print_lines, write_run
from modelgen.cli.pipeline import read_scene, run_scene, run_settings


def simulate(
    scene: SceneFile,
    until: Until = None,
    accuracy: Quality = None,
    tolerance: Tolerance = None,
    samples: Samples = None,
    method: Method = None,
    step: Step = None,
    scheme: Scheme = None,
    solver: Solver = None,
    fallback: Fallback = None,
    estimate: Estimated = None,
    values: Values = None,
    inputs: InputValues = None,
    form: Form = None,
    out: OutRun = None,
    plot: OutPicture = None,
    as_json: AsJson = False,
) -> None:
    """Run a scene; print its summary, write the run and its picture. Ctrl-C keeps what was computed."""
    from modelgen.report.summary import summary_lines

    check_outputs(out, plot)
    settings = run_settings(
        until, accuracy, tolerance, samples,
        method=method, step=step, scheme=scheme, solver=solver, fallback=fallback, estimate=estimate,
    ) | {"parameters": read_values(values, "--set"), "inputs": read_values(inputs, "--input")}  # fmt: skip
    trajectory, library = run_scene(scene, form, settings)
    drawn = None if out is None and plot is None else read_scene(scene, form)
    written = write_run(trajectory, library, drawn, out, plot)
    summary = trajectory.summary() | written
    print_facts(summary, as_json, lambda: print_lines(summary_lines(summary)))
    exit_with(trajectory)
