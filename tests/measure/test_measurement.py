"""What a measurement says of itself: what it read, what it remembered, how it ended."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from modelgen import derive, emit, require
from modelgen.measure import cost
from modelgen.measure.motion import Bodies
from modelgen.measure.peers.setup import _solid
from modelgen.measure.tuning import tune
from modelgen.scene.types import Scene
from tests.measure.thrown import TEXT, thrown

FOLDED = f"fold = true\n{TEXT}"


@pytest.fixture(autouse=True)
def hasty(monkeypatch: pytest.MonkeyPatch) -> None:
    """Few repeats: what a run costs is not asked here."""
    monkeypatch.setattr(cost, "ENOUGH_S", 1e-3)
    monkeypatch.setattr(cost, "BRIEF_S", 0.0)


def test_folded_bodies_have_the_masses_that_they_have_otherwise() -> None:
    def told(scene: Scene) -> tuple[Bodies, np.ndarray]:
        sentence = emit(derive(require(scene))).manifest.sentence
        solid = _solid((), sentence["bodies"][0], [np.zeros(3), np.zeros(4), np.zeros(3), np.zeros(3)])
        return Bodies.of(sentence), np.array([solid.mass, *np.ravel(solid.inertia)])

    (plain, numbers), (folded, other) = told(thrown()), told(thrown(FOLDED))
    assert plain.mass == pytest.approx([0.7], rel=1e-15)
    assert folded == plain
    assert numbers[1::4] == pytest.approx([0.0028, 0.003, 0.0031], rel=1e-15)
    assert (numbers == other).all()


def test_a_folded_scene_is_measured_and_tuned(tmp_path: Path) -> None:
    scene = thrown(FOLDED, "folded")
    assert tune(scene, error=1e-6, knobs=["tolerance"], root=tmp_path).point.error <= 1e-6  # type: ignore[operator]
