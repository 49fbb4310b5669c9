"""The core's complementarity solvers and regions, compiled alone."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path

import pytest

from tests.c_compiler import CC
from tests.core.compiling import CoreBuild, compile_core, core_in, includes, library_in


@pytest.fixture(scope="session")
def lcp_compile() -> Callable[..., Path]:
    """Compile the solvers, and `text` after them, into one file."""
    if not CC:
        pytest.skip("needs a C compiler")
    return compile_core


@pytest.fixture(scope="session")
def lcp_in() -> Callable[[str], CoreBuild]:
    """The library over "double", "float" or "long double"."""
    if not CC:
        pytest.skip("needs a C compiler")
    return cache(core_in)


@pytest.fixture(scope="session")
def lcp(lcp_in: Callable[[str], CoreBuild]) -> CoreBuild:
    return lcp_in("double")


@pytest.fixture(scope="session")
def regions_in() -> Callable[[str], CoreBuild]:
    """The regions alone over plane curves written by hand, in "double", "float" or "long double"."""
    if not CC:
        pytest.skip("needs a C compiler")
    kinds = Path(__file__).with_name("region_kinds.c")
    text = f'#include "{kinds}"\n' + includes("elementary", "base", "region")
    return cache(lambda real: library_in(real, text, "-O2", "-Wno-conversion"))


@pytest.fixture(scope="session")
def plane_core(regions_in: Callable[[str], CoreBuild]) -> CoreBuild:
    return regions_in("double")
