"""Shipped scenes as C programs with a `main` of a test."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

from modelgen import Accuracy, derive, emit, read, require
from modelgen.codegen.amalgamation import HEADER, SOURCE, header_text, runtime_text
from modelgen.runtime.c_program import driver_text
from modelgen.runtime.session import Session
from tests.running import SCENES, scene_of

CC = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")

needs_c = pytest.mark.skipif(CC is None, reason="needs a C compiler")


def program_of(name: str, folder: Path, main: str, accuracy: Accuracy) -> Path:
    """A program over the tables and the start of a scene. `main` is formatted with the size of a saved state.

    It has the content hash of the library of the scene, so that states of the library are its own.
    """
    library = scene_of(name)
    text = driver_text(library, accuracy, 1.0).partition("int main(void)")[0]
    size = Session(library, accuracy).shared.checkpoint_size
    package = emit(derive(require(read(SCENES / f"{name}.toml"))))
    files = {**package.files, HEADER: header_text(), SOURCE: runtime_text()}
    for file, content in {**files, "run.c": text + main.format(size=size)}.items():
        (folder / file).write_text(content)
    command = [str(CC), "-O1", "-std=c11", f'-DMG_HASH="{library.record.hash}"', "run.c", "model.c", SOURCE]
    subprocess.run([*command, "-lm", "-o", "run"], cwd=folder, check=True)
    return folder / "run"
