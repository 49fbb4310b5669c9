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
    assert Manifest.from_json(MANIFEST.structure_json(), MANIFEST.sentence_json()) == MANIFEST


def test_a_build_record_survives_as_well() -> None:
    record = BuildRecord("0f", "1e", "x86_64", "double", "lib.so", MANIFEST.vocabulary, {"casadi": "3"})
    assert BuildRecord.from_json(record.to_json()) == record
    with pytest.raises(LibraryError, match=r"r.json: it is not a BuildRecord"):
        BuildRecord.from_json(MANIFEST.structure_json(), "r.json")


def test_the_vocabulary_is_all_but_the_sentence() -> None:
    assert replace(MANIFEST, sentence={}, composed={}).vocabulary == MANIFEST.vocabulary
    for other in (replace(MANIFEST, abi=0), replace(MANIFEST, functions={}), replace(MANIFEST, kinds={})):
        assert other.vocabulary != MANIFEST.vocabulary


def test_keys_are_sorted() -> None:
    for text in (MANIFEST.structure_json(), MANIFEST.sentence_json()):
        assert list(json.loads(text)) == sorted(json.loads(text))


def test_the_structure_has_no_number_of_the_scene() -> None:
    heavier = replace(MANIFEST, sentence={**MANIFEST.sentence, "gravity": [0.0, 0.0, -1.62]})
    assert heavier.structure_json() == MANIFEST.structure_json()
    assert heavier.sentence_json() != MANIFEST.sentence_json()


def test_a_sentence_of_another_vocabulary_is_refused() -> None:
    other = replace(MANIFEST, functions={})
    with pytest.raises(LibraryError, match=r"m.json: its sentence is of another vocabulary.*build again"):
        Manifest.from_json(other.structure_json(), MANIFEST.sentence_json(), "m.json")


@pytest.mark.parametrize("text", ["", "{", "[]", "{}", '{"abi": 1}'])
def test_what_is_no_manifest_is_refused(text: str) -> None:
    with pytest.raises(LibraryError, match=r"m.json: it is not"):
        Manifest.from_json(text, MANIFEST.sentence_json(), "m.json")
    with pytest.raises(LibraryError, match=r"m.json: its sentence: it is not"):
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
    kinds, sentence = MANIFEST.kinds, MANIFEST.sentence
    assert (
        sentence["n_q"]
        == len(sentence["initial_q"])
        == sum(kinds["body"][b["kind"]]["n_q"] for b in sentence["bodies"])
    )
    assert (
        sentence["n_u"]
        == len(sentence["initial_u"])
        == sum(kinds["body"][b["kind"]]["n_u"] for b in sentence["bodies"])
    )
    assert sentence["n_eta"] == sum(contact["room"] for contact in sentence["contacts"])
    for group, entries in (("body", "bodies"), ("contact", "links")):
        for entry in sentence[entries]:
            assert len(entry["parameters"]) == len(kinds[group][entry["kind"]]["parameters"])
    for load in sentence["loads"]:
        assert len(load["parameters"]) == kinds["load"][load["kind"]]["n_parameters"]


def test_offsets_follow_one_another() -> None:
    kinds, sentence = MANIFEST.kinds, MANIFEST.sentence
    q = u = eta = 0
    for body in sentence["bodies"]:
        assert (body["q"], body["u"]) == (q, u)
        q, u = q + kinds["body"][body["kind"]]["n_q"], u + kinds["body"][body["kind"]]["n_u"]
    for contact in sentence["contacts"]:
        assert contact["eta"] == eta
        eta += max(kinds["contact"][link["kind"]]["n_eta"] for link in links_of(contact))


def links_of(contact: dict[str, Any]) -> list[dict[str, Any]]:
    """The links that a contact may be on: its own, or all of its pair."""
    pair, own = MANIFEST.sentence["pairs"][contact["pair"]], contact["link"]
    found: list[dict[str, Any]] = MANIFEST.sentence["links"]
    return found[slice(*pair["links"])] if own < 0 else [found[own]]


def test_every_pair_has_its_links_and_its_contacts_in_a_row() -> None:
    sentence = MANIFEST.sentence
    for entries in ("links", "contacts"):
        owners = [index for index, pair in enumerate(sentence["pairs"]) for _ in range(*pair[entries])]
        assert owners == [entry["pair"] for entry in sentence[entries]]
    for contact in sentence["contacts"]:
        assert all(link["pair"] == contact["pair"] for link in links_of(contact))
