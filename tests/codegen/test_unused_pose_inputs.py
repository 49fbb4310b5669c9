"""The manifest names the poses and twists of a kernel that change no result, and no others."""

from __future__ import annotations

import numpy as np
import pytest

from modelgen.codegen.library import Library
from tests.running import scene_of

PARTS = {"rotation": slice(3, 12), "spin": slice(3, 6), "position": slice(0, 3), "velocity": slice(0, 3)}
CALLED = (
    "bouncing_ball",
    "ball_in_bowl",
    "linked_rings",
    "sphere_slide_to_roll",
    "double_pendulum",
    "gripper",
)


def values(library: Library, name: str, random: np.random.Generator) -> list[np.ndarray]:
    kernel = library.kernel(name)
    return [random.uniform(0.3, 1.0, shape).astype(library.dtype) for _, shape in kernel.inputs]


@pytest.mark.parametrize("scene", CALLED)
def test_an_input_that_is_said_to_be_unused_changes_nothing_and_every_other_something(scene: str) -> None:
    library, random = scene_of(scene), np.random.default_rng(0)
    for name in library.manifest.functions:
        kernel = library.kernel(name)
        for k, (given, (size,)) in enumerate(kernel.inputs):
            if not given.startswith(("pose", "twist")) or size not in (6, 12):
                continue
            parts = ("position", "rotation") if size == 12 else ("velocity", "spin")
            for part in parts:
                at = values(library, name, random)
                before = kernel(*at)
                at[k][PARTS[part]] += random.uniform(0.1, 0.2, at[k][PARTS[part]].shape)
                same = all(
                    np.array_equal(a, b, equal_nan=True) for a, b in zip(before, kernel(*at), strict=True)
                )
                said = given in kernel.unused or f"{part} of {given}" in kernel.unused
                assert same == said, (name, given, part)


def test_a_sphere_without_friction_ignores_how_it_is_turned() -> None:
    library = scene_of("bouncing_ball")
    assert "rotation of pose_f" in library.kernel("mg_plane_sphere_explicit_rates").unused
    assert "twist_f" in library.kernel("mg_plane_sphere_explicit_rates").unused
    turning = scene_of("sphere_slide_to_roll")
    (name,) = (name for name in turning.manifest.functions if name.endswith("_rates"))
    assert not any("spin" in part for part in turning.kernel(name).unused)
