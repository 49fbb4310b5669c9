"""The references of tops: what they conserve, a second formulation, and what they are known for."""

from __future__ import annotations

import numpy as np
import pytest

from tests.oracles.friction.extrapolation import Array
from tests.oracles.friction.lagrange_route import LagrangeRoute, ellipsoid_support
from tests.oracles.friction.on_plane import (
    HEAT,
    Body,
    P,
    T,
    V,
    W,
    energy,
    rolled,
    rolls,
    rotation_of,
    slid,
    slides,
)  # fmt: skip
from tests.oracles.friction.tops import (
    EGG_AXES,
    RATTLEBACK_AXES,
    RATTLEBACK_DROP,
    TOP_OFFSET,
    TOP_RADIUS,
    jellett,
    rattleback,
    rattleback_start,
    slid_then_rolled,
    spinning_egg,
    spinning_egg_start,
    tippe_top,
    tippe_top_start,
)  # fmt: skip


def lost(body: Body, first: Array, x: Array) -> float:
    """What is missing of the energy."""
    return float(sum(energy(body, x)) + x[HEAT] - sum(energy(body, first)))


def apart(route: LagrangeRoute, first: Array, states: Array) -> tuple[float, float]:
    """Largest differences of positions and rotations from a second formulation."""
    R = rotation_of(first)
    v = None if route.rolls else (R @ first[V])[:2].astype(float)
    begin = route.start(R, (R @ first[W]).astype(float), v=v)
    p, turned, _, _ = route.run(*begin, states[:, T].astype(float))
    position = np.abs(p - states[:, P]).max()
    return float(position), float(np.abs(turned - [rotation_of(x) for x in states]).max())


@pytest.mark.slow
def test_a_rattleback_turns_back_and_keeps_its_energy() -> None:
    body, first = rattleback(), rattleback_start()
    states = rolled(body, first, [0, 0.5, 1, 2.1], 1e-13)
    spins = [float((rotation_of(x) @ x[W])[2]) for x in states]
    assert spins[0] == -3
    assert spins[-1] > 0.1
    assert max(abs(lost(body, first, x)) for x in states) < 1e-12
    forces = [rolls(body, x) for x in states]
    assert all(float(c.normal) > 1 and float(c.force @ c.force) < 2 * float(c.normal) ** 2 for c in forces)
    support = ellipsoid_support(RATTLEBACK_AXES, offset=(0, 0, RATTLEBACK_DROP))
    route = LagrangeRoute(support, 1.0, body.inertia.astype(float))
    position, rotation = apart(route, first, states[:3])
    assert position < 1e-9
    assert rotation < 1e-8


@pytest.mark.slow
def test_a_tippe_top_turns_over_keeps_jelletts_integral_and_comes_to_roll() -> None:
    body, first = tippe_top(), tippe_top_start()
    states, rolls_at = slid_then_rolled(body, first, [0, 0.1, 0.5, 1.0, 1.05], 1e-13)
    assert float(rolls_at) == pytest.approx(1.02517056980, abs=1e-9)
    assert float(rotation_of(states[0])[2, 2]) == pytest.approx(np.cos(0.1), abs=1e-16)
    assert float(rotation_of(states[3])[2, 2]) < -0.92
    for x in states:
        assert abs(lost(body, first, x)) < 1e-16
        assert float(jellett(body, x) / jellett(body, first)) == pytest.approx(1, abs=1e-15)
    contact = rolls(body, states[-1])
    assert float(contact.force @ contact.force) < (1 + 0.3**2) * float(contact.normal) ** 2
    support = ellipsoid_support([TOP_RADIUS] * 3, offset=(0, 0, TOP_OFFSET))
    route = LagrangeRoute(support, float(body.mass), body.inertia.astype(float), float(body.mu), last=2)
    position, rotation = apart(route, first, states[:2])
    assert position < 1e-10
    assert rotation < 1e-7


@pytest.mark.slow
def test_a_spinning_egg_rises() -> None:
    body, first = spinning_egg(), spinning_egg_start()
    states = slid(body, first, [0, 0.2, 1.0], 1e-15)
    raised = [float(rotation_of(x)[2, 2]) for x in states]
    assert raised[0] == pytest.approx(np.sin(0.1), abs=1e-16)
    assert raised[-1] > 0.7
    assert float(states[-1][P][2]) == pytest.approx(0.0256055404, abs=1e-9)
    assert max(abs(lost(body, first, x)) for x in states) < 1e-16
    assert all(0.3 < float(slides(body, x).normal) < 0.6 for x in states)
    route = LagrangeRoute(
        ellipsoid_support(EGG_AXES), float(body.mass), body.inertia.astype(float), float(body.mu), last=2
    )
    position, rotation = apart(route, first, states[:2])
    assert position < 1e-10
    assert rotation < 1e-7
