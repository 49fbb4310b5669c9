"""Output of a command: standard output, files, messages and the exit code."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from modelgen.cli import INTERRUPTED
from modelgen.errors import ModelgenError

if TYPE_CHECKING:
    from modelgen.codegen.library import Library
    from modelgen.runtime.trajectory import Trajectory
    from modelgen.scene.scene_types import Scene

FAILED, REFUSED = 1, 2


def check_outputs(run: Path | None, picture: Path | None) -> None:
    """Raise ModelgenError for output files that cannot be written, before anything is computed."""
    if run is None and picture is None:
        return
    from modelgen.report import run_files
    from modelgen.report.run_plot import FORMATS, require_matplotlib

    for path, formats in ((run, run_files.FORMATS), (picture, FORMATS)):
        if path is None:
            continue
        run_files.check_suffix(path, formats)
        check_file(path)
    if picture is not None:
        require_matplotlib()


def needed(out: Path | None, example: str) -> Path:
    """The file that a command writes; ModelgenError where none is named."""
    if out is None:
        raise ModelgenError("--out", "no file to write", "", f"write --out {example}")
    return out


def check_file(path: Path) -> None:
    """Raise ModelgenError if the file cannot be written; leaves no file behind."""
    from modelgen.file_writing import check_writable, unwritable

    try:
        if path.is_dir():
            raise ModelgenError(str(path), "it is a folder", "a file", "name one")
        if not path.parent.is_dir():
            raise ModelgenError(str(path), f"no folder {str(path.parent)!r}", "", "make it first")
        if not path.exists() or path.is_file():
            check_writable(path)
    except OSError as cause:
        raise unwritable(path, cause) from cause


def write_run(
    trajectory: Trajectory, library: Library, scene: Scene | None, run: Path | None, picture: Path | None
) -> dict[str, str | None]:
    """Write the requested files of a run of a scene. Returns their names under the keys `out` and `plot` of
    the summary."""
    written = {"out": None if run is None else str(run), "plot": None if picture is None else str(picture)}
    if run is None and picture is None:
        return written
    from modelgen.report.run_files import save
    from modelgen.report.run_record import record_of

    record = record_of(trajectory, library, scene)
    if run is not None:
        save(record, run)
    if picture is not None:
        from modelgen.report.run_plot import draw

        draw(record, picture)
    return written


def print_facts(facts: dict[str, Any], as_json: bool, show: Callable[[], None]) -> None:
    if as_json:
        click.echo(json.dumps(_finite(facts), allow_nan=False))
    else:
        show()


def print_lines(lines: Iterable[str]) -> None:
    """Print lines; on a terminal their numbers are coloured."""
    if not sys.stdout.isatty():
        for line in lines:
            click.echo(line)
        return
    from rich.console import Console

    console = Console()
    for line in lines:
        console.print(line, markup=False, emoji=False, soft_wrap=True)


def print_text(text: str, out: Path | None) -> None:
    """Print a text, or write it into a file and name that."""
    if out is None:
        click.echo(text)
        return
    from modelgen.file_writing import write_file

    write_file(out, text)
    click.echo(f"written: {out}")


def _finite(value: Any) -> Any:
    """The value with None in place of infinity and NaN, which JSON lacks."""
    if isinstance(value, dict):
        return {key: _finite(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(entry) for entry in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def exit_with(trajectory: Trajectory) -> None:
    """End the command with the exit code of a run that did not end as `done`, or whose companion was
    interrupted."""
    outcome = trajectory.outcome
    if not outcome.succeeded:
        click.echo(_ending(trajectory), err=True)
    elif trajectory.interrupted:
        click.echo(_whole(trajectory), err=True)
    else:
        return
    raise click.exceptions.Exit(INTERRUPTED if trajectory.interrupted else FAILED)


def _whole(trajectory: Trajectory) -> str:
    """True of a run that was interrupted at its end, or in its companion run."""
    where = "as the run came to its end" if trajectory.stopped else "in the companion run"
    bare = trajectory.estimate is None or not trajectory.estimate.uncertified
    return f"interrupted {where}: the run is whole{'' if bare else ', its error is not certified'}"


def _ending(trajectory: Trajectory) -> str:
    outcome = trajectory.outcome
    named = trajectory.outcome_contact or trajectory.outcome_function
    place = f" ({named})" if named else ""
    last = "; the last sample is the state then" if trajectory.reaches_its_end else ""
    return f"{outcome.name.lower()}{place} at t = {trajectory.t_end:.6g} s: {outcome.value}{last}"
