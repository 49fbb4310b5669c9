"""The core's complementarity solvers and regions, compiled alone."""

from __future__ import annotations

import ctypes
import subprocess
from collections.abc import Callable
from functools import cache
from pathlib import Path

import pytest

from tests.core.compiling import CORE, REALS, CoreBuild, compile_core, compiler, core_in, includes


@pytest.fixture(scope="session")
def lcp_compile(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Path]:
    """Compile the solvers, and `text` after them, into one file."""
    if compiler() is None:
        pytest.skip("no C compiler on the path")
    return lambda text, *flags: compile_core(tmp_path_factory.mktemp("lcp"), text, *flags)


@pytest.fixture(scope="session")
def lcp_in(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], CoreBuild]:
    """The library over "double", "float" or "long double"."""
    if compiler() is None:
        pytest.skip("no C compiler on the path")
    builds: dict[str, CoreBuild] = {}

    def build(real: str) -> CoreBuild:
        if real not in builds:
            builds[real] = core_in(tmp_path_factory.mktemp("lcp"), real)
        return builds[real]

    return build


@pytest.fixture(scope="session")
def lcp(lcp_in: Callable[[str], CoreBuild]) -> CoreBuild:
    return lcp_in("double")


@pytest.fixture(scope="session")
def regions_in(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], CoreBuild]:
    """The regions alone over plane curves written by hand, in "double", "float" or "long double"."""
    if compiler() is None:
        pytest.skip("no C compiler on the path")
    folder = tmp_path_factory.mktemp("regions")
    unit = folder / "regions.c"
    kinds = Path(__file__).with_name("region_kinds.c")
    unit.write_text(f'#include "{kinds}"\n' + includes("elementary", "base", "region"))
    warnings = ("-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "-Wno-unused-function")

    @cache
    def build(real: str) -> CoreBuild:
        flags, dtype = REALS[real]
        out = folder / f"{real.replace(' ', '_')}.so"
        command = [
            str(compiler()),
            *warnings,
            "-O2",
            "-fvisibility=hidden",
            "-shared",
            "-fPIC",
            f"-I{CORE}",
            *flags,
        ]
        done = subprocess.run([*command, unit, "-o", out, "-lm"], capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        return CoreBuild(ctypes.CDLL(str(out)), dtype)

    return build


@pytest.fixture(scope="session")
def plane_core(regions_in: Callable[[str], CoreBuild]) -> CoreBuild:
    return regions_in("double")
