"""Shipped scenes against trajectories found on another route."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from modelgen import Accuracy
from modelgen.runtime.trajectory import Trajectory
from tests.oracles.support_route import SupportRoute, solid
from tests.running import run

DATA = json.loads((Path(__file__).parent / "data" / "ellipsoid_on_plane.json").read_text())
FORMS_ON_PLANE = ["support", "implicit", "block", "paper", "mixed", "differentiated"]


def rotations(path: Trajectory, body: int) -> np.ndarray:
    return Rotation.from_quat(np.roll(path.quaternion[:, body].astype(float), -1, axis=-1)).as_matrix()


@pytest.mark.cases(3)
@pytest.mark.parametrize("form", FORMS_ON_PLANE)
def test_an_ellipsoid_on_a_plane_follows_its_reference(form: str) -> None:
    rows = DATA["trajectory"]
    path = run("ellipsoid_on_plane", Accuracy.tight(), form=form, until=1.0, samples=20)
    assert np.allclose(path.t, [row["t"] for row in rows], atol=1e-14)
    assert np.abs(path.p[:, 1] - [row["p"] for row in rows]).max() < 1e-8
    assert np.abs(rotations(path, 1) - [row["R"] for row in rows]).max() < 1e-7
    assert np.abs(path.v[:, 1] - [row["v"] for row in rows]).max() < 1e-6
    assert np.abs(path.w[:, 1] - [row["w"] for row in rows]).max() < 1e-6
    assert np.abs(path.points_f[:, 0] - [row["contact"] for row in rows]).max() < 1e-7
    force = np.array([row["normal_force"] for row in rows])
    assert np.abs(path.force[:, 0] / force - 1).max() < 1e-6


def compared(path: Trajectory, route: SupportRoute, direction: list[float]) -> tuple[float, float]:
    """Largest differences of position and rotation matrix between a run and the second route."""
    start = path.quaternion[0, 1]
    spin = rotations(path, 1)[0].T @ path.w[0, 1]
    guess = route.angles(np.array(direction))
    other = route.run(path.p[0, 1], start, path.v[0, 1], spin, guess, path.t)
    position = np.abs(path.p[:, 1] - other.y[:3].T).max()
    turned = Rotation.from_quat(np.roll(other.y[3:7].T, -1, axis=-1)).as_matrix()
    return float(position), float(np.abs(rotations(path, 1) - turned).max())


@pytest.mark.cases(1)
@pytest.mark.parametrize("form", ["implicit", "block", "mixed"])
def test_an_ellipsoid_in_a_cavity_follows_a_second_route(form: str) -> None:
    path = run("ellipsoid_in_cavity", Accuracy.tight(), form=form, until=2.0, samples=20)
    inner, wall = solid((0.1, 0.07, 0.05), 0.8), solid((0.5, 0.45, 0.4), 1.0)
    frame = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
    route = SupportRoute(inner, wall, cavity=True, frame=frame)
    position, rotation = compared(path, route, [0.1, 0.1, -1.0])
    assert position < 1e-10
    assert rotation < 1e-9


@pytest.mark.cases(2)
@pytest.mark.parametrize("form", ["implicit", "block", "paper"])
def test_an_ellipsoid_slides_off_an_ellipsoid_as_on_a_second_route(form: str) -> None:
    path = run("ellipsoid_on_ellipsoid", Accuracy.tight(), form=form, until=0.4, samples=20)
    pebble, rock = solid((0.05, 0.04, 0.03), 0.25), solid((0.3, 0.25, 0.2), 1.0)
    route = SupportRoute(pebble, rock, cavity=False, frame=np.eye(3))
    position, rotation = compared(path, route, [0.2, 0.1, 1.0])
    assert position < 1e-10
    assert rotation < 1e-9


def test_the_pebble_lifts_off_where_its_force_vanishes() -> None:
    path = run("ellipsoid_on_ellipsoid", Accuracy.tight())
    lift = next(event for event in path.events if event.kind == "lift-off")
    assert lift.t == pytest.approx(0.40763991317884796, abs=1e-10)
    assert path.outcome.succeeded


def test_a_bean_on_a_wavy_sheet_follows_its_reference() -> None:
    # integrated once on the charts with contact rates by implicit differentiation (SciPy DOP853, 1e-13)
    path = run("user_surface", Accuracy.tight(), until=2.0, samples=2)
    p = [[0.18447609004787455, -0.09517642612420929, 0.03150721742125377],
         [0.10547925289315366, -0.12085845133501238, 0.029434468716580467]]  # fmt: skip
    w = [[2.9190512699021656, -0.8807858981508364, -0.04007296733964266],
         [4.449218771308185, -0.8459557660957207, -0.006355172327960738]]  # fmt: skip
    assert np.abs(path.p[1:, 1] - p).max() < 1e-9
    assert np.abs(path.w[1:, 1] - w).max() < 1e-7
    assert path.force[1:, 0] == pytest.approx([3.818529552556781, 4.188644083567291], rel=1e-8)
