"""Completion of commands and options in the shell that is used: its script, shown or installed."""

from __future__ import annotations

import os
from pathlib import Path
from typing import NamedTuple

import click


class Shell(NamedTuple):
    """Where a shell finds a script of completion, in the home folder, and the line of its start for that."""

    script: str
    start: str = ""
    line: str = ""


SHELLS = {
    "bash": Shell(
        ".bash_completions/modelgen.sh", ".bashrc", "source '{home}/.bash_completions/modelgen.sh'"
    ),
    "zsh": Shell(".zfunc/_modelgen", ".zshrc", "fpath+=~/.zfunc; autoload -Uz compinit; compinit"),
    "fish": Shell(".config/fish/completions/modelgen.fish"),
}


def _shell() -> str:
    name = Path(os.environ.get("SHELL", "")).name
    if name not in SHELLS:
        raise click.UsageError(f"SHELL names no shell of {', '.join(SHELLS)}: {name!r}")
    return name


def _script(shell: str) -> str:
    from click.shell_completion import get_completion_class

    writer = get_completion_class(shell)
    assert writer is not None
    return writer(click.get_current_context().command, {}, "modelgen", "_MODELGEN_COMPLETE").source()


def show_completion() -> None:
    click.echo(_script(_shell()))


def install_completion() -> None:
    """Write the script where the shell looks for it, and one line, once, into the file of its start."""
    from modelgen.file_writing import write_file

    shell = _shell()
    home, files = Path.home(), SHELLS[shell]
    script = home / files.script
    write_file(script, _script(shell))
    if files.start:
        start, line = home / files.start, files.line.format(home=home)
        text = start.read_bytes() if start.exists() else b""  # in any encoding
        if line.encode() not in text:
            write_file(start, (text.rstrip() + f"\n{line}\n".encode()).lstrip())
    click.echo(f"written: {script}; completion works in a new shell")
