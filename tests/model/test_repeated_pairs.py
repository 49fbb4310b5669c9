"""Pairs of shapes that differ in their bodies alone share what follows from them, and are as each alone."""

from __future__ import annotations

import json
from dataclasses import replace
from itertools import combinations
from typing import Any

import numpy as np
import pytest

from modelgen import derive, emit, require
from modelgen.codegen.manifest import Manifest
from modelgen.model import Model
from modelgen.runtime.tables.features import FeatureTables
from modelgen.runtime.tables.library_tables import library_tables
from modelgen.runtime.tables.number_pool import WHOLE_SCENE, NumberPool, may_share
from modelgen.scene.scene_types import Scene
from tests.model.scenes import TABLE, contact, scene
from tests.running import compiled

BOX = "kind = 'box', size = [0.3, 0.2, 0.1]"
HALF = "kind = 'box', size = [0.3, 0.2, 0.1], position = [0.0, 0.0, 0.02]"
ROUND = "kind = 'cylinder', radius = 0.1, length = 0.2"
SHAPES = {"a": BOX, "b": BOX, "c": BOX, "moved": HALF, "d": ROUND, "e": ROUND}


def body(name: str, shape: str) -> str:
    return f'[[body]]\nname = "{name}"\nshape = {{ {shape} }}\ndensity = 1000.0\n'


def crowd(terms: str) -> Scene:
    """Every two of the bodies, and each of them and the table. Two pairs are named the other way round, and
    one has terms of its own."""
    pairs = {*combinations(SHAPES, 2), *((name, "table") for name in SHAPES)}
    turned = {("a", "c"), ("d", "table")}
    named = [pair[::-1] if pair in turned else pair for pair in sorted(pairs)]
    bodies = [body(name, shape) for name, shape in SHAPES.items()]
    own = {("b", "c"): "restitution = 0.5"}
    return scene(*bodies, TABLE, *(contact(*pair, own.get(pair, terms)) for pair in named))


@pytest.mark.parametrize("terms", ["", "friction = 0.3", "friction = 0.3\nrolling_resistance = 0.001"])
def test_each_pair_is_as_if_it_were_alone(terms: str) -> None:
    whole = crowd(terms)
    model = require(whole)
    repeats = [pair.repeats for pair in model.pairs]
    assert 5 < len([each for each in repeats if each is not None]) < len(repeats) - 5
    for k, pair in enumerate(whole.contacts):
        assert content(model, k) == content(require(replace(whole, contacts=(pair,))), 0)


def content(model: Model, k: int) -> dict[str, Any]:
    """All of a pair that does not depend on the other pairs."""
    entry = model.pairs[k]
    first, end = entry.feature_pairs
    kinds = [replace(kind, name="") for kind in model.contact_kinds]
    patches = [patch for patch in model.patches if patch.pair == k]
    return {
        "pair": replace(entry, feature_pairs=(0, end - first), contacts=(0, 0), repeats=None),
        "feature_pairs": [
            (replace(each, kind=0, pair=0), kinds[each.kind]) for each in model.feature_pairs[first:end]
        ],
        "contacts": [
            (each.name, each.room, each.feature_pair - (first if each.feature_pair >= 0 else 0))
            for each in model.contacts[slice(*entry.contacts)]
        ],
        "patches": [
            (
                *(patch.name, patch.parameters, kinds[patch.kind], patch.friction),
                tuple(number - first for number in patch.feature_pairs),
                [face_of(model, face) for face in patch.faces],
                None if patch.friction_kind < 0 else kinds[patch.friction_kind],
            )
            for patch in patches
        ],
    }


def face_of(model: Model, number: int) -> tuple[Any, ...]:
    face = model.faces[number]
    shapes = [replace(model.shape_kinds[arc.kind], name="") for arc in face.boundary]
    return replace(face, boundary=()), [replace(arc, kind=0) for arc in face.boundary], shapes


def test_a_file_has_their_feature_pairs_once() -> None:
    manifest = emit(derive(require(crowd("friction = 0.3")))).manifest
    text = manifest.instance_json()
    again = Manifest.from_json(manifest.structure_json(), text)
    assert again.instance == json.loads(json.dumps(manifest.instance, default=list))
    alone = [pair for pair in manifest.instance["pairs"] if "repeats" not in pair]
    count = sum(end - first for first, end in (pair["feature_pairs"] for pair in alone))
    assert text.count('"shape_o"') == count < len(manifest.instance["feature_pairs"]) / 2


def test_the_tables_of_the_core_do_not_depend_on_what_is_repeated() -> None:
    manifest = emit(derive(require(crowd("friction = 0.3")))).manifest
    pairs = [{key: pair[key] for key in pair if key != "repeats"} for pair in manifest.instance["pairs"]]
    other = replace(manifest, instance={**manifest.instance, "pairs": pairs})
    pools = [[NumberPool(shares=True) for _ in range(2)] for _ in range(2)]
    one, two = (
        FeatureTables(each, *pair, np.inf) for each, pair in zip((manifest, other), pools, strict=True)
    )
    assert one.integers.keys() == two.integers.keys()
    assert all((one.integers[name] == two.integers[name]).all() for name in one.integers)
    assert [pool.values for pool in pools[0]] == [pool.values for pool in pools[1]]


def test_a_scene_with_parameters_has_places_for_the_numbers_of_each_pair() -> None:
    """What a change of a parameter makes different is not shared, though it may be equal."""
    manifest = emit(derive(require(crowd("friction = 0.3")))).manifest
    with_parameter = {**manifest.instance, "parameters": [{"name": "size", "value": 1.0}]}
    places = []
    for instance in (manifest.instance, with_parameter):
        pools = [NumberPool(may_share(instance, manifest.functions)) for _ in range(2)]
        tables = FeatureTables(replace(manifest, instance=instance), *pools, np.inf)
        places.append(tables.integers["feature_pair_parameters"])
    shared, own = (len(set(each.tolist())) for each in places)
    assert shared < len(places[0]) / 2
    assert own == len(places[1])


def test_a_scene_with_a_composed_function_has_the_parameters_in_the_order_of_the_model() -> None:
    """Two balls, one content: the function of the whole scene takes the parameters of both pairs."""
    balls = [
        f'[[body]]\nname = "ball{k}"\nshape = {{ kind = "ellipsoid", semi_axes = [0.1, 0.2, 0.15] }}\n'
        f"density = 1000.0\nposition = [{k}.0, 0.0, 0.15]\n"
        for k in range(2)
    ]
    model = require(scene(*balls, TABLE, *(contact(f"ball{k}", "table") for k in range(2))))
    library = compiled(emit(derive(model)))
    assert library.manifest.instance["pairs"][1]["repeats"] == 0
    assert WHOLE_SCENE in library.manifest.functions
    blocks = (model.bodies, model.feature_pairs)
    wanted = [value for block in blocks for entry in block for value in entry.parameters]
    (found,) = (array for array in library_tables(library).arrays if array[: len(wanted)].tolist() == wanted)
    assert len(found) >= len(wanted)
