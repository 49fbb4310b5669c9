"""From text to a loaded library, at most once for each content."""

from __future__ import annotations

import hashlib
import sys
from collections.abc import Callable, Mapping
from pathlib import Path

import casadi as ca

from modelgen import __version__
from modelgen.codegen.amalgamation import runtime_text
from modelgen.codegen.built_files import cache_folder, made_once, put
from modelgen.codegen.compiler import (
    LEVEL,
    LEVELS,
    Compiler,
    compile_library,
    cpu_target,
    find_compiler,
)
from modelgen.codegen.core_cache import announce, runtime_hash, runtime_object
from modelgen.codegen.emit import Package
from modelgen.codegen.library import REAL_FLAGS, Library
from modelgen.codegen.manifest import INSTANCE, STRUCTURE, BuildRecord, record_name
from modelgen.errors import CompilerMissing, LibraryError, expect
from modelgen.name_suggestions import nearest

NAME = 100  # letters of the name of a scene in the name of its library
MANY = 300_000  # pairs of features of which the cost is told before
PAIR_S, PAIR_BYTES = 1.6e-5, 4000  # s of CPU time before the first step, and memory, for each


def build(
    package: Package,
    *,
    real: str | None = None,
    folder: str | Path | None = None,
    level: str | None = None,
    tell: Callable[[str], None] | None = None,
) -> Library:
    """The library of a package, compiled if no library of the same content, built by this user and whole,
    lies in `folder`.

    The scene's kernels are compiled and linked with the core, which is compiled once and kept in the user's
    cache folder (`runtime_object`).

    Args:
        package: what `emit` returned.
        real: "double", "float" or "long double"; the scene's own when None, else double.
        level: how far the compiler optimises: "O1", "O2" or "O3"; the scene's own when None, else O2.
        folder: where C, header, manifest, library and its record go; `generated/<scene>` when None.
        tell: receives one line before the core is compiled, and one on a scene of very many pairs of
            features; None: they go to the standard error.

    Raises:
        ModelgenError: what is given is no package.
        CompilerMissing: there is no C compiler, and no library of this text for this processor in `folder`.
        LibraryError: the compiler fails; the message names the command and the log.
    """
    expect("build", package, Package)
    run = package.manifest.instance["run"]
    real, level = real or run.get("real", "double"), level or run.get("level", LEVEL)
    for name, value, known in (("real", real, tuple(REAL_FLAGS)), ("level", level, LEVELS)):
        if value not in known:
            raise LibraryError(name, repr(value), f"allowed: {', '.join(known)}", nearest(value, known))
    folder = (Path("generated") / package.name if folder is None else Path(folder)).absolute()
    source = source_hash(package, real, level)
    try:
        compiler = find_compiler()
    except CompilerMissing:
        found = _built_before(folder, package, real, source)
        if found is None:
            raise
        return found
    flags = compiler.flags(real, level)
    feature_pairs = len(package.manifest.instance["feature_pairs"])
    if feature_pairs > MANY:
        (tell or announce)(_cost(feature_pairs))
    key = content_hash(package, flags, compiler)
    path = folder / f"lib{package.name[:NAME]}-{key[:16]}.so"

    def compile_kernels(scratch: Path) -> None:
        runtime = runtime_object(compiler, flags, tell, package.derivatives)
        named = (*flags, f'-DMG_HASH="{key}"')
        target, log = scratch / path.name, cache_folder() / f"{path.stem}.log"
        compile_library(compiler, named, scratch / "model.c", runtime, target, log)

    made_once(path, package.files, compile_kernels)
    record = BuildRecord(
        key, source, cpu_target(), real, path.name, package.manifest.kinds_hash, _versions(compiler)
    )
    library = Library(package.manifest, record, folder)
    texts = {
        STRUCTURE: package.manifest.structure_json(),
        INSTANCE: package.manifest.instance_json(),
        record_name(real): record.to_json(),
    }
    _write(folder, {**package.files, **texts})
    return library


def _cost(feature_pairs: int) -> str:
    """What a scene of very many pairs of features costs, and what to do."""
    return (
        f"{feature_pairs} pairs of features: about {PAIR_S * feature_pairs:.0f} s of CPU time and "
        f"{PAIR_BYTES * feature_pairs / 1e9:.1f} GB of memory before the first step; a second of a run in "
        "which many of these bodies touch takes minutes. Leave bodies that do not touch out of [contacts] "
        "(`among`), list pairs that do under [[contact]], run shorter (--until), or take steps in time "
        "(--method time-stepping --step 0.001)"
    )


def source_hash(package: Package, real: str, level: str) -> str:
    """SHA-256 (hex) of the text of a scene and of the core, with the real type and the level."""
    digest = hashlib.sha256()
    core = runtime_text(package.derivatives)
    for part in (real, level, core, *(text for _, text in sorted(package.files.items()))):
        digest.update(f"{len(part)}:{part}".encode())
    return digest.hexdigest()


def _built_before(folder: Path, package: Package, real: str, source: str) -> Library | None:
    """The library in a folder, if it was built of this text for this processor."""
    try:
        record = Library.load(folder, real).record
    except LibraryError:
        return None
    same = (record.source, record.cpu) == (source, cpu_target())
    return Library(package.manifest, record, folder) if same else None


def content_hash(package: Package, flags: tuple[str, ...], compiler: Compiler) -> str:
    """SHA-256 (hex) of all that decides what the library does: the scene's text, and the core with its
    flags, compiler and processor."""
    digest = hashlib.sha256(runtime_hash(compiler, flags, package.derivatives).encode())
    for name in sorted(package.files):
        for part in (name, package.files[name]):
            digest.update(f"{len(part)}:{part}".encode())
    return digest.hexdigest()


def _versions(compiler: Compiler) -> dict[str, str]:
    return {
        "modelgen": __version__,
        "casadi": str(ca.CasadiMeta.version()),
        "python": ".".join(str(part) for part in sys.version_info[:3]),
        "compiler": compiler.version.partition("\n")[0],
    }


def _write(folder: Path, files: Mapping[str, str]) -> None:
    """Each text to its file, if the file holds something else."""
    for name, text in files.items():
        path = folder / name
        if path.is_symlink() or not path.is_file() or path.read_bytes() != text.encode():
            put(path, text)
