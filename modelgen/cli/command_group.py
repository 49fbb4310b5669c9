"""The commands by name, each loaded when it is named or the help of all is shown."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from typing import Any

import click
from click.exceptions import Exit, NoSuchCommand

from modelgen import __version__
from modelgen.cli import INTERRUPTED
from modelgen.cli.command import command_of, option_that, shortened
from modelgen.interruption import nothing_swallowed

MODULES = {  # of `modelgen.cli`, each with a function of the name of its command
    "new": "new",
    "check": "check",
    "build": "build",
    "simulate": "simulate",
    "linearise": "linearise",
    "fit": "fit",
    "sweep": "sweep",
    "measure": "measure_and_tune",
    "tune": "measure_and_tune",
    "manual": "manual",
    "sensitivity": "sensitivity",
    "view": "view",
    "export": "export",
    "import": "import_file",
    "report": "report",
    "plot": "plot",
    "inspect": "inspect",
    "schema": "schema",
}
FUNCTIONS = {"import": "import_file"}  # where the name of a command is a word of Python


class Commands(click.Group):
    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(MODULES)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in MODULES:
            return None
        with nothing_swallowed():
            module = import_module(f"modelgen.cli.{MODULES[cmd_name]}")
        return command_of(getattr(module, FUNCTIONS.get(cmd_name, cmd_name)), cmd_name)

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """The command that is named; where there is none, the nearest names are suggested."""
        try:
            return super().resolve_command(ctx, args)
        except NoSuchCommand as error:
            raise NoSuchCommand(error.command_name, possibilities=MODULES, ctx=ctx) from None

    def make_context(self, *args: Any, **keys: Any) -> click.Context:
        with _told_when_interrupted(), _shortened_errors():
            return super().make_context(*args, **keys)

    def invoke(self, ctx: click.Context) -> Any:
        with _told_when_interrupted(), _shortened_errors():
            return super().invoke(ctx)


@contextmanager
def _told_when_interrupted() -> Iterator[None]:
    """Ctrl-C ends a command without a traceback, also while its modules are imported."""
    try:
        yield
    except KeyboardInterrupt:
        click.echo("interrupted", err=True)
        raise Exit(INTERRUPTED) from None


@contextmanager
def _shortened_errors() -> Iterator[None]:
    """Print long words of what was called wrongly in part."""
    try:
        yield
    except click.UsageError as error:
        raise click.UsageError(shortened(error.format_message()), ctx=error.ctx) from None


def _install_completion() -> None:
    from modelgen.cli.shell_completion import install_completion

    install_completion()


def _show_completion() -> None:
    from modelgen.cli.shell_completion import show_completion

    show_completion()


app = Commands(
    "modelgen",
    help="From a scene file to a compiled model of rigid bodies in smooth contact, and its trajectory.",
    params=[
        option_that(
            _install_completion, "--install-completion", "set up completion for the shell that SHELL names"
        ),
        option_that(_show_completion, "--show-completion", "print the script of completion for that shell"),
    ],
)
click.version_option(
    __version__, prog_name="modelgen", message="%(prog)s %(version)s", help="print the version"
)(app)
