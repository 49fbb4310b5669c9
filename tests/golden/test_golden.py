"""The committed manifests of the shipped scenes are what emit makes, and no instruction count rises."""

from __future__ import annotations

import json
from math import isclose
from pathlib import Path
from typing import Any

import pytest

from modelgen import derive, emit, read, require
from modelgen.codegen.manifest import Manifest
from tests.running import NAMES, SCENES

GENERATED = Path(__file__).parents[2] / "generated"
DIGITS = 1e-13  # relative; libraries of other machines differ in the last bits of a sine or a long sum

Keys = tuple[str | int, ...]


def leaves(value: Any, path: Keys = ()) -> dict[Keys, Any]:
    """The values of nested objects and lists by their path; an empty one is a value itself."""
    if isinstance(value, dict | list) and value:
        items = value.items() if isinstance(value, dict) else enumerate(value)
        return {p: leaf for key, entry in items for p, leaf in leaves(entry, (*path, key)).items()}
    return {path: value}


def agree(path: Keys, found: Any, golden: Any) -> bool:
    if path[-1] == "instructions":
        return bool(found <= golden)
    if isinstance(found, float) and isinstance(golden, float):
        return isclose(found, golden, rel_tol=DIGITS, abs_tol=DIGITS)
    return bool(found == golden)


@pytest.mark.parametrize("name", NAMES)
def test_the_manifest_is_as_reviewed_and_no_count_rises(name: str, request: pytest.FixtureRequest) -> None:
    path = GENERATED / name / "manifest.json"
    text = emit(derive(require(read(SCENES / f"{name}.toml")))).manifest.to_json()
    if request.config.getoption("--update-golden"):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    found, golden = leaves(json.loads(text)), leaves(json.loads(path.read_text(encoding="utf-8")))
    assert found.keys() == golden.keys()
    assert not {p: (found[p], golden[p]) for p in found if not agree(p, found[p], golden[p])}


def test_a_count_that_rises_and_any_other_change_are_seen() -> None:
    count, name = ("functions", "mg_x_rates", "instructions"), ("sentence", "name")
    assert agree(count, 9, 10)
    assert not agree(count, 11, 10)
    assert agree(name, "a", "a")
    assert not agree(name, "a", "b")
    assert agree(("kinds", 0), 0.1 + 0.2, 0.3)
    assert not agree(("kinds", 0), 0.3 + 1e-9, 0.3)


def test_every_committed_manifest_has_its_scene_and_is_read() -> None:
    for name in NAMES:
        text = (GENERATED / name / "manifest.json").read_text(encoding="utf-8")
        assert Manifest.from_json(text).name == name
