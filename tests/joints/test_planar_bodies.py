"""Bodies that move in a plane: closed forms in planes of any direction, and what does not fit a plane."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from modelgen import Accuracy, simulate
from modelgen.errors import SceneError
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Scene
from tests.oracles.pieces import rotations
from tests.running import library_of

GRAVITY = np.array([1.0, -2.0, -9.81])


def thrown(normal: np.ndarray, velocity: np.ndarray, spin: np.ndarray, start: np.ndarray) -> Scene:
    """A body whose principal axes are askew to the normal."""
    body = make.planar(
        "slab", mass=2.0, inertia=[1.0, 2.0, 2.5], normal=list(normal), position=[0.1, 0.2, 0.3],
        axis_angle={"axis": list(start), "angle": 1.0}, velocity=list(velocity), angular_velocity=list(spin),
    )  # fmt: skip
    return make.scene("thrown", [body], gravity=list(GRAVITY))


@pytest.mark.parametrize("seed", range(4))
def test_a_planar_body_falls_along_its_plane_and_spins_about_the_normal(seed: int) -> None:
    """p = p_0 + v t + g t^2/2 with the parts of v and g in the plane, R = exp(w t n) R_0."""
    rng = np.random.default_rng(seed)
    normal, velocity, axis = rng.normal(size=(3, 3))
    n = normal / np.linalg.norm(normal)
    flat = np.eye(3) - np.outer(n, n)
    velocity = flat @ velocity
    path = simulate(
        library_of(thrown(normal, velocity, 3.0 * n, axis)),
        until=1.0, accuracy=Accuracy.tight(), estimate=False,
    )  # fmt: skip
    (k,) = [k for k, name in enumerate(path.body_names) if name == "slab"]
    t = path.t[:, None]
    expected = np.array([0.1, 0.2, 0.3]) + velocity * t + flat @ GRAVITY * t**2 / 2
    assert np.abs(path.p[:, k] - expected).max() < 1e-12
    start = Rotation.from_rotvec(axis / np.linalg.norm(axis)).as_matrix()
    turns = Rotation.from_rotvec(3.0 * t * n).as_matrix() @ start
    assert np.abs(rotations(path, k) - turns).max() < 1e-11
    assert path.joint_error_max < 1e-12


def test_what_leads_out_of_the_plane_is_left_out_with_a_warning() -> None:
    z = np.array([0.0, 0.0, 1.0])
    path = simulate(library_of(thrown(z, np.array([1.0, 0.0, 1.0]), z, z)), until=0.1, estimate=False)
    assert any("'world_slab_planar' by 1 m/s" in warning for warning in path.warnings)
    assert np.abs(path.p[:, path.body_names.index("slab"), 2] - 0.3).max() < 1e-14


def test_a_plane_has_a_normal() -> None:
    with pytest.raises(SceneError, match=r"normal: a normal of length zero"):
        make.planar("slab", mass=1.0, inertia=[1, 1, 1], normal=[0, 0, 0])
