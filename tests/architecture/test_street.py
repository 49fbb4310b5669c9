"""Imports run down the street only, and what must know no symbols knows none."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.architecture.sources import PYTHON, imports, is_module, short

STREET = (
    ("errors", "notation", "core"),
    ("scene",),
    ("model",),
    ("geometry",),
    ("contact", "dynamics", "joint"),
    ("require",),
    ("derive",),
    ("evidence",),
    ("codegen",),
    ("runtime",),
    ("report",),
    ("measure",),
    ("cli",),
)
STATION = {room: number for number, rooms in enumerate(STREET) for room in rooms}
NUMERIC_SIDE = (
    "modelgen.errors",
    "modelgen.notation",
    "modelgen.codegen.manifest",
    "modelgen.codegen.library",
)


def room(module: str) -> str:
    """The room of `modelgen.scene.read` is `scene`; of the package itself, the empty name."""
    return module.split(".")[1] if "." in module else ""


def module_of(path: Path) -> str:
    parts = ("modelgen", *Path(short(path)).with_suffix("").parts)
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def modules_imported(path: Path) -> set[str]:
    return {name for _, name in imports(path) if name.split(".")[0] == "modelgen" and is_module(name)}


def test_every_file_has_a_place_on_the_street() -> None:
    strangers = {short(path) for path in PYTHON if room(module_of(path)) not in {*STATION, ""}}
    assert not strangers


@pytest.mark.parametrize("path", [p for p in PYTHON if room(module_of(p))], ids=short)
def test_imports_run_down_the_street(path: Path) -> None:
    """All but the package itself, which loads the verbs on demand."""
    here = room(module_of(path))
    uphill = {name for name in modules_imported(path) if room(name) and STATION[room(name)] > STATION[here]}
    assert not uphill


@pytest.mark.parametrize("path", [p for p in PYTHON if short(p).startswith("runtime/")], ids=short)
def test_runtime_imports_the_manifest_and_the_library_alone(path: Path) -> None:
    allowed = ("modelgen.runtime", *NUMERIC_SIDE)
    foreign = {n for n in modules_imported(path) if n not in ("modelgen", "modelgen.codegen")}
    assert not {name for name in foreign if not name.startswith(allowed)}


REFERENCES = ("runtime/reference.py", "runtime/friction/mpcc.py")  # answers by CasADi's solvers


def knows_no_symbols(path: Path) -> bool:
    name = short(path)
    numeric = name.startswith(("scene/", "runtime/")) and name not in REFERENCES
    return numeric or name in ("errors.py", "codegen/manifest.py", "codegen/library.py")


@pytest.mark.parametrize("path", [p for p in PYTHON if knows_no_symbols(p)], ids=short)
def test_no_symbols_on_the_numeric_side(path: Path) -> None:
    assert not {name for _, name in imports(path) if name.split(".")[0] in ("casadi", "sympy")}


def test_matplotlib_is_needed_by_the_plots_alone() -> None:
    users = {short(path) for path in PYTHON for _, name in imports(path) if name.startswith("matplotlib")}
    assert users == {"report/plot.py"}
