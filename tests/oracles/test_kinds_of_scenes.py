"""Only what a scene needs is generated: `check`, the manifest, the registry and the built library agree."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

from modelgen import derive, emit, read, require
from modelgen.codegen.amalgamation import header_text, runtime_text
from modelgen.codegen.library import Library
from modelgen.codegen.manifest import Manifest
from modelgen.derivation import Derivation
from modelgen.report.check import check_facts
from tests.elf import defined_symbols
from tests.registry import REGISTRY
from tests.running import SCENES, scene_of

EVERY_SCENE = pytest.mark.parametrize("name", REGISTRY)
ON_LINUX = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="libraries are ELF files on Linux")
ROLES = (
    *("pose", "motion", "energy", "path", "wrench", "deflection", "surface", "curve", "point"),
    *("rates", "place", "aim", "seek", "angle", "rows", "coordinates"),
)
GROUPS = ("body", "contact", "load", "joint", "limit")
OF_A_KERNEL = (  # what casadi.external asks of a function, by suffix
    *("", "_n_in", "_n_out", "_name_in", "_name_out", "_sparsity_in", "_sparsity_out"),
)
OF_THE_FILE = {
    f"mg_kernels_casadi_{name}" for name in ("real_size", "int_size", "version")
}  # from CasADi 3.8.2 on


@cache
def derived(name: str) -> Derivation:
    return derive(require(read(SCENES / f"{name}.toml")))


@cache
def manifest_of(name: str) -> Manifest:
    return emit(derived(name)).manifest


def functions_in(text: str) -> set[str]:
    return set(re.findall(r"^MG_API .*?(mg_\w+)\(", text, re.MULTILINE))


def api() -> set[str]:
    """The functions that the public header declares, but for those that differentiate runs."""
    return functions_in(header_text()) - (functions_in(runtime_text(True)) - functions_in(runtime_text()))


def exported(library: Library) -> set[str]:
    return defined_symbols(Path(library.path))


@pytest.mark.cases(5)
@EVERY_SCENE
def test_check_shows_the_kinds_of_the_registry_and_of_the_manifest(name: str) -> None:
    shown = check_facts(derived(name))["kinds"]
    kinds = manifest_of(name).kinds
    assert tuple(shown) == REGISTRY[name].kinds
    assert [kind["name"] for group in GROUPS for kind in kinds[group]] == shown


@pytest.mark.cases(14)
@EVERY_SCENE
def test_every_kind_is_used_by_the_scene(name: str) -> None:
    kinds, instance = manifest_of(name).kinds, manifest_of(name).instance
    users = {"body": "bodies", "contact": "feature_pairs", "load": "loads", "joint": "joints"}
    for group, entries in users.items():
        used = {entry["kind"] for entry in instance[entries]}
        if group == "contact":
            used |= {
                entry[key]
                for entry in instance["patches"]
                for key in ("kind", "friction_kind")
                if key in entry
            }
        assert used == set(range(len(kinds[group])))
    limits = {entry["kind"] - len(kinds["contact"]) for entry in instance["limits"]}
    assert limits == set(range(len(kinds["limit"])))
    in_contact = {side for kind in kinds["contact"] for side in kind["shapes"]}
    in_bounds = {arc["kind"] for face in instance["faces"] for arc in face["boundary"]}
    assert in_contact | in_bounds == set(range(len(kinds["shape"])))


@pytest.mark.cases(14)
@EVERY_SCENE
def test_every_function_is_of_one_of_these_kinds_and_check_counts_all(name: str) -> None:
    kinds, functions = manifest_of(name).kinds, manifest_of(name).functions
    names = "|".join(kind["name"] for group in kinds.values() for kind in group)
    of_a_kind = re.compile(f"mg_({names})_({'|'.join(ROLES)})")
    of_all = ("mg_sensors", "mg_rhs")
    assert all(of_a_kind.fullmatch(function) for function in functions if function not in of_all)
    counted = check_facts(derived(name))["instructions"]
    assert set(counted) - set(functions) <= {"mg_rhs"}
    assert set(functions) <= set(counted)
    assert all(counted[function] == entry["instructions"] for function, entry in functions.items())


@pytest.mark.cases(8)
@ON_LINUX
@EVERY_SCENE
def test_the_built_library_exports_these_functions_and_the_core_and_nothing_else(name: str) -> None:
    library = scene_of(name)
    kernels = {f"{kernel}{suffix}" for kernel in library.manifest.functions for suffix in OF_A_KERNEL}
    symbols = exported(library)
    written = {name for name in OF_THE_FILE if name in (library.path.parent / "kernels.c").read_text()}
    assert symbols == kernels | written | api()


@ON_LINUX
@pytest.mark.skipif(shutil.which("nm") is None, reason="nm is not installed")
def test_the_symbols_read_are_those_that_nm_lists() -> None:
    library = scene_of("ball_in_bowl")
    command = ["nm", "--dynamic", "--defined-only", "--format=posix", str(library.path)]
    listed = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    assert exported(library) == {line.split()[0] for line in listed.splitlines()}
