"""What is committed under generated/ is what emit makes, on every machine; no instruction count rises."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from functools import cache
from pathlib import Path
from typing import Any

import casadi as ca
import pytest

from modelgen import derive, emit, read, require
from modelgen.codegen.emit import Package
from modelgen.codegen.manifest import STRUCTURE
from tests.running import NAMES, SCENES

ROOT = Path(__file__).parents[2]
GENERATED = ROOT / "generated"
REVIEWED_C = {  # kernels whose C is committed as text: scene and kind
    "plane_sphere_explicit": "bouncing_ball",
    "plane_circle_support": "disc_on_rim",
    "sphere_torus_cavity_centre_surface": "ball_in_torus",
}
CORES = ("Haswell", "Prescott")  # of OpenBLAS: with fused operations and without
LINES = 6000  # of JSON that a person can review

Keys = tuple[str | int, ...]


@cache
def package(name: str) -> Package:
    return emit(derive(require(read(SCENES / f"{name}.toml"))))


def leaves(value: Any, path: Keys = ()) -> dict[Keys, Any]:
    """The values of nested objects and lists by their path; an empty one is a value itself."""
    if isinstance(value, dict | list) and value:
        items = value.items() if isinstance(value, dict) else enumerate(value)
        return {p: leaf for key, entry in items for p, leaf in leaves(entry, (*path, key)).items()}
    return {path: value}


def agree(path: Keys, found: Any, golden: Any) -> bool:
    return bool(found <= golden) if path[-1] == "instructions" else bool(found == golden)


def reviewed(text: str, path: Path, request: pytest.FixtureRequest) -> str:
    """The committed text, written anew where that is asked for."""
    if request.config.getoption("--update-golden"):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    return path.read_text(encoding="utf-8")


@pytest.mark.parametrize("name", NAMES)
def test_the_manifest_is_as_reviewed_and_no_count_rises(name: str, request: pytest.FixtureRequest) -> None:
    text = package(name).manifest.structure_json()
    golden_text = reviewed(text, GENERATED / name / STRUCTURE, request)
    found, golden = leaves(json.loads(text)), leaves(json.loads(golden_text))
    assert found.keys() == golden.keys()
    assert not {p: (found[p], golden[p]) for p in found if not agree(p, found[p], golden[p])}
    if found == golden:
        assert text == golden_text


def test_a_count_that_rises_and_any_other_change_are_seen() -> None:
    count, name = ("functions", "mg_x_rates", "instructions"), ("instance", "name")
    assert agree(count, 9, 10)
    assert not agree(count, 11, 10)
    assert agree(name, "a", "a")
    assert not agree(name, "a", "b")


def test_manifests_are_short_enough_to_review() -> None:
    texts = [(GENERATED / name / STRUCTURE).read_text(encoding="utf-8") for name in NAMES]
    assert sum(len(text.splitlines()) for text in texts) < LINES


def kernel_text(kind: str) -> str:
    """CasADi's C of the kernels of one contact kind, with the version that wrote it."""
    whole = package(REVIEWED_C[kind]).files["kernels.c"]
    entry = rf"^MG_ENTRY\((mg_{kind}_\w+), (\w+),"
    parts = [f"/* CasADi {ca.CasadiMeta.version()} */\n"]
    for name, internal in re.findall(entry, whole, re.MULTILINE):
        body = re.search(rf"^static int {internal}\(.*?^}}$", whole, re.MULTILINE | re.DOTALL)
        assert body is not None
        parts.append(f"/* {name} */\n{body.group(0)}\n")
    return "\n".join(parts)


@pytest.mark.parametrize("kind", REVIEWED_C)
def test_the_c_of_some_kinds_is_as_reviewed(kind: str, request: pytest.FixtureRequest) -> None:
    text = kernel_text(kind)
    golden = reviewed(text, GENERATED / "kinds" / f"{kind}.c", request)
    if golden.splitlines()[0] != text.splitlines()[0]:
        pytest.skip(f"reviewed as text of {golden.splitlines()[0].strip('/* ')}")
    assert len(text.splitlines()) > 20
    assert text == golden


PRINT_ALL = """
import sys
from modelgen import derive, emit, read, require
for name in sys.argv[1:]:
    print(emit(derive(require(read(f"scenes/{name}.toml")))).manifest.structure_json())
"""


def structures(core: str, names: tuple[str, ...]) -> str:
    environment = {**os.environ, "OPENBLAS_CORETYPE": core, "PYTHONPATH": str(ROOT)}
    command = [sys.executable, "-c", PRINT_ALL, *names]
    return subprocess.run(
        command, cwd=ROOT, env=environment, capture_output=True, text=True, check=True
    ).stdout


@pytest.mark.parametrize(
    "names", [("egg_on_spline", "glass_on_table"), pytest.param(NAMES, marks=pytest.mark.slow)], ids=len
)
def test_structure_does_not_depend_on_the_blas(names: tuple[str, ...]) -> None:
    one, other = (structures(core, names) for core in CORES)
    assert one == other
    assert one.count('"functions"') == len(names)
