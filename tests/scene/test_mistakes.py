"""Mistakes that people make in scene files are answered by one line: place, finding, remedy."""

from __future__ import annotations

from pathlib import Path

import pytest

from modelgen import read, require
from modelgen.errors import SceneError
from modelgen.scene.read import read_text
from tests.scene.mistakes import GOOD, REFUSED, WARNED, Mistake, written


def told(mistake: Mistake) -> str:
    with pytest.raises(SceneError) as refused:
        require(read_text(mistake.text, "scene.toml"))
    return str(refused.value)


@pytest.mark.parametrize("mistake", REFUSED, ids=lambda mistake: mistake.name)
def test_a_mistake_is_answered_by_place_finding_and_remedy(mistake: Mistake) -> None:
    answer = told(mistake)
    assert answer.startswith("scene.toml: ")
    assert "\n" not in answer
    assert not [word for word in mistake.words if word not in answer], answer


@pytest.mark.parametrize("mistake", WARNED, ids=lambda mistake: mistake.name)
def test_what_is_allowed_but_seldom_meant_is_remarked_on(mistake: Mistake) -> None:
    (remark,) = read_text(mistake.text, "scene.toml").remarks
    assert not [word for word in mistake.words if word not in remark], remark
    assert remark in require(read_text(mistake.text, "scene.toml")).warnings


def test_mistakes_with_files_are_answered(tmp_path: Path) -> None:
    for name, path, words in written(tmp_path):
        with pytest.raises(SceneError) as refused:
            read(path)
        answer = str(refused.value)
        assert answer.startswith(f"{path}: "), name
        assert not [word for word in words if word not in answer], answer


def test_the_scene_without_a_mistake_is_read_without_a_remark() -> None:
    scene = read_text(GOOD, "scene.toml")
    assert not scene.remarks
    assert not require(scene).warnings


def test_there_are_at_least_fifty_of_different_kinds() -> None:
    names = [mistake.name for mistake in (*REFUSED, *WARNED)]
    assert len(set(names)) == len(names) >= 50
    assert len({told(mistake).split(";")[0] for mistake in REFUSED}) > 0.9 * len(REFUSED)
