"""Shipped scenes as C programs with a `main` of a test."""

from __future__ import annotations

import subprocess
from pathlib import Path

from modelgen import Accuracy, derive, emit, read, require
from modelgen.codegen.amalgamation import HEADER, header_text
from modelgen.runtime.c_initialisers import driver_text
from modelgen.runtime.core_session import Session
from tests.c_compiler import CC
from tests.running import SCENES, scene_of


def program_of(name: str, folder: Path, main: str, accuracy: Accuracy) -> Path:
    """A program over the tables and the start of a scene, linked with its library. `main` is formatted with
    the size of a saved state."""
    library = scene_of(name)
    text = driver_text(library, accuracy, 1.0).partition("int main(void)")[0]
    size = Session(library, accuracy).shared.checkpoint_size
    package = emit(derive(require(read(SCENES / f"{name}.toml"))))
    files = {**package.files, HEADER: header_text(), "run.c": text + main.format(size=size)}
    for file, content in files.items():
        (folder / file).write_text(content)
    command = [*CC, "-O1", "-std=c11", "run.c", str(library.path), f"-Wl,-rpath,{library.path.parent}"]
    subprocess.run([*command, "-o", "run"], cwd=folder, check=True)
    return folder / "run"
