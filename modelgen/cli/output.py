"""Output of a command: standard output, files, messages and the exit code."""

from __future__ import annotations

import functools
import json
import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, ParamSpec, get_type_hints

import typer
from typer.models import ArgumentInfo

from modelgen.cli import INTERRUPTED
from modelgen.errors import ModelgenError

if TYPE_CHECKING:
    from modelgen.codegen.library import Library
    from modelgen.runtime.trajectory import Trajectory
    from modelgen.scene.scene_types import Scene

FAILED, REFUSED = 1, 2

P = ParamSpec("P")


def guarded(command: Callable[P, None]) -> Callable[P, None]:
    """Turn errors of the user into one message on standard error and an exit code, without a traceback."""

    @functools.wraps(command)
    def wrapper(*args: P.args, **kwargs: P.kwargs) -> None:
        try:
            check_inputs(command, kwargs)
            command(*args, **kwargs)
        except ModelgenError as error:
            message, code = str(error), REFUSED
        except OSError as error:
            message, code = f"{error.filename or 'standard output'}: {error.strerror}", REFUSED
        except KeyboardInterrupt:
            message, code = "interrupted", INTERRUPTED
        else:
            return
        typer.echo(message, err=True)
        raise typer.Exit(code)

    return wrapper


def check_inputs(command: Callable[..., None], given: Mapping[str, object]) -> None:
    """Raise ModelgenError for a file that a command reads and that is not there, before anything else is
    looked at."""
    for name, value in given.items():
        if name not in _arguments(command):
            continue
        for path in value if isinstance(value, list) else [value]:
            if isinstance(path, Path) and is_missing(path):
                raise _missing(path)


@functools.cache
def _arguments(command: Callable[..., None]) -> frozenset[str]:
    """The parameters of a command that are written without a name."""
    hints = get_type_hints(command, include_extras=True)
    marks = {name: getattr(hint, "__metadata__", ()) for name, hint in hints.items()}
    return frozenset(
        name for name, each in marks.items() if any(isinstance(mark, ArgumentInfo) for mark in each)
    )


def is_missing(path: Path) -> bool:
    """Whether nothing has this path; False of what is no path."""
    try:
        return not path.exists()
    except (OSError, ValueError):
        return False


def _missing(path: Path) -> ModelgenError:
    from modelgen.report.run_files import missing_run
    from modelgen.scene.read import no_such_file

    return missing_run(path) if path.suffix == ".npz" else no_such_file(path)


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
    if path.is_dir():
        raise ModelgenError(str(path), "it is a folder", "a file", "name one")
    if not path.parent.is_dir():
        raise ModelgenError(str(path), f"no folder {str(path.parent)!r}", "", "make it first")
    if path.exists() and not path.is_file():
        return
    is_new = not path.exists()
    try:
        path.open("ab").close()
        if is_new:
            path.unlink()
    except OSError as cause:
        raise _unwritable(path, cause) from cause


def write_text(text: str, path: Path) -> None:
    """Write a text file; raises ModelgenError where that fails."""
    try:
        path.write_text(text, encoding="utf-8")
    except OSError as cause:
        raise _unwritable(path, cause) from cause


def _unwritable(path: Path, cause: OSError) -> ModelgenError:
    return ModelgenError(str(path), f"cannot be written: {cause.strerror}", "", "name another file")


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
        typer.echo(json.dumps(_finite(facts), allow_nan=False))
    else:
        show()


def print_text(text: str, out: Path | None) -> None:
    """Print a text, or write it into a file and name that."""
    if out is None:
        typer.echo(text)
        return
    write_text(text, out)
    typer.echo(f"written: {out}")


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
        typer.echo(_ending(trajectory), err=True)
    elif trajectory.interrupted:
        typer.echo(_whole(trajectory), err=True)
    else:
        return
    raise typer.Exit(INTERRUPTED if trajectory.interrupted else FAILED)


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
