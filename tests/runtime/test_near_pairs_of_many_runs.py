"""Which pairs are left out follows from the state of a run alone.

Saved runs, runs that take turns on the same scratch memory, and runs with other values of parameters go on
bit for bit; sensors keep their pairs.
"""

from __future__ import annotations

import numpy as np
import pytest

from modelgen import Accuracy, start, start_many
from modelgen.codegen.library import Library
from modelgen.runtime.core_session import FULL, Session
from modelgen.scene import python_scenes as make
from modelgen.scene.read import read_text
from modelgen.scene.scene_types import Scene
from tests.running import library_of
from tests.runtime.test_near_pairs import gas

SPHERES = """
gravity = [0, 0, 0]
contacts = { between = "all", restitution = 1.0 }
[[sensor]]
name = "apart"
of = "left/s1-right/s1.gap"
"""
RADIUS = """
[[parameter]]
name = "r{k}"
value = 0.1
minimum = 0.01
"""
BODY = """
[[body]]
name = "{name}"
mass = 1.0
inertia = [0.01, 0.01, 0.01]
position = [{x}, 0, 0]
velocity = [{v}, 0, 0]
shape = [
  {{ name = "s0", kind = "sphere", radius = "r0" }},
  {{ name = "s1", kind = "sphere", radius = "r1", position = [0, 1, 0] }},
]
"""
METHODS = [Accuracy.balanced(), Accuracy(method="time-stepping", step=2e-3)]


def begun(library: Library, accuracy: Accuracy) -> Session:
    session = Session(library, accuracy)
    assert session.begin() == 0
    return session


def advanced(session: Session, until: float, steps: int = 10**6) -> bytes:
    """The state at `until`, or after so many steps."""
    record, code = session.tables.Record(), FULL
    while code == FULL:
        code = session.advance(until, steps, record)
        session.drain_events()
    return session.save()


def hail() -> Scene:
    """Boxes and balls that fall onto each other and onto a floor, with friction."""
    floor = make.fixed("floor", make.plane())
    shapes = (make.box(0.2, 0.3, 0.1), make.sphere(0.1), make.ellipsoid(0.1, 0.15, 0.2))
    moving = [
        make.dynamic(
            f"body{k}", shapes[k % 3], density=500.0, position=[0.2 * (k % 2), 0.01 * k, 0.3 + 0.35 * k],
            rpy=[0.1 * k, 0.2, 0.0], velocity=[0.0, 0.0, -0.2 * k],
        )
        for k in range(9)
    ]  # fmt: skip
    return make.scene("hail", [floor, *moving], contacts={"between": "all", "friction": 0.3})


@pytest.mark.cases(1)
@pytest.mark.parametrize("accuracy", METHODS, ids=lambda each: each.method)
@pytest.mark.parametrize("scene", [gas(0), hail()], ids=lambda each: each.name)
def test_saved_runs_go_on_bit_for_bit_on_the_memory_of_other_runs(scene: Scene, accuracy: Accuracy) -> None:
    library = library_of(scene)
    alone, shared, other = (begun(library, accuracy) for _ in range(3))
    advanced(other, 0.1)
    shared.work[:], shared.iwork[:] = np.nan, -1
    left_out, states = set(), [alone.save(), other.save()]
    for _ in range(60):
        for k, steps in ((0, 10), (1, 3)):
            shared.load(states[k])
            states[k] = advanced(shared, 10.0, steps)
        assert states[0] == advanced(alone, 10.0, 10)
        left_out.add(tuple(np.flatnonzero(alone.run_arrays["is_far"])))
    assert len(left_out) > 4  # pairs came near and were left out on the way


def test_lanes_of_a_gas_are_runs_of_their_own() -> None:
    library = library_of(gas(1))
    many = start_many(library, 3)
    x = np.array(many.state)
    n_q = library.manifest.instance["n_q"]
    n_u = library.manifest.instance["n_u"]
    u = np.array([speed * x[0, n_q : n_q + n_u] for speed in (0.5, 1.0, 2.0)])
    many.reset([0, 1, 2], u=u)
    alone = []
    for lane in range(3):
        sim = start_many(library, 1)
        sim.reset([0], u=u[lane : lane + 1])
        alone.append(sim)
    for _ in range(10):
        many.step(0.03)
        for lane, sim in enumerate(alone):
            sim.step(0.03)
            assert np.array_equal(many.state[lane], sim.state[0])


def spheres() -> Library:
    """Two bodies of two spheres each, all of one size at the values of the scene."""
    radii = "".join(RADIUS.format(k=k) for k in range(2))
    bodies = "".join(BODY.format(name=name, x=x, v=-x) for name, x in (("left", -2.0), ("right", 2.0)))
    return library_of(read_text(SPHERES + radii + bodies, "spheres"))


def test_lanes_whose_shapes_differ_in_size_have_the_same_tables() -> None:
    """Spheres that are equal in one lane and different in another meet when their radii say so."""
    library, radii = spheres(), np.array([[0.1, 0.1], [0.1, 0.3], [0.4, 0.2]])
    many = start_many(library, 3, parameters={"r0": radii[:, 0], "r1": radii[:, 1]})
    alone = [start(library, parameters={"r0": r0, "r1": r1}) for r0, r1 in radii.tolist()]
    for until in (0.5, 1.0):
        many.step(0.5)
        for lane, sim in enumerate(alone):
            sim.step(until=until)
            assert np.array_equal(many.state[lane], sim.state)
    for lane, pair in enumerate(radii):
        first = next(event.t for event in many.events(lane) if event.kind == "impact")
        assert first == pytest.approx((4.0 - 2 * pair.max()) / 4.0, abs=1e-8)


def test_a_pair_that_a_sensor_measures_is_never_left_out() -> None:
    sim = start(spheres())
    sim.step(until=0.25)
    assert sim.sensors["apart"] == pytest.approx(3.0 - 0.2, abs=1e-9)
    assert sum(sim.session.run_arrays["is_far"]) == 3  # the other pairs of spheres
