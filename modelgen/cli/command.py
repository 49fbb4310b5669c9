"""The command of a function: the annotations of its parameters say how they are written.

A parameter is a text, a path, a switch, or a list of texts or paths: `Annotated[type, Option(...)]`; or a
dataclass of such parameters, which the command has in its place.
"""

from __future__ import annotations

import inspect
import os
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import is_dataclass
from pathlib import Path
from types import NoneType, UnionType
from typing import Any, NamedTuple, get_args, get_origin, get_type_hints

import click

from modelgen.cli.output import REFUSED
from modelgen.errors import ModelgenError

LONG = re.compile(r"(\S{60})\S{300,}(\S{60})")  # a word that is printed in part


def shortened(message: str) -> str:
    """A message with long words in part."""
    return LONG.sub(lambda word: f"{word[1]}..{word[2]}", message)


class Argument(NamedTuple):
    """A parameter that is written without a name."""

    metavar: str
    help: str


class Option:
    """A parameter that is written with one of these names; where none is told, with its own."""

    def __init__(self, *names: str, help: str = "", metavar: str | None = None, hidden: bool = False) -> None:
        self.names, self.help, self.metavar, self.hidden = names, help, metavar, hidden


def _check_current_folder() -> None:
    try:
        os.getcwd()
    except OSError as cause:
        raise ModelgenError(
            "the current folder", cause.strerror or "", "", "go to one that is there"
        ) from None


def check_inputs(values: Iterable[object]) -> None:
    """Raise ModelgenError for a path of a file to read, or one in a list of paths, where no file is."""
    for value in values:
        for path in value if isinstance(value, list) else [value]:
            if isinstance(path, Path) and _is_missing(path):
                raise _missing(path)


def _is_missing(path: Path) -> bool:
    """Whether nothing has this path; False of what is no path."""
    try:
        return not path.exists()
    except (OSError, ValueError):
        return False


def _missing(path: Path) -> ModelgenError:
    from modelgen.report.run_files import missing_run
    from modelgen.scene.read import no_such_file

    return missing_run(path) if path.suffix == ".npz" else no_such_file(path)


@contextmanager
def refused_in_words() -> Iterator[None]:
    """Turn errors of the user into one message on standard error and an exit code, without a traceback."""
    try:
        yield
        return
    except ModelgenError as error:
        message = str(error)
    except OSError as error:
        where, remedy = error.filename, "name another file"
        if where is None:
            where, remedy = "a temporary file", "make room there, or name another folder in TMPDIR"
        message = f"{where}: {error.strerror or error}; {remedy}"
    click.echo(shortened(message), err=True)
    raise click.exceptions.Exit(REFUSED)


def check_outputs_apart(params: Iterable[click.Parameter], values: Mapping[str, object]) -> None:
    """Raise ModelgenError for an option that names a file to write which the command reads."""
    params = list(params)
    sources = [values[each.name] for each in params if isinstance(each, click.Argument) and each.name]
    for option in params:
        target = values.get(option.name or "")
        if not isinstance(option, click.Option) or not isinstance(target, Path):
            continue
        for source in sources:
            for path in source if isinstance(source, list) else [source]:
                if isinstance(path, str | Path) and _is_one_file(target, path):
                    found = f"{target} is the {'scene' if target.suffix == '.toml' else 'input'} itself"
                    remedy = "or give --in-place" if "in_place" in values else "name one"
                    raise ModelgenError(option.opts[0], found, "another file", remedy)


def _is_one_file(path: Path, other: str | Path) -> bool:
    """Whether two names are of one file; False of what is none."""
    try:
        return path.is_file() and path.samefile(other)
    except (OSError, ValueError):
        return False


class Command(click.Command):
    """A command whose errors are told in words."""

    def invoke(self, ctx: click.Context) -> Any:
        """Call the function, once all files that it reads are there."""
        with refused_in_words():
            _check_current_folder()
            check_inputs(ctx.params[each.name] for each in self.params if isinstance(each, click.Argument))
            check_outputs_apart(self.params, ctx.params)
            return super().invoke(ctx)


def command_of(function: Callable[..., None], name: str) -> Command:
    """The command that calls a function; its help is the docstring."""
    parameters: list[click.Parameter] = []
    records: dict[str, tuple[type, list[str]]] = {}
    for key, hint, default in _signature(function):
        written = [(key, hint, default)]
        if isinstance(hint, type) and is_dataclass(hint):
            written = list(_signature(hint))
            records[key] = hint, [field for field, _, _ in written]
        parameters += [_parameter(*each) for each in written]

    def called(**given: Any) -> None:
        made = {
            key: record(**{field: given.pop(field) for field in own})
            for key, (record, own) in records.items()
        }
        function(**made, **given)

    return Command(name, callback=called, params=parameters, help=inspect.getdoc(function))


def _signature(function: Callable[..., Any]) -> Iterator[tuple[str, Any, Any]]:
    """Name, annotation and default of each parameter."""
    hints = get_type_hints(function, include_extras=True)
    for name, each in inspect.signature(function).parameters.items():
        yield name, hints[name], each.default


def _parameter(name: str, hint: Any, default: Any) -> click.Parameter:
    annotated, written = get_args(hint)
    kind, is_list = _kind(annotated)
    shared: dict[str, Any] = {
        "type": click.Path(path_type=Path, readable=False) if kind is Path else kind,
        "callback": _listed if is_list else None,
        "required": default is inspect.Parameter.empty,
    }
    if not shared["required"]:
        shared["default"] = default
    if isinstance(written, Argument):
        metavar = written.metavar if shared["required"] else f"[{written.metavar}]"
        return click.Argument(
            [name], metavar=metavar, help=written.help, nargs=-1 if is_list else 1, **shared
        )
    long = name.replace("_", "-")
    names = written.names or (f"--{long}/--no-{long}" if kind is bool else f"--{long}",)
    return click.Option(
        [*names, name],
        metavar=written.metavar,
        help=written.help,
        hidden=written.hidden,
        is_flag=kind is bool,
        multiple=is_list,
        show_default=True,
        **shared,
    )


def _kind(annotated: Any) -> tuple[type, bool]:
    """The type of a value, and whether there may be several."""
    if isinstance(annotated, UnionType):
        (annotated,) = (each for each in get_args(annotated) if each is not NoneType)
    return (get_args(annotated)[0], True) if get_origin(annotated) is list else (annotated, False)


def _listed(_: click.Context, __: click.Parameter, values: tuple[Any, ...]) -> list[Any] | None:
    """The values of a parameter that may be repeated; None where there are none."""
    return list(values) or None


def option_that(acts: Callable[[], None], name: str, help: str) -> click.Option:
    """An option that does one thing in place of a command; its errors are told in words."""

    def called(ctx: click.Context, _: click.Parameter, given: bool) -> None:
        if given and not ctx.resilient_parsing:
            with refused_in_words():
                acts()
            ctx.exit()

    return click.Option([name], is_flag=True, is_eager=True, expose_value=False, help=help, callback=called)
