"""The commands that trade speed for accuracy: measure and tune."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import click
from rich.console import Console

import modelgen
from modelgen.cli import INTERRUPTED
from modelgen.cli.command import Argument, Option
from modelgen.cli.option_reading import read_option, read_values
from modelgen.cli.options import AsJson, OutPicture, Samples, SceneFile, Until, Values
from modelgen.cli.output import FAILED, check_file, check_outputs, print_facts, print_lines
from modelgen.cli.pipeline import check_folder, folder_of
from modelgen.cli.progress import activity
from modelgen.errors import ModelgenError
from modelgen.file_writing import write_file

if TYPE_CHECKING:
    from modelgen.benchmark import Measurement

UNITS = {"ns": 1.0, "us": 1e3, "µs": 1e3, "ms": 1e6, "s": 1e9}  # of a budget, in ns

Knobs = Annotated[
    str | None, Option(help="only these knobs, by name; default: all that matter", metavar="A,B,...")
]
Limit = Annotated[str | None, Option(help="wall time, s, after which nothing new is tried", metavar="NUMBER")]
Against = Annotated[
    str | None,
    Option(help="other simulators beside it: mujoco, drake, siconos, exudyn, simbody", metavar="A,B,..."),
]
SceneOrNone = Annotated[Path | None, Argument(metavar="SCENE", help="scene file, TOML")]
Extremes = Annotated[
    bool,
    Option("--extremes", help="instead: gaps, curvatures, masses, units .. by decades, without a scene"),
]
Only = Annotated[str | None, Option(help="only these extremes, by name", metavar="A,B,...")]
Fresh = Annotated[bool, Option("--fresh", help="measure again what is remembered")]
AllowedError = Annotated[
    str | None, Option(help="that is allowed, over the characteristic length", metavar="NUMBER")
]
Budget = Annotated[
    str | None,
    Option(
        help="CPU time per simulated second that is allowed, such as 20us; the setting found may exceed it "
        "by 20 %, and says so",
        metavar="TIME",
    ),
]
OutScene = Annotated[
    Path | None,
    Option(help="the scene with the settings; default: SCENE_tuned.toml", metavar="FILE"),
]
InPlace = Annotated[bool, Option("--in-place", help="write them into SCENE itself")]


def measure(
    scene: SceneOrNone = None,
    until: Until = None,
    samples: Samples = None,
    knobs: Knobs = None,
    against: Against = None,
    limit: Limit = None,
    fresh: Fresh = False,
    values: Values = None,
    plot: OutPicture = None,
    extremes: Extremes = False,
    only: Only = None,
    as_json: AsJson = False,
) -> None:
    """Measure error and cost of every setting that matters for a scene, or with --extremes and no scene what
    happens at the ends of double precision. Ctrl-C keeps what was measured."""
    from modelgen.benchmark import measure as measured

    if extremes or scene is None:
        others = {"until": until, "samples": samples, "knobs": knobs, "against": against, "limit": limit}
        _survey(
            scene, extremes, only, others | {"fresh": fresh or None, "set": values, "plot": plot}, as_json
        )
        return
    _refuse({"only": only}, f"with the scene {scene}", "--extremes and no scene go with it")
    check_outputs(None, plot)
    what = modelgen.read(scene)
    check_folder(folder_of(what, None))
    with activity("reference") as report:
        found = measured(
            what,
            until=read_option("until", until),
            samples=read_option("samples", samples),
            knobs=_names("knobs", knobs),
            against=_names("against", against) or (),
            limit=_seconds(limit),
            fresh=fresh,
            parameters=read_values(values, "--set"),
            on_progress=report,
        )
    _show(found, plot, as_json)


def _show(found: Measurement, plot: Path | None, as_json: bool) -> None:
    from modelgen.benchmark.front_plot import draw_measurement
    from modelgen.benchmark.measurement_table import print_measurement

    if plot is not None:
        draw_measurement(found, plot)
    facts = found.as_json() | {"plot": None if plot is None else str(plot)}
    print_facts(facts, as_json, lambda: print_measurement(found, Console()))
    if found.was_stopped:
        raise click.exceptions.Exit(INTERRUPTED)


def _survey(
    scene: Path | None, extremes: bool, only: str | None, given: Mapping[str, object], as_json: bool
) -> None:
    """`given`: options of a measurement, which a survey does not take."""
    from modelgen.benchmark.extremes_survey import survey
    from modelgen.benchmark.extremes_table import print_survey

    if not extremes:
        raise ModelgenError("measure", "no scene", "a scene file, or --extremes", "name one of them")
    if scene is not None:
        raise ModelgenError("--extremes", f"with the scene {scene}", "no scene", "leave one of them out")
    _refuse(given, "with --extremes", "--only and --json go with it")
    with activity("reference") as report:
        found = survey(_names("only", only), on_progress=report)
    print_facts(found.as_json(), as_json, lambda: print_survey(found, Console()))
    if found.interrupted:
        raise click.exceptions.Exit(INTERRUPTED)
    if not found.holds:
        raise click.exceptions.Exit(FAILED)


def tune(
    scene: SceneFile,
    error: AllowedError = None,
    budget: Budget = None,
    until: Until = None,
    knobs: Knobs = None,
    limit: Limit = None,
    values: Values = None,
    out: OutScene = None,
    in_place: InPlace = False,
    as_json: AsJson = False,
) -> None:
    """Find the cheapest setting within an error, or the most accurate within a budget, and write it down."""
    from modelgen.benchmark import tune as tuned
    from modelgen.benchmark.measurement_table import print_tuned
    from modelgen.benchmark.run_table_rewriting import with_run_table
    from modelgen.report.summary import written_line

    target = _target(scene, out, in_place)
    what = modelgen.read(scene)
    check_folder(folder_of(what, None))
    text = scene.read_text(encoding="utf-8")
    with activity("reference") as report, _resumable():
        found = tuned(
            what,
            error=_error(error),
            budget=_budget(budget),
            until=read_option("until", until),
            knobs=_names("knobs", knobs),
            limit=_seconds(limit),
            parameters=read_values(values, "--set"),
            on_progress=report,
        )
    if scene.read_text(encoding="utf-8") != text:
        remedy = "tune it again: what was measured of the same scene is remembered"
        raise ModelgenError(str(scene), "it was changed while it was tuned", "", remedy)
    write_file(target, with_run_table(text, found.point.settings, str(scene)))
    facts = found.as_json() | {"file": str(target)}
    print_facts(facts, as_json, lambda: print_tuned(found, Console()))
    if not as_json:
        print_lines([written_line(target)])


def _target(scene: Path, out: Path | None, in_place: bool) -> Path:
    """The file into which the tuned scene is written. Raises ModelgenError for conflicting options or a
    missing folder."""
    if out is not None and in_place:
        raise ModelgenError("--out", "together with --in-place", "one of them", "leave one out")
    target = scene if in_place else out or scene.with_name(f"{scene.stem}_tuned.toml")
    if target.is_dir():
        raise ModelgenError("--out", f"{str(target)!r} is a folder", "a file", "name one")
    if target.suffix != ".toml":
        raise ModelgenError(
            "--out", repr(str(target)), "a scene file, .toml", f"write {target.with_suffix('.toml')}"
        )
    check_file(target)
    return target


def _refuse(given: Mapping[str, object], found: str, allowed: str) -> None:
    """Raise ModelgenError for given options that would have no effect; None: not given."""
    for option, value in given.items():
        if value is not None:
            raise ModelgenError(f"--{option}", found, allowed, "leave it out")


def _names(option: str, text: str | None) -> tuple[str, ...] | None:
    """The names in `A,B,..`; None if the option was not given. Raises ModelgenError for a list without
    names."""
    if text is None:
        return None
    names = tuple(part.strip() for part in text.split(",") if part.strip())
    if not names:
        raise ModelgenError(
            f"--{option}", repr(text), "names with commas between them", f"name one, or leave --{option} out"
        )
    return names


def _error(text: str | None) -> float | None:
    return None if text is None else _number("error", text, "a number such as 1e-6")


def _seconds(text: str | None) -> float | None:
    return None if text is None else _number("limit", text, "a number of seconds")


def _budget(text: str | None) -> float | None:
    """Nanoseconds of `20us`."""
    if text is None:
        return None
    unit = next((unit for unit in UNITS if text.endswith(unit)), "")
    if not unit:
        raise ModelgenError("--budget", repr(text), "a time with its unit: ns, us, ms or s", "write 20us")
    return UNITS[unit] * _number("budget", text, "a time such as 20us", unit)


def _number(name: str, text: str, allowed: str, unit: str = "") -> float:
    """The positive number before the unit."""
    try:
        value = float(text.removesuffix(unit))
    except ValueError:
        value = -1.0
    if not 0 < value < float("inf"):
        raise ModelgenError(f"--{name}", repr(text), f"{allowed}, positive", "write one")
    return value


@contextmanager
def _resumable() -> Iterator[None]:
    """End the command on Ctrl-C before there is a result; measurements made so far are kept for the next
    call."""
    from modelgen.benchmark.measurement import INTERRUPTED as STOPPED
    from modelgen.benchmark.measurement import resumable

    try:
        yield
    except KeyboardInterrupt:
        click.echo(resumable(STOPPED), err=True)
        raise click.exceptions.Exit(INTERRUPTED) from None
