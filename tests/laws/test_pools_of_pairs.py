"""A large group of equal bodies runs as if all its pairs were listed, on tables for those that are near."""

from __future__ import annotations

import numpy as np
import pytest

from modelgen import Accuracy, simulate, start
from modelgen.runtime.core_session import Session
from modelgen.runtime.run_distance import columns_in_common
from modelgen.runtime.start import begin
from modelgen.runtime.tables.library_tables import library_tables
from modelgen.runtime.trajectory import Outcome, Trajectory
from modelgen.scene import contact_groups
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Scene
from tests.benchmarks.many_contacts import stack
from tests.running import library_of

SHAPES = {
    "sphere": make.sphere(0.05),
    "ellipsoid": make.ellipsoid(0.06, 0.05, 0.04),
    "box": make.box(0.1, 0.09, 0.08),
    "capsule": make.capsule(0.04, 0.04),
    "cylinder": make.cylinder(0.04, 0.09),
    "frustum": make.frustum(0.05, 0.03, 0.08),
}
FAMILIES = (
    ("sphere",),
    ("box",),
    ("sphere", "ellipsoid", "capsule"),
    ("box", "cylinder", "frustum", "sphere"),
)
UNTIL = {"balanced": 0.18, "coarse": 0.18}


def heap(kinds: tuple[str, ...], seed: int, count: int = 12, **group: object) -> Scene:
    """Bodies that fly at each other and fall on a floor."""
    rng, width = np.random.default_rng(seed), int(np.ceil(count ** (1 / 3)))
    bodies = [make.fixed("floor", make.plane())]
    for k in range(count):
        place = np.array([k % width, k // width % width, k // width**2]) * 0.15 + [0, 0, 0.09]
        bodies.append(
            make.dynamic(
                f"body{k}",
                SHAPES[kinds[k % len(kinds)]],
                density=1000.0,
                position=(place + rng.uniform(-0.01, 0.01, 3)).tolist(),
                velocity=rng.uniform(-0.5, 0.5, 3).tolist(),
            )
        )
    given = {"between": "all", "friction": 0.3, "restitution": 0.3} | group
    return make.scene(f"heap_{'_'.join(kinds)}", bodies, contacts=given)


@pytest.fixture
def pooled(monkeypatch: pytest.MonkeyPatch) -> None:
    """Pools for groups of any size."""
    monkeypatch.setattr(contact_groups, "LISTED", 1)
    monkeypatch.setattr(contact_groups, "POOLED", 2)


def listed_and_pooled(
    kinds: tuple[str, ...], seed: int, accuracy: str, monkeypatch: pytest.MonkeyPatch
) -> tuple[Trajectory, Trajectory]:
    found = []
    for limits in ((10**9, 10**9), (1, 2)):
        for name, limit in zip(("LISTED", "POOLED"), limits, strict=True):
            monkeypatch.setattr(contact_groups, name, limit)
        scene = heap(kinds, seed)
        assert bool(scene.pools) == (limits[0] == 1)
        found.append(
            simulate(library_of(scene), until=UNTIL[accuracy], accuracy=accuracy, samples=9, estimate=False)
        )
    return found[0], found[1]


@pytest.mark.cases(2)
@pytest.mark.parametrize("accuracy", UNTIL)
@pytest.mark.parametrize("kinds", FAMILIES, ids="-".join)
def test_pooled_runs_are_those_of_listed_pairs(
    kinds: tuple[str, ...], accuracy: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    for seed in range(2):
        listed, pooled = listed_and_pooled(kinds, seed, accuracy, monkeypatch)
        assert listed.outcome is pooled.outcome is Outcome.DONE
        assert np.abs(listed.p - pooled.p).max() < 1e-9
        assert set(pooled.contact_names) <= set(listed.contact_names)
        blows = [
            {(each.contact, each.kind) for each in path.events if each.speed > 0} for path in (listed, pooled)
        ]
        assert blows[0] == blows[1]
        assert any("floor" not in contact for contact, _ in blows[0])
        mine, theirs = columns_in_common(listed, pooled)
        size = np.abs(mine["force"]).max()
        assert np.abs(mine["force"] - theirs["force"]).max() < 1e-4 * size  # one motion, shared otherwise


def test_stacks_rest_on_faces_of_pairs_in_slots(monkeypatch: pytest.MonkeyPatch) -> None:
    """Bit for bit, as the pairs of one pool are in the order of the scene."""
    found = []
    for limits in ((10**9, 10**9), (1, 2)):
        for name, limit in zip(("LISTED", "POOLED"), limits, strict=True):
            monkeypatch.setattr(contact_groups, name, limit)
        found.append(simulate(library_of(stack(5)), until=0.3, accuracy="balanced", samples=4))
    listed, pooled = found
    assert np.array_equal(listed.p, pooled.p)
    assert listed.steps == pooled.steps
    assert [(each.kind, each.contact) for each in listed.events] == [
        (each.kind, each.contact) for each in pooled.events
    ]
    resting = [sorted(path.patch_names[k] for k in path.patch[-1] if k >= 0) for path in (listed, pooled)]
    assert len(resting[0]) == 5
    assert resting[0] == resting[1]
    assert listed.doubts == pooled.doubts


@pytest.mark.usefixtures("pooled")
def test_a_run_gets_the_room_that_it_needs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("modelgen.codegen.manifest_pools.FEWEST", 1)
    roomy, scarce = (heap(("sphere",), 3, 40, near_per_body=near) for near in (8, 1))
    paths = [
        simulate(library_of(scene), until=0.2, accuracy="coarse", samples=4, estimate=False)
        for scene in (roomy, scarce)
    ]
    assert [path.outcome for path in paths] == [Outcome.DONE] * 2
    assert np.abs(paths[0].p - paths[1].p).max() < 1e-9
    session = Session(library_of(scarce), Accuracy.coarse())
    few = session.shared.slots.count
    assert few < library_tables(library_of(roomy)).slots.count


@pytest.mark.usefixtures("pooled")
def test_a_stepped_run_tells_that_it_has_too_little_room(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("modelgen.codegen.manifest_pools.FEWEST", 1)
    monkeypatch.setattr("modelgen.codegen.manifest_pools.UNEVEN", 0.02)
    sim = start(library_of(heap(("sphere",), 3, 40, near_per_body=1)), accuracy="coarse")
    for t in np.linspace(0.01, 0.2, 20):
        if sim.outcome is None:
            sim.step(float(t))
    assert sim.outcome is Outcome.TOO_MANY_NEAR


@pytest.mark.usefixtures("pooled")
def test_pooled_runs_go_on_bit_for_bit_from_what_was_saved() -> None:
    library = library_of(heap(("sphere", "box"), 5))
    alone, again = (Session(library, Accuracy.coarse()) for _ in range(2))
    nothing = alone.tables.Record()
    begin(alone)
    alone.advance(0.1, 10_000, nothing)
    again.load(alone.save())
    for session in (alone, again):
        session.drain_events()
        session.advance(0.2, 10_000, nothing)
    assert alone.save() == again.save()
    assert alone.run_arrays["slot_balls"].any()


@pytest.mark.usefixtures("pooled")
def test_each_slot_has_the_entries_of_its_pattern() -> None:
    tables = library_tables(library_of(heap(("box", "capsule", "sphere"), 0)))
    system, slots = tables.system, tables.slots

    def column(name: str, size: int) -> np.ndarray:
        pointer = np.ctypeslib.as_array(
            (np.ctypeslib.ctypes.c_int * size).from_address(getattr(system, name))
        )
        return np.array(pointer)

    pairs = column("pair_feature_pair", system.n_pair + 1)
    conditions = column("feature_pair_condition", system.n_feature_pair + 1)
    beyond = column("condition_feature_pair", int(conditions[-1]))
    kinds = column("feature_pair_kind", system.n_feature_pair)
    owners = column("feature_pair_owner", system.n_feature_pair)
    assert np.array_equal(owners[: pairs[-1]], np.repeat(np.arange(system.n_pair), np.diff(pairs)))
    for slot, pattern in zip(
        range(slots.pair.at, system.n_pair), slots.pair.order[slots.pair.at :], strict=True
    ):
        own, its = (slice(pairs[k], pairs[k + 1]) for k in (slot, pattern))
        assert np.array_equal(kinds[own], kinds[its])
        mine, theirs = (beyond[conditions[part.start] : conditions[part.stop]] for part in (own, its))
        moved = np.where(theirs < 0, theirs, theirs + own.start - its.start)
        assert np.array_equal(mine, moved)


@pytest.mark.usefixtures("pooled")
def test_bodies_that_results_name_have_pairs_of_their_own() -> None:
    scene = heap(("sphere",), 0, 12)
    named = make.scene(
        "named",
        scene.bodies,
        contacts={"between": "all"},
        sensor=[{"name": "gap", "of": "body1-body2.gap"}],
    )
    pooled = {name for members in named.classes for name, _ in members}
    assert not {"body1", "body2"} & pooled
    assert len(pooled) == 10
