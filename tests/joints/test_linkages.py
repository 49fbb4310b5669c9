"""Linkages against minimal coordinates: each to 1e-8 m, and far below."""

from __future__ import annotations

import numpy as np

from modelgen import Accuracy
from modelgen.runtime.trajectory import Trajectory
from tests.joints.minimal import double_pendulum, four_bar, slider_crank, solved
from tests.running import run

CLOSE = 1e-10  # m


def off(path: Trajectory, bodies: list[str], centres: np.ndarray) -> float:
    """The largest distance of the bodies' centres from (n, bodies, 2) in x-z, or from the plane."""
    p = path.p[:, [path.body_names.index(body) for body in bodies]]
    return float(max(np.abs(p[..., [0, 2]] - centres).max(), np.abs(p[..., 1]).max()))


def test_a_four_bar_linkage_follows_lagranges_equation_in_its_crank() -> None:
    path = run("four_bar", Accuracy.tight())
    slope, where = four_bar()
    turns = solved(slope, [0.0, 6.0], path.t).y[0]
    centres = np.array([where(turn)[0].full() for turn in turns])
    assert off(path, ["crank", "coupler", "rocker"], centres) < CLOSE
    assert np.abs(path.coordinates[:, path.coordinate_names.index("crank_hinge.angle")] - turns).max() < CLOSE
    assert path.joint_error_max < 1e-14
    assert path.energy_drift < 1e-12
    assert turns[-1] > 2 * np.pi


def test_the_redundant_hinge_of_a_four_bar_linkage_is_named() -> None:
    path = run("four_bar", Accuracy.balanced(), until=0.1)
    assert [w for w in path.warnings if w.startswith("joint 'rocker_hinge' is redundant: 3 of its 5 rows")]
    assert sum("redundant" in warning for warning in path.warnings) == 1


def test_the_forces_at_the_hinges_of_a_four_bar_linkage_are_its_change_of_momentum() -> None:
    path = run("four_bar", Accuracy.tight(), samples=2000)
    mass = np.array([1.0, 0.8, 1.2])
    first, last = (path.joint_names.index(name) for name in ("crank_hinge", "rocker_hinge"))
    ground = path.joint_force[:, first] - path.joint_force[:, last]
    momentum = np.einsum("b,nbi->ni", mass, path.v[:, :3])
    h = path.t[1] - path.t[0]
    change = (momentum[:-4] - 8 * momentum[1:-3] + 8 * momentum[3:-1] - momentum[4:]) / (12 * h)
    wanted = change + np.array([0.0, 0.0, 9.81 * mass.sum()])
    assert np.abs(ground[2:-2] - wanted).max() < 1e-5 * np.abs(wanted).max()


def test_a_slider_crank_with_a_cam_follower_follows_lagranges_equation_in_its_crank() -> None:
    path = run("slider_crank", Accuracy.tight())
    slope, where = slider_crank()
    turns = solved(slope, [0.0, 8.0], path.t).y[0]
    centres = np.array([where(turn).full() for turn in turns])
    assert off(path, ["crank", "rod", "slider", "follower"], centres) < CLOSE
    assert not path.events
    assert path.force[:, 0].min() > 0


def stopped(times: np.ndarray) -> tuple[np.ndarray, list[float]]:
    """Angles (n, 2) of the double pendulum with Newton's law at its stop, and the times of the impacts."""
    slope, _, mass = double_pendulum()
    low, high, restitution = -0.7, 0.3, 0.6
    t, state = 0.0, np.zeros(4)
    angles, impacts = np.zeros((len(times), 2)), []

    def bound(limit: float, sign: float):
        def gap(_: float, s: np.ndarray) -> float:
            return sign * (s[1] - s[0] - limit)

        gap.terminal, gap.direction = True, -1
        return gap

    while t < times[-1]:
        left = times[times >= t]
        grid = np.unique(np.concatenate([[t], left]))
        found = solved(slope, state, grid, events=[bound(low, 1.0), bound(high, -1.0)])
        done = np.isin(times, found.t)
        angles[done] = found.y[:2, np.isin(found.t, times)].T
        if found.status != 1:
            break
        hit = next(k for k in range(2) if len(found.t_events[k]))
        t, state = float(found.t_events[hit][0]), found.y_events[hit][0].copy()
        impacts.append(t)
        W = np.array([-1.0, 1.0])
        weighed = np.linalg.solve(mass(state[:2]).full(), W)
        state[2:] -= weighed * (1 + restitution) * (W @ state[2:]) / (W @ weighed)
    return angles, impacts


def test_a_double_pendulum_with_a_stop_follows_lagranges_equations_and_newtons_law() -> None:
    path = run("double_pendulum", Accuracy.tight())
    angles, impacts = stopped(path.t)
    where = double_pendulum()[1]
    centres = np.array([where(pair).full() for pair in angles])
    struck = [event for event in path.events if event.kind == "impact"]
    assert len(struck) == len(impacts) >= 4
    assert np.abs(np.array([event.t for event in struck]) - impacts).max() < CLOSE
    assert {event.contact for event in struck} == {"elbow:min", "elbow:max"}
    assert off(path, ["upper", "lower"], centres) < CLOSE
