"""A scene in a mirror moves as the mirror image of the scene, within the errors that both runs state."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from modelgen import simulate
from modelgen.scene.scene_from_tables import scene_from_tables
from tests.benchmarks.scene_twins import mirrored
from tests.benchmarks.verdict_scenes.parts import body, contact, ground, row, scene
from tests.benchmarks.verdicts import ROUNDED, TWINS, judged
from tests.running import library_of


@pytest.mark.cases(12)
@given(st.integers(0, 2**32 - 1))
def test_a_box_that_strikes_a_floor_with_a_face_while_it_spins(seed: int) -> None:
    """Forces on four corners are not unique, and how they are shared decides how much spin is left."""
    random = np.random.default_rng(seed)
    size, friction = random.uniform(0.02, 0.1, 3), random.uniform(0.1, 0.6)
    thrown: dict[str, Any] = {
        "velocity": row([*random.uniform(-1, 1, 2), 0.0]),
        "angular_velocity": row([0.0, 0.0, random.uniform(-8, 8)]),
        "rpy": row([0.0, 0.0, random.uniform(-3, 3)]),
    }
    box = body("box", {"kind": "box", "size": row(size)}, [0, 0, size[2]], **thrown)
    tables = scene([ground(), box], [contact("floor", "box", friction, 0.3)], 0.5)
    twin = mirrored(tables)
    path, other = (simulate(library_of(scene_from_tables("s", t, "<s>"))) for t in (tables, twin.tables))
    assume(path.is_trusted)
    where = path.body_names.index("box")
    apart = np.linalg.norm(twin.positions(path.p[:, where]) - other.p[:, where], axis=-1)
    assert (apart <= path.position_error + other.position_error + ROUNDED).all()
    turned = twin.quaternions(path.quaternion[:, where])
    chord = np.minimum(
        *(np.linalg.norm(turned + sign * other.quaternion[:, where], axis=-1) for sign in (1, -1))
    )
    assert path.estimate is not None
    assert other.estimate is not None
    assert (2 * chord <= path.estimate.rotation + other.estimate.rotation + ROUNDED).all()


@pytest.mark.parametrize("seed", [16, 18])
def test_boxes_that_tumble_onto_a_face(seed: int) -> None:
    found = judged("mixed sizes and masses", seed, ["mirrored"])
    assert set(found.apart) <= set(TWINS)
    assert found.verdict != "trusted" or found.apart["mirrored"] <= 1
