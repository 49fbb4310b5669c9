"""Pairs that are left out while they are far apart meet at the right times, and cost no accuracy."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from modelgen import simulate
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Scene
from tests.running import library_of

COLLISIONS = 60
BOX = (-0.4, 1.4)  # m
Row = np.ndarray


def gas(seed: int, bodies: int = 27) -> Scene:
    """Elastic spheres of sizes over more than a decade, slow and fast, without gravity."""
    rng = np.random.default_rng(seed)
    side = 3
    spheres = []
    for k in range(bodies):
        cell = np.array([k % side, k // side % side, k // side**2])
        radius = float(0.2 * 10 ** -rng.uniform(0, 1.2))
        speed = 10 ** rng.uniform(-1, 1)
        way = rng.normal(size=3) - 0.7 * (cell - 1)
        spheres.append(
            make.dynamic(
                f"s{k}",
                make.sphere(radius),
                mass=float(radius**2),
                inertia=[1.0, 1.0, 1.0],
                position=[float(x) for x in 0.5 * cell],
                velocity=[float(x) for x in speed * way / np.linalg.norm(way)],
            )
        )
    walls = []
    for axis, turn in enumerate(([0.0, 90.0, 0.0], [-90.0, 0.0, 0.0], [0.0, 0.0, 0.0])):
        for end, sign in zip(BOX, (1, -1), strict=True):
            at = [end if k == axis else 0.0 for k in range(3)]
            flip = 180.0 if sign < 0 else 0.0
            rpy = [
                float(np.radians(a))
                for a in (turn[0] + (flip if axis else 0), turn[1] + (0 if axis else flip), 0.0)
            ]
            walls.append(
                make.fixed(f"{'xyz'[axis]}{'lh'[int(sign < 0)]}", make.plane(), position=at, rpy=rpy)
            )
    return make.scene(
        "gas", [*walls, *spheres], gravity=[0.0, 0.0, 0.0], contacts={"between": "all", "restitution": 1.0}
    )


def collisions(scene: Scene, count: int) -> list[tuple[float, frozenset[str]]]:
    """Times and pairs of the first collisions, from straight lines between them."""
    moving = [body for body in scene.bodies if body.motion == "dynamic"]
    names = [body.name for body in moving]
    p = np.array([body.pose.position for body in moving])
    v = np.array([body.velocity for body in moving])
    m = np.array([body.mass for body in moving])
    r = np.array([body.shapes[0].parameters[0][1] for body in moving])
    t, found = 0.0, []
    while len(found) < count:
        first: tuple[float, int, int] = (np.inf, -1, -1)
        for i, j in combinations(range(len(names)), 2):
            x, u = p[j] - p[i], v[j] - v[i]
            b, c = x @ u, x @ x - (r[i] + r[j]) ** 2
            root = b * b - (u @ u) * c
            if b < 0 <= root:
                first = min(first, (float(c / (-b + np.sqrt(root))), i, j))
        h, i, j = first
        away = np.where(v > 0, BOX[1] - r[:, None] - p, BOX[0] + r[:, None] - p) / v
        if away.min() < h:
            i, axis = np.unravel_index(away.argmin(), away.shape)
            p, t = p + away.min() * v, t + away.min()
            found.append((t, frozenset((names[i], f"{'xyz'[axis]}{'lh'[int(v[i, axis] > 0)]}"))))
            v[i, axis] = -v[i, axis]
            continue
        p, t = p + h * v, t + h
        n = (p[j] - p[i]) / (r[i] + r[j])
        impulse = 2 * m[i] * m[j] / (m[i] + m[j]) * (n @ (v[j] - v[i]))
        v[i], v[j] = v[i] + impulse / m[i] * n, v[j] - impulse / m[j] * n
        found.append((t, frozenset((names[i], names[j]))))
    return found


def impacts(path: Trajectory) -> list[tuple[float, frozenset[str]]]:
    return [(e.t, frozenset(e.contact.split("-"))) for e in path.events if e.kind == "impact"]


@pytest.mark.cases(1)
@pytest.mark.parametrize("seed", range(3))
def test_no_collision_of_a_gas_is_missed(seed: int) -> None:
    scene = gas(seed)
    expected = collisions(scene, COLLISIONS)
    assert sum(all(name[0] == "s" for name in pair) for _, pair in expected) > 5
    path = simulate(
        library_of(scene), until=expected[-1][0] + 1e-6, samples=4, estimate=False, accuracy="tight"
    )
    found = impacts(path)
    assert [pair for _, pair in found] == [pair for _, pair in expected]
    # An error of a direction grows by up to the free path over the radius in a collision: 1e2 here, rarely.
    np.testing.assert_allclose([t for t, _ in found], [t for t, _ in expected], atol=1e-6)


def test_far_pairs_have_no_gap_and_near_ones_have() -> None:
    balls = [
        make.dynamic(
            name,
            make.sphere(0.1),
            mass=1.0,
            inertia=[1.0] * 3,
            position=[x, 0.0, 0.0],
            velocity=[v, 0.0, 0.0],
        )
        for name, x, v in (("left", 0.0, 1.0), ("right", 5.0, -1.0))
    ]
    scene = make.scene("two", balls, gravity=[0.0] * 3, contacts={"between": "all", "restitution": 1.0})
    path = simulate(library_of(scene), until=3.0, samples=30, estimate=False)
    gap = path.gap[:, 0]
    assert np.isnan(gap[0])
    assert np.isnan(gap[-1])
    known = ~np.isnan(gap)
    distance = np.linalg.norm(path.p[:, 1] - path.p[:, 0], axis=1) - 0.2
    assert known[distance < 0.01].all()
    np.testing.assert_allclose(gap[known], distance[known], atol=1e-9)
    (impact,) = [event for event in path.events if event.kind == "impact"]
    assert impact.t == pytest.approx(2.4, abs=1e-9)


@pytest.mark.parametrize("scheme", ["stewart-trinkle", "moreau"])
def test_time_stepping_follows_what_impulses_throw_together(scheme: str) -> None:
    """A fast ball strikes a resting one, which in the same step reaches a third: none is passed through."""
    at, velocity = (0.0, 0.35, 0.6), (40.0, 0.0, 0.0)
    balls = [
        make.dynamic(
            f"b{k}",
            make.sphere(0.1),
            mass=1.0,
            inertia=[1.0] * 3,
            position=[x, 0.0, 0.0],
            velocity=[v, 0.0, 0.0],
        )
        for k, (x, v) in enumerate(zip(at, velocity, strict=True))
    ]
    scene = make.scene("row", balls, gravity=[0.0] * 3, contacts={"between": "all"})
    path = simulate(
        library_of(scene),
        until=0.1,
        samples=10,
        estimate=False,
        method="time-stepping",
        step=0.01,
        scheme=scheme,
    )
    assert (np.diff(path.p[:, :, 0], axis=1) > 0.2 - (0.4 if scheme == "moreau" else 1e-8)).all()
    assert path.v[-1, :, 0].sum() == pytest.approx(40.0)


def test_a_box_of_boxes_comes_near_and_rests() -> None:
    """Solids with edges are searched when they come near; the stack rests at heights that geometry tells."""
    boxes = [
        make.dynamic(
            f"box{k}", make.box(0.2, 0.2, 0.1), density=500.0, position=[0.01 * k, 0.0, 0.06 + 0.6 * k]
        )
        for k in range(2)
    ]
    bodies = [make.fixed("floor", make.plane()), *boxes]
    path = simulate(
        library_of(make.scene("stack", bodies, contacts={"between": "all", "friction": 0.5})),
        until=0.6, samples=10, estimate=False,
    )  # fmt: skip
    np.testing.assert_allclose(path.p[-1, 1:, 2], [0.05, 0.15], atol=1e-6)
