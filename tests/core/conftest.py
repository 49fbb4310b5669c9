"""The core's complementarity solvers, compiled alone."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from tests.core.compiling import CoreBuild, compile_core, compiler, core_in


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
