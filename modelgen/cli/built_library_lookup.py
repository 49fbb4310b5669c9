"""The library of a scene file that was built before, found without reading the scene or deriving anything.

`remember` leaves in the folder of a library what it was built from, as one signature: text and name of the
scene file, the files of this package and of CasADi, Python, compiler and processor; manifest, instance and
record. `recall` loads the library if all this is as it was.
"""

from __future__ import annotations

import hashlib
import importlib.util
import os
import sys
from collections.abc import Iterator
from pathlib import Path

from modelgen.codegen.built_files import put, signature
from modelgen.codegen.compiler import DEBUG, compiler_words, cpu_target
from modelgen.codegen.library import REAL_FLAGS, Library
from modelgen.codegen.manifest import INSTANCE, STRUCTURE, record_name
from modelgen.errors import LibraryError

NAME = "scene.signature"  # beside the library
PACKAGE = Path(__file__).parents[1]


def scene_key(scene: Path, *choices: str) -> str | None:
    """SHA-256 (hex) of all that decides which library `build` gives for a scene file; None where it cannot be
    read. `choices`: what the caller changes in the scene."""
    try:
        text = scene.read_bytes()
    except (OSError, ValueError):
        return None
    digest = hashlib.sha256(text)
    for part in (scene.name, *choices, os.environ.get(DEBUG, ""), sys.version, cpu_target(), *_tools()):
        digest.update(f"{len(part)}:{part}".encode(errors="surrogateescape"))
    return digest.hexdigest()


def recall(folder: Path, key: str) -> Library | None:
    """The library in a folder, if it was remembered under this key and its files are those of then."""
    if not all(path.is_file() for path in (folder / NAME, folder / STRUCTURE, folder / INSTANCE)):
        return None
    try:
        found = (folder / NAME).read_bytes()
        for real in REAL_FLAGS:
            if (folder / record_name(real)).is_file() and found == _signature(folder, real, key):
                return Library.load(folder, real)
    except (OSError, LibraryError):
        pass
    return None


def remember(library: Library, key: str) -> None:
    """Leave the key in the folder of a library that was just built."""
    folder = library.path.parent
    put(folder / NAME, _signature(folder, library.real, key))


def _signature(folder: Path, real: str, key: str) -> bytes:
    files = (STRUCTURE, INSTANCE, record_name(real))
    return signature(key.encode(), *((folder / name).read_bytes() for name in files))


def _tools() -> Iterator[str]:
    """The files that make a library, each with size and time of its last change."""
    casadi = importlib.util.find_spec("casadi")
    for word in compiler_words():
        yield _stamp(word) if os.path.isfile(word) else word
    yield _stamp(casadi.origin) if casadi and casadi.origin else ""
    for place, folders, names in os.walk(PACKAGE):
        folders[:] = sorted(name for name in folders if name != "__pycache__")
        for name in sorted(names):
            if name.endswith((".py", ".c", ".h")):
                yield _stamp(os.path.join(place, name))


def _stamp(path: str) -> str:
    found = os.stat(path)
    return f"{path}:{found.st_size}:{found.st_mtime_ns}"
