"""Small motions about contacts that stick: rocking in closed form, the compiled equations, and refusals."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from jsonschema import Draft202012Validator
from rich.console import Console
from scipy.spatial.transform import Rotation

from modelgen import Accuracy, derive, linearise, read, require, simulate
from modelgen.errors import SimulationError
from modelgen.linearisation.equilibrium_and_modes import Linearised
from modelgen.report.linearisation_output import mode_facts, print_modes
from modelgen.report.linearisation_schema import linearised_schema
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Body, Scene
from tests.oracles.differenced_motion import differenced, exponents
from tests.oracles.pieces import TABLE, G, ball
from tests.running import SCENES, library_of

SMALL = 1e-6  # m/s or rad/s at the start of a run along a mode
INERTIA = [[2e-3, 3e-4, 1e-4], [3e-4, 3e-3, -2e-4], [1e-4, -2e-4, 4e-3]]
PLAIN = [[2e-3, 0.0, 0.0], [0.0, 3e-3, 0.0], [0.0, 0.0, 4e-3]]
AXES = (0.12, 0.09, 0.07)


def linear(scene: Scene) -> Linearised:
    return linearise(derive(require(scene)), library_of(scene))


def stone(
    axes: Sequence[float] = AXES,
    low: Sequence[float] = (0.0, 0.0, -0.02),
    inertia: Sequence[Sequence[float]] = PLAIN,
    turned: float = 0.0,
    **keys: object,
) -> Body:
    """An ellipsoid, turned about z, on z = 0 at the origin, with its centre of mass `low` off its middle."""
    about = {"axis": [0.0, 0.0, 1.0], "angle": turned}
    shape = make.ellipsoid(*axes, position=[-x for x in low], axis_angle=about)
    where = [low[0], low[1], axes[2] + low[2]]
    # full inertia, whatever the numbers: one library for all stones
    tilted = np.array(inertia) + 1e-12 * (np.ones((3, 3)) - np.eye(3))
    return make.dynamic("stone", shape, mass=1.0, inertia=tilted.tolist(), position=where, **keys)


def on(table: Body, body: Body, down: Sequence[float] = (0, 0, -G), friction: float = 9.0) -> Scene:
    contact = [{"between": ["stone", "table"], "friction": friction}]
    name = f"stone_on_{table.shapes[0].kind}"
    return make.scene(name, [table, body], contact=contact, gravity=list(down))


def slope(angle: float) -> tuple[float, float, float]:
    return G * np.sin(angle), 0.0, -G * np.cos(angle)


def bowl(x: float, y: float) -> Body:
    """Radii of curvature at its lowest point; negative: convex there."""
    return make.fixed("table", make.paraboloid(x, y))


@pytest.mark.parametrize("low", [0.02, 0.06])
@pytest.mark.parametrize("radii", [None, (0.5, 0.4), (0.5, -0.4), (-0.3, -0.2)])
def test_a_stone_rocks_by_its_curvature_past_the_ground_s(
    radii: tuple[float, float] | None, low: float
) -> None:
    """w^2 = m g (1/(k - k_ground) - h)/(I + m h^2) in each principal plane; below 0: it falls that fast."""
    axes = (0.12, 0.09, 0.07)
    found = linear(on(bowl(*radii) if radii else TABLE, stone(axes, (0.0, 0.0, -low))))
    h, ground = axes[2] - low, [1 / r for r in radii] if radii else [0.0, 0.0]
    square = [
        G * (1 / (axes[2] / axes[k] ** 2 - ground[k]) - h) / (PLAIN[1 - k][1 - k] + h * h) for k in range(2)
    ]
    rates = sorted(np.emath.sqrt(-np.array(square)), key=abs)
    swings = sorted(abs(rate) for rate, w2 in zip(rates, sorted(square, key=abs), strict=True) if w2 > 0)
    falls = sorted(abs(rate) for rate, w2 in zip(rates, sorted(square, key=abs), strict=True) if w2 < 0)
    assert found.frequencies == pytest.approx(swings, rel=1e-8)
    assert sorted(m.growth for m in found.modes if m.growth > 0) == pytest.approx(falls, rel=1e-8)
    assert [mode.kind for mode in found.modes].count("neutral") == 1
    assert list(found.force.values()) == pytest.approx([G])
    assert [each.share for each in found.friction.values()] == pytest.approx([0.0], abs=1e-9)


def rattleback() -> Scene:
    return replace(read(SCENES / "rattleback.toml"), name="stone_on_plane")


def test_a_rattleback_rocks_with_the_two_frequencies_of_its_skew_inertia() -> None:
    """At rest, from a tilted start: det(K - w^2 M) = 0, M and K of the angles about x and y at its foot."""
    a, b, c, h = 0.2, 0.03, 0.02, 0.01
    mass = np.array([[2e-4 + h * h, -2e-5], [-2e-5, 16e-4 + h * h]])
    stiff = G * np.diag([b * b / c - h, a * a / c - h])
    found = linear(rattleback())
    expected = np.sqrt(np.sort(np.linalg.eigvals(np.linalg.solve(mass, stiff)).real))
    assert found.frequencies == pytest.approx(expected, rel=1e-9)
    assert found.p["stone"][2] == pytest.approx(h, abs=1e-11)


LEANING = on(TABLE, stone(AXES, (0.007, 0.016, -0.013), INERTIA), down=(-1.3, 0.9, -G))


@pytest.mark.parametrize("scene", [rattleback(), LEANING], ids=["rattleback", "leaning"])
def test_a_run_along_a_mode_stays_on_it(scene: Scene) -> None:
    """From the equilibrium with u = SMALL shape, p - p0 = SMALL shape sin(w t)/w up to the second order."""
    found = linear(scene)
    (index,) = [k for k, body in enumerate(scene.bodies) if body.name == "stone"]
    turn = Rotation.from_quat(np.roll(found.quaternion["stone"], -1))
    origin = found.p["stone"] - turn.apply(require(scene).bodies[index].centre_of_mass)
    for mode in found.modes:
        if mode.kind != "oscillation":
            continue
        shape = np.real(mode.shape) * SMALL / np.abs(mode.shape).max()
        start = replace(
            scene.bodies[index], velocity=tuple(shape[:3]), angular_velocity=tuple(turn.apply(shape[3:])),
            pose=replace(scene.bodies[index].pose, position=tuple(origin),
                         quaternion=tuple(found.quaternion["stone"])),
        )  # fmt: skip
        moved = replace(scene, bodies=tuple(start if k == index else b for k, b in enumerate(scene.bodies)))
        path = simulate(library_of(moved), until=10 / mode.frequency, samples=50, accuracy=Accuracy.tight())
        swing = np.outer(np.sin(mode.frequency * path.t) / mode.frequency, shape[:3])
        size = np.abs(shape[:3]).max() / mode.frequency
        assert np.abs(path.p[:, index] - found.p["stone"] - swing).max() < 1e-4 * size


@pytest.mark.slow
def test_a_rod_on_two_balls_swings_in_a_trough_as_one_roller() -> None:
    """w^2 = g/((R - r)(1 + I/(m r^2))); along itself the rod is held twice, which changes no motion."""
    r, R, m, inertia = 0.05, 0.3, 1.3, 0.002
    ends = [make.sphere(r, name=name, position=[0, y, 0]) for name, y in (("a", 0.1), ("b", -0.1))]
    across = {"axis": [1.0, 0.0, 0.0], "angle": np.pi / 2}
    trough = make.fixed("trough", make.cylinder(R, cavity=True, axis_angle=across))
    rod = make.dynamic("rod", *ends, mass=m, inertia=[0.01, inertia, 0.01], position=[0, 0, r - R])
    pairs = [{"between": [f"rod/{end}", "trough"], "friction": 0.5} for end in "ab"]
    found = linear(make.scene("trough", [trough, rod], contact=pairs))
    assert found.redundant == 1
    assert found.frequencies == pytest.approx([np.sqrt(G / ((R - r) * (1 + inertia / (m * r * r))))])


def test_a_stone_that_leans_on_its_friction_has_a_stiffness_without_symmetry() -> None:
    """Its centre of mass is above its foot along gravity, which friction and N balance."""
    found = linear(LEANING)
    K = found.stiffness
    assert np.abs(K - K.T).max() > 0.1 * np.abs(K).max()
    assert found.friction["stone-table"].force == pytest.approx([-1.3, 0.9, 0.0], abs=1e-9)
    assert found.friction["stone-table"].share == pytest.approx(np.hypot(1.3, 0.9) / G / 9.0)


def random_stone(seed: int, curved: bool) -> Scene:
    """At rest, stable or not: its centre of mass is above its foot along gravity."""
    rng = np.random.default_rng(seed)
    axes, down = rng.uniform(0.06, 0.15, 3), np.array([*rng.normal(scale=1.5, size=2), -G])
    turn = Rotation.random(rng=rng).as_matrix()
    inertia = turn @ np.diag([2e-3, 3e-3, 4e-3]) @ turn.T
    low = -rng.uniform(0.2, 1.5) * axes[2] / G * down - [0, 0, axes[2]]
    ground = bowl(*rng.choice([-1, 1], 2) * rng.uniform(0.4, 1.0, 2)) if curved else TABLE
    return on(ground, stone(axes, low, inertia, turned=rng.uniform(-3, 3)), down=list(down))


def assert_as_differenced(scene: Scene) -> Linearised:
    found = linear(scene)
    expected = exponents(found)
    assert differenced(library_of(scene), found) == pytest.approx(expected, abs=1e-5 * np.abs(expected).max())
    return found


@pytest.mark.parametrize("seed", range(6))
def test_a_random_stone_has_the_eigenvalues_of_the_compiled_equations(seed: int) -> None:
    assert_as_differenced(random_stone(seed, curved=seed % 2 == 1))


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(100, 400))
def test_many_random_stones_have_the_eigenvalues_of_the_compiled_equations(seed: int) -> None:
    assert_as_differenced(random_stone(seed, curved=seed % 2 == 1))


@pytest.mark.slow
@pytest.mark.parametrize("damping", [0.3, 2.0, 40.0])
def test_a_damped_stone_that_leans_has_the_eigenvalues_of_the_compiled_equations(damping: float) -> None:
    spring = {
        "between": ["post", "stone"], "anchors": [[0, 0, 0], [0.01, 0.02, 0.03]], "stiffness": 3.0,
        "damping": damping, "rest_length": 0.3,
    }  # fmt: skip
    post = make.fixed("post", make.sphere(0.01), position=[0.1, 0.2, 0.5])
    contact = [{"between": ["stone", "table"], "friction": 9.0}]
    bodies = [*LEANING.bodies, post]
    scene = make.scene("damped", bodies, contact=contact, gravity=[-1.3, 0.9, -G], spring=[spring])
    assert any(mode.growth for mode in assert_as_differenced(scene).modes)


def test_a_stone_on_a_slope_that_is_too_smooth_is_refused_with_what_it_lacks() -> None:
    scene = on(TABLE, stone(AXES, (0, 0, -0.03), INERTIA), slope(0.05), friction=0.02)
    with pytest.raises(SimulationError, match=r"stone-table.*would slip") as refused:
        linear(scene)
    assert f"takes {np.tan(0.05) / 0.02:.6g} times its static friction" in str(refused.value)


def test_a_stone_without_rest_is_refused() -> None:
    """No point of a ball can stand above its foot along gravity on a slope."""
    scene = on(TABLE, stone((0.1, 0.1, 0.1), (0, 0, -1e-3)), slope(0.2))
    with pytest.raises(SimulationError, match="no equilibrium near the start"):
        linear(scene)


def test_slip_at_the_start_is_refused() -> None:
    scene = on(TABLE, stone(velocity=[0.3, 0.0, 0.0]))
    with pytest.raises(SimulationError, match=r"stone-table.*slips at the start, at 0.3 m/s"):
        linear(scene)


def test_a_contact_without_force_is_refused() -> None:
    with pytest.raises(SimulationError, match=r"stone-table.*presses with no force"):
        linear(on(TABLE, stone(), (0, 0, 0)))


def test_a_rolling_start_is_linearised_at_rest() -> None:
    scene = on(TABLE, stone(angular_velocity=[0.0, 1.0, 0.0], velocity=[AXES[2] - 0.02, 0.0, 0.0]))
    assert linear(scene).frequencies == pytest.approx(linear(on(TABLE, stone())).frequencies)


def block(friction: float) -> Scene:
    box = make.dynamic("block", make.box(0.2, 0.1, 0.05), density=1000.0, position=[0, 0, 0.025])
    contact = [{"between": ["block", "table"], "friction": friction}]
    return make.scene("block", [TABLE, box], contact=contact, gravity=list(slope(0.3)))


def test_a_block_on_a_slope_is_held_by_its_face_and_says_so() -> None:
    """m g cos(a) and m g sin(a) are shared by its corners; no motion is left."""
    found = linear(block(0.5))
    assert found.modes == ()
    assert sum(found.force.values()) == pytest.approx(G * np.cos(0.3))
    assert sum(each.force for each in found.friction.values()) == pytest.approx(
        [G * np.sin(0.3), 0, 0], abs=1e-9
    )
    console = Console(width=200)
    with console.capture() as text:
        print_modes(mode_facts(found), console)
    assert "no small motions: what touches holds all bodies" in text.get()
    assert "of what holds" in text.get()
    Draft202012Validator(linearised_schema()).validate(mode_facts(found))


@pytest.mark.parametrize("spare", [1.001, 0.999, 0.5])
def test_the_face_of_a_block_holds_up_to_the_angle_of_friction(spare: float) -> None:
    """Forces of minimum norm would let its upper corners slip before."""
    scene = block(spare * np.tan(0.3))
    if spare > 1:
        assert max(each.share for each in linear(scene).friction.values()) <= 1
        return
    with pytest.raises(SimulationError, match="would slip") as refused:
        linear(scene)
    factor = float(str(refused.value).split("takes ")[1].split()[0])
    assert factor == pytest.approx(1 / spare, rel=1e-4)


@pytest.mark.parametrize("resistance", [0.03, 0.01])
def test_a_ball_on_a_slope_is_held_by_rolling_resistance_alone(resistance: float) -> None:
    """m g sin(a) r against resistance m g cos(a); about the normal it turns as it likes."""
    contact = [{"between": ["ball", "table"], "friction": 0.5, "rolling_resistance": resistance}]
    scene = make.scene("held", [TABLE, ball("ball", [0, 0, 0.1])], contact=contact, gravity=list(slope(0.2)))
    needed = 0.1 * np.tan(0.2) / resistance
    if needed < 1:
        found = linear(scene)
        assert [mode.kind for mode in found.modes] == ["neutral"]
        assert found.friction["ball-table"].share == pytest.approx(needed)
        return
    with pytest.raises(SimulationError, match=f"would roll.*{needed:.4g}.* times its rolling resistance"):
        linear(scene)
