"""The core compiled once for each compiler, flags, processor and real type, in the user's cache folder."""

from __future__ import annotations

import fcntl
import hashlib
import os
import sys
import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from platformdirs import user_cache_path

from modelgen.codegen.amalgamation import HEADER, SOURCE, header_text, runtime_text
from modelgen.codegen.compiler import Compiler, compile_object, cpu_target
from modelgen.errors import LibraryError

CACHE = "MODELGEN_CACHE"  # environment variable that names another folder


def runtime_object(
    compiler: Compiler,
    flags: tuple[str, ...],
    tell: Callable[[str], None] | None = None,
    derivatives: bool = False,
) -> Path:
    """The core as an object file, compiled if the cache has none of the same content.

    Two processes may ask at once: the second waits for the first. One that is killed leaves nothing that
    another would take for an object.

    Args:
        compiler: what compiles it.
        flags: for an object (`Compiler.flags`).
        tell: receives one line before the core is compiled; None: the line goes to the standard error.
        derivatives: with what differentiates runs.

    Raises:
        LibraryError: the cache cannot be written, or the compiler fails; the message names the log.
    """
    lines = any(flag.startswith("-DMG_DEBUG") for flag in flags)
    texts = {HEADER: header_text(), SOURCE: runtime_text(derivatives, lines)}
    path = cache_folder() / f"runtime-{runtime_hash(compiler, flags, derivatives)[:16]}.o"

    def compile_core(scratch: Path) -> None:
        (tell or announce)(
            f"compiling the core, once for this compiler and these flags, into {path} (about 10 s)"
        )
        compile_object(compiler, flags, scratch / SOURCE, scratch / path.name, path.with_suffix(".log"))

    return compiled_once(path, texts, compile_core)


def compiled_once(path: Path, texts: Mapping[str, str], compile_texts: Callable[[Path], None]) -> Path:
    """The file `path` of the cache, made if it is not there.

    Two processes may ask at once: the second waits for the first. One that is killed leaves nothing that
    another would take for the file.

    Args:
        path: the file, whose name holds a digest of all that decides its content.
        texts: sources by file name.
        compile_texts: makes a file of that name in the folder that it is given, which holds the sources.
    """
    if path.exists():
        return path
    with _locked(path.with_suffix(".lock")):
        if not path.exists():
            with tempfile.TemporaryDirectory(prefix=".build-", dir=path.parent) as name:
                scratch = Path(name)
                for file, text in texts.items():
                    (scratch / file).write_text(text, encoding="utf-8")
                compile_texts(scratch)
                os.replace(scratch / path.name, path)
    return path


def cache_folder() -> Path:
    """Where compiled cores are kept: MODELGEN_CACHE, else the user's cache folder."""
    named = os.environ.get(CACHE)
    folder = Path(named) if named else user_cache_path("modelgen", appauthor=False)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise LibraryError(
            str(folder),
            f"the cache folder cannot be made: {error.strerror}",
            "",
            f"name another in {CACHE}",
        ) from None
    return folder.absolute()


def runtime_hash(compiler: Compiler, flags: tuple[str, ...], derivatives: bool = False) -> str:
    """SHA-256 (hex) of all that decides what the object of the core does."""
    return content_hash((header_text(), runtime_text(derivatives)), compiler, flags)


def content_hash(texts: Iterable[str], compiler: Compiler, flags: tuple[str, ...]) -> str:
    """SHA-256 (hex) of all that decides what a compiled file does: texts, flags, compiler, processor."""
    digest = hashlib.sha256()
    for part in (*texts, *flags, *compiler.command, compiler.version, cpu_target()):
        digest.update(f"{len(part)}:{part}".encode())
    return digest.hexdigest()


@contextmanager
def _locked(path: Path) -> Iterator[None]:
    """Hold a file lock, which the operating system releases when the process ends for any reason."""
    try:
        file = path.open("a")
    except OSError as error:
        raise LibraryError(
            str(path), f"cannot be written: {error.strerror}", "", f"name another folder in {CACHE}"
        ) from None
    with file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield


def announce(line: str) -> None:
    """Print a line for a person who waits."""
    print(f"modelgen: {line}", file=sys.stderr, flush=True)
