"""Small motions about an equilibrium: closed forms, and runs along each mode."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.spatial.transform import Rotation

from modelgen import Accuracy, derive, linearise, read, require, simulate
from modelgen.errors import ModelgenError, SimulationError
from modelgen.linearisation.admissible_contact_forces import least_pressing
from modelgen.linearisation.equilibrium_and_modes import Linearised
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Scene
from tests.oracles.pieces import TABLE, G, ball
from tests.running import SCENES, library_of

SMALL = 1e-6  # m/s or rad/s at the start of a run along a mode


def shipped(name: str) -> Scene:
    return read(SCENES / f"{name}.toml")


def linear(scene: Scene) -> Linearised:
    return linearise(derive(require(scene)), library_of(scene))


def standing(*size: float) -> Scene:
    """An ellipsoid at rest on the end of its third axis."""
    a, b, c = size
    inertia = [0.2 * (b * b + c * c), 0.2 * (a * a + c * c), 0.2 * (a * a + b * b)]
    egg = make.dynamic("egg", make.ellipsoid(a, b, c), mass=1.0, inertia=inertia, position=[0, 0, c])
    return make.scene("standing", [TABLE, egg], contact=[{"between": ["egg", "table"]}])


def test_a_ball_in_a_bowl_swings_as_a_pendulum_of_the_difference_of_radii() -> None:
    found = linear(shipped("ball_in_bowl"))
    assert found.frequencies == pytest.approx([np.sqrt(G / 0.02)] * 2, rel=1e-12)
    assert found.force == pytest.approx({"ball-bowl": G}, rel=1e-12)
    assert found.p["ball"] == pytest.approx([0, 0, -0.02], abs=1e-12)


def test_an_ellipsoid_rocks_about_rest_that_is_found_from_a_tilted_start() -> None:
    """w^2 = m g (rho - c)/I with rho = a^2/c: the frictionless contact point runs along."""
    found = linear(shipped("ellipsoid_on_plane"))
    assert found.frequencies == pytest.approx([13.1332980048, 18.5717844298], rel=1e-10)
    assert [mode.kind for mode in found.modes].count("neutral") == 3
    assert found.p["egg"][2] == pytest.approx(0.07, abs=1e-12)


def test_linked_rings_swing_as_the_double_pendulum_and_the_ring_across() -> None:
    R, r, m, A = 0.2, 0.15, 0.3, 0.003375
    M = m * np.array([[R**2, R * r], [R * r, r**2 + A / m]])
    along = eigh(m * G * np.diag([R, r]), M, eigvals_only=True)
    expected = np.sort(np.sqrt([*along, G / r]))
    found = linear(shipped("linked_rings"))
    assert found.frequencies == pytest.approx(expected, rel=1e-12)
    assert found.modes[-1].hertz == pytest.approx(expected[-1] / (2 * np.pi), rel=1e-12)


def test_a_peg_lies_in_its_hole_on_two_rims() -> None:
    """Across: a pendulum of length b - r; turning: its ends climb, w^2 = m g L^2/(4 (b - r) I)."""
    found = linear(shipped("peg_in_hole"))
    inertia = (3 * 0.04**2 + 0.2**2) / 12
    assert found.frequencies == pytest.approx(
        [np.sqrt(G / 0.02), np.sqrt(G * 0.2**2 / (4 * 0.02 * inertia))], rel=1e-9
    )
    assert list(found.force.values()) == pytest.approx([sum(found.force.values()) / 2] * 2, rel=1e-9)


def test_an_ellipsoid_on_its_tip_falls_with_its_own_rate() -> None:
    a, b, c = 0.05, 0.06, 0.1
    found = linear(standing(a, b, c))
    rates = [np.sqrt(G * (c - w * w / c) / (0.2 * (w * w + c * c))) for w in (a, b)]
    assert sorted(mode.growth for mode in found.modes if mode.kind == "growth") == pytest.approx(
        sorted(rates)
    )
    assert sorted(-mode.growth for mode in found.modes if mode.kind == "decay") == pytest.approx(
        sorted(rates)
    )
    assert found.p["egg"].tolist() == [0, 0, c]


def test_a_spring_with_a_damper_dies_out_as_its_closed_form() -> None:
    m, k, c = 2.0, 50.0, 3.0
    post = make.fixed("post", make.sphere(0.01), position=[0, 0, 1.0])
    spring = {
        "between": ["post", "bob"], "anchors": [[0, 0, 0], [0, 0, 0]], "stiffness": k, "damping": c,
        "rest_length": 0.5,
    }  # fmt: skip
    bob = ball("bob", [0, 0, 0.2], mass=m)
    found = linear(make.scene("bob", [post, bob], spring=[spring]))
    (damped,) = [mode for mode in found.modes if mode.growth]
    assert damped.growth == pytest.approx(-c / (2 * m), rel=1e-9)
    assert damped.frequency == pytest.approx(np.sqrt(k / m - (c / (2 * m)) ** 2), rel=1e-9)
    swings = [mode.frequency for mode in found.modes if not mode.growth]
    length = 0.5 + m * G / k
    assert swings == pytest.approx([np.sqrt(G / length)] * 2, rel=1e-9)
    assert found.p["bob"] == pytest.approx([0, 0, 1.0 - length], abs=1e-9)


@pytest.mark.cases(2)
@pytest.mark.parametrize("name", ["linked_rings", "helix_on_cylinder", "user_surface", "ellipsoid_in_cavity"])
def test_a_run_along_a_mode_stays_on_it_with_its_frequency(name: str) -> None:
    """From the equilibrium with u = SMALL shape, p - p0 = SMALL shape sin(w t)/w up to the second order."""
    scene = shipped(name)
    found = linear(scene)
    (body,) = found.p
    index = [each.name for each in scene.bodies].index(body)
    turn = Rotation.from_quat(np.roll(found.quaternion[body], -1))
    origin = found.p[body] - turn.apply(require(scene).bodies[index].centre_of_mass)
    for mode in found.modes:
        if mode.kind != "oscillation":
            continue
        shape = np.real(mode.shape) * SMALL / np.abs(mode.shape).max()
        start = replace(
            scene.bodies[index], velocity=tuple(shape[:3]), angular_velocity=tuple(turn.apply(shape[3:])),
            pose=replace(scene.bodies[index].pose, position=tuple(origin),
                         quaternion=tuple(found.quaternion[body])),
        )  # fmt: skip
        moved = replace(scene, bodies=tuple(start if k == index else b for k, b in enumerate(scene.bodies)))
        path = simulate(library_of(moved), until=10 / mode.frequency, samples=50, accuracy=Accuracy.tight())
        swing = np.outer(np.sin(mode.frequency * path.t) / mode.frequency, shape[:3])
        size = np.abs(shape).max() / mode.frequency
        assert np.abs(path.p[:, index] - found.p[body] - swing).max() < 1e-5 * size


def test_modes_are_normal_to_one_another_by_the_mass() -> None:
    found = linear(shipped("ellipsoid_in_cavity"))
    shapes = np.array([mode.shape for mode in found.modes])
    assert shapes @ found.mass @ shapes.T == pytest.approx(np.eye(len(shapes)), abs=1e-12)
    assert found.motions.T @ found.mass @ found.motions == pytest.approx(np.eye(len(shapes)), abs=1e-12)


CORNERS = tuple((s, t) for s in (-1, 1) for t in (-1, 1))


def stool(off: float = 0.0) -> Scene:
    """A body on four round feet at (+-0.15, +-0.1) m, with its centre of mass off the middle."""
    feet = [
        make.sphere(0.02, name=f"foot{k}", position=[0.15 * s, 0.1 * t, 0.0])
        for k, (s, t) in enumerate(CORNERS)
    ]
    stool = make.dynamic(
        "stool", *feet, mass=2.0, inertia=[0.1, 0.2, 0.3], position=[0, 0, 0.02],
        center_of_mass=[0.3 * off, 0.05 * off, 0.1],
    )  # fmt: skip
    pairs = [{"between": [f"stool/foot{k}", "table"]} for k in range(4)]
    return make.scene("stool", [TABLE, stool], contact=pairs)


def test_neutral_motions_are_those_of_single_coordinates_where_they_can_be() -> None:
    """A frictionless stool slides along x, along y, and turns about z."""
    found = linear(stool())
    assert [mode.kind for mode in found.modes] == ["neutral"] * 3
    shapes = [mode.shape / np.abs(mode.shape).max() for mode in found.modes]
    assert np.abs(shapes) == pytest.approx(np.eye(6)[[0, 1, 5]], abs=1e-9)


def test_a_damper_leaves_the_neutral_motions_and_their_number() -> None:
    """A bob on a damper in the plane x-z of a table: free along x and y, and it comes to rest nowhere."""
    post = make.fixed("post", make.sphere(0.01), position=[0, 0, 3.0])
    damper = {"between": ["post", "egg"], "stiffness": 0.0, "damping": 2.0}
    scene = replace(standing(0.12, 0.09, 0.07), name="damped")
    built = make.scene(
        "damped", [*scene.bodies, post], contact=[{"between": ["egg", "table"]}], spring=[damper]
    )
    free, damped = linear(scene), linear(built)
    assert (
        [m.kind for m in damped.modes].count("neutral") == [m.kind for m in free.modes].count("neutral") == 3
    )
    assert damped.frequencies == pytest.approx(free.frequencies, rel=1e-9)


def test_equal_frequencies_have_shapes_along_the_coordinates() -> None:
    """A ball in a bowl swings along x and along y with one frequency, and turns as it likes."""
    found = linear(shipped("ball_in_bowl"))
    swings = [np.abs(mode.shape[:3]) for mode in found.modes if mode.frequency]
    assert [swing / swing.max() for swing in swings] == pytest.approx(np.eye(3)[:2], abs=1e-6)


@pytest.mark.parametrize("off", [0.0, 0.1, 0.3])
def test_forces_of_four_feet_have_minimum_norm(off: float) -> None:
    """f = W/4 (1 + 2 off s + off t/2) at (s, t) balances the moments, and lies in the rows' space."""
    found = linear(stool(off))
    assert found.redundant == 1
    expected = [2 * G / 4 * (1 + 2 * off * s + 0.5 * off * t) for s, t in CORNERS]
    assert list(found.force.values()) == pytest.approx(expected, rel=1e-9)


def test_a_least_force_that_would_pull_is_zero_and_the_others_are_least() -> None:
    """Far off the middle: one foot carries nothing, and three carry what their moments say."""
    found = linear(stool(0.45))
    force = np.array(list(found.force.values()))
    s, t = np.array(CORNERS).T
    assert force[0] == pytest.approx(0.0, abs=1e-9)
    assert np.array([force.sum(), force @ s, force @ t]) == pytest.approx(2 * G * np.array([1, 0.9, 0.225]))
    assert force[1:].min() > 0


@pytest.mark.parametrize("seed", range(20))
def test_least_pressing_forces_meet_their_optimality(seed: int) -> None:
    """f >= 0, A f = b, and f - A^T y >= 0 with f across it for some y."""
    rng = np.random.default_rng(seed)
    A = rng.normal(size=(3, 8))
    b = A @ np.maximum(rng.normal(size=8), 0.0)
    f = least_pressing(A, b)
    assert np.abs(A @ f - b).max() < 1e-9
    assert f.min() >= 0
    y = np.linalg.lstsq(A[:, f > 1e-9].T, f[f > 1e-9], rcond=None)[0]
    assert np.abs(A[:, f > 1e-9].T @ y - f[f > 1e-9]).max() < 1e-7
    assert (A[:, f <= 1e-9].T @ y).max(initial=0.0) < 1e-7


@pytest.mark.cases(2)
@pytest.mark.parametrize("name", ["bouncing_ball", "ellipsoid_on_ellipsoid", "disc_on_rim", "coin_in_bowl"])
def test_without_an_equilibrium_near_the_start_it_is_refused(name: str) -> None:
    with pytest.raises(SimulationError, match="no equilibrium near the start"):
        linear(shipped(name))


def test_a_driven_body_is_refused() -> None:
    lift = make.driven("lift", make.plane(), path={"position": ["0", "0", "0.01*sin(t)"]})
    scene = make.scene("lifted", [lift, ball("b", [0, 0, 0.1])], contact=[{"between": ["b", "lift"]}])
    with pytest.raises(SimulationError, match=r"lift.*driven"):
        linear(scene)


def test_a_wrong_argument_is_refused() -> None:
    with pytest.raises(ModelgenError, match="linearise"):
        linearise("scenes/ball_in_bowl.toml", None)  # type: ignore[arg-type]
