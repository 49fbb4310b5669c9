"""Bodies that are tossed, stacked or leant: runs end, books close, nothing sinks, and jams are named."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from modelgen import Accuracy, simulate
from modelgen.runtime.trajectory import Outcome
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Shape
from tests.oracles.pieces import TABLE, G, ran
from tests.running import library_of, scene_of

SHAPES: dict[str, Shape] = {
    "box": make.shape("box", size=[0.12, 0.08, 0.05]),
    "cylinder": make.cylinder(0.05, 0.08),
    "ellipsoid": make.ellipsoid(0.06, 0.04, 0.03),
}


@pytest.mark.cases(8)
@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("shape", SHAPES)
def test_a_tossed_body_comes_to_the_end_of_its_run(shape: str, seed: int) -> None:
    rng = np.random.default_rng(seed)
    turned = Rotation.random(random_state=seed).as_quat()[[3, 0, 1, 2]]
    body = make.dynamic(
        "body", SHAPES[shape], density=500.0, position=[0, 0, 0.2], quaternion=turned.tolist(),
        velocity=rng.uniform(-1.5, 1.5, 3).tolist(), angular_velocity=rng.uniform(-15, 15, 3).tolist(),
    )  # fmt: skip
    static = float(rng.uniform(0.05, 1.0))
    friction = {"static": static, "kinetic": static * float(rng.choice([1.0, 0.7]))}
    contact = [
        {"between": ["body", "table"], "friction": friction, "restitution": float(rng.uniform(0, 0.8))}
    ]
    path = ran([body, TABLE], 3.0, contact, Accuracy.balanced(), samples=100)
    assert path.outcome is Outcome.DONE
    assert path.energy_drift < 1e-9
    assert path.gap_max < 1e-12
    size = np.linalg.norm(path.friction, axis=-1)
    assert (size <= static * np.abs(path.force) * (1 + 1e-8) + 1e-9).all()
    gains = np.diff(path.energy) > 1e-9
    assert not gains.any() or any("made" in warning for warning in path.warnings)


def test_a_stack_rests_and_slides_as_one() -> None:
    size = make.shape("box", size=[0.2, 0.2, 0.1])
    boxes = [
        make.dynamic(n, size, density=500.0, position=[0, 0, z]) for n, z in (("low", 0.05), ("high", 0.15))
    ]
    contact = [{"between": ["low", "table"], "friction": 0.5}, {"between": ["low", "high"], "friction": 0.5}]
    rests = ran([*boxes, TABLE], 1.0, contact, samples=5)
    assert np.abs(rests.p - rests.p[0]).max() < 1e-12
    tilted = [G * np.sin(0.7), 0.0, -G * np.cos(0.7)]
    slides = ran([*boxes, TABLE], 0.2, contact, samples=5, gravity=tilted)
    a = G * (np.sin(0.7) - 0.5 * np.cos(0.7))
    assert slides.p[:, 0, 0] == pytest.approx(a * slides.t**2 / 2, abs=1e-7)


@pytest.mark.parametrize(("mu_floor", "stays"), [(0.3, True), (0.1, False)])
def test_a_ladder_leant_on_a_slippery_wall_stays_if_the_floor_is_rough(mu_floor: float, stays: bool) -> None:
    # tan(0.35) / 2 = 0.18 is needed on the floor
    ladder = make.dynamic(
        "ladder", make.shape("capsule", radius=1e-3, length=1.0), mass=1.0, inertia=[1 / 12, 1 / 12, 1e-4],
        position=[0.5 * np.sin(0.35) + 1e-3, 0, 0.5 * np.cos(0.35) + 1e-3], rpy=[0, -0.35, 0],
    )  # fmt: skip
    wall = make.fixed("wall", make.plane(), rpy=[0, np.pi / 2, 0])
    contact = [
        {"between": ["ladder", "table"], "friction": mu_floor},
        {"between": ["ladder", "wall"], "friction": 1e-6},
    ]
    path = ran([ladder, TABLE, wall], 0.3, contact, samples=5)
    assert path.outcome is Outcome.DONE
    assert (np.abs(path.p - path.p[0]).max() < 1e-9) == stays


def test_a_rod_pushed_into_the_ground_jams_and_says_so() -> None:
    # Painleve: a long rod that slides steeply forward on rough ground has no finite contact force
    angle = 1.0
    rod = make.dynamic(
        "rod", make.point(0.5, 0.0, 0.0), mass=1.0, inertia=[1e-3, 1 / 120, 1 / 120], rpy=[0, angle, 0],
        position=[-0.5 * np.cos(angle), 0, 0.5 * np.sin(angle)], velocity=[2.0, 0, 0],
    )  # fmt: skip
    scene = make.scene("jam", [rod, TABLE], contact=[{"between": ["rod", "table"], "friction": 3.0}])
    path = simulate(library_of(scene), until=0.1, samples=5, fallback=False)
    assert path.outcome is Outcome.NO_FRICTION
    assert "Painleve" in path.outcome.value


@pytest.mark.parametrize(("real", "off"), [("float", 1e-4), ("long double", 1e-14)])
def test_friction_runs_over_every_real_type(real: str, off: float) -> None:
    path = simulate(scene_of("sphere_slide_to_roll", real=real), samples=4)
    double = simulate(scene_of("sphere_slide_to_roll"), samples=4)
    assert [e.kind for e in path.events] == ["slip-stop"]
    assert np.abs(path.p - double.p).max() < off
