"""Steady motions and the small motions about them: closed forms and runs."""

from __future__ import annotations

import numpy as np
import pytest

from modelgen import Accuracy, derive, linearise, linearise_steady, read, require, simulate, stability
from modelgen.errors import SimulationError
from modelgen.linearisation.steady_modes import LinearisedSteady
from modelgen.scene.read import read_text
from tests.oracles.pieces import G
from tests.running import SCENES, library_of

RADIUS, MASS = 0.1, 2.0

WHEEL = f"""
[[parameter]]
name = "speed"
value = 1.0
[[parameter]]
name = "about"
value = 0.0
[[parameter]]
name = "lean"
value = 0.0
[[body]]
name = "floor"
motion = "fixed"
shape = {{ kind = "plane" }}
[[body]]
name = "wheel"
shape = {{ kind = "circle", radius = {RADIUS} }}
mass = {MASS}
inertia = [{MASS * RADIUS**2 / 4}, {MASS * RADIUS**2 / 4}, {MASS * RADIUS**2 / 2}]
position = [0.0, "-{RADIUS}*sin(lean)", "{RADIUS}*cos(lean)"]
rpy = ["-pi/2 + lean", 0.0, 0.0]
velocity = ["speed", 0.0, 0.0]
angular_velocity = [0.0, "speed/{RADIUS}", "about"]
[[contact]]
between = ["wheel", "floor"]
friction = 10.0
"""
TOP = """
[[parameter]]
name = "spin"
value = 50.0
[[body]]
name = "top"
mass = 0.5
inertia = [2e-3, 2e-3, 6e-4]
position = [0.0, 0.0, 0.06]
angular_velocity = [0.0, 0.0, "spin"]
[[joint]]
name = "tip"
kind = "spherical"
between = ["world", "top"]
position = [0.0, 0.0, 0.0]
"""
GOVERNOR = """
[[parameter]]
name = "rate"
value = 9.0
[[body]]
name = "shaft"
mass = 1.0
inertia = [0.01, 0.01, 0.02]
position = [0.0, 0.0, 0.2]
angular_velocity = [0.0, 0.0, "rate"]
[[body]]
name = "bob"
motion = "dynamic"
mass = 0.8
inertia = [1e-3, 1e-3, 1e-3]
position = [0.18, 0.0, -0.24]
rpy = [0.0, "-atan(0.75)", 0.0]
velocity = [0.0, "0.18*rate", 0.0]
angular_velocity = [0.0, 0.0, "rate"]
[[joint]]
name = "bearing"
kind = "revolute"
between = ["world", "shaft"]
[[joint]]
name = "hinge"
kind = "revolute"
between = ["shaft", "bob"]
position = [0.0, 0.0, 0.0]
rpy = ["-pi/2", 0.0, 0.0]
"""


EGG = """
[[body]]
name = "bowl"
motion = "fixed"
shape = { kind = "paraboloid", radii = [0.3, 0.25] }
[[body]]
name = "egg"
shape = { kind = "ellipsoid", semi_axes = [0.06, 0.05, 0.04] }
density = 1000.0
position = [0.0, 0.0, 0.04]
[[contact]]
between = ["egg", "bowl"]
friction = 1.0
"""


def steady(text: str, **parameters: float) -> LinearisedSteady:
    scene = read_text(text)
    return linearise_steady(derive(require(scene)), library_of(scene), parameters=parameters)


@pytest.mark.parametrize("speed", [0.8, 0.5])
def test_a_wheel_that_rolls_straight_ahead_has_rouths_frequency(speed: float) -> None:
    """(A + m r^2) s^2 = m g r - C (C + m r^2) / A omega^2, A and C about a diameter and the axle: stable
    above v^2 = g r / 3. Source: E. J. Routh, Advanced Rigid Dynamics (1905), art. 244."""
    found = steady(WHEEL, speed=speed)
    across, axial, path = MASS * RADIUS**2 / 4, MASS * RADIUS**2 / 2, MASS * RADIUS**2
    square = MASS * G * RADIUS - axial * (axial + path) / across * (speed / RADIUS) ** 2
    expected = np.emath.sqrt(square / (across + path))
    moving = [value for value in found.eigenvalues if value]
    assert sorted(np.abs(moving)) == pytest.approx([abs(expected)] * 2, rel=1e-11)
    assert np.isreal(moving).all() == (square > 0)
    assert (found.growth > 0) == (square > 0)
    assert found.symmetries == 4


def test_the_least_speed_of_a_wheel_is_found_though_nothing_dissipates() -> None:
    scene = read_text(WHEEL)
    found = stability(derive(require(scene)), library_of(scene), "speed", [0.5, 0.6])
    ((least, last),) = found.stable
    assert least == pytest.approx(np.sqrt(G * RADIUS / 3), rel=1e-7)
    assert last == 0.6


def test_a_wheel_that_circles_keeps_its_lean_and_height_in_a_run() -> None:
    """A run from the steady motion, once round: v and w turn about the vertical, p goes round a circle."""
    found = steady(WHEEL, speed=0.9, about=-4.0, lean=-0.35)
    given = {
        name: [float(x) for x in getattr(found, name)["wheel"]] for name in ("p", "quaternion", "v", "w")
    }
    text = WHEEL[WHEEL.index("[[body]]") : WHEEL.index("position = ")] + (
        f"position = {given['p']}\nquaternion = {given['quaternion']}\n"
        f"velocity = {given['v']}\nangular_velocity = {given['w']}\n[[contact]]"
        + WHEEL.split("[[contact]]")[1]
    )
    path = simulate(library_of(read_text(text)), until=1.5, accuracy=Accuracy.tight())
    assert path.is_trusted
    at = path.body_names.index("wheel")
    assert np.ptp(path.p[:, at, 2]) < 1e-11
    assert np.ptp(path.w[:, at, 2]) < 1e-9
    assert abs(given["p"][1]) > 0.01  # it leans


@pytest.mark.parametrize("spin", [30.0, 60.0])
def test_a_sleeping_top_precesses_at_its_two_rates(spin: float) -> None:
    """A n^2 - C spin n + m g l = 0 with A about the tip: n real above a spin, as seen by axes at rest."""
    found = steady(TOP, spin=spin)
    across, axial = 2e-3 + 0.5 * 0.06**2, 6e-4
    rates = np.roots([across, -axial * spin, 0.5 * G * 0.06])
    expected = np.sort_complex(np.array([0.0, *(1j * rates), *(-1j * rates.conj())], dtype=complex))
    assert np.abs(np.sort(np.abs(found.eigenvalues)) - np.sort(np.abs(expected))).max() < 1e-9
    assert found.growth == pytest.approx(np.abs(rates.imag).max(), abs=1e-9)


def test_the_arm_of_a_governor_swings_under_a_conserved_moment_of_momentum() -> None:
    """Reduced by the moment of momentum p = I(angle) rate: V = p^2 / (2 I(angle)) - m g h cos(angle)."""
    found = steady(GOVERNOR)
    h, mass, own, shaft = 0.3, 0.8, 1e-3, 0.02
    angle = float(np.arctan2(found.p["bob"][0], -found.p["bob"][2]))
    rate = found.w["shaft"][2]
    assert rate**2 == pytest.approx(mass * G * h / (mass * h**2 * np.cos(angle)), rel=1e-9)
    inertia = shaft + own + mass * h**2 * np.sin(angle) ** 2
    slope = mass * h**2 * np.sin(2 * angle)
    bend = 2 * mass * h**2 * np.cos(2 * angle)
    stiff = rate**2 * (slope**2 / inertia - bend / 2) + mass * G * h * np.cos(angle)
    frequencies = [mode.frequency for mode in found.modes if mode.frequency]
    assert frequencies == pytest.approx([np.sqrt(stiff / (own + mass * h**2))], rel=1e-9)


def test_an_equilibrium_is_a_steady_motion() -> None:
    """An egg that rocks without slip on a bowl."""
    scene = read_text(EGG)
    derivation, library = derive(require(scene)), library_of(scene)
    rest, motion = linearise(derivation, library), linearise_steady(derivation, library)
    found = [mode.frequency for mode in motion.modes if mode.frequency]
    assert found == pytest.approx(rest.frequencies, rel=1e-9)
    assert motion.force == pytest.approx(rest.force)


def test_a_pendulum_that_hangs_is_steady_though_its_symmetry_does_nothing_there() -> None:
    """A turn about the vertical moves a ball aside of its lowest place only: both swings remain."""
    scene = read(SCENES / "ball_in_bowl.toml")
    found = linearise_steady(derive(require(scene)), library_of(scene))
    assert found.symmetries == 0
    assert np.abs(found.eigenvalues) == pytest.approx([np.sqrt(G / 0.02)] * 4, rel=1e-9)


@pytest.mark.slow
def test_a_rattleback_that_spins_the_other_way_has_its_eigenvalues_negated() -> None:
    """Time reversed: what grows about one sense of spin dies out about the other."""
    text = (SCENES / "rattleback.toml").read_text()
    other = text.replace("[0.0, 0.0, -3.0]", "[0.0, 0.0, 3.0]").replace(
        "[0.0020236863145688283, 0.11703417837342656, 0.0]",
        "[-0.0020236863145688283, -0.11703417837342656, 0.0]",
    )
    one, reversed_ = (steady(each) for each in (text, other))
    assert one.growth > 1e-3
    assert np.sort_complex(-reversed_.eigenvalues) == pytest.approx(one.eigenvalues, rel=1e-8, abs=1e-7)


def test_values_without_a_steady_motion_are_kept_as_refused() -> None:
    """A wheel that circles needs more friction than some floors have."""
    grip = '[[parameter]]\nname = "grip"\nvalue = 1.0\n' + WHEEL.replace(
        "friction = 10.0", 'friction = "grip"'
    )
    scene, turning = read_text(grip), {"speed": 0.9, "about": -4.0, "lean": -0.35}
    found = stability(
        derive(require(scene)), library_of(scene), "grip", [0.1, 0.14, 0.2, 0.3], parameters=turning
    )
    assert [value for value, _ in found.refused] == [0.1, 0.14]
    assert "times its static friction" in found.refused[0][1]
    assert found.stable == ((0.2, 0.3),)
    assert [len(each) for each in found.eigenvalues] == [0, 0, 4, 4]


def test_what_speeds_up_for_ever_is_refused() -> None:
    text = """
    [[body]]
    name = "stone"
    mass = 1.0
    inertia = [1.0, 1.0, 1.0]
    """
    with pytest.raises(SimulationError, match="no steady motion near the start"):
        steady(text)


def test_loads_that_depend_on_time_are_refused() -> None:
    push = '[[force]]\nbody = "wheel"\nforce = ["sin(t)", "0", "0"]\n'
    with pytest.raises(SimulationError, match="depend on time"):
        steady(WHEEL + push)
