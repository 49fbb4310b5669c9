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
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

from modelgen.errors import ModelgenError
from modelgen.interruption import cleared

SCRATCH = ".modelgen-"  # start of the name of a file that is being written
SCRATCH_NAME = re.compile(rf"{re.escape(SCRATCH)}([0-9a-f]{{16}}|\d+-\d+)(\.|$)")
LONGEST_ENDING = 16  # letters of an ending that programs know files by; with a longer one names get too long
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
    with _named(path), _beside(path, mode) as (scratch, place):
        yield scratch
        if scratch != place:
            _flush(scratch)
            os.replace(scratch, place)
            _flush_folders([place.parent])


@contextmanager
def scratch_folder() -> Iterator[Path]:
    """A temporary folder, which is removed when the block ends; those of processes that were killed are
    removed before."""
    top = Path(tempfile.gettempdir())
    for left in top.glob(f"{FOLDER}*"):
        _remove_if_abandoned(left)
    with _held_folder(lambda: top / f"{FOLDER}{secrets.token_hex(8)}", 0o700) as folder:
        yield folder


def write_file(path: Path, content: str | bytes, mode: int | None = None) -> None:
    """Write a file, as `replaced` does; text in UTF-8."""
    with replaced(path, mode) as scratch:
        scratch.write_bytes(_encoded(content))


def write_files(contents: Mapping[Path, str | bytes]) -> None:
    """Write several files: all, or, if one cannot be written, none.

    All are on the disk, beside their places, before the first is moved. The files of one new folder appear at
    once, with the folder. Others are moved one right after the other: a process that is killed between two of
    these moves leaves some new files and some older ones, each of them whole. A move that fails is undone,
    and so are those before it; on a file system without hard links only those of new files.
    """
    tops = {_first_missing(path) for path in contents}
    (top,) = tops if len(tops) == 1 else (None,)
    if top is None or not _write_folder(top, contents):
        _write_beside(contents)


def _write_folder(top: Path, contents: Mapping[Path, str | bytes]) -> bool:
    """Write files into a folder that is not there; False if another process has made it meanwhile."""
    with _named(top):
        top.parent.mkdir(parents=True, exist_ok=True)
        _clear(top.parent)
        with _held_folder(lambda: _scratch_name(top)) as scratch:
            for path, content in contents.items():
                with _named(path):
                    own = scratch / Path(os.path.realpath(path)).relative_to(top)
                    own.parent.mkdir(parents=True, exist_ok=True)
                    own.write_bytes(_encoded(content))
                    _flush(own)
            _flush_folders(Path(place) for place, _, _ in os.walk(scratch))
            try:
                os.rename(scratch, top)
            except OSError as cause:
                if cause.errno in (errno.ENOTEMPTY, errno.EEXIST, errno.ENOTDIR):
                    return False
                raise
            _flush_folders([top.parent])
    return True


def _write_beside(contents: Mapping[Path, str | bytes]) -> None:
    """Write files of which some may be there."""
    moves: list[tuple[Path, Path, Path]] = []
    with ExitStack() as stack:
        for path, content in contents.items():
            stack.enter_context(_named(path))
            scratch, place = stack.enter_context(_beside(path))
            scratch.write_bytes(_encoded(content))
            if scratch != place:
                _flush(scratch)
                moves.append((path, scratch, place))
        undo = [stack.enter_context(_older(place)) for _, _, place in moves]
        with cleared(lambda: _bring_back(undo)):
            for path, scratch, place in moves:
                with _named(path):
                    os.replace(scratch, place)
            undo.clear()
        _flush_folders({place.parent for _, _, place in moves})


@contextmanager
def _older(place: Path) -> Iterator[Callable[[], object]]:
    """A function that brings back what a place holds now: its file, which has a second name meanwhile, or
    nothing."""
    if not place.exists():
        yield lambda: place.unlink(missing_ok=True)
        return
    kept = _scratch_name(place)
    with cleared(lambda: _remove(kept)):
        try:
            os.link(place, kept)
        except OSError:  # a disk without links
            yield lambda: None
            return
        lock = _lock(kept)
        try:
            yield lambda: os.replace(kept, place)
        finally:
            if lock is not None:
                os.close(lock)


def _bring_back(undo: Iterable[Callable[[], object]]) -> None:
    for bring_back in undo:
        with suppress(OSError):
            bring_back()


def check_writable(path: Path) -> None:
    """Raise ModelgenError if `replaced` could not begin; leaves no file behind."""
    with _named(path), _beside(path):
        pass


def unwritable(path: Path, cause: OSError) -> ModelgenError:
    """The error of a file that cannot be written."""
    remedy = "make room there, or name" if cause.errno in (errno.ENOSPC, errno.EDQUOT) else "name"
    return ModelgenError(
        str(path), f"cannot be written: {cause.strerror or cause}", "", f"{remedy} another file"
    )


def remove_abandoned(folder: Path) -> None:
    """Remove the files and folders that processes which were killed have left half written in a folder."""
    with suppress(OSError):
        for name in os.listdir(folder):
            if SCRATCH_NAME.match(name):
                _remove_if_abandoned(folder / name)


def _remove_if_abandoned(path: Path) -> None:
    """Remove a temporary file or folder, unless a process holds its lock."""
    lock = _lock(path)
    if lock is None:
        return
    with suppress(OSError):
        if path.is_dir():
            shutil.rmtree(path, ignore_errors=True)
        else:
            os.unlink(path)
    os.close(lock)


def _clear(folder: Path) -> None:
    """Remove what others left in a folder, once a process."""
    if folder not in _cleared:
        remove_abandoned(folder)
        _cleared.add(folder)


@contextmanager
def _named(path: Path) -> Iterator[None]:
    """Errors of the operating system are those of this file."""
    try:
        yield
    except OSError as cause:
        raise unwritable(path, cause) from cause


@contextmanager
def _beside(path: Path, mode: int | None = None) -> Iterator[tuple[Path, Path]]:
    """A new file, which is removed if it is still there when the block ends, and the place that it is to
    take; of what is no file, the place itself."""
    place = Path(os.path.realpath(path))
    if place.exists() and not place.is_file():
        yield place, place
        return
    place.parent.mkdir(parents=True, exist_ok=True)
    _clear(place.parent)
    rights = 0o666 if mode is None else mode
    while True:
        scratch = _scratch_name(place)
        with (
            cleared(lambda: _remove(scratch)),  # noqa: B023 (it is called in this turn)
            open(scratch, "x+b", opener=lambda name, flags: os.open(name, flags, rights)) as file,
        ):
            if not _hold(scratch, file.fileno()):
                continue
            if mode is None and place.exists():
                place.open("ab").close()  # one that may not be written is not replaced either
                scratch.chmod(place.stat().st_mode & 0o7777)
            yield scratch, place
            return


@contextmanager
def _held_folder(name: Callable[[], Path], rights: int = 0o777) -> Iterator[Path]:
    """A new folder, which is removed if it is still there when the block ends."""
    while True:
        folder = name()
        with cleared(lambda: shutil.rmtree(folder, ignore_errors=True)):  # noqa: B023 (called in this turn)
            folder.mkdir(rights)
            try:
                lock = os.open(folder, os.O_RDONLY)
            except FileNotFoundError:
                continue
            try:
                if _hold(folder, lock):
                    yield folder
                    return
            finally:
                os.close(lock)


def _remove(path: Path) -> None:
    with suppress(OSError):
        path.unlink(missing_ok=True)


def _scratch_name(place: Path) -> Path:
    """A name for what is to take a place, in the same folder, with the same ending if it is short."""
    ending = place.suffix if len(place.suffix) < LONGEST_ENDING else ""
    return place.with_name(f"{SCRATCH}{secrets.token_hex(8)}{ending}")


def _first_missing(path: Path) -> Path | None:
    """The highest folder of a file that is not there; None where all are."""
    with _named(path):
        place = Path(os.path.realpath(path))
        return next((each for each in reversed(place.parents) if not each.exists()), None)


def _hold(path: Path, handle: int) -> bool:
    """Lock a new file or folder; False where another process has taken it for one that was left, and removed
    it, before."""
    with suppress(OSError):  # a disk without locks: then nothing there is ever taken for abandoned
        fcntl.flock(handle, fcntl.LOCK_EX)
    return path.exists()


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


def _encoded(content: str | bytes) -> bytes:
    """Text as UTF-8, with escapes of what is no text, as in names of files in another encoding."""
    return content.encode(errors="backslashreplace") if isinstance(content, str) else content


def _flush(path: Path) -> None:
    """Wait until a file or folder is on the disk."""
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def _flush_folders(folders: Iterable[Path]) -> None:
    """Wait until the names in folders are on the disk; nothing for those that may not be read."""
    for folder in folders:
        with suppress(OSError):
            _flush(folder)
