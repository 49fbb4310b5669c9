"""A set of files, written once for each operation on files that this takes, which fails, or before which the
process is killed: `python -m tests.stories.failing_operations fails|killed FOLDER BEFORE` prints as JSON how
each attempt ended, and the files that it left. BEFORE: the files that are there before each, as JSON. Or
processes that write at once: `python -m tests.stories.failing_operations races FOLDER COUNT`."""

from __future__ import annotations

import errno
import json
import os
import shutil
import sys
from pathlib import Path

from modelgen.errors import ModelgenError
from modelgen.file_writing import write_files

OPERATIONS = ("open", "os.rename", "os.link", "os.mkdir", "os.chmod")  # as Python's audit hooks call them
FILES = {"a.c": "a", "b.h": "b" * 100, "sources/c.c": "c" * 300, "empty": ""}
WRITERS = 3
UNTOUCHED, REFUSED, OVERCOME, KILLED = 0, 2, 3, 137  # nothing failed; refused; written nevertheless; killed


def attempts(mode: str, folder: Path, before: dict[str, str]) -> list[tuple[int, dict[str, str]]]:
    """How each attempt ended, and files by name; in the last every operation succeeds."""
    found: list[tuple[int, dict[str, str]]] = []
    while not found or found[-1][0] != UNTOUCHED:
        shutil.rmtree(folder, ignore_errors=True)
        for name, text in before.items():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            (folder / name).write_text(text)
        child = os.fork()
        if child == 0:
            os._exit(_attempt(mode, folder, len(found)))
        code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        found.append((code, texts(folder)))
    return found


def races(folder: Path, count: int) -> list[tuple[int, dict[str, str]]]:
    """How many of WRITERS processes that write FILES at once, each with texts of its own, have failed, and
    which files they left. The folder is new in every second race."""
    found = []
    for number in range(count):
        if number % 2 == 0:
            shutil.rmtree(folder, ignore_errors=True)
        children = []
        for writer in range(WRITERS):
            child = os.fork()
            if child == 0:
                try:
                    write_files({folder / name: written_by(writer, name) for name in FILES})
                finally:
                    os._exit(sys.exc_info()[0] is not None)
            children.append(child)
        codes = [os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) for child in children]
        found.append((sum(map(bool, codes)), texts(folder.parent)))
    return found


def written_by(writer: int, name: str) -> str:
    return f"{name} of {writer}\n" * 1000


def texts(folder: Path) -> dict[str, str]:
    return {str(each.relative_to(folder)): each.read_text() for each in folder.rglob("*") if each.is_file()}


def _attempt(mode: str, folder: Path, number: int) -> int:
    count = 0

    def hook(event: str, arguments: tuple[object, ...]) -> None:
        nonlocal count
        if event not in OPERATIONS or not str(arguments[0]).startswith(str(folder.parent)):
            return
        count += 1
        if count == number + 1:
            if mode == "killed":
                os._exit(KILLED)
            raise OSError(errno.ENOSPC, "No space left on device")

    sys.addaudithook(hook)
    try:
        write_files({folder / name: text for name, text in FILES.items()})
    except ModelgenError:
        return REFUSED
    return OVERCOME if count > number else UNTOUCHED


if __name__ == "__main__":
    mode, place, given = sys.argv[1], Path(sys.argv[2]), json.loads(sys.argv[3])
    print(json.dumps(races(place, given) if mode == "races" else attempts(mode, place, given)))
