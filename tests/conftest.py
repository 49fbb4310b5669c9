"""Options of the test run."""

from __future__ import annotations

import signal
from os import environ
from pathlib import Path
from shutil import rmtree
from tempfile import mkdtemp
from typing import Any

import pytest
from hypothesis import settings

from modelgen.benchmark import scene_under_measurement
from modelgen.codegen import build
from modelgen.codegen.compiler import Compiler, compile_library
from modelgen.codegen.emit import Package
from modelgen.codegen.library import Library
from tests.running import LEVEL

GOLDEN = 0.6180339887

settings.register_profile("repeatable", deadline=None, derandomize=True, database=None)
settings.register_profile("exploring", deadline=None)  # pytest --hypothesis-profile=exploring
settings.load_profile("repeatable")


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--update-golden", action="store_true", help="rewrite what is committed under generated/"
    )


def pytest_configure(config: pytest.Config) -> None:
    """Compile the core at level O1 and kernels without optimisation, which compute the same bits as O2; let
    workers find each other's libraries. Let Ctrl-C end what the tests start."""
    if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:  # as in the background of a script
        signal.signal(signal.SIGINT, signal.default_int_handler)
    build.LEVEL = LEVEL
    build.compile_library = compile_without_optimisation
    if hasattr(config, "workerinput"):
        return
    made = mkdtemp(prefix="modelgen-pool-")
    environ["MODELGEN_POOL"] = made
    config.add_cleanup(lambda: rmtree(made, ignore_errors=True))


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark the cases that are left to the studies, and give studies their time."""
    functions: dict[str, list[pytest.Item]] = {}
    for item in items:
        if item.get_closest_marker("cases") and not item.get_closest_marker("slow"):
            functions.setdefault(item.nodeid.partition("[")[0], []).append(item)
    for cases in functions.values():
        (kept,) = cases[0].get_closest_marker("cases").args  # type: ignore[union-attr]
        step = max(len(cases) / kept, 1.0)
        chosen = {int((k + k * GOLDEN % 1) * step) for k in range(kept)}  # spread over inner parameters too
        for number, item in enumerate(cases):
            if number not in chosen:
                item.add_marker(pytest.mark.slow)
    for item in items:
        if item.get_closest_marker("slow"):
            item.add_marker(pytest.mark.timeout(0))


def compile_without_optimisation(compiler: Compiler, flags: tuple[str, ...], *places: Path) -> None:
    """The library of a scene, whose kernels run seldom in a test."""
    compile_library(compiler, ("-O0", *(flag for flag in flags if not flag.startswith("-O"))), *places)


def build_at_one_level(package: Package, **options: Any) -> Library:
    """The library of a package, compiled as all of a test run."""
    return build.build(package, **options | {"level": LEVEL})


@pytest.fixture
def hasty(monkeypatch: pytest.MonkeyPatch) -> None:
    """Few repeats, no counted instructions, nothing compiled at another level, no figures of exports: what a
    run costs is not asked here."""
    monkeypatch.setattr("modelgen.benchmark.cost.ENOUGH_S", 1e-3)
    monkeypatch.setattr("modelgen.benchmark.cost.BRIEF_S", 0.0)
    monkeypatch.setattr("modelgen.benchmark.setting_evaluation.instructions", lambda *given: None)
    monkeypatch.setattr(scene_under_measurement, "build", build_at_one_level)
    monkeypatch.setattr("modelgen.export.c_folder.footprint_of", lambda *given: None)
