"""Forces that are not unique: those of the least sum of A_ii f_i^2, A = J M^-1 J^T, as the manual says."""

from __future__ import annotations

import numpy as np
import pytest

from modelgen import simulate
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_from_tables import scene_from_tables
from modelgen.scene.scene_types import Scene
from tests.benchmarks.verdict_scenes import drawn
from tests.running import library_of

G = 9.81
ROD = 0.5  # m


def plate(rng: np.random.Generator, at: np.ndarray, hanging: bool) -> tuple[Scene, float, np.ndarray]:
    """A plate on four balls, or on four vertical rods, with its mass and inertia."""
    mass, inertia = float(rng.uniform(0.5, 5)), rng.uniform(0.05, 0.1, 3)
    feet = [make.sphere(0.05, name=f"foot{k}", position=[x, y, 0]) for k, (x, y) in enumerate(at.tolist())]
    body = make.dynamic("plate", *feet, mass=mass, inertia=inertia.tolist(), position=[0, 0, 0.05])
    if not hanging:
        contact = [{"between": [f"plate/foot{k}", "floor"]} for k in range(4)]
        return make.scene("plate", [make.fixed("floor", make.plane()), body], contact=contact), mass, inertia
    joint = [
        {
            "name": f"rod{k}", "kind": "distance", "between": ["world", "plate"], "distance": ROD,
            "frames": [{"position": [x, y, 0.05 + ROD]}, {"position": [x, y, 0]}],
        }
        for k, (x, y) in enumerate(at.tolist())
    ]  # fmt: skip
    return make.scene("plate", [body], joint=joint), mass, inertia


def least(at: np.ndarray, mass: float, inertia: np.ndarray) -> np.ndarray:
    """The forces f of the least sum of A_ii f_i^2 that carry the weight; A_ii by the motion of each point."""
    carried = np.array([np.ones(4), at[:, 1], -at[:, 0]])  # force, and moments about x and y
    weight = np.sqrt(1 / mass + at[:, 1] ** 2 / inertia[0] + at[:, 0] ** 2 / inertia[1])
    return np.asarray(np.linalg.pinv(carried / weight) @ [mass * G, 0, 0]) / weight


@pytest.mark.cases(4)
@pytest.mark.parametrize("hanging", [False, True])
@pytest.mark.parametrize("seed", range(25))
def test_forces_that_are_not_unique_have_the_least_weighted_norm(seed: int, hanging: bool) -> None:
    rng = np.random.default_rng(seed)
    at = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * 0.3 + rng.uniform(-0.1, 0.1, (4, 2))
    scene, mass, inertia = plate(rng, at, hanging)
    path = simulate(library_of(scene), until=1e-3, samples=1, estimate=False)
    shown = path.joint_force[0, :, 2] if hanging else path.force[0]
    right = least(at, mass, inertia)
    assert right.min() > 0
    assert shown == pytest.approx(right, rel=1e-9)
    plain = np.linalg.pinv(np.array([np.ones(4), at[:, 1], -at[:, 0]])) @ [mass * G, 0, 0]
    assert np.abs(plain - right).max() > 1e-4 * right.max()  # the plain norm is another one


def cart(rolls: bool, **axles: float) -> Scene:
    """A cart on four wheels that roll from the start or slide."""
    radius, upright, speed = 0.05, [np.pi / 2, 0.0, 0.0], 0.5
    bodies = [
        make.fixed("floor", make.plane()),
        make.dynamic(
            "cart", make.box(0.4, 0.2, 0.05), density=800.0, position=[0, 0, 0.11], velocity=[speed, 0, 0]
        ),
    ]
    joint, contacts = [], []
    for k, (x, y) in enumerate(((0.2, 0.12), (0.2, -0.12), (-0.2, 0.12), (-0.2, -0.12))):
        wheel = make.dynamic(
            f"wheel{k}", make.sphere(radius), density=800.0, position=[x, y, radius], rpy=upright,
            velocity=[speed, 0, 0], angular_velocity=[0, speed / radius if rolls else 0, 0],
        )  # fmt: skip
        bodies.append(wheel)
        axle = {
            "kind": "revolute",
            "between": ["cart", f"wheel{k}"],
            "position": [x, y, radius],
            "rpy": upright,
        }
        joint.append({"name": f"axle{k}", **axles, **axle})
        contacts.append({"between": [f"wheel{k}", "floor"], "friction": 0.6})
    return make.scene("cart", bodies, joint=joint, contact=contacts)


@pytest.mark.parametrize("armature", [0.0, 1e-4])
def test_a_cart_on_four_wheels_has_three_forces_too_many_with_armature_or_without(armature: float) -> None:
    """12 components at the contacts hold 9 of the 10 motions: one is left, straight on."""
    path = simulate(library_of(cart(rolls=True, armature=armature)), until=0.1)
    assert path.redundant_max == 3
    assert path.is_trusted


@pytest.mark.parametrize(("rolls", "damping"), [(False, 0.0), (True, 1e-3)])
def test_a_cart_whose_wheels_slide_or_are_braked_may_share_its_weight_in_other_ways(
    rolls: bool, damping: float
) -> None:
    """A wheel that carries more begins to roll earlier; one that carries nothing is braked to a stop."""
    path = simulate(library_of(cart(rolls, damping=damping)), until=0.1)
    assert path.indeterminate_contact.startswith("wheel")
    assert path.indeterminate_part > 0.01
    assert f"at {path.indeterminate_contact} by" in path.doubts[0]


@pytest.mark.parametrize("seed", [1, 5])
def test_dominoes_fall_in_one_way(seed: int) -> None:
    """Each leans with an edge on the face of the next: how its ends share the force is open."""
    path = simulate(library_of(scene_from_tables("falls", drawn("grips nuts dominoes", seed), "<drawn>")))
    assert path.redundant_max >= 2
    assert path.is_trusted
