"""The commands of the command line, one function each; its docstring is its help text."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console

import modelgen
from modelgen.cli.export import export
from modelgen.cli.fit import fit
from modelgen.cli.import_file import import_file
from modelgen.cli.linearise import linearise
from modelgen.cli.manual import manual, print_page
from modelgen.cli.measure_and_tune import measure, tune
from modelgen.cli.new import new
from modelgen.cli.options import (
    AsJson,
    At,
    Brief,
    Derivatives,
    Estimated,
    Fallback,
    Form,
    Frames,
    InputValues,
    MainFile,
    Method,
    OutFolder,
    OutPicture,
    OutRun,
    Quality,
    RealName,
    Samples,
    SceneFile,
    Scheme,
    Solver,
    Step,
    Style,
    Tolerance,
    Until,
    Values,
    Verify,
    read_configuration,
    read_option,
    read_values,
    refuse_main,
)
from modelgen.cli.output import (
    FAILED,
    check_file,
    check_outputs,
    exit_with,
    guarded,
    needed,
    print_facts,
    print_text,
    write_run,
)
from modelgen.cli.pipeline import (
    build_scene,
    derive_scene,
    folder_of,
    read_scene,
    run_scene,
    run_settings,
)
from modelgen.cli.report import report
from modelgen.cli.sensitivity import sensitivity
from modelgen.cli.sweep import Of, plot_sweep, sweep
from modelgen.cli.view import recorded, view
from modelgen.errors import ModelgenError

app = typer.Typer(
    help="From a scene file to a compiled model of rigid bodies in smooth contact, and its trajectory.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)


@app.callback(invoke_without_command=True)
def version(
    show: Annotated[bool, typer.Option("--version", help="print the version", is_eager=True)] = False,
) -> None:
    if show:
        typer.echo(f"modelgen {modelgen.__version__}")
        raise typer.Exit


app.command()(new)


@app.command()
@guarded
def check(scene: SceneFile, form: Form = None, brief: Brief = False, as_json: AsJson = False) -> None:
    """Say what a scene requires: kinds, forms, instruction counts, what leaving things out saves. Compiles
    nothing."""
    from modelgen.report.check import check_facts, print_check
    from modelgen.report.savings_by_decision import savings_of

    derivation = derive_scene(read_scene(scene, form))
    facts = check_facts(derivation)
    if not brief:
        facts["savings"] = [saving.as_json() for saving in savings_of(derivation)]
    print_facts(facts, as_json, lambda: print_check(facts, Console()))


@app.command()
@guarded
def build(
    scene: SceneFile,
    out: OutFolder = None,
    real: RealName = None,
    form: Form = None,
    main: MainFile = None,
    derivatives: Derivatives = False,
    as_json: AsJson = False,
) -> None:
    """Generate and compile the library of a scene; compiles nothing that is already there."""
    refuse_main(main)
    what = read_scene(scene, form)
    library = build_scene(what, out or folder_of(what, form), read_option("real", real), derivatives)
    manifest = library.manifest
    facts = {
        "scene": manifest.instance["name"],
        "library": str(library.path),
        "real": library.real,
        "hash": library.record.hash,
        "instructions": {name: entry["instructions"] for name, entry in manifest.functions.items()},
    }
    print_facts(facts, as_json, lambda: typer.echo(library.path))


@app.command()
@guarded
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
    from modelgen.report.summary import print_summary

    check_outputs(out, plot)
    settings = run_settings(
        until, accuracy, tolerance, samples,
        method=method, step=step, scheme=scheme, solver=solver, fallback=fallback, estimate=estimate,
    ) | {"parameters": read_values(values, "--set"), "inputs": read_values(inputs, "--input")}  # fmt: skip
    trajectory, library = run_scene(scene, form, settings)
    drawn = None if out is None and plot is None else read_scene(scene, form)
    written = write_run(trajectory, library, drawn, out, plot)
    summary = trajectory.summary() | written
    print_facts(summary, as_json, lambda: print_summary(summary, Console()))
    exit_with(trajectory)


app.command()(linearise)
app.command()(fit)
app.command()(sweep)
app.command()(measure)
app.command()(tune)
app.command()(manual)
app.command()(sensitivity)
app.command()(view)
app.command()(export)
app.command("import")(import_file)
app.command()(report)


@app.command()
@guarded
def plot(
    source: Annotated[
        Path,
        typer.Argument(
            metavar="RUN.npz|SCENE|SWEEP",
            help="a run, a scene to run first, a folder of a sweep",
            readable=False,
        ),
    ],
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            "-o",
            help="FILE.png or FILE.svg, needed; FILE.gif or FILE.mp4: a film",
            metavar="FILE",
            readable=False,
        ),
    ] = None,
    frames: Frames = None,
    of: Of = None,
    as_json: AsJson = False,
) -> None:
    """Draw motion, forces, gaps, energy, the contact curves on both surfaces, and the bodies; or the outcomes
    of a sweep."""
    out = needed(out, "run.png")
    if source.is_dir():
        if frames is not None:
            raise ModelgenError("--frames", repr(frames), "pictures of the bodies of a run", "leave it out")
        plot_sweep(source, out, of, as_json)
        return
    from modelgen.report.run_plot import draw
    from modelgen.report.summary import print_written

    check_outputs(None, out)
    if of is not None:
        raise ModelgenError("--of", repr(of), "columns of a sweep", "leave it out for a run")
    pictures = read_option("frames", frames)
    record, trajectory = recorded(source, {})
    draw(record, out, pictures)
    facts = {"file": str(out), "scene": record.summary["scene"], "outcome": record.summary["outcome"]}
    print_facts(facts, as_json, lambda: print_written(out, Console()))
    if trajectory:
        exit_with(trajectory)


@app.command()
@guarded
def inspect(
    source: Annotated[str, typer.Argument(metavar="KIND|SCENE", help="a scene, or SHAPE-SHAPE[:FORM]")],
    formula: Annotated[
        str | None, typer.Option(help="only this formula, role or quantity: mg_..._rates, rates, gamma")
    ] = None,
    style: Style = "text",
    at: At = None,
    verify: Verify = None,
    out: Annotated[
        Path | None, typer.Option("--out", "-o", help="file to write the text into", readable=False)
    ] = None,
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
        raise typer.Exit(FAILED)


@app.command()
@guarded
def schema(
    name: Annotated[
        str | None, typer.Argument(metavar="KEY", help="a key, a table, or a kind of shape or joint")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Print the JSON Schema of scene files, or what it says of one KEY in words.

    `$defs` of the whole has the schemas of what the verbs print with --json.
    """
    if name is None:
        typer.echo(json.dumps(_all_schemas(), indent=None if as_json else 2, allow_nan=False))
        return
    from modelgen.report.keys_page import page_of, sections_of

    if as_json:
        typer.echo(json.dumps([asdict(section) for section in sections_of(name)]))
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
