"""Shipped scenes as exported folders, and what compiles and runs them elsewhere."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path

import pytest

from modelgen import derive, read, require
from modelgen.codegen.library import REAL_FLAGS
from modelgen.export.export_formats import Choices, export
from tests.running import SCENES

STRICT = ("-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-ffp-contract=off", "-fno-math-errno")
SELFTEST = ("scene.c", "modelgen_runtime.c", "selftest.c")
ZIG = (sys.executable, "-m", "ziglang", "cc")

needs_gcc = pytest.mark.skipif(shutil.which("gcc") is None, reason="needs gcc")
needs_zig = pytest.mark.skipif(find_spec("ziglang") is None, reason="needs ziglang (extra `compiler`)")

WASI = """
const { readFileSync } = require('node:fs');
const { WASI } = require('node:wasi');
const [name, ...words] = process.argv.slice(2);
const wasi = new WASI({ version: 'preview1', args: [name, ...words], env: {}, returnOnExit: true });
WebAssembly.instantiate(readFileSync(name), wasi.getImportObject())
  .then((made) => process.exit(wasi.start(made.instance)));
"""


def exported(name: str, to: str, folder: Path, **choices: object) -> Path:
    """A shipped scene in a format, in a folder."""
    derivation = derive(require(read(SCENES / f"{name}.toml")))
    chosen = Choices(**{"figures": False, **choices})  # type: ignore[arg-type]
    export(derivation, to, folder, folder / ".library", chosen)
    return folder


def compiled(folder: Path, compiler: Sequence[str], program: str, *flags: str, real: str = "double") -> Path:
    """The self-test of a folder, compiled without a warning."""
    command = [*compiler, *STRICT, *REAL_FLAGS[real], *flags, *SELFTEST, "-lm", "-o", program]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[:4000]
    return folder / program


def said(program: Path, *words: str, by: Sequence[str] = ()) -> tuple[str, str]:
    """Standard output and error of a program that ends with 0."""
    done = subprocess.run([*by, str(program), *words], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[:4000]
    return done.stdout, done.stderr


def runner(target: str, folder: Path) -> tuple[str, ...] | None:
    """What runs programs of a target here; None: nothing does."""
    if target == "wasm32-wasi":
        if shutil.which("node") is None:
            return None
        (folder / "wasi.cjs").write_text(WASI)
        return ("node", "--no-warnings", str(folder / "wasi.cjs"))
    if target.startswith("x86_64-linux") and os.uname().machine == "x86_64":
        return ()
    emulator = {"aarch64-linux-musl": "qemu-aarch64", "arm-linux-musleabihf": "qemu-arm"}.get(target, "")
    return (emulator,) if shutil.which(emulator) else None
