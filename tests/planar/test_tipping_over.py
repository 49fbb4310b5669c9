"""Bodies tip from their base over a rim until they lie on their side, against the integral of energy."""

from __future__ import annotations

from collections.abc import Callable
from itertools import product
from math import atan2, cos, isclose, pi, sin, sqrt

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

from modelgen import simulate
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Shape
from tests.benchmarks.cliffs import spinning_box
from tests.planar.scenes import INERTIA, MASS, G, standing, table
from tests.running import library_of

RADIUS, LENGTH, TOP = 0.03, 0.12, 0.02
PUSHED_TIPS = 0.2056835  # s, by quadrature of a pressure that is linear where it is not zero, and DOP853
LEVELS = pytest.mark.parametrize("accuracy", ["fast", "balanced", "tight"])
SPINS = pytest.mark.parametrize("spin", [8.5, 9.0, 10.0, 12.0])  # rad/s
SHAPES: dict[str, tuple[Shape, float]] = {  # and the lean on their side, rad
    "can": (make.cylinder(RADIUS, LENGTH), pi / 2),
    "frustum": (make.frustum(RADIUS, TOP, LENGTH), pi / 2 + atan2(RADIUS - TOP, LENGTH)),
    "tube": (make.tube(RADIUS, 0.02, LENGTH), pi / 2),
}


def tipped(shape: Shape, spin: float, friction: float | None, accuracy: str, **keys: object) -> Trajectory:
    """It turns about a point of its rim; without friction its centre of mass moves up and down alone."""
    rubs = {} if friction is None else {"friction": friction}
    slide = 0.0 if friction is None else LENGTH / 2 * spin
    body = standing(
        shape, height=LENGTH / 2, angular_velocity=[0, spin, 0], velocity=[slide, 0, RADIUS * spin], **keys
    )
    scene = make.scene("tipped", [table(), body], contact=[{"between": ["body", "table"], **rubs}])
    return simulate(library_of(scene), until=0.6, accuracy=accuracy, samples=20, estimate=False)


def time_to_lie(spin: float, lean: float, inertia: Callable[[float], float]) -> float:
    """inertia(angle) times the rate squared over two, and the weight's energy, stay what they were."""

    def height(angle: float) -> float:
        return RADIUS * sin(angle) + LENGTH / 2 * cos(angle)

    def slowness(angle: float) -> float:
        fallen = MASS * G * (height(0) - height(angle))
        return sqrt(inertia(angle) / (inertia(0) * spin**2 + 2 * fallen))

    return float(quad(slowness, 0, lean, epsabs=1e-14, epsrel=1e-13)[0])


def about_rim(angle: float) -> float:
    return INERTIA[1] + MASS * (RADIUS**2 + (LENGTH / 2) ** 2)


def free_to_slide(angle: float) -> float:
    return INERTIA[1] + MASS * (RADIUS * cos(angle) - LENGTH / 2 * sin(angle)) ** 2


@pytest.mark.cases(12)
@LEVELS
@SPINS
@pytest.mark.parametrize("name", SHAPES)
def test_a_body_tips_over_its_rim_until_the_other_rim_touches(name: str, spin: float, accuracy: str) -> None:
    shape, lean = SHAPES[name]
    path = tipped(shape, spin, None, accuracy)
    lies = [event.t for event in path.events if event.kind == "touch-down" and "top" in event.contact]
    bound = {"fast": 1e-4, "balanced": 1e-8, "tight": 1e-11}[accuracy]
    assert lies[0] == pytest.approx(time_to_lie(spin, lean, free_to_slide), abs=bound)
    assert np.nanmin(path.gap[-1]) > -1e-6


@LEVELS
def test_a_can_that_does_not_slip_turns_about_its_rim(accuracy: str) -> None:
    path = tipped(SHAPES["can"][0], 6.0, 0.8, accuracy)
    sticks = (path.t > 0.02) & (path.t < min(event.t for event in path.events if event.kind == "slip-start"))
    leans = 2 * np.arcsin(path.quaternion[sticks, path.body_names.index("body"), 2])
    bound = {"fast": 1e-4, "balanced": 1e-8, "tight": 1e-11}[accuracy]
    assert len(leans) > 5
    assert [time_to_lie(6.0, lean, about_rim) for lean in leans] == pytest.approx(path.t[sticks], abs=bound)


@LEVELS
@pytest.mark.parametrize("lean", [1e-7, 1e-6, 1e-5, 1e-4, 1e-2])
def test_a_can_that_leans_by_a_little_falls_on_its_side_too(lean: float, accuracy: str) -> None:
    height = LENGTH / 2 * cos(lean) + RADIUS * sin(lean)
    tilt = {"axis_angle": {"axis": [0, 1, 0], "angle": lean}, "position": [0, 0, height]}
    path = tipped(SHAPES["can"][0], 8.0, 0.8, accuracy, **tilt)
    assert path.p[-1, path.body_names.index("body"), 2] == pytest.approx(RADIUS, abs=1e-6)


def leaned(spin: float, slide: float, friction: float, until: float) -> float:
    """The lean of a can that slips and turns over its rim, by the balance of momentum."""

    def rates(t: float, state: list[float]) -> list[float]:
        lean, rate, speed = state
        arm, height = RADIUS * cos(lean) - LENGTH / 2 * sin(lean), RADIUS * sin(lean) + LENGTH / 2 * cos(lean)
        rub = -friction if speed > rate * height else friction
        yields = (arm + height * rub) / INERTIA[1]
        force = MASS * (G - height * rate**2) / (1 + MASS * arm * yields)
        return [rate, -yields * force, rub * force / MASS]

    found = solve_ivp(rates, (0, until), [0, spin, slide], "DOP853", rtol=1e-13, atol=1e-16)
    return float(found.y[0, -1])


TURNS = list(product((0.3, 8.0), (0.0, 2.2, pi), (0.0, 0.3), (0.0, 1.0)))
HALF = [turn for turn in TURNS if turn[1] != 2.2 and sum(number > 0 for number in turn[1:]) % 2 == 0]


@pytest.mark.cases(2)
@pytest.mark.parametrize("accuracy", ["fast", "balanced", pytest.param("tight", marks=pytest.mark.slow)])
@pytest.mark.parametrize(
    ("spin", "azimuth", "friction", "restitution"),
    [pytest.param(*turn, marks=() if turn in HALF else pytest.mark.slow) for turn in TURNS],
)
def test_whichever_way_a_can_begins_to_turn_it_knows_how_well_it_does(
    spin: float, azimuth: float, friction: float, restitution: float, accuracy: str
) -> None:
    """Its rim is pressed from the first moment, though it is followed only once the can leans."""
    slide, until = -0.3, min(0.03, spin * free_to_slide(0) / (MASS * G * RADIUS))
    body = standing(
        SHAPES["can"][0], height=LENGTH / 2, angular_velocity=[-spin * sin(azimuth), spin * cos(azimuth), 0],
        velocity=[slide * cos(azimuth), slide * sin(azimuth), RADIUS * spin],
    )  # fmt: skip
    touch = {"between": ["body", "table"], "restitution": restitution, "friction": friction}
    library = library_of(make.scene("turning", [table(), body], contact=[touch]))
    path = simulate(library, until=until, accuracy=accuracy, samples=4)
    _, x, y, _ = path.quaternion[-1, path.body_names.index("body")]
    lean, expected = 2 * np.arcsin(np.hypot(x, y)), leaned(spin, slide, friction, until)
    assert isclose(lean, expected, rel_tol=1e-3)
    assert abs(lean - expected) < 10 * path.rotation_error[-1] + 1e-15
    assert path.steps < 200


@pytest.mark.slow
def test_a_spinning_can_that_is_pushed_tips_at_one_time_wherever_samples_and_ends_of_runs_fall() -> None:
    """Its friction comes from a pressure that is sought; near the rim it depends on where that began."""
    can = make.dynamic(
        "can", make.cylinder(0.04, 0.2), density=500.0, position=[0, 0, 0.1],
        velocity=[0.5, 0, 0], angular_velocity=[0, 0, 2.0],
    )  # fmt: skip
    push = {"body": "can", "force": ["6*t", "0.0", "0.0"], "point": [0, 0, 0.08]}
    touch = {"between": ["can", "table"], "friction": 0.2}
    library = library_of(make.scene("pushed", [table(), can], contact=[touch], force=[push]))
    for until, samples in [(0.22, 2), (0.22, 6), (0.22, 12), (0.22, 60), (0.24, 20), (0.26, 200)]:
        path = simulate(library, until=until, accuracy="fast", samples=samples, estimate=False)
        tips = [event.t for event in path.events if event.kind == "tipping"]
        assert tips[0] == pytest.approx(PUSHED_TIPS, abs=1e-6)


@pytest.mark.slow
def test_two_accuracies_agree_where_pressure_reaches_the_edge_of_a_face_that_does_not_tip() -> None:
    """The pressure that is used near the edge is continuous in the centre of pressure."""
    library = library_of(spinning_box())
    balanced, tight = (
        simulate(library, until=0.3, samples=30, accuracy=name) for name in ("balanced", "tight")
    )
    assert [event.kind for event in tight.events] == ["face-contact"]
    stated = balanced.spin_error[-1] + tight.spin_error[-1]
    assert stated < 1e-6
    assert np.abs(balanced.w[-1] - tight.w[-1]).max() < 2 * stated
