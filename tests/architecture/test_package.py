"""The package as it is imported."""

from __future__ import annotations

import subprocess
import sys

import pytest

from tests.architecture.sources import ROOT

VERBS = ("read", "require", "derive", "emit", "build", "simulate", "measure", "linearise", "Accuracy")


def run(code: str) -> str:
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return result.stdout.strip()


def test_import_is_cheap() -> None:
    heavy = {"casadi", "numpy", "scipy", "sympy", "click", "rich", "matplotlib"}
    loaded = run("import modelgen, sys; print(*(name.split('.')[0] for name in sys.modules))").split()
    assert not heavy & set(loaded)


@pytest.mark.parametrize("first", ["", "import modelgen.assembly, modelgen.derivation, modelgen.benchmark; "])
def test_verbs_are_callable_whatever_was_imported_before(first: str) -> None:
    names = ", ".join(VERBS)
    assert run(f"{first}from modelgen import {names}; print(all(map(callable, ({names}))))") == "True"


def test_unknown_name_is_refused() -> None:
    assert run("import modelgen; print(hasattr(modelgen, 'tabel'))") == "False"


def test_a_scene_without_splines_is_derived_and_emitted_without_scipy_or_sympy() -> None:
    steps = "modelgen.emit(modelgen.derive(modelgen.require(modelgen.read(sys.argv[0]))))"
    scene = str(ROOT / "scenes" / "coin.toml")
    code = f"import sys, modelgen, modelgen.runtime.simulate; sys.argv[0] = {scene!r}; {steps}"
    loaded = run(f"{code}; print(*(name.split('.')[0] for name in sys.modules))").split()
    assert not {"scipy", "sympy", "mpmath"} & set(loaded)
