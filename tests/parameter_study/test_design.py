"""Values of the runs of a sweep: grids, and draws from ranges."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from modelgen.errors import ModelgenError
from modelgen.parameter_study.design import design_points, variations_of


def points(vary: dict[str, Any], samples: int | None = None, design: str | None = None, seed: int = 0) -> Any:
    return design_points(variations_of(vary), samples, design, seed)[1]


def test_a_grid_has_all_combinations_the_last_number_fastest() -> None:
    found = points({"a": "0:1:3", "b": [5.0, 7.0]})
    assert found.tolist() == [[0, 5], [0, 7], [0.5, 5], [0.5, 7], [1, 5], [1, 7]]


def test_a_range_reaches_its_ends_exactly() -> None:
    for text in ("0.1:0.7:7", "1e-3:7e3:5:log", "-0.3:0.1:4", "pi/7:pi:3"):
        (variation,) = variations_of({"a": text})
        assert variation.values[0] == variation.low
        assert variation.values[-1] == variation.high
        assert all(a < b for a, b in pairwise(variation.values))
    ratios = {round(b / a, 9) for a, b in pairwise(variations_of({"a": "1:1000:4:log"})[0].values)}
    assert ratios == {10.0}


@pytest.mark.parametrize("design", ["sobol", "latin", "random"])
def test_draws_repeat_with_their_seed_and_stay_in_range(design: str) -> None:
    vary = {"a": "2:3", "b": "1e-2:1e2:log", "c": "0:1:5", "d": [3.0, 9.0, 4.0]}
    found = points(vary, 200, design, 1)
    assert (found == points(vary, 200, design, 1)).all()
    assert (found[:, 0] != points(vary, 200, design, 2)[:, 0]).any()
    assert ((found[:, 0] >= 2) & (found[:, 0] <= 3)).all()
    assert 0.35 < (found[:, 1] < 1).mean() < 0.65  # half of the decades
    assert set(found[:, 2]) == {0, 0.25, 0.5, 0.75, 1}
    assert set(found[:, 3]) == {3, 9, 4}


@pytest.mark.parametrize("design", ["sobol", "latin"])
def test_each_of_equal_parts_of_a_range_has_one_run(design: str) -> None:
    """A property of a Latin hypercube for any number, of a scrambled Sobol sequence for powers of two."""
    found = points({"a": "0:1", "b": "0:1"}, 64, design, 3)
    assert (np.sort((found * 64).astype(int), axis=0) == np.arange(64)[:, None]).all()


@pytest.mark.parametrize(
    ("vary", "options", "word"),
    [
        ({}, {}, "nothing varies"),
        ({"a": ""}, {}, "a="),
        ({"a": "1:2:3:4:5"}, {}, "no values"),
        ({"a": "2:1:3"}, {}, "exchange"),
        ({"a": "0:1:1"}, {}, "from 2 on"),
        ({"a": "0:1:x"}, {}, "from 2 on"),
        ({"a": "-1:1:3:log"}, {}, "0 < a < b"),
        ({"a": "1,1"}, {}, "twice"),
        ({"a": "1,b"}, {}, "unknown name"),
        ({"a": "1e999,1"}, {}, "allowed"),
        ({"a": "0:1"}, {}, "a=0:1:5"),
        ({"a": "0:1:5"}, {"samples": 3, "design": "grid"}, "leave samples out"),
        ({"a": "0:1:5"}, {"design": "sobol"}, "give the samples"),
        ({"a": "0:1:5"}, {"samples": 0}, "at least 1"),
        ({"a": "0:1:5"}, {"samples": 3, "design": "soboll"}, "did you mean 'sobol'?"),
        ({"a": "0:1:9999", "b": "0:1:9999"}, {}, "fewer"),
    ],
)
def test_wrong_designs_are_refused(vary: dict[str, Any], options: dict[str, Any], word: str) -> None:
    with pytest.raises(ModelgenError, match=word.replace("?", r"\?")):
        points(vary, **options)
