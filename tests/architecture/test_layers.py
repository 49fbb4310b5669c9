"""Imports run down the pipeline only, and what must know no symbols knows none."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

from tests.architecture.sources import PYTHON, imports, is_module, short, tree

PIPELINE = (
    (
        "errors",
        "file_writing",
        "interruption",
        "name_suggestions",
        "notation",
        "repeated_entries",
        "rotations",
        "core",
    ),
    ("scene",),
    ("model",),
    ("geometry",),
    ("contact", "dynamics", "joint"),
    ("assembly",),
    ("composition",),
    ("derivation",),
    ("differentiation",),
    ("verification",),
    ("codegen",),
    ("runtime",),
    ("casadi_functions", "gym", "identification", "linearisation"),
    ("optimal_control",),
    ("report",),
    ("view", "parameter_study"),
    ("benchmark",),
    ("export", "importing"),
    ("cli",),
)
LAYER = {room: number for number, rooms in enumerate(PIPELINE) for room in rooms}
RESOURCES = ("core/__init__.py",)  # holds C text, no Python
NUMERIC_SIDE = (
    "modelgen.errors",
    "modelgen.name_suggestions",
    "modelgen.notation",
    "modelgen.repeated_entries",
    "modelgen.rotations",
    "modelgen.codegen.manifest",
    "modelgen.codegen.library",
    "modelgen.codegen.amalgamation",
    "modelgen.codegen.casadi_controllers",  # compiles what a run calls, loaded where one asks for it
    "modelgen.codegen.library_with_parameters",  # reads a scene again, loaded where a run asks for it
)

ENTRY = "modelgen.__main__"


def room(module: str) -> str:
    """The room of `modelgen.scene.read` is `scene`; of the package and its entry, the empty name."""
    return module.split(".")[1] if "." in module and module != ENTRY else ""


def module_of(path: Path) -> str:
    parts = ("modelgen", *Path(short(path)).with_suffix("").parts)
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def modules_imported(path: Path) -> set[str]:
    return {name for _, name in imports(path) if name.split(".")[0] == "modelgen" and is_module(name)}


def test_every_module_belongs_to_a_layer() -> None:
    unlisted = {short(path) for path in PYTHON if room(module_of(path)) not in {*LAYER, ""}}
    assert not unlisted


def upward_imports() -> Iterator[str]:
    """Imports of a later layer of the pipeline; the package itself loads the verbs on demand."""
    for path in PYTHON:
        here = room(module_of(path))
        for name in sorted(modules_imported(path)) if here else ():
            if room(name) and LAYER[room(name)] > LAYER[here]:
                yield f"{short(path)} imports {name}"


def test_modules_import_from_their_layer_or_lower_ones() -> None:
    assert not list(upward_imports())


def test_modules_do_not_import_each_other_in_a_circle() -> None:
    known = {module_of(path) for path in PYTHON}
    edges = {
        module_of(path): {n for n in modules_imported(path) if n in known and n != module_of(path)}
        for path in PYTHON
        if module_of(path) != "modelgen"
    }
    packages = {module_of(path) for path in PYTHON if path.name == "__init__.py"}
    for name, targets in edges.items():  # a package is imported with each of its modules
        edges[name] = {n for n in targets if not (n in packages and name.startswith(f"{n}."))}
    assert not list(circles(edges))


def circles(edges: Mapping[str, set[str]]) -> Iterator[str]:
    """Sets of nodes that reach each other."""
    graph = TopologicalSorter(edges)
    try:
        graph.prepare()
    except CycleError as error:
        yield " -> ".join(error.args[1])


def test_circles_are_found() -> None:
    assert list(circles({"a": {"b"}, "b": {"c"}, "c": {"a"}}))
    assert not list(circles({"a": {"b"}, "b": {"c"}, "c": set()}))


def test_runtime_imports_the_manifest_and_the_library_alone() -> None:
    allowed = ("modelgen.runtime", *NUMERIC_SIDE)
    assert not [
        f"{short(path)} imports {name}"
        for path in PYTHON
        if short(path).startswith("runtime/")
        for name in modules_imported(path) - {"modelgen", "modelgen.codegen"}
        if not name.startswith(allowed)
    ]


REFERENCES = ("runtime/qp_reference.py", "runtime/friction/mpcc.py")  # answers by CasADi's solvers


def knows_no_symbols(path: Path) -> bool:
    name = short(path)
    numeric = name.startswith(("scene/", "runtime/")) and name not in REFERENCES
    return numeric or name in (
        "errors.py",
        "name_suggestions.py",
        "codegen/manifest.py",
        "codegen/library.py",
    )


def test_no_symbols_on_the_numeric_side() -> None:
    assert not [
        f"{short(path)} imports {name}"
        for path in PYTHON
        if knows_no_symbols(path)
        for _, name in imports(path)
        if name.split(".")[0] in ("casadi", "sympy")
    ]


def test_matplotlib_is_needed_by_the_plots_alone() -> None:
    users = {short(path) for path in PYTHON for _, name in imports(path) if name.startswith("matplotlib")}
    assert users == {"report/run_plot.py", "report/body_pictures.py", "report/film.py"}


def test_packages_say_what_they_take_in_and_give_out() -> None:
    silent = [
        short(path)
        for path in PYTHON
        if path.name == "__init__.py" and not ast.get_docstring(tree(path)) and short(path) not in RESOURCES
    ]
    assert not silent
