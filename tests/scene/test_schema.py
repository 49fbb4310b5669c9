"""The JSON Schema and the reader are one: what the reader accepts, the schema accepts."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from hypothesis import given
from hypothesis import strategies as st

from modelgen.errors import SceneError
from modelgen.scene.json_schema import scene_schema
from modelgen.scene.read import read
from modelgen.scene.scene_format import SCENE, SHAPE_KINDS
from modelgen.scene.scene_from_tables import scene_from_tables

from .broken_structure import SOUND, STRUCTURAL

SCENES = sorted((Path(__file__).parents[2] / "scenes").glob("*.toml"))
VALIDATOR = jsonschema.Draft202012Validator(scene_schema())


def test_the_schema_is_a_schema() -> None:
    jsonschema.Draft202012Validator.check_schema(scene_schema())


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_a_shipped_scene_is_read_and_conforms(path: Path) -> None:
    scene = read(path)
    assert scene.name == path.stem
    assert scene.contacts or scene.joints
    VALIDATOR.validate(tomllib.loads(path.read_text()))


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_a_shipped_scene_says_what_it_shows_and_where_its_reference_comes_from(path: Path) -> None:
    lines = path.read_text().splitlines()
    comment = [line for line in lines[: lines.index("")] if line.startswith("#")]
    assert any(line.startswith("# Reference: ") for line in comment[1:])


def test_the_sound_scene_conforms() -> None:
    VALIDATOR.validate(tomllib.loads(SOUND))


@pytest.mark.parametrize("text", [pytest.param(case[1], id=case[0]) for case in STRUCTURAL])
def test_the_schema_refuses_what_the_reader_refuses_by_structure(text: str) -> None:
    assert not VALIDATOR.is_valid(tomllib.loads(text))


def test_every_key_is_described() -> None:
    schema = scene_schema()
    assert set(schema["properties"]) == {field.key for field in SCENE.fields}
    for table in (schema, *schema["$defs"]["body"]["oneOf"], *schema["$defs"]["shape"]["oneOf"]):
        for key, value in table["properties"].items():
            assert value["description"], key


def test_every_shape_has_a_branch() -> None:
    branches = scene_schema()["$defs"]["shape"]["oneOf"]
    assert tuple(branch["properties"]["kind"]["const"] for branch in branches) == SHAPE_KINDS


leaves = st.none() | st.booleans() | st.integers(-3, 3) | st.floats() | st.text(max_size=8)
words = st.sampled_from(["egg", "table", "egg/sphere", "pi/2", "fixed", "dynamic", "plane", "sphere", "auto"])
junk = st.recursive(
    leaves | words,
    lambda values: st.lists(values, max_size=4) | st.dictionaries(st.text(max_size=8), values, max_size=3),
    max_leaves=6,
)


def _mutate(node: Any, data: st.DataObject) -> None:
    """Replace one value somewhere in the tables."""
    keys = list(node) if isinstance(node, dict) else list(range(len(node)))
    key = data.draw(st.sampled_from(keys))
    if isinstance(node[key], dict | list) and data.draw(st.booleans()):
        _mutate(node[key], data)
    else:
        node[key] = data.draw(junk)


@given(st.data())
def test_any_value_in_any_place_is_one_error_or_a_scene_that_conforms(data: st.DataObject) -> None:
    tables = tomllib.loads(SOUND)
    _mutate(tables, data)
    try:
        scene_from_tables("x", tables, "x.toml")
    except SceneError as error:
        message = str(error)
    else:
        VALIDATOR.validate(tables)
        return
    assert message.startswith("x.toml: ")
    assert "\n" not in message
