"""What may be done in some places only: input and output, calls into C, tolerances, allocation."""

from __future__ import annotations

import ast
import fnmatch
import re
from dataclasses import fields
from pathlib import Path

from modelgen import Accuracy
from modelgen.runtime.tables.ctypes_structures import OWN, SETTINGS_COUNTS, SETTINGS_REALS
from modelgen.runtime.thresholds import Thresholds
from tests.architecture.sources import PYTHON, ROOT, C, imports, short, tree

IO_PLACES = (
    "file_writing.py",
    "scene/read.py",
    "codegen/build.py",
    "codegen/compiler.py",
    "codegen/library.py",
    "codegen/built_files.py",
    "codegen/core_cache.py",
    "identification/recording_files.py",
    "casadi_functions/compiled_function.py",
    "report/",
    "view/guarded_server.py",
    "benchmark/callgrind_counts.py",
    "benchmark/peers/",
    "benchmark/measurement_store.py",
    "benchmark/extremes_table.py",
    "benchmark/measurement_table.py",
    "export/",
    "parameter_study/sweep_folder.py",
    "parameter_study/dask_workers.py",
    "parameter_study/sweep_output.py",
    "importing/",
    "cli/",
)
IO_MODULES = {"subprocess", "shutil", "tempfile", "socket", "urllib", "http", "multiprocessing"}
IO_CALLS = {
    *("open", "print", "write_text", "write_bytes", "read_text", "read_bytes", "unlink", "mkdir"),
    *("rename", "rmdir", "savez", "savez_compressed", "savetxt", "loadtxt"),
}
PACKAGE_DATA = {  # part of the program: the text of the core, the page that plays a run
    "codegen/amalgamation.py": {"read_text"},
    "view/page.py": {"read_text", "write_text"},
}
C_CALLERS = ("codegen/library.py", "runtime/", "export/sources/")  # the last: what is written for elsewhere

# Numbers below 1e-3 in runtime/ outside Accuracy, and why each is no tolerance of a run.
SMALL = {
    ("compiled_lcp.py", 1e-12): "rounding slack of the test whether a given matrix is semidefinite",
    **{
        ("mpcc.py", 10.0**-k): "relaxations of the reference by IPOPT, its tolerances"
        for k in (4, 6, 8, 10, 11, 12)
    },
    ("painleve.py", 1e-10): "what counts as zero when the signs of a small problem are read",
    ("qp_reference.py", 1e-7): "row classification of the slow reference answer",
    ("finite_differences.py", 2e-4): "step of differences between runs",
    ("simulate.py", 1e-6): "keeps a measured wall time from being zero",
}
# Numbers up to 1e-3 in the core, and why each is no tolerance of a run.
SMALL_IN_CORE = {
    **{
        ("base/base.h", value): "regularisation and residuals of solvers, by the real type"
        for value in (1e-3, 1e-4, 1e-9, 1e-10, 1e-12)
    },
    ("base/taylor_models.c", 1e-6): "exponents that change by more have no bound",
    ("closest/overlap.c", 1e-7): "distance of samples from the ends of a coordinate",
    ("closest/segment_crossings.c", 1e-6): "overlap of neighbouring cells",
    ("events/event_location.c", 1e-6): "where bisection hands over to the search for a zero",
    ("forces/row_refinement.c", 1e-3): "condition from which rows are refined",
    ("impact/frictional_impact.c", 1e-3): "first yield of contacts that share a blow",
    ("region/winkler_pressure.c", 1e-6): "least part of a Newton step",
    ("region/winkler_pressure.c", 1e-3): "least part of a continuation step",
    ("solve/friction/interior_point.c", 1e-4): "least centring of an interior-point step",
    ("solve/friction/semismooth_newton.c", 1e-4): "sufficient decrease of a line search",
    ("solve/friction/semismooth_newton.c", 1e-6): "first damping, and overshoot beyond a change of mode",
    ("solve/friction/starting_points.c", 1e-4): "shortest step of a continuation",
    ("solve/lcp/qp.c", 1e-4): "condition up to which two unknowns are solved in closed form",
}

# Fixed ratios to a setting: (file, ratio, setting), and why it is not the setting itself.
RATIOS_IN_CORE = {
    ("closest/cells.c", "8 *", "feature_border"): "a search excludes only what is clearly outside",
    ("closest/minima_acceptance.c", "2 *", "flat_angle"): "what a hand-over from a flat face leaves open",
    ("closest/minima_search.c", "2 *", "start_gap"): "a lower bound of gaps, beyond what touches",
    ("closest/segment_crossings.c", "2 *", "start_gap"): "a segment through all that touches",
    ("events/singular_passage_step.c", "2 *", "margin_refuse"): "a passage ends clearly above the refusal",
    ("features/feature_changes.c", "100 *", "feature_border"): "loosest border of a change of feature",
    ("forces/friction_modes.c", "10 *", "friction_bound_margin"): "noise of a solution that meets the bound",
    ("forces/friction_modes.c", "/ 10", "friction_bound_margin"): "effect of a lowered bound beyond noise",
    ("integrate/rim_rolling_start.c", "/ 100", "tolerance"): "Newton's method ends well within the error",
    ("integrate/stiff_slip_step.c", "/ 100", "tolerance"): "Newton's method ends well within the error",
    ("model/load_branches.c", "4 *", "event_tolerance"): "zero of a switching function after its event",
    ("model/planar_contacts.c", "2 *", "flat_angle"): "opening of a face within one step",
    ("model/planar_contacts.c", "4 *", "flat_angle"): "a face that has just opened",
    ("sensitivity/kinks.c", "2 *", "friction_bound_margin"): "at the bound, from either side of it",
    ("sensitivity/kinks.c", "3 *", "feature_border"): "at the border, from either side of it",
}
NUMBER = re.compile(r"(?<![\w.])(\d+\.?\d*(?:e[-+]?\d+)?|\.\d+)[LfF]?(?![\w.])")
RATIO = re.compile(r"(\d+ \*) c->settings->(\w+)|c->settings->(\w+) (/ \d+)")
MOST_SHOWN = 19  # fields of Accuracy: what a user may want to move, and `thresholds`
C_HEADERS = {"math.h", "tgmath.h", "float.h", "stddef.h", "string.h", "assert.h"}  # the last: debug core
TOP_LEVEL = {"pyproject.toml", "README.md", "LICENSE", "modelgen", "generated", "tests", "scenes"}


def called_names(path: Path) -> set[str]:
    calls = [node.func for node in ast.walk(tree(path)) if isinstance(node, ast.Call)]
    names = {f.id for f in calls if isinstance(f, ast.Name)}
    return names | {f.attr for f in calls if isinstance(f, ast.Attribute)}


def test_no_line_is_broken_where_a_console_thinks_it_ends() -> None:
    """Through a pipe it would be after 80 characters, within a sentence."""
    calls = [(path, node) for path in PYTHON for node in ast.walk(tree(path)) if isinstance(node, ast.Call)]
    printed = [
        (path, node)
        for path, node in calls
        if isinstance(node.func, ast.Attribute) and node.func.attr == "print"
    ]
    broken = [
        f"{short(path)}:{node.lineno}"
        for path, node in printed
        if "soft_wrap" not in {keyword.arg for keyword in node.keywords}
    ]
    assert printed
    assert not broken


def test_input_and_output_have_their_places() -> None:
    wrong = []
    for path in PYTHON:
        if not short(path).startswith(IO_PLACES):
            modules = {name.split(".")[0] for _, name in imports(path)} & IO_MODULES
            called = called_names(path) & IO_CALLS - PACKAGE_DATA.get(short(path), set())
            wrong += [f"{short(path)}: {name}" for name in sorted(modules | called)]
    assert not wrong


def test_the_core_is_called_from_the_library_and_the_runtime() -> None:
    assert not [
        short(path)
        for path in PYTHON
        if not short(path).startswith(C_CALLERS)
        for _, name in imports(path)
        if name.split(".")[0] == "ctypes"
    ]


def test_no_text_is_executed() -> None:
    """Scene text is data: nothing that could run it is called anywhere."""
    forbidden = {"eval", "exec", "compile", "sympify", "parse_expr"}
    assert not [
        f"{short(path)}:{node.lineno}: {node.func.id}"
        for path in PYTHON
        for node in ast.walk(tree(path))
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id in forbidden
    ]


def test_tolerances_are_in_accuracy() -> None:
    found = set()
    for path in PYTHON:
        if short(path).startswith("runtime/") and path.name not in ("accuracy.py", "thresholds.py"):
            numbers = [n.value for n in ast.walk(tree(path)) if isinstance(n, ast.Constant)]
            found |= {(path.name, x) for x in numbers if isinstance(x, float) and 0 < abs(x) < 1e-3}
    assert found == set(SMALL)


def core_texts() -> dict[str, str]:
    """The text of each file of the core, without comments; none of coefficients and elementary functions."""
    files = [path for path in C if short(path).startswith("core/")]
    texts = {short(path)[5:]: path.read_text(encoding="utf-8") for path in files}
    return {
        name: re.sub(r'/\*.*?\*/|"[^"\n]*"', "", text, flags=re.DOTALL)
        for name, text in texts.items()
        if not name.startswith("elementary/") and "coefficients" not in name
    }


def small_numbers(text: str) -> set[float]:
    return {value for value in map(float, NUMBER.findall(text)) if 0 < value <= 1e-3}


def ratios(text: str) -> set[tuple[str, str]]:
    """Fixed ratios to settings: (ratio, setting)."""
    return {(times or over, by or of) for times, by, of, over in RATIO.findall(text)}


def test_tolerances_of_the_core_are_in_accuracy() -> None:
    texts = core_texts()
    found = {(name, value) for name, text in texts.items() for value in small_numbers(text)}
    assert found == set(SMALL_IN_CORE)
    assert {(name, *each) for name, text in texts.items() for each in ratios(text)} == set(RATIOS_IN_CORE)


def test_numbers_and_ratios_in_c_are_found() -> None:
    text = "x = (mg_real)1e-7L * a[3] + .0005f / mg_1e3; if (d < 100 * c->settings->start_gap) e = 0.5;"
    assert small_numbers(text) == {1e-7, 5e-4}
    assert ratios(text + "f = c->settings->tolerance / 8;") == {("100 *", "start_gap"), ("/ 8", "tolerance")}


def test_accuracy_shows_few_fields_and_each_setting_of_the_core_is_one() -> None:
    shown, others = ({each.name for each in fields(record)} for record in (Accuracy, Thresholds))
    assert len(shown) <= MOST_SHOWN
    assert not shown & others
    assert {*SETTINGS_REALS, *SETTINGS_COUNTS} <= shown | others
    assert set(SETTINGS_REALS) & shown == {*OWN, "step"}


def test_the_core_neither_allocates_nor_prints() -> None:
    wrong = []
    for path in (path for path in C if short(path).startswith("core/")):
        text = path.read_text(encoding="utf-8")
        called = re.findall(r"\b(malloc|calloc|realloc|free|printf|fprintf|exit|abort)\s*\(", text)
        foreign = set(re.findall(r"#include <(\S+)>", text)) - C_HEADERS
        wrong += [f"{short(path)}: {name}" for name in (*called, *sorted(foreign))]
    assert not wrong


def test_the_top_level_is_fixed() -> None:
    patterns = (ROOT / ".gitignore").read_text(encoding="utf-8").split()
    ignored = [pattern.strip("/") for pattern in patterns]
    names = {path.name for path in ROOT.iterdir() if not path.name.startswith(".")}
    kept = {name for name in names if not any(fnmatch.fnmatch(name, pattern) for pattern in ignored)}
    assert (kept - {"uv.lock"}) | {"generated"} == TOP_LEVEL
