"""The command `simulate`: a run of a scene, its summary and its files."""

from __future__ import annotations

from modelgen.cli.option_reading import read_option
from modelgen.cli.options import AsJson, Form, OutPicture, OutRun, Samples, SceneFile
from modelgen.cli.output import check_outputs, exit_with, print_facts, print_lines, write_run
from modelgen.cli.pipeline import read_scene, run_scene
from modelgen.cli.run_options import RunOptions


def simulate(
    scene: SceneFile,
    run: RunOptions,
    samples: Samples = None,
    form: Form = None,
    out: OutRun = None,
    plot: OutPicture = None,
    as_json: AsJson = False,
) -> None:
    """Run a scene; print its summary, write the run and its picture. Ctrl-C keeps what was computed."""
    from modelgen.report.summary import summary_lines

    check_outputs(out, plot)
    settings = run.settings() | {"samples": read_option("samples", samples)}
    trajectory, library = run_scene(scene, form, settings)
    drawn = None if out is None and plot is None else read_scene(scene, form)
    written = write_run(trajectory, library, drawn, out, plot)
    summary = trajectory.summary() | written
    print_facts(summary, as_json, lambda: print_lines(summary_lines(summary)))
    exit_with(trajectory)
