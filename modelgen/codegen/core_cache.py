"""The core compiled once for each compiler, flags, processor and real type, in the user's cache folder."""

from __future__ import annotations

import hashlib
import sys
from collections.abc import Callable, Iterable
from pathlib import Path

from modelgen.codegen.amalgamation import HEADER, SOURCE, header_text, runtime_text
from modelgen.codegen.built_files import cache_folder, made_once
from modelgen.codegen.compiler import Compiler, compile_object, cpu_target


def runtime_object(
    compiler: Compiler,
    flags: tuple[str, ...],
    tell: Callable[[str], None] | None = None,
    derivatives: bool = False,
) -> Path:
    """The core as an object file, compiled if the cache has none of the same content.

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

    return made_once(path, texts, compile_core)


def runtime_hash(compiler: Compiler, flags: tuple[str, ...], derivatives: bool = False) -> str:
    """SHA-256 (hex) of all that decides what the object of the core does."""
    return content_hash((header_text(), runtime_text(derivatives)), compiler, flags)


def content_hash(texts: Iterable[str], compiler: Compiler, flags: tuple[str, ...]) -> str:
    """SHA-256 (hex) of all that decides what a compiled file does: texts, flags, compiler, processor."""
    digest = hashlib.sha256()
    for part in (*texts, *flags, *compiler.command, compiler.version, cpu_target()):
        digest.update(f"{len(part)}:{part}".encode())
    return digest.hexdigest()


def announce(line: str) -> None:
    """Print a line for a person who waits."""
    print(f"modelgen: {line}", file=sys.stderr, flush=True)
