"""An impact is said to have made energy where it has, over all its contacts and limits, and nowhere else."""

from __future__ import annotations

import numpy as np
import pytest

from modelgen import Accuracy
from modelgen.scene import python_scenes as make
from tests.oracles.pieces import TABLE, ran, times


@pytest.mark.parametrize("restitution", [0.0, 0.5])
@pytest.mark.parametrize("friction", [0.3, 1.0, 3.0])
def test_a_plank_that_falls_flat_makes_no_energy(friction: float, restitution: float) -> None:
    """Its end that stands gains some of what its end that strikes loses."""
    width, height, lean, spin = 0.1, 0.4, 0.6, np.array([0.0, 0.5, 0.0])
    c, s = np.cos(lean), np.sin(lean)
    centre = np.array([height * s - width * c, 0.0, height * c + width * s]) / 2  # its lower edge is at 0
    plank = make.dynamic(
        "plank", make.box(width, 0.1, height), density=250.0, position=centre.tolist(), rpy=[0, lean, 0],
        velocity=np.cross(spin, centre).tolist(), angular_velocity=spin.tolist(),
    )  # fmt: skip
    contact = {"between": ["plank", "table"], "friction": friction, "restitution": restitution}
    path = ran([plank, TABLE], 0.45, [contact], Accuracy.balanced(), samples=300)
    assert times(path, "touch-down") + times(path, "impact")
    assert (np.diff(path.energy) < 1e-9).all()
    assert not [warning for warning in path.warnings if "made" in warning]


@pytest.mark.parametrize("mass", [1.0, 1.25, 1.5, 1.75, 2.0, 2.25, 2.5, 2.75, 3.0])
def test_an_impact_that_reaches_a_limit_at_rest_makes_no_energy(mass: float) -> None:
    """A plate on an arm at its limit strikes the table, with friction."""
    arm = make.dynamic(
        "arm", mass=mass, inertia=[2.6e-3, 2.8e-3, 2.2e-3], position=[-0.024, 0.116, 0.019],
        quaternion=[-0.70, -1.27, -0.62, 0.04],
    )  # fmt: skip
    plate = make.dynamic(
        "plate", make.sphere(0.05), mass=0.9, inertia=[2.37e-3, 2.30e-3, 2.38e-3],
        position=[-0.005, -0.034, -0.167], quaternion=[-0.16, 0.54, 0.21, 0.36],
        center_of_mass=[0.0156, 0.0174, -0.0057],
    )  # fmt: skip
    hinge = {
        "name": "hinge", "kind": "revolute", "between": ["world", "arm"],
        "quaternion": [-1.25, -0.73, -0.54, -0.32], "limits": [-0.9, 0.15], "restitution": 0.12,
    }  # fmt: skip
    slide = {
        "name": "slide", "kind": "planar", "between": ["arm", "plate"],
        "position": [-0.0144, 0.0409, -0.0741], "quaternion": [1.51, 1.35, 0.78, 0.26],
    }  # fmt: skip
    table = make.fixed("table", make.plane(), position=[0, 0, -0.5], rpy=[0.0916, 0.171, 0])
    contact = {"between": ["plate", "table"], "friction": 0.78, "restitution": 0.89}
    path = ran([arm, plate, table], 0.8, [contact], joint=[hinge, slide])
    assert any("reached hinge:min" in warning for warning in path.warnings)
    assert not [warning for warning in path.warnings if "made" in warning]
