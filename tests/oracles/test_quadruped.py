"""A quadruped by time-stepping: it lands on its feet, is pushed, and stands again, for ten seconds."""

from __future__ import annotations

import numpy as np
import pytest

from modelgen import Accuracy, simulate
from modelgen.runtime.trajectory import Outcome, Trajectory
from tests.oracles.pieces import G, rotations, times
from tests.oracles.quadruped import FOOT, LEGS, MASSES, SHIN, STIFFNESS, THIGH, quadruped
from tests.running import library_of

SCHEMES = ("stewart-trinkle", "anitescu-potra", "moreau")
WEIGHT = G * (MASSES["trunk"] + len(LEGS) * (MASSES["thigh"] + MASSES["shin"]))
PUSH = "200*exp(-((t - 4)/0.05)**2)"  # N


def stood(scheme: str, push: str = PUSH, until: float = 10.0) -> Trajectory:
    record = Accuracy.balanced().time_stepping(1e-3, scheme)  # type: ignore[arg-type]
    library = library_of(quadruped(push, 0.03))
    return simulate(library, until=until, samples=100, accuracy=record, estimate=False)


def moments(path: Trajectory) -> np.ndarray:
    """(4, 2) N m: of gravity, the force on the foot and the spring, about hip and knee of each leg."""
    names, found = list(path.coordinate_names), []
    for leg, name in enumerate(LEGS):
        thigh, shin = (2 + 2 * leg, 3 + 2 * leg)
        up = [rotations(path, body)[-1][:, 2] for body in (thigh, shin)]
        centres = path.p[-1, [thigh, shin]]
        hip, knee = (centres[k] + length / 2 * up[k] for k, length in enumerate((THIGH, SHIN)))
        sole = centres[1] - SHIN / 2 * up[1] - [0, 0, FOOT]
        pressed = path.force[-1, leg] * np.array([0, 0, 1.0]) + path.friction[-1, leg]
        down = [[0, 0, -G * MASSES[each]] for each in ("thigh", "shin")]
        angles = [path.coordinates[-1, names.index(f"{kind}_{name}.angle")] for kind in ("hip", "knee")]
        about_hip = sum(
            np.cross(at - hip, force)
            for at, force in ((sole, pressed), (centres[0], down[0]), (centres[1], down[1]))
        )
        about_knee = np.cross(sole - knee, pressed) + np.cross(centres[1] - knee, down[1])
        axis = rotations(path, thigh)[-1][:, 1]
        found.append([axis @ about_hip - STIFFNESS * angles[0], axis @ about_knee - STIFFNESS * angles[1]])
    return np.array(found)


@pytest.mark.cases(1)
@pytest.mark.parametrize("scheme", SCHEMES)
def test_a_quadruped_lands_is_pushed_and_stands_in_balance(scheme: str) -> None:
    """At the end the feet carry the weight, and every hinge balances its spring. Damper rates reach 8e3/s."""
    path = stood(scheme)
    assert path.outcome is Outcome.DONE
    assert path.joint_error_max < 1e-9
    assert path.p[:, 1, 2].min() > 0.3
    assert np.ptp(path.p[:, 1, 0]) > 0.05  # the push moves it
    assert np.abs(path.v[-1]).max() < 1e-6
    assert path.force[-1].sum() == pytest.approx(WEIGHT, rel=1e-6)
    assert np.abs(moments(path)).max() < 1e-4 * WEIGHT * THIGH
    assert path.energy_drift < (1e-3 if scheme == "moreau" else 2e-2)
    assert len(times(path, "touch-down")) >= len(LEGS)


@pytest.mark.slow
def test_the_schemes_agree_where_it_stands_unless_pushed() -> None:
    """Height and forces on the feet agree; where exactly the feet stick is left to the landing."""
    paths = [stood(scheme, "0.0", 2.0) for scheme in SCHEMES]
    for path in paths[1:]:
        assert path.p[-1, 1, 2] == pytest.approx(paths[0].p[-1, 1, 2], abs=1e-4)
        assert path.force[-1] == pytest.approx(paths[0].force[-1], rel=1e-2)
