"""What is looked up by name: another name is refused with all there are and the nearest, everywhere."""

from __future__ import annotations

import copy
import json
import pickle
from dataclasses import asdict
from typing import Any

import pytest

from modelgen import ModelgenError, closest_points, distance_minima, start, start_many
from modelgen.name_suggestions import nearest
from modelgen.runtime.by_name import ByName
from tests.stories.public_calls import TURN, library, mappings, trajectory

NO_NAMES: tuple[Any, ...] = (3, None, ("ball", "floor"), ["ball"], {}, float("nan"), b"ball", "")


def refused(mapping: Any, name: Any) -> ModelgenError:
    with pytest.raises(ModelgenError) as caught:
        mapping[name]
    return caught.value


def test_every_mapping_says_which_names_it_has() -> None:
    for where, mapping in mappings().items():
        names = list(mapping)
        assert names, where
        for name in names:
            error = refused(mapping, name + "x")
            assert error.where, where
            assert repr(name + "x") == error.found
            assert all(each in error.allowed for each in names), where
            assert f"did you mean {name!r}?" in error.remedy or len(names) > 1, where
            exchanged = "-".join(reversed(name.split("-")))
            if exchanged != name:
                assert f"did you mean {name!r}?" in refused(mapping, exchanged).remedy, where
        for name in NO_NAMES:
            assert repr(name) in str(refused(mapping, name)), where


def test_a_mapping_is_asked_whether_it_has_a_name() -> None:
    for where, mapping in mappings().items():
        assert next(iter(mapping)) in mapping, where
        assert "none of that name" not in mapping, where
        assert mapping.get("none of that name", 3) == 3, where


def test_results_by_name_are_copied_sent_and_written_as_dicts_are() -> None:
    given = ByName({"ring-ball": 1.0}, "contact")
    for made in (pickle.loads(pickle.dumps(given)), copy.deepcopy(given), copy.copy(given)):
        assert made == {"ring-ball": 1.0}
        assert refused(made, "ball-ring").where == "contact"
    assert json.loads(json.dumps(given)) == given
    assert asdict(trajectory())["inputs"] == trajectory().inputs


@pytest.mark.parametrize(
    ("given", "known", "meant"),
    [
        ("ball-ring", ["ring", "ring-ball", "ball"], "ring-ball"),
        ("ball-ring:rim", ["ring-ball", "ring-ball:rim"], "ring-ball:rim"),
        ("b/y-a/x", ["a/x-b/z", "a/x-b/y"], "a/x-b/y"),
        ("tea-pot", ["time-stepping", "tea-pit"], "tea-pit"),
    ],
)
def test_a_pair_in_the_other_order_is_suggested(given: str, known: list[str], meant: str) -> None:
    assert nearest(given, known) == f"did you mean {meant!r}?"


def test_arguments_that_are_names_suggest_the_pair_in_its_order() -> None:
    """Where the order decides the direction of the normal it is not accepted."""
    here = [0.0, 0.0, 0.05, *TURN]
    for call in (closest_points, distance_minima):
        with pytest.raises(ModelgenError, match=r"no contact 'floor-ball'.*did you mean 'ball-floor'"):
            call(library(), "floor-ball", here, here)


def test_names_of_arguments() -> None:
    """By name given in a call: inputs and parameters."""
    for call in (lambda **more: start(library(), **more), lambda **more: start_many(library(), 2, **more)):
        with pytest.raises(ModelgenError, match=r"'pusch'.*push.*did you mean 'push'"):
            call(inputs={"pusch": 1.0})
        with pytest.raises(ModelgenError, match=r"'hight'.*height.*did you mean 'height'"):
            call(parameters={"hight": 1.0})
