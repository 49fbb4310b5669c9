"""The vocabulary of every shipped scene, and instruction counts that may fall but not rise."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from modelgen import derive, emit, read, require
from tests.running import NAMES, SCENES

HERE = Path(__file__).parent


def facts(name: str) -> dict[str, Any]:
    """Kinds, and of each function its arguments and its instruction count."""
    derivation = derive(require(read(SCENES / f"{name}.toml")))
    manifest = emit(derivation).manifest
    ways = ("inputs", "outputs")
    functions = {
        key: {way: {port["name"]: port["shape"] for port in entry[way]} for way in ways}
        for key, entry in manifest.functions.items()
    }
    instructions = {formula.name: formula.instructions for formula in derivation.formulas}
    return {"kinds": manifest.kinds, "functions": functions, "instructions": instructions}


@pytest.mark.parametrize("name", NAMES)
def test_vocabulary_is_as_reviewed_and_no_count_rises(name: str, request: pytest.FixtureRequest) -> None:
    path, found = HERE / f"{name}.json", facts(name)
    if request.config.getoption("--update-golden"):
        path.write_text(json.dumps(found, sort_keys=True, indent=1) + "\n", encoding="utf-8")
    golden = json.loads(path.read_text(encoding="utf-8"))
    assert {key: found[key] for key in ("kinds", "functions")} == {
        key: golden[key] for key in ("kinds", "functions")
    }
    counts, ceilings = found["instructions"], golden["instructions"]
    assert counts.keys() == ceilings.keys()
    assert not {key: (count, ceilings[key]) for key, count in counts.items() if count > ceilings[key]}


def test_every_golden_file_has_its_scene() -> None:
    assert {path.stem for path in HERE.glob("*.json")} == set(NAMES)
