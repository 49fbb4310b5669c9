"""No derivative that is called differentiable is wrong: numbers of scenes beside differences of runs."""

from __future__ import annotations

import pytest

from modelgen.runtime.sensitivity_directions import directions_of
from tests.benchmarks.derivative_pairs import study
from tests.running import NAMES
from tests.sensitivity.pairs import Pairs, library_with_factors


@pytest.mark.parametrize(
    ("name", "by"), [("bouncing_ellipsoid", "stone.velocity"), ("spinning_egg", "egg.orientation")]
)
def test_derivatives_by_numbers_of_a_scene(name: str, by: str) -> None:
    """Its masses, shapes, friction and restitution, and a start."""
    library, meanings = library_with_factors(name, 5)
    until = float(library.manifest.instance["run"]["until"])
    pairs = Pairs(library, [0.25 * until, 0.6 * until])
    found = [
        pair
        for direction in directions_of(library.manifest.instance, [*list(meanings)[:3], by])
        for pair in pairs.of(direction)
    ]
    assert [pair for pair in found if pair.verdict]
    assert not [pair for pair in found if pair.verdict and pair.outcome in ("off", "wrong")]
    assert sum(pair.outcome == "agrees" for pair in found) >= len(found) // 2


@pytest.mark.slow
@pytest.mark.parametrize("accuracy", ["balanced", "tight"])
@pytest.mark.parametrize("name", NAMES)
def test_no_derivative_of_a_shipped_scene_is_wrong(name: str, accuracy: str) -> None:
    found = list(study(name, 0.05, accuracy))
    assert not [each for each in found if each["kind"] == "differentiable" and each["outcome"] == "wrong"]
