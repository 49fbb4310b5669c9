"""Curves through the whole pipeline: shipped scenes and small ones against references of their own."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import eigh

from modelgen import Accuracy, read, simulate
from modelgen.errors import SceneError, SimulationError
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene import python_scenes as make
from tests.oracles.pieces import TABLE, G, ball, ran, rotations
from tests.running import SCENES, library_of, run

TIGHT = Accuracy.tight()
R, r, MASS, ACROSS = 0.2, 0.15, 0.3, 0.003375  # linked rings: radii, mass, moment about a diameter


def test_a_disc_on_its_rim_is_a_heavy_symmetric_top_on_a_sliding_point() -> None:
    """T = m (r cos(a) a')^2/2 + A (a'^2 + (f' sin a)^2)/2 + C n^2/2, V = m g r sin a; L_z and n are kept."""
    path = run("disc_on_rim", TIGHT)
    m, radius, A, C = 0.5, 0.1, 0.00125, 0.0025
    turn = rotations(path, 1)[0]
    w = turn.T @ [0.0, 2.0, 1.0]
    n, L = w[2], (turn @ ([A, A, C] * w))[2]
    tilt = np.arccos(turn[2, 2])
    rate = -np.cross([0.0, 2.0, 1.0], turn[:, 2])[2] / np.sin(tilt)

    def motion(t: float, x: np.ndarray) -> list[float]:
        s, c = np.sin(x[0]), np.cos(x[0])
        turning = (L - C * n * c) / (A * s * s)
        pull = (
            m * radius**2 * s * c * x[1] ** 2
            + A * turning**2 * s * c
            - C * n * turning * s
            - m * G * radius * c
        )
        return [x[1], pull / (A + m * (radius * c) ** 2)]

    found = solve_ivp(motion, (0, path.t[-1]), [tilt, rate], "DOP853", path.t, rtol=1e-13, atol=1e-13).y[0]
    assert np.abs(path.p[:, 1, 2] - radius * np.sin(found)).max() < 1e-10
    assert np.abs(path.p[:, 1, :2] - np.outer(path.t, [0.3, 0.1])).max() < 1e-11
    assert path.energy_drift < 1e-11
    assert path.gap_max < 1e-12


@pytest.mark.cases(2)
@pytest.mark.parametrize("form", ["curve_implicit", "curve_block", "curve_differentiated"])
def test_every_form_takes_the_disc_the_same_way(form: str) -> None:
    other = run("disc_on_rim", TIGHT, form, until=0.5)
    assert np.abs(other.p - run("disc_on_rim", TIGHT, until=0.5).p).max() < 1e-10


def linked(**keys: object) -> Trajectory:
    """The shipped rings with another start of the hanging one."""
    scene = read(SCENES / "linked_rings.toml")
    until = float(keys.pop("until", 5.0))  # type: ignore[arg-type]
    changed = replace(scene, bodies=(scene.bodies[0], replace(scene.bodies[1], **keys)))  # type: ignore[arg-type]
    return simulate(library_of(changed), until=until, accuracy=TIGHT, samples=200, estimate=False)


def test_linked_rings_swing_for_a_hundred_seconds() -> None:
    path = run("linked_rings", TIGHT, until=100.0)
    assert path.outcome.name == "DONE"
    assert path.energy_drift < 1e-8
    assert path.gap_max < 1e-12
    assert path.force[:, 0].min() > 0
    assert touches_in_one_place(path)


def test_rings_in_one_plane_are_a_double_pendulum() -> None:
    """The first link has length R and no mass, the second length r and the ring's moment about a diameter."""

    def motion(t: float, x: np.ndarray) -> np.ndarray:
        a, b, a1, b1 = x
        c, s = np.cos(a - b), np.sin(a - b)
        M = [[MASS * R**2, MASS * R * r * c], [MASS * R * r * c, MASS * r**2 + ACROSS]]
        f = [-R * r * s * b1**2 - G * R * np.sin(a), R * r * s * a1**2 - G * r * np.sin(b)]
        return np.concatenate([x[2:], np.linalg.solve(M, MASS * np.array(f))])

    path = linked(velocity=(0.25, 0.0, 0.0))
    a, b = solve_ivp(motion, (0, 5.0), [0, 0, 0.5, 1.0], "DOP853", path.t, rtol=1e-13, atol=1e-13).y[:2]
    assert np.abs(path.p[:, 1, 0] - R * np.sin(a) - r * np.sin(b)).max() < 1e-9
    assert np.abs(path.p[:, 1, 2] + R * np.cos(a) + r * np.cos(b)).max() < 1e-9
    assert np.abs(path.p[:, 1, 1]).max() < 1e-12


def test_small_swings_have_the_frequencies_of_the_linearised_rings() -> None:
    """M = m [[R^2, R r], [R r, r^2 + A/m]], K = m g diag(R, r) along the fixed ring; g/r across."""
    M = MASS * np.array([[R**2, R * r], [R * r, r**2 + ACROSS / MASS]])
    squares, modes = eigh(MASS * G * np.diag([R, r]), M)
    size = 1e-5
    start = np.linalg.solve(modes, [0.5, 1.0])
    path = linked(velocity=(0.25 * size, 0.3 * size, 0.0), angular_velocity=(0.0, -size, 0.0))
    swing = modes @ (start[:, None] * np.sin(np.outer(np.sqrt(squares), path.t)) / np.sqrt(squares)[:, None])
    assert np.abs(path.p[:, 1, 0] / size - np.array([R, r]) @ swing).max() < 1e-6
    across = 0.3 * np.sin(np.sqrt(G / r) * path.t) / np.sqrt(G / r)
    assert np.abs(path.p[:, 1, 1] / size - across).max() < 1e-6


def test_a_ring_falls_into_its_hook() -> None:
    """The start is apart, so that no normal is needed; the fall ends after sqrt(2 h/g) with an impact."""
    drop = linked_drop(0.05, restitution=0.4)
    impact = drop.events[0]
    assert impact.kind == "impact"
    assert impact.t == pytest.approx(np.sqrt(0.1 / G), abs=1e-10)
    assert drop.gap[:, 0].min() > -1e-12
    assert touches_in_one_place(drop)


def touches_in_one_place(path: Trajectory) -> bool:
    """Whether the first contact of the pair alone is ever on a link."""
    return bool((path.feature_pair[:, 0] >= 0).all() and (path.feature_pair[:, 1:] < 0).all())


def linked_drop(height: float, **contact: object) -> Trajectory:
    hook = make.fixed("hook", make.circle(R), rpy=["pi/2", 0, 0])
    ring = make.dynamic(
        "ring", make.circle(r), mass=MASS, inertia=[ACROSS, ACROSS, 2 * ACROSS],
        position=[0, 0, -R - r + height], rpy=[0, "pi/2", 0],
    )  # fmt: skip
    return ran([hook, ring], 0.3, [{"between": ["hook", "ring"], **contact}])


def test_two_curves_that_touch_at_the_start_need_a_side() -> None:
    with pytest.raises(SimulationError, match="normal"):
        linked_drop(0.0)


def test_the_normal_of_two_curves_stays_while_tangents_pass_through_parallel() -> None:
    """A ring turns about the line of the two centres: the tangents are parallel twice a turn, at a gap."""
    hoop = make.fixed("hoop", make.circle(1.0))
    ring = make.dynamic(
        "ring", make.circle(0.5), mass=1.0, inertia=[1.0, 1.0, 1.0], position=[2.0, 0, 0],
        angular_velocity=[3.0, 0, 0], rpy=[0.4, 0, 0],
    )  # fmt: skip
    path = ran([hoop, ring], 5.0, [{"between": ["hoop", "ring"]}], gravity=[0, 0, 0], samples=300)
    assert touches_in_one_place(path)
    assert np.abs(path.gap[:, 0] - 0.5).max() < 1e-12
    assert np.abs(path.normals[:, 0] - [1.0, 0, 0]).max() < 1e-12
    signs = path.eta[:, 2]
    assert set(np.sign(signs)) == {-1.0, 1.0}
    assert set(path.eta[:, 3]) == {1.0}


def test_a_ball_on_two_rails_rolls_on_without_force_along_them() -> None:
    """Straight edges: each rail carries m g/(2 cos) and the ball keeps its speed."""
    half, radius = 0.06, 0.1
    rails = [
        make.fixed(name, make.line(rpy=[0, "pi/2", 0]), position=[0, y, 0])
        for name, y in (("left", half), ("right", -half))
    ]
    high = np.sqrt(radius**2 - half**2)
    contact = [{"between": ["ball", name]} for name in ("left", "right")]
    path = ran([*rails, ball("ball", [0, 0, high], velocity=[0.3, 0, 0])], 2.0, contact)
    assert np.abs(path.p[:, 2] - [0, 0, high] - np.outer(path.t, [0.3, 0, 0])).max() < 1e-12
    assert np.abs(path.force - G / 2 * radius / high).max() < 1e-9


def test_crossing_wires_collide_like_points_of_their_reduced_mass() -> None:
    """A wire falls across a fixed one above its centre and bounces without turning: v' = -e v."""
    fixed_wire = make.fixed("under", make.segment(1.0, rpy=[0, "pi/2", 0]))
    wire = make.dynamic(
        "over", make.segment(1.0), mass=0.2, inertia=[0.01, 0.01, 0.001], position=[0, 0, 0.1],
        rpy=["pi/2", 0, 0],
    )  # fmt: skip
    path = ran([fixed_wire, wire], 0.25, [{"between": ["under", "over"], "restitution": 0.6}])
    fall = np.sqrt(0.2 / G)
    t = path.t[-1] - fall
    assert path.events[0].t == pytest.approx(fall, abs=1e-11)
    assert path.p[-1, 1, 2] == pytest.approx(0.6 * G * fall * t - G * t * t / 2, abs=1e-11)
    assert np.abs(path.w).max() < 1e-12


def test_a_curve_of_the_users_own_is_that_of_the_catalogue() -> None:
    """The rim of a disc with a parameter that is no arc length."""
    own = make.curve(
        "r*cos(t + 0.2*sin(t))", "r*sin(t + 0.2*sin(t))", "0*t", domain=[-3.2, 3.2], parameters={"r": 0.1}
    )
    keys = {
        "mass": 0.5, "inertia": [0.00125, 0.00125, 0.0025], "position": [0, 0, "0.1*sin(1.1)"],
        "rpy": [1.1, 0, 0], "angular_velocity": [0, 2.0, 1.0],
    }  # fmt: skip
    runs = [
        ran([TABLE, make.dynamic("disc", shape, **keys)], 1.0, [{"between": ["disc", "table"]}])
        for shape in (own, make.circle(0.1))
    ]
    assert np.abs(runs[0].p - runs[1].p).max() < 1e-10


@pytest.mark.parametrize(
    ("shapes", "contact", "words"),
    [
        ((make.plane(), make.line()), {}, "no form"),
        ((make.plane(), make.circle(1.0)), {"normal": [0, 0, 1]}, "two curves"),
        ((make.circle(1.0), make.circle(1.0)), {"normal": [0, 0, 0]}, "nonzero"),
        ((make.circle(1.0), make.circle(1.0)), {"form": "block"}, "curves_block"),
    ],
)
def test_what_curves_cannot_do_is_refused(shapes: tuple, contact: dict, words: str) -> None:
    body = make.dynamic("b", shapes[1], mass=1.0, inertia=[1, 1, 1], position=[0, 0, 1])
    bodies = [make.fixed("a", shapes[0]), body]
    with pytest.raises(SceneError, match=words):
        ran(bodies, 0.1, [{"between": ["a", "b"], **contact}])


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"x": "1", "y": "2", "z": "3", "domain": [0, 1]}, "depend on t"),
        ({"x": "t", "y": "0", "z": "0", "domain": [1, 0]}, "smaller"),
        ({"x": "t", "y": "0", "z": "0", "domain": [0, 1], "periodic": True}, "closes"),
        ({"x": "log(t - 5)", "y": "0", "z": "0", "domain": [0, 1]}, "finite"),
        ({"x": "t", "y": "0", "z": "0", "domain": [0, 1], "cavity": True}, "cavity"),
        ({"x": "u", "y": "0", "z": "0", "domain": [0, 1]}, "u"),
    ],
)
def test_a_broken_curve_is_refused_with_its_reason(keys: dict, words: str) -> None:
    with pytest.raises(SceneError, match=words):
        make.shape("curve", **keys)
