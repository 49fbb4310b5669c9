"""The benchmark bicycle against Meijaard, Papadopoulos, Ruina, Schwab, Proc. R. Soc. A 463 (2007), 1955."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import linear_sum_assignment

from modelgen import derive, read, require, simulate, stability
from modelgen.linearisation.stability import Stability
from tests.running import SCENES, scene_of

G = 9.81
# (5.4): M q'' + v C1 q' + (g K0 + v^2 K2) q = 0, q = lean and steer
M = np.array([[80.81722, 2.31941332208709], [2.31941332208709, 0.29784188199686]])
K0 = np.array([[-80.95, -2.59951685249872], [-2.59951685249872, -0.80329488458618]])
K2 = np.array([[0.0, 76.59734589573222], [0.0, 2.65431523794604]])
C1 = np.array([[0.0, 33.86641391492494], [-0.85035641456978, 1.68540397397560]])
# table 2: at v = 0, 1, .. 10 m/s
STILL = (-5.53094371765393, -3.13164324790656, 3.13164324790656, 5.53094371765393)
WEAVE = (
    3.52696170990070 + 0.80774027519930j, 2.68234517512745 + 1.68066296590675j,
    1.70675605663975 + 2.31582447384325j, 0.41325331521125 + 3.07910818603206j,
    -0.77534188219585 + 4.46486771378823j, -1.52644486584142 + 5.87673060598709j,
    -2.13875644258362 + 7.19525913329805j, -2.69348683581097 + 8.46037971396931j,
    -3.21675402252485 + 9.69377351531791j, -3.72016840437287 + 10.90681139476287j,
)  # fmt: skip
CAPSIZE = (
    -3.13423125066578, -3.07158645641514, -2.63366137253667, -1.42944427361326, -0.32286642900409,
    -0.00406690076970, 0.10268170574766, 0.14327879765713, 0.15790184030917, 0.16105338653172,
)  # fmt: skip
CASTER = (
    -7.11008014637442, -8.67387984831735, -10.35101467245920, -12.15861426576447, -14.07838969279822,
    -16.08537123098026, -18.15788466125262, -20.27940894394569, -22.43788559040858, -24.62459635017404,
)  # fmt: skip
WEAVE_SPEED, CAPSIZE_SPEED = 4.29238253634111, 6.02426201538837  # m/s


@cache
def found() -> Stability:
    """Over 0 to 10 m/s."""
    model = require(read(SCENES / "bicycle.toml"))
    return stability(derive(model), scene_of("bicycle"), "speed", np.arange(11.0))


def published(speed: int) -> list[complex]:
    if not speed:
        return list(STILL)
    weave = WEAVE[speed - 1]
    return [weave, weave.conjugate(), CAPSIZE[speed - 1], CASTER[speed - 1]]


def equations(speed: float) -> np.ndarray:
    """(4, 4) of lean, steer and their rates."""
    stiff, damped = G * K0 + speed**2 * K2, speed * C1
    return np.block(
        [[np.zeros((2, 2)), np.eye(2)], [-np.linalg.solve(M, stiff), -np.linalg.solve(M, damped)]]
    )


def apart(found: np.ndarray, expected: np.ndarray) -> float:
    """The largest distance of two sets of eigenvalues, paired."""
    distance = np.abs(found[:, None] - np.asarray(expected)[None, :])
    return float(distance[linear_sum_assignment(distance)].max())


@pytest.mark.parametrize("speed", range(11))
def test_eigenvalues_are_the_published_ones(speed: int) -> None:
    """Beside the four a fifth is zero: the bicycle may go at another speed."""
    own = found().eigenvalues[speed]
    assert apart(own, [*published(speed), 0.0]) < 1e-8
    assert apart(own, [*np.linalg.eigvals(equations(speed)), 0.0]) < 1e-10


def test_it_is_stable_between_the_published_speeds() -> None:
    ((weave, capsize),) = found().stable
    assert weave == pytest.approx(WEAVE_SPEED, abs=1e-10)
    assert capsize == pytest.approx(CAPSIZE_SPEED, abs=1e-10)


def test_a_run_follows_the_published_equations() -> None:
    """A small lean rate: the lean of the rear frame after a second, to second order in it."""
    rate, speed = 1e-4, 4.0
    path = simulate(scene_of("bicycle"), until=1.0, parameters={"lean_rate": rate, "speed": speed})
    lean = expm(equations(speed))[0] @ [0.0, 0.0, rate, 0.0]
    assert path.is_trusted
    w, x, y, z = path.quaternion[-1, path.body_names.index("frame")]
    assert 2 * (w * x + y * z) == pytest.approx(lean, rel=10 * rate)
