"""Loads on rigid bodies against Newton and Euler in momenta and rotation matrices, integrated by SciPy."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from modelgen.scene import python_scenes as make
from tests.oracles.pieces import TABLE, G, ball, imbalance, ran, rotations

MASS, SMALL = 1.3, 0.4
INERTIA = np.array([[0.02, 0.003, -0.002], [0.003, 0.03, 0.004], [-0.002, 0.004, 0.025]])
CENTRE = np.array([0.05, -0.03, 0.02])
ORIGIN, SPIN, VELOCITY = np.array([0.1, 0.2, 0.3]), np.array([1.0, -2.0, 3.0]), np.array([0.3, 0.2, -0.1])
TURN = Rotation.from_rotvec([0.4, -0.7, 0.3])
GRAVITY = np.array([0.1, -0.2, -9.81])
POINTS = np.array([[0.2, 0.1, 0.0], [-0.1, 0.2, 0.3], [0.1, 0.05, -0.2], [0.0, 0.1, 0.0], [0.0, 0.1, 0.1]])
WALL, WALL_TURN, HOOK = np.array([1.0, 0.5, 0.2]), 0.3, np.array([0.1, 0.2, 0.3])


def crank(t: float) -> tuple[np.ndarray, np.ndarray]:
    """A point of the driven body, at (0.1, 0.1, 0.1) in its axes, and its velocity."""
    arm = Rotation.from_euler("xyz", [0.1, 0.2, 0.3]).apply([0.1, 0.1, 0.1])
    turned = Rotation.from_rotvec([0, 0, np.sin(t)]).apply(arm)
    p = np.array([0.5 + 0.3 * np.sin(2 * t), 0.6 + 0.1 * t, 0.7 + 0.2 * np.cos(t)]) + turned
    v = np.array([0.6 * np.cos(2 * t), 0.1, -0.2 * np.sin(t)]) + np.cross([0, 0, np.cos(t)], turned)
    return p, v


def pull(a, b, stiffness: float, damping: float, rest: float) -> np.ndarray:
    """The force on the end a of a spring between (position, velocity) pairs."""
    line = b[0] - a[0]
    length = np.linalg.norm(line)
    n = line / length
    return (stiffness * (length - rest) + damping * n @ (b[1] - a[1])) * n


def slope(t: float, s: np.ndarray) -> np.ndarray:
    """s = [centre, R row by row, v, angular momentum, small ball's p, v]."""
    c, R, v, L, other, other_v = s[:3], s[3:12].reshape(3, 3), s[12:15], s[15:18], s[18:21], s[21:24]
    w = R @ np.linalg.solve(INERTIA, R.T @ L)
    body_w = R.T @ w
    x, y, z, e = Rotation.from_matrix(R).as_quat(canonical=True)
    arms = (POINTS - CENTRE) @ R.T
    ends = [(c + arm, v + np.cross(w, arm)) for arm in arms]
    hook = (WALL + Rotation.from_rotvec([0, 0, WALL_TURN]).apply(HOOK), np.zeros(3))
    between = pull(ends[4], (other, other_v), 8.0, 0.1, 0.5)
    forces = [
        np.array([np.sin(3 * t) - 0.4 * v[0], c[0] * c[1] - 0.3 * v[1], 2 * w[2] + e * x]),
        R @ np.array([0.5 * np.cos(t), -v[2], c[2] + 0.1 * y * e]),
        pull(ends[2], hook, 20.0, 0.7, 0.3),
        pull(ends[3], crank(t), 12.0, 0.2, 0.0),
        between,
    ]
    torque = np.array([0.1 * np.sin(t), -0.05 * w[1], 0.02 * z * x])
    torque = torque + R @ np.array([-0.03 * w[0], 0.1 * t, 0.05 * v[0]])
    torque = torque + sum(np.cross(arm, force) for arm, force in zip(arms, forces, strict=True))
    turning = R @ np.array(
        [[0, -body_w[2], body_w[1]], [body_w[2], 0, -body_w[0]], [-body_w[1], body_w[0], 0]]
    )
    return np.concatenate(
        [v, turning.ravel(), GRAVITY + sum(forces) / MASS, torque, other_v, GRAVITY - between / SMALL]
    )


def test_every_load_at_once_moves_a_body_as_on_a_second_route() -> None:
    body = make.dynamic(
        "body",
        mass=MASS,
        inertia=INERTIA.tolist(),
        center_of_mass=CENTRE.tolist(),
        position=ORIGIN.tolist(),
        quaternion=TURN.as_quat()[[3, 0, 1, 2]].tolist(),
        velocity=VELOCITY.tolist(),
        angular_velocity=SPIN.tolist(),
    )
    wall = make.fixed("wall", position=WALL.tolist(), axis_angle={"axis": [0, 0, 1], "angle": WALL_TURN})
    path = {"position": ["0.3*sin(2*t)", "0.1*t", "0.2*cos(t)"], "rotation_vector": ["0.0", "0.0", "sin(t)"]}
    arm = make.driven("arm", path=path, position=[0.5, 0.6, 0.7], rpy=[0.1, 0.2, 0.3])
    small = make.dynamic(
        "small", mass=SMALL, inertia=[0.01] * 3, position=[1.0] * 3, velocity=[0.0, 0.1, 0.0]
    )
    at = POINTS.tolist()
    seen = ran(
        [body, wall, arm, small],
        1.2,
        gravity=GRAVITY.tolist(),
        force=[
            {"body": "body", "force": ["sin(3*t)-0.4*vx", "x*y-0.3*vy", "2*wz+qw*qx"], "point": at[0]},
            {"body": "body", "force": ["0.5*cos(t)", "-vz", "z+0.1*qy*qw"], "point": at[1], "frame": "body"},
        ],
        torque=[
            {"body": "body", "torque": ["0.1*sin(t)", "-0.05*wy", "0.02*qz*qx"]},
            {"body": "body", "torque": ["-0.03*wx", "0.1*t", "0.05*vx"], "frame": "body"},
        ],
        spring=[
            {"between": ["body", "wall"], "anchors": [at[2], HOOK.tolist()],
             "stiffness": 20.0, "damping": 0.7, "rest_length": 0.3},
            {"between": ["arm", "body"], "anchors": [[0.1] * 3, at[3]], "stiffness": 12.0, "damping": 0.2},
            {"between": ["body", "small"], "anchors": [at[4], [0, 0, 0]],
             "stiffness": 8.0, "damping": 0.1, "rest_length": 0.5},
        ],
    )  # fmt: skip
    R = TURN.as_matrix()
    start = [ORIGIN + R @ CENTRE, R.ravel(), VELOCITY, R @ INERTIA @ R.T @ SPIN, [1.0] * 3, [0.0, 0.1, 0.0]]
    other = solve_ivp(
        slope, (0.0, 1.2), np.concatenate(start), method="DOP853", rtol=1e-12, atol=1e-13, t_eval=seen.t
    )
    assert np.abs(seen.p[:, 0] - other.y[:3].T).max() < 1e-9
    assert np.abs(seen.p[:, 3] - other.y[18:21].T).max() < 1e-9
    assert np.abs(rotations(seen, 0).reshape(-1, 9) - other.y[3:12].T).max() < 1e-8
    assert imbalance(seen) < 1e-11


@pytest.mark.parametrize("frame", ["world", "body"])
def test_a_force_at_a_point_is_the_force_at_the_centre_and_its_moment(frame: str) -> None:
    point, force = np.array([0.3, -0.2, 0.1]), np.array([1.0, 2.0, -0.5])
    keys = {"mass": 2.0, "inertia": [0.1, 0.2, 0.25], "rpy": [0.2, -0.4, 0.6]}
    written = [str(value) for value in force.tolist()]
    one = {"body": "b", "force": written, "point": point.tolist(), "frame": frame}
    a = ran([make.dynamic("b", **keys)], 0.5, force=[one], gravity=[0, 0, 0])
    if frame == "body":
        moment = [str(value) for value in np.cross(point, force).tolist()]
        two = {
            "force": [one | {"point": [0, 0, 0]}],
            "torque": [{"body": "b", "torque": moment, "frame": "body"}],
        }
    else:
        rows = ["1-2*(qy**2+qz**2)", "2*(qx*qy-qw*qz)", "2*(qx*qz+qw*qy)"]
        rows += ["2*(qx*qy+qw*qz)", "1-2*(qx**2+qz**2)", "2*(qy*qz-qw*qx)"]
        rows += ["2*(qx*qz-qw*qy)", "2*(qy*qz+qw*qx)", "1-2*(qx**2+qy**2)"]
        arm = ["+".join(f"({rows[3 * i + j]})*({point[j]})" for j in range(3)) for i in range(3)]
        moment = [f"({arm[i - 2]})*({force[i - 1]})-({arm[i - 1]})*({force[i - 2]})" for i in range(3)]
        two = {"force": [one | {"point": [0, 0, 0]}], "torque": [{"body": "b", "torque": moment}]}
    b = ran([make.dynamic("b", **keys)], 0.5, gravity=[0, 0, 0], **two)
    assert np.abs(a.p - b.p).max() < 1e-13
    assert np.abs(a.quaternion - b.quaternion).max() < 1e-12


def test_drag_on_a_falling_ball_gives_the_exponential() -> None:
    path = ran([ball("b", [0, 0, 0])], 4.0, force=[{"body": "b", "force": ["-0.5*vx", "-0.5*vy", "-0.5*vz"]}])
    assert np.abs(path.v[:, 0, 2] + 2 * G * (1 - np.exp(-path.t / 2))).max() < 1e-11
    assert imbalance(path) < 1e-11


def test_a_spring_between_two_balls_keeps_their_momentum_and_its_frequency() -> None:
    bodies = [ball("a", [0, 0, 0], mass=2.0), ball("b", [1.2, 0, 0], mass=3.0)]
    spring = {"between": ["a", "b"], "stiffness": 30.0, "rest_length": 1.0}
    path = ran(bodies, 5.0, spring=[spring], gravity=[0, 0, 0], samples=50)
    length = path.p[:, 1, 0] - path.p[:, 0, 0]
    assert np.abs(length - 1 - 0.2 * np.cos(5 * path.t)).max() < 1e-11  # k / m = 30 / (6/5)
    assert np.abs(2 * path.v[:, 0] + 3 * path.v[:, 1]).max() < 1e-13


def test_a_force_that_grows_from_nothing_holds_a_touching_ball() -> None:
    # a closed contact without force takes it up at the instant at which it is pressed
    push = [{"body": "b", "force": ["0.0", "0.0", "-t*sin(t)"]}]
    path = ran(
        [TABLE, ball("b", [0, 0, 0.1])],
        6.0,
        [{"between": ["b", "table"]}],
        force=push,
        gravity=[0, 0, 0],
    )
    pressed = path.t < np.pi
    assert np.abs(path.force[pressed, 0] - (path.t * np.sin(path.t))[pressed]).max() < 1e-9
    lift = next(event.t for event in path.events if event.kind == "lift-off")
    assert lift == pytest.approx(np.pi, abs=1e-10)
    t = path.t[~pressed]
    rise = (
        t * np.sin(t) + 2 * np.cos(t) + 2 + np.pi * (t - np.pi)
    )  # twice the integral of -t sin t from pi on
    assert np.abs(path.p[~pressed, 1, 2] - 0.1 - rise).max() < 1e-10
    assert imbalance(path) < 1e-10
