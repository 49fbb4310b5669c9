"""Lanes of a group are runs of their own: bit for bit those of a session, in any number of threads."""

from __future__ import annotations

import ctypes
from typing import Any, NamedTuple

import numpy as np
import pytest

from modelgen import Accuracy
from modelgen.codegen.library import Library
from modelgen.errors import SimulationError
from modelgen.runtime.core_session import FULL, Session
from modelgen.runtime.session_group import SessionGroup
from modelgen.runtime.tables.ctypes_structures import SYSTEM_REALS, address
from modelgen.runtime.tables.library_tables import library_tables
from modelgen.runtime.trajectory import Event, Outcome
from tests.running import scene_of

SCENES = ("ellipsoid_on_plane", "cube_toss", "gripper", "gears", "four_bar")
BALANCED = Accuracy.balanced()
TIMES = (0.02, 0.05, 0.13)


class OwnNumbers(NamedTuple):
    system: Any  # mg_system
    arrays: dict[str, np.ndarray]  # its real numbers, by the names of their fields, which may be written to


def own_numbers(library: Library) -> OwnNumbers:
    """A copy of the system of a library with numbers of its own."""
    shared = library_tables(library)
    by_address = {address(array): array for array in shared.arrays}
    system = type(shared.system).from_buffer_copy(shared.system)
    system.shapes_digest = 0  # made at each call, as the numbers change
    arrays = {name: by_address[getattr(system, name)].copy() for name in SYSTEM_REALS}
    for name, array in arrays.items():
        setattr(system, name, address(array))
    return OwnNumbers(system, arrays)


def alone(library: Library, x: np.ndarray, own: OwnNumbers | None = None) -> Session:
    session = Session(library, BALANCED, own.system if own else None)
    session.x[:] = x
    session.begin()
    return session


def advanced(session: Session, t: float) -> list[Event]:
    record, events, code = session.tables.Record(), session.drain_events(), FULL
    while code == FULL:
        code = session.advance(t, 10**8, record)
        events += session.drain_events()
    return events


def starts(group: SessionGroup) -> None:
    """Different velocities of all lanes."""
    instance = group.library.manifest.instance
    spread = 1 + 0.01 * np.arange(group.n)[:, None]
    group.x[:, instance["n_q"] : instance["n_q"] + instance["n_u"]] *= spread


@pytest.mark.cases(3)
@pytest.mark.parametrize("threads", [1, 2, 3])
@pytest.mark.parametrize("name", SCENES)
def test_lanes_are_sessions(name: str, threads: int) -> None:
    library = scene_of(name)
    group = SessionGroup(library, n=7)
    starts(group)
    sessions = [alone(library, x) for x in group.x]
    assert not group.begin(threads)
    told: list[list[Event]] = [[] for _ in sessions]
    for t in TIMES:
        group.advance(t, threads)
        for lane, session in enumerate(sessions):
            told[lane] += advanced(session, t)
            assert group.save(lane) == session.save()
        assert (group.t == t).all()
    assert [group.drain_events(lane) for lane in range(group.n)] == told
    assert group.drain_events(0) == []
    assert group.outcomes == (Outcome.DONE,) * 7


def changed(library: Library, **factors: float) -> OwnNumbers:
    own = own_numbers(library)
    for name, factor in factors.items():
        own.arrays[name][:] *= factor
    return own


def test_lanes_have_their_own_numbers() -> None:
    library = scene_of("cube_toss")
    before = [array.tobytes() for array in Session(library, BALANCED).shared.arrays]
    own = [
        None,
        changed(library, friction_static=0.5, friction_kinetic=0.5),
        changed(library, restitution=0.9),
    ]
    like = library_tables(library).system
    group = SessionGroup(library, n=3, systems=[each.system if each else like for each in own])
    sessions = [alone(library, x, each) for x, each in zip(group.x, own, strict=True)]
    group.begin(2)
    group.advance(0.6, 2)
    for lane, session in enumerate(sessions):
        advanced(session, 0.6)
        assert group.save(lane) == session.save()
    assert len({group.x[lane].tobytes() for lane in range(3)}) == 3
    assert before == [array.tobytes() for array in Session(library, BALANCED).shared.arrays]
    with pytest.raises(SimulationError, match="other tables"):
        group.load(0, group.save(1))
    sessions[2].load(group.save(2))


def test_runs_of_other_scenes_may_take_turns_on_one_scratch_memory() -> None:
    """Bounds of shapes, which it keeps from one search to the next, are not taken for those of others."""
    names = ("ball_in_torus", "coin_in_bowl", "cube_toss", "helix_on_cylinder", "user_surface")
    plain, turning = (
        [alone(library, Session(library, BALANCED).x) for library in map(scene_of, names)] for _ in "ab"
    )
    work = np.zeros(max(len(session.work) for session in plain))
    iwork = np.zeros(max(len(session.iwork) for session in plain), dtype=np.intc)
    for session in turning:
        session._scratch = tuple(ctypes.c_void_p(address(array)) for array in (work, iwork))
    made = 0
    for t in np.linspace(0.01, 0.2, 20):
        for one, other in zip(plain, turning, strict=True):
            one.work[:], one.iwork[:] = 0.0, 0
            assert advanced(one, t) == advanced(other, t)
            assert one.save() == other.save()
            assert one.iwork[0] == iwork[0]  # number of cells of shapes with bounds
            made += int(iwork[0]) - 1
    assert made > 1000


@pytest.mark.parametrize("name", ["egg_on_spline", "gears", "coin_in_bowl"])
def test_bounds_are_those_of_the_parameters_of_the_shapes(name: str) -> None:
    """The digest by which bounds are recognised, first in the scratch memory, changes with every parameter of
    a shape that is searched, and with no start, load or mass."""
    library = scene_of(name)
    own = own_numbers(library)
    session = Session(library, BALANCED, own.system)

    def digest() -> bytes:
        session.poses()
        return session.work[:1].tobytes()

    first, parameters = digest(), own.arrays["parameters"]
    trees = np.ctypeslib.as_array((ctypes.c_int * 2).from_address(session.system.feature_tree))
    shape = session.instance["feature_pairs"][0]["shape_o" if trees[0] >= 0 else "shape_f"]
    at = (ctypes.c_int * 2).from_address(session.system.feature_parameters)[0 if trees[0] >= 0 else 1]
    assert parameters[at : at + len(shape["parameters"])].tolist() == list(shape["parameters"])
    assert len(shape["parameters"])
    for k in range(len(shape["parameters"])):
        kept = parameters[at + k]
        parameters[at + k] += 1e-9
        assert digest() != first
        parameters[at + k] = kept
    own.arrays["mass_inverse"][:] *= 2
    session.x[:] += 0.1
    assert digest() == first


def test_a_lane_that_fails_leaves_the_others_alone() -> None:
    library = scene_of("ellipsoid_on_plane")
    group, intact = SessionGroup(library, n=6), SessionGroup(library, n=6)
    for each in (group, intact):
        starts(each)
    group.x[1, 2] -= 0.01
    (refused,) = group.begin(2).items()
    assert refused[0] == 1
    assert "run 1, contact 'egg-table'" in str(refused[1])
    assert "interpenetrate" in str(refused[1])
    assert not intact.begin()
    group.x[4, -3:] = np.nan
    stopped = group.x[1].copy()
    for t in TIMES:
        group.advance(t, 2)
        intact.advance(t)
    assert group.outcomes[1] is None
    assert group.outcomes[4] is Outcome.NOT_FINITE
    assert (group.x[1] == stopped).all()
    for lane in (0, 2, 3, 5):
        assert group.save(lane) == intact.save(lane)
    group.load(4, intact.save(4))
    group.advance(0.2)
    intact.advance(0.2)
    assert group.save(4) == intact.save(4)


def test_lists_of_events_that_are_full_are_emptied() -> None:
    library = scene_of("bouncing_ball")
    group, session = SessionGroup(library, n=2), Session(library, BALANCED)
    for events in group._lists:
        events.capacity = 4 * session.n_contact + 2 + 3  # full after four events
    session.begin()
    told = advanced(session, 3.0)
    group.begin()
    group.advance(3.0, 2)
    assert len(told) > 20
    assert [group.drain_events(lane) for lane in range(2)] == [told, told]
    assert group.x[0].tolist() == session.x.tolist()


def test_each_lane_has_its_time() -> None:
    library = scene_of("bouncing_ellipsoid")
    group = SessionGroup(library, n=3)
    group.begin()
    group.advance(np.array([0.1, 0.3, 0.2]), 2)
    assert group.t.tolist() == [0.1, 0.3, 0.2]
    group.advance(0.2)
    assert group.t.tolist() == [0.2, 0.3, 0.2]
    assert (group.x[0] != group.x[1]).any()


def test_arguments_are_checked() -> None:
    library = scene_of("bouncing_ellipsoid")
    group = SessionGroup(library, n=2)
    cases: tuple[tuple[Any, str], ...] = (
        (lambda: SessionGroup(library, n=0), "n: 0; a whole number, at least 1"),
        (lambda: SessionGroup(library, n=2, systems=[None]), "systems: 1 entries; 2, one for each run"),
        (lambda: group.begin(1.5), "threads: 1.5"),  # type: ignore[arg-type]
        (lambda: group.advance(np.zeros(3)), r"t: shape \(3,\)"),
        (lambda: group.advance(np.nan), "t: not finite"),
        (lambda: group.load(0, b"nothing"), "no saved state"),
    )
    for call, words in cases:
        with pytest.raises(SimulationError, match=words):
            call()
