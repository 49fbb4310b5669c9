"""Scenes of many pairs leave out those that are far apart: none of them meets unseen."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from modelgen import build, derive, emit, require, simulate
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Scene

BODIES = 30  # 465 pairs; scenes of up to 400 follow all of them
STEP = 2e-3  # s


def shower(seed: int, speed: float) -> tuple[Scene, np.ndarray]:
    """Balls at rest in layers above a floor, a fast one that is shot through them; their radii (30,), m."""
    rng = np.random.default_rng(seed)
    radii = rng.uniform(0.04, 0.1, BODIES)
    names = [f"ball{i}" for i in range(BODIES)]
    places = [(0.22 * (i % 3), 0.22 * (i // 3 % 3), 0.15 + 0.22 * (i // 9)) for i in range(BODIES)]
    places[0] = (-1.0, 0.22, 0.4)
    velocities = [[speed, 0.0, 0.0], *([[0.0, 0.0, 0.0]] * (BODIES - 1))]
    balls = [
        make.dynamic(name, make.sphere(float(radius)), density=800.0, position=list(place), velocity=velocity)
        for name, radius, place, velocity in zip(names, radii, places, velocities, strict=True)
    ]
    pairs = [{"between": list(pair)} for pair in combinations(["floor", *names], 2)]
    return make.scene("shower", [make.fixed("floor", make.plane()), *balls], contact=pairs), radii


@pytest.mark.cases(3)
@pytest.mark.parametrize("scheme", ["stewart-trinkle", "moreau"])
@pytest.mark.parametrize(("seed", "speed"), [(0, 2.0), (1, 20.0), (2, 100.0)])
def test_no_pair_that_is_left_out_meets(seed: int, speed: float, scheme: str) -> None:
    """Gaps by the centres and radii of the balls, at the ends of steps."""
    scene, radii = shower(seed, speed)
    path = simulate(
        build(emit(derive(require(scene)))),
        until=0.6, samples=150, estimate=False,
        method="time-stepping", step=STEP, scheme=scheme,
    )  # fmt: skip
    i, j = np.triu_indices(BODIES, 1)
    p = path.p[:, 1:]
    between = np.linalg.norm(p[:, i] - p[:, j], axis=2) - radii[i] - radii[j]
    gap = np.hstack([p[..., 2] - radii, between])  # those with the floor come first
    told = path.gap
    followed = np.isfinite(told)
    assert path.outcome.succeeded
    assert gap.min() >= -1e-8
    np.testing.assert_allclose(told[followed], gap[followed], atol=1e-9)
    assert not followed[:, :BODIES].all()
    assert not followed[:, BODIES:].all()
    assert followed[np.abs(gap) < 1e-6].all()  # what touches is followed


def rain(seed: int, may_be_left_out: bool) -> Scene:
    """Solids of four kinds that come down a slope into the corner between two walls: pairs of a rule may be
    left out, those that are listed are followed, as long as they are few."""
    rng = np.random.default_rng(seed)
    shapes = (make.box(0.1, 0.14, 0.08), make.capsule(0.05, 0.1), make.sphere(0.06), make.cylinder(0.06, 0.1))
    stones = [
        make.dynamic(
            f"stone{i}", shape, density=800.0, position=[0.35 * i, float(rng.uniform(-0.1, 0.1)), 0.7],
            rpy=rng.uniform(-2, 2, 3).tolist(), velocity=rng.uniform(-1, 1, 3).tolist(),
        )
        for i, shape in enumerate(shapes)
    ]  # fmt: skip
    tilt = float(rng.uniform(0.2, 0.5))
    walls = [
        make.fixed("slope", make.plane(), rpy=[0.0, -tilt, 0.0]),
        make.fixed("end", make.plane(), position=[-0.6, 0.0, 0.0], rpy=[0.0, float(np.pi / 2) - tilt, 0.0]),
        make.fixed("side", make.plane(), position=[0.0, 0.4, 0.0], rpy=[float(np.pi / 2), 0.0, 0.0]),
    ]
    contacts = {"friction": 0.3, "restitution": 0.2}
    names = [body.name for body in (*walls, *stones)]
    listed = [{"between": pair} | contacts for pair in combinations(names, 2) if "stone" in pair[1]]
    rule = {"contacts": {"between": "all"} | contacts} if may_be_left_out else {"contact": listed}
    return make.scene("rain", [*walls, *stones], **rule)


@pytest.mark.cases(2)
@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize(("method", "allowed"), [("time-stepping", 2e-3), ("dop853", 1e-7)])  # m
def test_what_is_left_out_changes_no_motion(seed: int, method: str, allowed: float) -> None:
    """What is near limits some steps of time-stepping, whose motion depends on them to first order."""
    step = STEP if method == "time-stepping" else None
    some, all_of_them = (
        simulate(
            build(emit(derive(require(rain(seed, each))))), until=0.4, samples=50, estimate=False,
            method=method, step=step,
        )
        for each in (True, False)
    )  # fmt: skip
    assert some.outcome is all_of_them.outcome
    assert np.isnan(some.gap).any()
    assert any("impact" in event.kind and "stone" in event.contact for event in some.events)
    np.testing.assert_allclose(some.p, all_of_them.p, atol=allowed)
