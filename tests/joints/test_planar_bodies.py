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


def sliding(planar: bool, across: float, spin: float = 0.0) -> Scene:
    """An ellipsoid that slides, then rolls in its plane of symmetry, y = 0, kept there by a joint if it is
    `planar`; with a force across the plane, N."""
    kind = make.planar if planar else make.dynamic
    normal = {"normal": [0, 1, 0]} if planar else {}
    body = kind(
        "egg", make.ellipsoid(0.12, 0.09, 0.07), mass=1.2, inertia=[0.003, 0.0046, 0.0054],
        position=[0, 0, 0.07], velocity=[0.4, 0, 0], angular_velocity=[0, spin, 0], **normal,
    )  # fmt: skip
    load = {"force": [{"body": "egg", "force": ["0", f"{across}", "0"]}]} if across else {}
    contact = [{"between": ["egg", "table"], "friction": 0.3}]
    return make.scene("sliding", [make.fixed("table", make.plane()), body], contact=contact, **load)


@pytest.mark.parametrize("spin", [0.0, 2.0])
def test_a_planar_body_with_friction_moves_as_a_body_in_its_plane_of_symmetry(spin: float) -> None:
    """Friction across the plane, which the joint holds, is no unknown: the run is trusted as the other is."""
    runs = [
        simulate(library_of(sliding(planar, 0.0, spin)), until=0.8, accuracy="tight")
        for planar in (True, False)
    ]
    egg = [path.body_names.index("egg") for path in runs]
    assert "slip-stop" in [event.kind for event in runs[0].events]
    assert [e.kind for e in runs[0].events] == [e.kind for e in runs[1].events]
    assert [e.t for e in runs[0].events] == pytest.approx([e.t for e in runs[1].events], abs=1e-10)
    for quantity in ("p", "v", "w"):
        mine, other = (getattr(path, quantity)[:, k] for path, k in zip(runs, egg, strict=True))
        assert np.abs(mine - other).max() < 1e-9 * max(1.0, np.abs(other).max()), quantity
    for path in runs:
        assert path.redundant_max == 0
        assert path.estimate is not None
        assert path.estimate.uncertified == ()
        assert path.friction[:, 0, 1] == pytest.approx(0.0, abs=1e-9)


def test_a_load_across_the_plane_leaves_the_forces_open_and_not_the_motion() -> None:
    """The normal force is unique, and friction, within bounds that are known, leaves one motion: that without
    the load, which the joint can hold alone."""
    path, free = (simulate(library_of(sliding(True, across)), until=0.8) for across in (1.0, 0.0))
    assert path.redundant_max == 1
    assert path.is_trusted, path.doubts
    egg = path.body_names.index("egg")
    apart = np.linalg.norm(path.p[:, egg] - free.p[:, egg], axis=-1)
    assert (apart <= path.position_error + free.position_error).all()
