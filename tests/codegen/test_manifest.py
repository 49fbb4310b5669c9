"""The manifest is plain JSON and loses nothing."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import pytest

from modelgen import derive, emit, require
from modelgen.codegen.manifest import BuildRecord, Manifest
from modelgen.errors import LibraryError
from modelgen.notation import notation
from tests.model.scenes import WIDE

MANIFEST = emit(derive(require(WIDE))).manifest


def test_json_and_back_is_the_identity() -> None:
    assert Manifest.from_json(MANIFEST.structure_json(), MANIFEST.instance_json()) == MANIFEST


def test_a_build_record_survives_as_well() -> None:
    record = BuildRecord("0f", "1e", "x86_64", "double", "lib.so", MANIFEST.kinds_hash, {"casadi": "3"})
    assert BuildRecord.from_json(record.to_json()) == record
    with pytest.raises(LibraryError, match=r"r.json: it is not a BuildRecord"):
        BuildRecord.from_json(MANIFEST.structure_json(), "r.json")


def test_the_vocabulary_is_all_but_the_sentence() -> None:
    assert replace(MANIFEST, instance={}, composed={}).kinds_hash == MANIFEST.kinds_hash
    for other in (replace(MANIFEST, abi=0), replace(MANIFEST, functions={}), replace(MANIFEST, kinds={})):
        assert other.kinds_hash != MANIFEST.kinds_hash


def test_keys_are_sorted() -> None:
    for text in (MANIFEST.structure_json(), MANIFEST.instance_json()):
        assert list(json.loads(text)) == sorted(json.loads(text))


def test_the_structure_has_no_number_of_the_scene() -> None:
    heavier = replace(MANIFEST, instance={**MANIFEST.instance, "gravity": [0.0, 0.0, -1.62]})
    assert heavier.structure_json() == MANIFEST.structure_json()
    assert heavier.instance_json() != MANIFEST.instance_json()


def test_a_instance_of_another_vocabulary_is_refused() -> None:
    other = replace(MANIFEST, functions={})
    with pytest.raises(LibraryError, match=r"m.json: its instance is of another set of kinds.*build again"):
        Manifest.from_json(other.structure_json(), MANIFEST.instance_json(), "m.json")


@pytest.mark.parametrize("text", ["", "{", "[]", "{}", '{"abi": 1}'])
def test_what_is_no_manifest_is_refused(text: str) -> None:
    with pytest.raises(LibraryError, match=r"m.json: it is not"):
        Manifest.from_json(text, MANIFEST.instance_json(), "m.json")
    with pytest.raises(LibraryError, match=r"m.json: its instance: it is not"):
        Manifest.from_json(MANIFEST.structure_json(), text, "m.json")


FUNCTIONS = {**MANIFEST.functions, **MANIFEST.composed}


@pytest.mark.parametrize("name", FUNCTIONS)
def test_every_argument_has_shape_and_unit(name: str) -> None:
    entry = FUNCTIONS[name]
    for port in (*entry["inputs"], *entry["outputs"]):
        assert port["unit"] == notation(port["name"]).unit
        assert len(port["shape"]) == 1
    assert entry["instructions"] > 0
    assert entry["citation"]


def test_sentence_and_kinds_agree_in_their_sizes() -> None:
    kinds, instance = MANIFEST.kinds, MANIFEST.instance
    assert (
        instance["n_q"]
        == len(instance["initial_q"])
        == sum(kinds["body"][b["kind"]]["n_q"] for b in instance["bodies"])
    )
    assert (
        instance["n_u"]
        == len(instance["initial_u"])
        == sum(kinds["body"][b["kind"]]["n_u"] for b in instance["bodies"])
    )
    assert instance["n_eta"] == sum(contact["room"] for contact in instance["contacts"])
    for group, entries in (("body", "bodies"), ("contact", "feature_pairs")):
        for entry in instance[entries]:
            assert len(entry["parameters"]) == len(kinds[group][entry["kind"]]["parameters"])
    for load in instance["loads"]:
        assert len(load["parameters"]) == kinds["load"][load["kind"]]["n_parameters"]


def test_offsets_follow_one_another() -> None:
    kinds, instance = MANIFEST.kinds, MANIFEST.instance
    q = u = eta = 0
    for body in instance["bodies"]:
        assert (body["q"], body["u"]) == (q, u)
        q, u = q + kinds["body"][body["kind"]]["n_q"], u + kinds["body"][body["kind"]]["n_u"]
    for contact in instance["contacts"]:
        assert contact["eta"] == eta
        eta += max(
            kinds["contact"][feature_pair["kind"]]["n_eta"] for feature_pair in feature_pairs_of(contact)
        )


def feature_pairs_of(contact: dict[str, Any]) -> list[dict[str, Any]]:
    """The feature pairs that a contact may be on: its own, or all of its pair."""
    pair, own = MANIFEST.instance["pairs"][contact["pair"]], contact["feature_pair"]
    found: list[dict[str, Any]] = MANIFEST.instance["feature_pairs"]
    return found[slice(*pair["feature_pairs"])] if own < 0 else [found[own]]


def test_every_pair_has_its_links_and_its_contacts_in_a_row() -> None:
    instance = MANIFEST.instance
    for entries in ("feature_pairs", "contacts"):
        owners = [index for index, pair in enumerate(instance["pairs"]) for _ in range(*pair[entries])]
        assert owners == [entry["pair"] for entry in instance[entries]]
    for contact in instance["contacts"]:
        assert all(feature_pair["pair"] == contact["pair"] for feature_pair in feature_pairs_of(contact))
