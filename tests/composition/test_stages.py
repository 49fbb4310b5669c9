"""Stages of steps by the composed right-hand side: the kernels of the kinds give the same."""

from __future__ import annotations

import numpy as np
import pytest

from modelgen import Accuracy, build, derive, emit, read, require, simulate
from modelgen.codegen.library import Library
from modelgen.runtime.core_session import Session
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene import python_scenes as make
from modelgen.scene.read import read_text
from tests.running import SCENES, library_of, scene_of

STEP = 1e-3
ROUNDING = 1e-13  # relative to the size of a slope; sums of some hundred terms
COMPOSED = ("ball_in_bowl", "disc_on_rim", "ellipsoid_on_ellipsoid", "ellipsoid_on_plane", "linked_rings")
STICKING = ("coin", "rattleback", "rolling_disc", "rolling_ellipsoid", "spinning_egg")


def held(library: Library, accuracy: Accuracy) -> Session:
    """A session in which the first contact of each pair carries force."""
    session = Session(library, accuracy)
    assert session.begin() == 0
    firsts = [pair["contacts"][0] for pair in session.instance["pairs"]]
    assert all(session.feature_pair[k] >= 0 for k in firsts)
    session.closed[: session.n_contact] = session.active[: session.n_contact] = 0
    session.closed[firsts] = session.active[firsts] = 1
    others = [k for k in range(session.n_contact) if k not in firsts]
    session.feature_pair[others] = -1
    session.friction_mode[:-1] = 1  # sticks
    return session


def by_hand(session: Session) -> np.ndarray:
    """The end of one step of RK4 from evaluations of the right-hand side by the kernels of the kinds."""
    n = session.n_x
    slopes, x = np.zeros((4, n)), session.x[:n].copy()
    for stage, part in enumerate((0.0, 0.5, 0.5, 1.0)):
        at = np.zeros_like(session.x)
        at[:n] = x + part * STEP * (slopes[stage - 1] if stage else 0.0)
        found = np.zeros_like(session.x)
        session.evaluate(0.0, at, found)
        slopes[stage] = found[:n]
    return np.asarray(x + STEP / 6 * (slopes[0] + 2 * (slopes[1] + slopes[2]) + slopes[3]))


@pytest.mark.parametrize("name", [*COMPOSED, *STICKING])
def test_a_step_of_rk4_is_that_of_the_kernels(name: str) -> None:
    library = scene_of(name)
    assert "mg_rhs" in library.manifest.functions
    session = held(library, Accuracy.tight().fixed_step(STEP))
    expected = by_hand(session)
    session.smooth(1)
    np.testing.assert_allclose(
        session.x[: session.n_x - 1], expected[:-1], rtol=ROUNDING, atol=ROUNDING * np.abs(expected).max()
    )


def rolling(friction: float, push: str) -> Trajectory:
    """An ellipsoid that rolls until it slips; with a load it has no composed right-hand side."""
    text = (SCENES / "rolling_ellipsoid.toml").read_text().replace("friction = 1.0", f"friction = {friction}")
    library = library_of(read_text(text + push, "rolling.toml"))
    assert ("mg_rhs" in library.manifest.functions) == (not push)
    return simulate(library, until=1.0, accuracy=Accuracy.tight(), samples=20)


LOAD = '\n[[force]]\nbody = "egg"\nforce = ["0*vx", "0", "0"]\n'


@pytest.mark.parametrize("friction", [0.05, 0.1, 1.0])
def test_rolling_that_comes_to_slip_is_that_of_the_kernels(friction: float) -> None:
    own, other = (rolling(friction, push) for push in ("", LOAD))
    events = [[(event.kind, event.contact) for event in path.events] for path in (own, other)]
    assert events[0] == events[1]
    assert bool(events[0]) == (friction < 1)
    times = [[event.t for event in path.events] for path in (own, other)]
    np.testing.assert_allclose(times[0], times[1], rtol=0, atol=1e-9)
    np.testing.assert_allclose(own.p, other.p, rtol=0, atol=1e-11)


def test_a_contact_that_slips_takes_the_kernels_of_the_kinds() -> None:
    """The composed right-hand side would stop it."""
    session = held(scene_of("sphere_slide_to_roll"), Accuracy.tight().fixed_step(STEP))
    session.friction_mode[:-1] = 4  # slips
    expected = by_hand(session)
    session.smooth(1)
    np.testing.assert_allclose(session.x[: session.n_x - 1], expected[:-1], rtol=ROUNDING, atol=ROUNDING)


@pytest.mark.parametrize("name", [*COMPOSED, *STICKING])
def test_numbers_folded_into_the_code_give_the_same_step(name: str) -> None:
    text = "fold = true\n" + (SCENES / f"{name}.toml").read_text()
    folded = build(emit(derive(require(read_text(text, "folded.toml")))))
    libraries = folded, scene_of(name)
    sessions = [held(library, Accuracy.tight().fixed_step(STEP)) for library in libraries]
    for session in sessions:
        session.smooth(10)
    scale = np.abs(sessions[1].x).max()
    np.testing.assert_allclose(sessions[0].x, sessions[1].x, rtol=0, atol=10 * ROUNDING * scale)


def test_a_contact_without_force_takes_the_kernels_of_the_kinds() -> None:
    """The composed right-hand side would hold it."""
    session = held(scene_of("ellipsoid_on_plane"), Accuracy.tight().fixed_step(STEP))
    session.closed[0] = session.active[0] = 0
    height = int(session.instance["bodies"][1]["u"]) + session.instance["n_q"] + 2
    before = float(session.x[height])
    session.smooth(1)
    assert float(session.x[height]) == pytest.approx(before - 9.81 * STEP, abs=1e-12)


def test_scenes_with_loads_have_none() -> None:
    text = (SCENES / "ellipsoid_on_plane.toml").read_text()
    loaded = text + '\n[[force]]\nbody = "egg"\nforce = ["-0.1*vx", "0", "0"]\n'
    package = emit(derive(require(read_text(loaded, "loaded.toml"))))
    assert "mg_rhs" not in package.manifest.functions
    assert "mg_rhs" in package.manifest.composed
    assert ".scene_rhs" not in package.files["model.c"]
    assert ".scene_rhs" in emit(derive(require(read(SCENES / "ellipsoid_on_plane.toml")))).files["model.c"]


def hung(kind: str, push: bool, inertia: float = 0.01) -> Library:
    """A body on one joint to the world, 0.5 m from its centre of mass."""
    body = make.dynamic(
        "rod", mass=1.0, inertia=[0.6 * inertia, inertia, 0.9 * inertia], position=[0.5, 0.1, -0.2]
    )
    joint = {"name": "held", "kind": kind, "between": ["world", "rod"], "rpy": [0.3, 0.2, 0.1]}
    keys = {"force": [{"body": "rod", "force": ["0*vx", "0", "0"]}]} if push else {}
    return library_of(make.scene("hung", [body], joint=[joint], **keys))


@pytest.mark.parametrize("kind", ["revolute", "spherical", "cylindrical", "universal"])
def test_a_body_on_one_joint_moves_as_by_the_kernels(kind: str) -> None:
    libraries = [hung(kind, push) for push in (False, True)]
    assert ["mg_rhs" in library.manifest.functions for library in libraries] == [True, False]
    own, other = (simulate(each, until=1.0, accuracy=Accuracy.tight(), samples=20) for each in libraries)
    assert own.steps == other.steps
    np.testing.assert_allclose(own.p, other.p, rtol=0, atol=1e-12)
    np.testing.assert_allclose(own.joint_force, other.joint_force, rtol=0, atol=1e-10)


def test_badly_conditioned_rows_of_a_joint_take_the_kernels_of_the_kinds() -> None:
    """Nearly a point mass on a long arm; the composed right-hand side does not refine its forces."""
    own, other = (
        simulate(hung("revolute", push, 1e-6), until=1.0, accuracy=Accuracy.tight(), samples=20)
        for push in (False, True)
    )
    np.testing.assert_array_equal(own.p, other.p)
