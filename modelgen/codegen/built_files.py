"""Files that this user's builds wrote: made once for each content, and recognised by a seal.

A seal is a message authentication code of a file, with a key that lies in the user's cache folder. A file is
loaded, linked or believed only if its seal fits: one that was damaged is made again, and one that somebody
else put there is never run. Source: RFC 2104 (HMAC), with SHA-256.
"""

from __future__ import annotations

import fcntl
import hmac
import os
import secrets
import shutil
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path

from modelgen.errors import LibraryError
from modelgen.interruption import cleared

CACHE = "MODELGEN_CACHE"  # environment variable that names another folder
USUAL = "~/Library/Caches" if sys.platform == "darwin" else "~/.cache"
KEY, KEY_BYTES = "key", 32
SEAL, LOCK, SCRATCH = ".seal", ".lock", ".build-"  # ends of names of files, start of that of a folder


def made_once(path: Path, texts: Mapping[str, str], make: Callable[[Path], None]) -> Path:
    """The file `path`, made if it is not there as it was made once.

    Two processes may ask at once: the second waits for the first. One that is killed leaves nothing that
    another would take for the file, and a folder that the next one removes.

    Args:
        path: the file, whose name holds a digest of all that decides its content.
        texts: sources by file name.
        make: makes a file of that name in the folder that it is given, which holds the sources.

    Raises:
        LibraryError: the cache folder cannot be used.
        ModelgenError: the file cannot be written.
    """
    if is_sealed(path):
        return path
    with _locked(path.name):
        if not is_sealed(path):
            _remove_abandoned(path.parent)
            own = path.parent / f"{SCRATCH}{path.name}"
            shutil.rmtree(own, ignore_errors=True)
            scratch = own / secrets.token_hex(8)  # compilers of a build that was killed may still write
            with cleared(lambda: shutil.rmtree(own, ignore_errors=True)):
                for file, text in texts.items():
                    put(scratch / file, text)
                make(scratch)
                content = (scratch / path.name).read_bytes()
            put(path, content)
            seal(path)
    return path


def is_sealed(path: Path) -> bool:
    """Whether a file is as `made_once` or `seal` left it."""
    if not (_seal_of(path).is_file() and path.is_file()):
        return False
    try:
        found, content = _seal_of(path).read_bytes(), path.read_bytes()
    except OSError:
        return False
    return hmac.compare_digest(found, signature(path.name.encode(), content))


def seal(path: Path) -> None:
    """Leave beside a file the seal of its name and content."""
    put(_seal_of(path), signature(path.name.encode(), path.read_bytes()))


def put(path: Path, content: str | bytes, mode: int | None = None) -> None:
    """Write a file; a link, folder or pipe of its name is removed, not followed."""
    from modelgen.file_writing import write_file  # what was built before is run without it

    if path.is_symlink():
        path.unlink()
    elif path.is_dir():
        shutil.rmtree(path)
    elif path.exists() and not path.is_file():
        path.unlink()
    write_file(path, content, mode)


def signature(*parts: bytes) -> bytes:
    """HMAC-SHA-256 (hexadecimal digits) of byte strings under this user's key."""
    code = hmac.new(_key(cache_folder()), digestmod="sha256")
    for part in parts:
        code.update(b"%d:" % len(part))
        code.update(part)
    return code.hexdigest().encode()


def cache_folder() -> Path:
    """Where cores and the key are kept: MODELGEN_CACHE, else `modelgen` in the user's cache folder."""
    base = os.environ.get("XDG_CACHE_HOME", "")
    usual = Path(base if os.path.isabs(base) else os.path.expanduser(USUAL)) / "modelgen"
    folder = Path(os.environ.get(CACHE) or usual)
    if not (os.environ.get(CACHE) or usual.is_absolute()):  # a key in the current folder may be of others
        remedy = "set HOME, or name a folder for the cache"
        raise LibraryError(CACHE, "this user has no home folder", "", remedy)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise _unusable(folder, "the cache folder cannot be made", error) from None
    return folder.absolute()


@cache
def _key(folder: Path) -> bytes:
    """The key of a cache folder, made if there is none or it is damaged: then all is built again."""
    path = folder / KEY
    with _locked(KEY):
        try:
            found = path.read_bytes()
        except FileNotFoundError:
            found = b""
        except OSError as error:
            raise _unusable(path, "it cannot be read", error) from None
        if len(found) == KEY_BYTES:
            return found
        made = secrets.token_bytes(KEY_BYTES)
        put(path, made, mode=0o600)
        return made


def _seal_of(path: Path) -> Path:
    return path.with_name(path.name + SEAL)


def _remove_abandoned(folder: Path) -> None:
    """Remove the folders in which builds that were killed have compiled."""
    for scratch in folder.glob(f"{SCRATCH}*"):
        with suppress(BlockingIOError), _locked(scratch.name.removeprefix(SCRATCH), fcntl.LOCK_NB):
            shutil.rmtree(scratch, ignore_errors=True)


@contextmanager
def _locked(name: str, how: int = 0) -> Iterator[None]:
    """Hold a lock in the cache folder, which the operating system releases when the process ends."""
    path = cache_folder() / f"{name}{LOCK}"
    try:
        file = path.open("a")
    except OSError as error:
        raise _unusable(path, "cannot be written", error) from None
    with file:
        fcntl.flock(file, fcntl.LOCK_EX | how)
        yield


def _unusable(path: Path, found: str, error: OSError) -> LibraryError:
    return LibraryError(str(path), f"{found}: {error.strerror}", "", f"name another folder in {CACHE}")
