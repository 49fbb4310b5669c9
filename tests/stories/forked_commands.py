"""Commands whose standard streams are closed or full, each in a process that is forked once all is imported:
`python -m tests.stories.forked_commands CASES` prints as JSON how each ended, and what it printed.

CASES, as JSON: of each the words of a command, and what standard output and standard error are: "file",
"closed", "full" (a device without room) or "unread" (a pipe that nobody reads).
"""

from __future__ import annotations

import gc
import json
import os
import signal
import sys
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from typing import NamedTuple

from modelgen import cli
from modelgen.cli.command_group import MODULES

LATER = (
    "report.run_page",
    "report.run_plot",
    "export.export_formats",
    "importing.import_formats",
    "benchmark",
)
LONGEST = 600  # s, of a command on a machine that has much else to do


class Told(NamedTuple):
    """Exit code, standard output, standard error; of streams that are no files nothing."""

    code: int
    out: str
    err: str


def told(words: Sequence[str], out: str, err: str) -> Told:
    """What a command tells, called in a process of its own."""
    files = {1: Path("standard_output"), 2: Path("standard_error")}
    for path in files.values():
        path.write_text("")
    child = os.fork()
    if child == 0:
        for number, kind in ((1, out), (2, err)):
            _become(number, kind, files[number])
        signal.alarm(LONGEST)
        sys.argv = ["modelgen", *words]
        cli.main()
    code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    return Told(code, *(path.read_text() for path in files.values()))


def _become(number: int, kind: str, path: Path) -> None:
    """Let a standard stream be of this kind, as where the process starts with it."""
    name = {1: "stdout", 2: "stderr"}[number]
    os.close(number)
    setattr(sys, name, None)
    if kind == "closed":
        return
    if kind == "unread":
        reading, handle = os.pipe()
        os.close(reading)
    else:
        handle = os.open("/dev/full" if kind == "full" else path, os.O_WRONLY)
    if handle != number:
        os.dup2(handle, number)
        os.close(handle)
    os.set_inheritable(number, True)
    setattr(sys, name, os.fdopen(number, "w", closefd=False))


def main() -> None:
    for name in {f"cli.{each}" for each in MODULES.values()} | set(LATER):
        import_module(f"modelgen.{name}")
    gc.freeze()  # or each process copies what it never frees
    answers = [told(*case) for case in json.loads(sys.argv[1])]
    print(json.dumps(answers))


if __name__ == "__main__":
    main()
