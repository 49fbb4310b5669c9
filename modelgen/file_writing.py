"""Files are written beside their place and moved there once they are on the disk: what fails, or is killed,
leaves the older file as it was.

A process holds a lock on each file and folder that is to be temporary, which the operating system releases
when the process ends. One that is not locked was left by a process that was killed; the next that writes in
the same folder removes it.
"""

from __future__ import annotations

import errno
import fcntl
import os
import re
import secrets
import shutil
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

from modelgen.errors import ModelgenError

SCRATCH = ".modelgen-"  # start of the name of a file that is being written
SCRATCH_NAME = re.compile(rf"{re.escape(SCRATCH)}([0-9a-f]{{16}}|\d+-\d+)(\.|$)")
FOLDER = "modelgen-scratch-"  # start of the name of a temporary folder
_cleared: set[Path] = set()  # folders in which this process has removed what others left


@contextmanager
def replaced(path: Path, mode: int | None = None) -> Iterator[Path]:
    """A file to write beside `path`, with the same ending, that takes its place when the block ends.

    Folders are made. A link stays one: the file that it names is replaced. What is no file, as a device or a
    pipe, is written itself.

    Args:
        path: of the file; its rights are kept if it is there.
        mode: rights of the file; None: those of a new file.

    Raises:
        ModelgenError: the file cannot be written; it is as it was before.
    """
    try:
        place = Path(os.path.realpath(path))
        if place.exists() and not place.is_file():
            yield place
            return
        place.parent.mkdir(parents=True, exist_ok=True)
        if place.parent not in _cleared:
            remove_abandoned(place.parent)
            _cleared.add(place.parent)
        scratch, lock = _beside(place, 0o666 if mode is None else mode)
        try:
            if mode is None and place.exists():
                place.open("ab").close()  # one that may not be written is not replaced either
                scratch.chmod(place.stat().st_mode & 0o7777)
            yield scratch
            _flush(scratch)
            os.replace(scratch, place)
            with suppress(OSError):  # a folder that may not be read
                _flush(place.parent)
        finally:
            with suppress(OSError):
                scratch.unlink(missing_ok=True)
            os.close(lock)
    except OSError as cause:
        raise unwritable(path, cause) from cause


@contextmanager
def scratch_folder() -> Iterator[Path]:
    """A temporary folder, which is removed when the block ends; those of processes that were killed are
    removed before."""
    top = Path(tempfile.gettempdir())
    for left in top.glob(f"{FOLDER}*"):
        lock = _lock(left)
        if lock is not None:
            shutil.rmtree(left, ignore_errors=True)
            os.close(lock)
    while True:
        folder = Path(tempfile.mkdtemp(prefix=FOLDER))
        lock = _lock(folder)
        if folder.is_dir():  # not taken for one that was left, before it was locked
            break
    try:
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)
        if lock is not None:
            os.close(lock)


def write_file(path: Path, content: str | bytes, mode: int | None = None) -> None:
    """Write a file, as `replaced` does; text in UTF-8."""
    with replaced(path, mode) as scratch:
        scratch.write_bytes(content.encode() if isinstance(content, str) else content)


def write_files(contents: Mapping[Path, str | bytes]) -> None:
    """Write several files: all, or, if one cannot be written, none."""
    with ExitStack() as stack:
        for path, content in contents.items():
            scratch = stack.enter_context(replaced(path))
            scratch.write_bytes(content.encode() if isinstance(content, str) else content)
            _flush(scratch)


def check_writable(path: Path) -> None:
    """Raise ModelgenError if `replaced` could not begin; leaves no file behind."""
    place = Path(os.path.realpath(path))
    try:
        if place.exists():
            place.open("ab").close()
        scratch, lock = _beside(place, 0o666)
        scratch.unlink()
        os.close(lock)
    except OSError as cause:
        raise unwritable(path, cause) from cause


def unwritable(path: Path, cause: OSError) -> ModelgenError:
    """The error of a file that cannot be written."""
    remedy = "make room there, or name" if cause.errno in (errno.ENOSPC, errno.EDQUOT) else "name"
    return ModelgenError(
        str(path), f"cannot be written: {cause.strerror or cause}", "", f"{remedy} another file"
    )


def remove_abandoned(folder: Path) -> None:
    """Remove the files that processes which were killed have left half written in a folder."""
    with suppress(OSError):
        for name in os.listdir(folder):
            if SCRATCH_NAME.match(name) and (lock := _lock(folder / name)) is not None:
                with suppress(OSError):
                    os.unlink(folder / name)
                os.close(lock)


def _beside(place: Path, mode: int) -> tuple[Path, int]:
    """A new file in the folder of a place, with the same ending, and the handle that holds its lock."""
    while True:
        scratch = place.with_name(f"{SCRATCH}{secrets.token_hex(8)}{place.suffix}")
        handle = os.open(scratch, os.O_RDWR | os.O_CREAT | os.O_EXCL, mode)
        with suppress(OSError):  # a disk without locks: then nothing there is ever taken for abandoned
            fcntl.flock(handle, fcntl.LOCK_EX)
        if scratch.exists():  # not taken for one that was left, before it was locked
            return scratch, handle
        os.close(handle)


def _lock(path: Path) -> int | None:
    """A handle that holds the lock of a file or folder; None where another process holds it, or none can."""
    flags = os.O_NOFOLLOW | os.O_NONBLOCK
    try:
        handle = os.open(path, flags | (os.O_RDONLY if path.is_dir() else os.O_RDWR))
    except OSError:
        return None
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        os.close(handle)
        return None
    return handle


def _flush(path: Path) -> None:
    """Wait until a file or folder is on the disk."""
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
