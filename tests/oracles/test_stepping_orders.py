"""Order of time-stepping where nothing is struck: two; and the ledger of its work."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.special import ellipj

from modelgen import Accuracy, simulate
from modelgen.codegen.library import Library
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Scene
from tests.oracles.pieces import TABLE, G, ball, rotations, solid, times
from tests.running import library_of, scene_of

SCHEMES = ("stewart-trinkle", "anitescu-potra", "moreau")
STEPS = (4e-3, 2e-3, 1e-3, 5e-4)
EGG = (0.12, 0.09, 0.07)
SPIN = (3.0, 4.0, -2.0)
AXES_SPIN = (2.0, 0.0, 4.0)  # about the axes of least and of largest inertia


def order(errors: list[float]) -> float:
    """The slope of log error over log step."""
    return float(np.polyfit(np.log(STEPS), np.log(errors), 1)[0])


def stepped(library: Library, until: float, step: float, scheme: str) -> Trajectory:
    record = Accuracy.balanced().time_stepping(step, scheme)  # type: ignore[arg-type]
    return simulate(library, until=until, samples=1, accuracy=record, estimate=False)


def reference(library: Library, until: float) -> Trajectory:
    """The event-driven run at tolerance 1e-12."""
    return simulate(library, until=until, samples=1, accuracy=Accuracy.of(1e-12), estimate=False)


def flight(spin: tuple[float, ...] = SPIN, **keys: object) -> Scene:
    """An ellipsoid with unequal inertias far above a plane."""
    egg = solid("egg", EGG, position=[0, 0, 50.0], angular_velocity=list(spin), velocity=[3.0, 1.0, 0])
    return make.scene("flight", [TABLE, egg], contact=[{"between": ["egg", "table"]}], **keys)


def orders(library: Library, scheme: str, until: float) -> dict[str, float]:
    """Order of positions, rotations, velocities and spins at the end; of those that differ at all."""
    exact = reference(library, until)
    runs = [stepped(library, until, step, scheme) for step in STEPS]
    found = {}
    for name in ("p", "quaternion", "v", "w"):
        errors = [float(np.abs(getattr(run, name)[-1] - getattr(exact, name)[-1]).max()) for run in runs]
        if max(errors) > 1e-13:
            found[name] = order(errors)
    return found


@pytest.mark.parametrize("scheme", SCHEMES)
def test_flight_against_drag_is_of_order_two(scheme: str) -> None:
    drag = {"body": "egg", "force": ["-2*vx", "-3*vy*sqrt(vx*vx + vy*vy)", "-vz"]}
    twist = {"body": "egg", "torque": ["-0.004*wx", "-0.002*wy", "0.0"]}
    found = orders(library_of(flight(force=[drag], torque=[twist])), scheme, 1.0)
    assert set(found) == {"p", "quaternion", "v", "w"}
    assert min(found.values()) > 1.9


def jacobi(inertia: np.ndarray, spin: np.ndarray, t: float) -> np.ndarray:
    """Spin (3,) at time t without torque, I_1 < I_2 < I_3, from a start with w_2 = 0 and w_1, w_3 > 0.

    Landau and Lifshitz, Mechanics, section 37, for M^2 > 2 E I_2.
    """
    one, two, three = inertia
    energy, square = inertia @ spin**2, np.square(inertia * spin).sum()  # 2 E and M^2
    assert square > energy * two
    least, most = energy * three - square, square - energy * one
    rate = np.sqrt((three - two) * most / (one * two * three))
    sn, cn, dn, _ = ellipj(rate * t, (two - one) * least / ((three - two) * most))
    first, second = np.sqrt(least / (one * (three - one))), np.sqrt(least / (two * (three - two)))
    return np.array([first * cn, second * sn, np.sqrt(most / (three * (three - one))) * dn])


@pytest.mark.parametrize("scheme", SCHEMES)
def test_free_spin_is_of_order_two_against_jacobis_functions(scheme: str) -> None:
    """The spin by Euler's equations in closed form, and the constant angular momentum."""
    library, until = library_of(flight(AXES_SPIN, gravity=[0, 0, 0])), 2.0
    squares, spin = np.square(EGG), np.array(AXES_SPIN)
    inertia = (squares.sum() - squares) / 5
    exact = jacobi(inertia, spin, until)
    assert abs(exact[1]) > 0.1
    spins, momenta = [], []
    for step in STEPS:
        path = stepped(library, until, step, scheme)
        turn = rotations(path, 1)[-1]
        own = turn.T @ path.w[-1, 1]
        spins.append(float(np.abs(own - exact).max()))
        momenta.append(float(np.abs(turn @ (inertia * own) - inertia * spin).max()))
    assert order(spins) > 1.9
    assert order(momenta) > 1.9
    assert spins[-1] < 1e-4


def test_a_linkage_is_of_order_two_and_its_ledger_exact_where_rows_are_taken_in_the_middle() -> None:
    library = scene_of("double_pendulum")
    found = orders(library, "moreau", 0.25)
    assert min(found["p"], found["quaternion"]) > 1.9
    assert stepped(library, 0.25, 1e-3, "moreau").energy_drift < 1e-12


@pytest.mark.parametrize("scheme", SCHEMES)
def test_drag_takes_what_the_ledger_says(scheme: str) -> None:
    """Without spin, the work of the loads and of gravity is the change of the kinetic energy, to rounding."""
    drag = {"body": "egg", "force": ["-2*vx", "-3*vy*sqrt(vx*vx + vy*vy)", "4*cos(5*t) - vz"]}
    library = library_of(flight((0.0, 0.0, 0.0), force=[drag]))
    assert stepped(library, 1.0, 4e-3, scheme).energy_drift < 1e-12


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("restitution", [0.3, 0.7])
def test_bounces_keep_their_heights_and_times_with_order_one(scheme: str, restitution: float) -> None:
    """The first two impacts of a ball are within five steps of their times, at any step."""
    height = 0.3
    bodies = [TABLE, ball("b", [0, 0, 0.1 + height])]
    contact = [{"between": ["b", "table"], "restitution": restitution}]
    library = library_of(make.scene("bounces", bodies, contact=contact))
    fall = (2 * height / G) ** 0.5
    exact = [fall, fall * (1 + 2 * restitution)]
    for step in STEPS:
        path = stepped(library, 1.2 * exact[-1], step, scheme)
        assert times(path, "impact")[:2] == pytest.approx(exact, abs=5 * step)
        assert path.energy.max() <= path.energy[0] * (1 + 1e-9)
