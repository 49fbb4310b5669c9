"""What the force and torque of a joint hold: all that it does to its second body, without spring, damper,
actuator and limits, by Newton's and Euler's equations."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from modelgen import simulate
from modelgen.scene import python_scenes as make
from tests.running import library_of

G = np.array([0.0, 0.0, -9.81])
START = [0.1, 0.2, 0.3]


@pytest.mark.cases(6)
@pytest.mark.parametrize("seed", range(30))
def test_joint_force_and_torque_leave_out_spring_damper_actuator_and_limits(seed: int) -> None:
    rng = np.random.default_rng(seed)
    kind = ("prismatic", "revolute")[seed % 2]
    stiffness, damping, push = rng.uniform(0.5, 2, 3).tolist()
    frame = Rotation.from_rotvec(rng.uniform(-1, 1, 3))
    axis, origin = frame.as_matrix()[:, 2], rng.uniform(-0.2, 0.2, 3)
    mass, inertia = float(rng.uniform(0.5, 2)), rng.uniform(0.05, 0.08, 3)
    limits = {"limits": [0.0, "none"]} if seed % 3 == 0 else {}
    hold = 0.0 if seed % 3 else 30.0  # presses on the limit
    scene = make.scene(
        "joint",
        [make.dynamic("arm", make.sphere(0.1), mass=mass, inertia=inertia.tolist(), position=START)],
        joint=[
            {
                "name": "j", "kind": kind, "between": ["world", "arm"], "position": origin.tolist(),
                "rotation": frame.as_matrix().tolist(), "stiffness": stiffness, "damping": damping,
                "rest": 0.3, **limits,
            }
        ],
        actuator=[{"joint": "j", "force": f"{push!r}*cos(3*t) - {hold!r}"}],
        sensor=[
            {"name": "a", "of": "arm.acceleration"}, {"name": "turning", "of": "arm.angular_acceleration"},
            {"name": "place", "of": "j.coordinate"}, {"name": "rate", "of": "j.rate"},
        ],
    )  # fmt: skip
    path = simulate(library_of(scene), until=0.4, samples=8, estimate=False)
    a, turning, x, rate = np.split(path.sensors, [3, 6, 7], axis=1)
    along = push * np.cos(3 * path.t[:, None]) - hold - stiffness * (x - 0.3) - damping * rate
    if limits:
        assert path.contact_names == ("j:min",)
        assert path.force.max() > 1
        along = along + path.force
    R = Rotation.from_quat(path.quaternion[:, 0], scalar_first=True).as_matrix()
    tensor = R @ np.diag(inertia) @ np.swapaxes(R, 1, 2)
    w = path.w[:, 0]
    spin = np.einsum("nij,nj->ni", tensor, turning) + np.cross(w, np.einsum("nij,nj->ni", tensor, w))
    force, torque = path.joint_force[:, 0], path.joint_torque[:, 0]
    turned = np.einsum("nij,j->ni", R, origin - START)  # the frame in the arm, from its centre
    pull, twist = (along * axis, 0.0) if kind == "prismatic" else (0.0, along * axis)
    at = origin - path.p[:, 0] if kind == "revolute" else turned
    assert mass * (a - G) == pytest.approx(force + pull, abs=1e-9)
    assert spin == pytest.approx(torque + np.cross(at, force + pull) + twist, abs=1e-9)
    assert np.abs((force if kind == "prismatic" else torque) @ axis).max() < 1e-9
