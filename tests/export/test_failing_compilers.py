"""A compiler that fails at an export is told with a log that is there afterwards, or with its own words."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from modelgen.codegen.compiler import Compiler
from modelgen.errors import LibraryError, ModelgenError
from modelgen.export import browser_page
from modelgen.export.memory_footprint import footprint_of
from modelgen.export.shared_library import shared_library
from tests.export.folders import needs_gcc

FAILING = Compiler(("sh", "-c", "echo model.c:1: error: it is no C >&2; exit 3"), "1.0")


@pytest.mark.parametrize(
    "compile_",
    [
        lambda: shared_library(FAILING, (), {"model.c": "no C"}, ("model.c",)),
        lambda: browser_page._module(FAILING, {"page.c": "no C"}),
    ],
)
def test_the_log_that_is_named_is_there(
    compile_: Callable[[], bytes], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("MODELGEN_CACHE", str(tmp_path))
    monkeypatch.setattr(browser_page, "runtime_object", lambda *given: tmp_path / "runtime.o")
    with pytest.raises(LibraryError, match=r"ended with 3: model\.c:1: error: it is no C") as caught:
        compile_()
    (log,) = re.findall(r"its output is in (\S+)$", str(caught.value))
    assert "error: it is no C" in Path(log).read_text()


@needs_gcc
def test_figures_that_cannot_be_measured_say_why() -> None:
    texts = {"scene.c": "no C", "modelgen_runtime.c": "int a;", "scene.h": ""}
    with pytest.raises(ModelgenError, match=r"ended with 1: scene.c:1:.*error.*; export with --no-figures"):
        footprint_of(texts, ())
