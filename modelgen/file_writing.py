"""Files are written beside their place and moved there once they are on the disk: what fails, or is killed,
leaves the older file as it was."""

from __future__ import annotations

import errno
import os
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from itertools import count
from pathlib import Path

from modelgen.errors import ModelgenError

_NUMBERS = count()
SCRATCH = ".modelgen-"  # start of the name of a file that is being written


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
        scratch = _beside(place)
        try:
            scratch.touch(0o666 if mode is None else mode)
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
    except OSError as cause:
        raise unwritable(path, cause) from cause


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
        scratch = _beside(place)
        scratch.touch()
        scratch.unlink()
    except OSError as cause:
        raise unwritable(path, cause) from cause


def unwritable(path: Path, cause: OSError) -> ModelgenError:
    """The error of a file that cannot be written."""
    remedy = "make room there, or name" if cause.errno in (errno.ENOSPC, errno.EDQUOT) else "name"
    return ModelgenError(
        str(path), f"cannot be written: {cause.strerror or cause}", "", f"{remedy} another file"
    )


def _beside(place: Path) -> Path:
    return place.with_name(f"{SCRATCH}{os.getpid()}-{next(_NUMBERS)}{place.suffix}")


def _flush(path: Path) -> None:
    """Wait until a file or folder is on the disk."""
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
