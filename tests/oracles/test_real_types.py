"""The same source over float, double and long double: each agrees with the finer as far as it resolves."""

from __future__ import annotations

import numpy as np
import pytest

from modelgen import Accuracy
from modelgen.codegen.library import Library
from modelgen.runtime.accuracy import RESOLVED
from modelgen.runtime.core_session import Session
from modelgen.runtime.start import begin
from modelgen.runtime.trajectory import Event, Outcome, Trajectory
from tests.oracles.plain_rows import followed
from tests.registry import REGISTRY
from tests.running import run, scene_of

FORMS = REGISTRY["ellipsoid_on_plane"].forms
WIDER = np.finfo(np.longdouble).eps < np.finfo(np.float64).eps
GRIPS = (
    *("slip-start", "slip-stop", "slip-reversal", "spin-start", "spin-stop", "spin-reversal"),
    *("roll-start", "roll-stop", "roll-reversal"),
)
IN_FLOAT = ("box_dropped", "egg_on_spline", "four_bar", "glass_on_table", "linked_rings", "turntable")
SCENES_IN_FLOAT = [
    pytest.param(name, marks=() if name in IN_FLOAT else pytest.mark.slow) for name in REGISTRY
]
needs_long = pytest.mark.skipif(not WIDER, reason="long double is double here")


def egg(form: str, real: str, accuracy: Accuracy) -> Trajectory:
    path = run("ellipsoid_on_plane", accuracy, form=form, real=real, until=1.0, samples=20)
    assert path.outcome is Outcome.DONE
    return path


def apart(one: Trajectory, other: Trajectory) -> tuple[float, float, float]:
    """Largest differences of position, rotation and angular velocity."""
    fields = ("p", "quaternion", "w")
    p, e, w = (float(np.abs(getattr(one, name) - getattr(other, name)).max()) for name in fields)
    return p, e, w


@pytest.mark.cases(3)
@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("accuracy", [Accuracy.of(1e-5), Accuracy.balanced(), Accuracy.tight()])
def test_float_follows_double(form: str, accuracy: Accuracy) -> None:
    coarse = egg(form, "float", accuracy)
    p, e, w = apart(coarse, egg(form, "double", Accuracy.tight()))
    assert p < 2e-5
    assert e < 2e-4
    assert w < 2e-3
    assert coarse.steps < 50
    assert coarse.energy_drift < 1e-4


FAINT = 1e-6  # m/s, speed of a strike out of rounding, as of the flanks of gears that take over


def flat(events: tuple[Event, ...]) -> float:
    """Time of the first strike that is faint, or below a twentieth of the fastest: float lands flat there."""
    fastest = max((event.speed for event in events), default=0.0)
    slow = max(fastest / 20, FAINT)
    return min((event.t for event in events if 0 < event.speed < slow), default=np.inf)


def lively(events: tuple[Event, ...], end: float) -> list[tuple[str, str]]:
    """Kinds and contacts before a time.

    When a contact slips or sticks is not compared: float decides friction to a thousandth.
    """
    return [(event.kind, event.contact) for event in events if event.t < end and event.kind not in GRIPS]


@pytest.mark.cases(3)
@pytest.mark.parametrize("name", SCENES_IN_FLOAT)
def test_every_scene_runs_in_float(name: str) -> None:
    coarse = run(name, Accuracy.balanced(), real="float", until=0.5, samples=5)
    fine = run(name, Accuracy.tight(), until=0.5, samples=5)
    assert coarse.outcome is Outcome.DONE
    end = min(flat(coarse.events), flat(fine.events)) - 1e-4  # what leads to the strike comes with it
    assert lively(coarse.events, end) == lively(fine.events, end)
    assert np.abs(coarse.p - fine.p).max() < REGISTRY[name].single


@pytest.mark.parametrize("name", ["linked_rings", "disc_on_rim"])
@pytest.mark.parametrize("accuracy", [Accuracy.fast(), Accuracy.tight()])
def test_float_finds_the_start_of_curves(name: str, accuracy: Accuracy) -> None:
    coarse = run(name, accuracy, real="float", until=0.5, samples=5)
    assert coarse.outcome is Outcome.DONE
    assert np.abs(coarse.p - run(name, Accuracy.tight(), until=0.5, samples=5).p).max() < 2e-5


@needs_long
@pytest.mark.parametrize("form", FORMS)
def test_double_follows_long_double(form: str) -> None:
    p, e, w = apart(egg(form, "double", Accuracy.tight()), egg(form, "long double", Accuracy.of(1e-16)))
    assert p < 1e-12
    assert e < 1e-11
    assert w < 1e-10


@needs_long
def test_two_forms_in_long_double_agree_beyond_double() -> None:
    support, implicit = (egg(form, "long double", Accuracy.of(1e-16)) for form in ("support", "implicit"))
    assert np.abs(support.p - implicit.p).max() < 1e-16
    assert np.abs(support.w - implicit.w).max() < 1e-14


def called(library: Library, kernel: str, arguments: list[np.ndarray]) -> list[np.ndarray]:
    return list(library.kernel(kernel)(*(argument.astype(library.dtype) for argument in arguments)))


def starts_of(library: Library) -> dict[str, dict[str, np.ndarray]]:
    """Of each contact kind's kernels the poses, closest points and parameters of one contact at the start."""
    session = Session(library, Accuracy.tight())
    begin(session)
    poses, starts = session.poses(), {}
    for contact in followed(library, session.feature_pair[:-1]):
        kind = library.manifest.kinds["contact"][contact["kind"]]
        eta = session.eta[contact["eta"] : contact["eta"] + kind["n_eta"]].copy()
        values = {"pose_o": poses[contact["o"]], "pose_f": poses[contact["f"]], "eta": eta}
        values["parameters"] = np.array(contact["parameters"], float)
        starts |= {f"mg_{kind['name']}_{role}": values for role in ("rates", "place")}
    return starts


@pytest.mark.cases(1)
@needs_long
@pytest.mark.parametrize("name", ["ellipsoid_on_plane", "ellipsoids_in_bowl", "user_surface"])
def test_kernels_in_double_are_those_in_long_double(name: str) -> None:
    double, extended = scene_of(name), scene_of(name, real="long double")
    random, starts = np.random.default_rng(0), starts_of(double)
    for kernel in 5 * list(double.manifest.functions):
        inputs, given = double.kernel(kernel).inputs, starts.get(kernel, {})
        arguments = [given.get(key, random.uniform(0.5, 1.5, size))[:size] for key, (size,) in inputs]
        pairs = zip(called(double, kernel, arguments), called(extended, kernel, arguments), strict=True)
        for found, exact in pairs:
            size = max(1.0, float(np.abs(exact).max(initial=0.0)))
            assert np.abs(found - exact).max(initial=0.0) < 1e-13 * size, kernel


def test_no_tolerance_is_finer_than_the_real_type() -> None:
    for real in ("double", "float"):
        library = scene_of("ellipsoid_on_plane", real=real)
        for accuracy in (Accuracy.fast(), Accuracy.balanced(), Accuracy.tight()):
            settings = Session(library, accuracy).settings
            epsilon = float(np.finfo(library.dtype).eps)
            for name, multiple in RESOLVED.items():
                record = accuracy if name in Accuracy.__slots__ else accuracy.thresholds
                taken, wanted = getattr(settings, name), getattr(record, name)
                assert taken == pytest.approx(max(wanted, multiple * epsilon), rel=1e-6)
                assert real == "float" or taken == wanted
