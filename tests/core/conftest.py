"""The core's complementarity solvers, compiled alone."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

CORE = Path(__file__).parents[2] / "modelgen" / "core"
SOURCES = (
    "active_solve", "enumerate", "lcp_basis", "lcp_cholesky", "lcp_minimum_norm", "lcp_residual", "lemke",
    "qp", "qp_pivot", "qp_refine", "qp_small",
)  # fmt: skip
WARNINGS = ("-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "-Wshadow", "-Wconversion")
REALS: dict[str, tuple[tuple[str, ...], Any]] = {
    "double": ((), np.float64),
    "float": (("-DMG_REAL_FLOAT",), np.float32),
    "long double": (("-DMG_REAL_LONG",), np.longdouble),
}


REGIONS = ("crossings", "hull", "inside", "lay", "margin", "outline", "region", "tracks")


@dataclass(frozen=True)
class CoreBuild:
    cdll: ctypes.CDLL
    dtype: Any


@pytest.fixture(scope="session")
def lcp_compile(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Path]:
    """Compile the solvers, and `text` after them, into one file."""
    compiler = next((found for name in ("cc", "gcc", "clang") if (found := shutil.which(name))), None)
    if compiler is None:
        pytest.skip("no C compiler on the path")

    def compile_(text: str, *flags: str) -> Path:
        folder = tmp_path_factory.mktemp("lcp")
        unit = folder / "lcp_unit.c"
        unit.write_text("".join(f'#include "{name}.c"\n' for name in SOURCES) + text)
        out = folder / "lcp_unit.out"
        command = [compiler, *WARNINGS, f"-I{CORE}", *flags, str(unit), "-o", str(out), "-lm"]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        return out

    return compile_


@pytest.fixture(scope="session")
def lcp_in(lcp_compile: Callable[..., Path]) -> Callable[[str], CoreBuild]:
    """The library over "double", "float" or "long double"."""
    builds: dict[str, CoreBuild] = {}

    def build(real: str) -> CoreBuild:
        if real not in builds:
            flags, dtype = REALS[real]
            path = lcp_compile("", "-O2", "-fvisibility=hidden", "-shared", "-fPIC", *flags)
            builds[real] = CoreBuild(ctypes.CDLL(str(path)), dtype)
        return builds[real]

    return build


@pytest.fixture(scope="session")
def lcp(lcp_in: Callable[[str], CoreBuild]) -> CoreBuild:
    return lcp_in("double")


@pytest.fixture(scope="session")
def regions_in(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], CoreBuild]:
    """The regions alone over plane curves written by hand, in "double", "float" or "long double"."""
    compiler = next((found for name in ("cc", "gcc", "clang") if (found := shutil.which(name))), None)
    if compiler is None:
        pytest.skip("no C compiler on the path")
    folder = tmp_path_factory.mktemp("regions")
    unit = folder / "regions.c"
    sources = [Path(__file__).with_name("region_kinds.c"), *(CORE / f"{name}.c" for name in REGIONS)]
    unit.write_text("".join(f'#include "{source}"\n' for source in sources))
    warnings = ("-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "-Wno-unused-function")

    @cache
    def build(real: str) -> CoreBuild:
        flags, dtype = REALS[real]
        out = folder / f"{real.replace(' ', '_')}.so"
        command = [compiler, *warnings, "-O2", "-fvisibility=hidden", "-shared", "-fPIC", f"-I{CORE}", *flags]
        done = subprocess.run([*command, unit, "-o", out, "-lm"], capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        return CoreBuild(ctypes.CDLL(str(out)), dtype)

    return build


@pytest.fixture(scope="session")
def plane_core(regions_in: Callable[[str], CoreBuild]) -> CoreBuild:
    return regions_in("double")
