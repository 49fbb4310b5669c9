"""Springs and dampers in time-stepping: closed forms by decades of their rates, the ledger, and stability."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import expm

from modelgen import Accuracy, simulate
from modelgen.runtime.accuracy import Scheme
from modelgen.runtime.trajectory import Outcome, Trajectory
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Body, Scene
from tests.running import library_of

SCHEMES: tuple[Scheme, ...] = ("stewart-trinkle", "anitescu-potra", "moreau")
STEPS = (4e-3, 2e-3, 1e-3, 5e-4)
STEP, STILL = 1e-3, [0.0, 0.0, 0.0]
INERTIA = 0.3  # kg m^2, of a wheel about its axis
DECADES = [10.0**k for k in range(-1, 12)]  # 1/s: from 1e-4 to 1e8 over a step


def wheel(name: str = "wheel", **keys: object) -> Body:
    return make.dynamic(name, mass=2.0, inertia=[0.4, 0.4, INERTIA], **keys)


def stepped(
    scene: Scene, until: float, step: float = STEP, scheme: Scheme = "moreau", samples: int = 1
) -> Trajectory:
    record = Accuracy.balanced().time_stepping(step, scheme)
    path = simulate(library_of(scene), until=until, samples=samples, accuracy=record, estimate=False)
    assert path.outcome is Outcome.DONE
    return path


def order(errors: list[float]) -> float:
    """The slope of log error over log step."""
    return float(np.polyfit(np.log(STEPS), np.log(errors), 1)[0])


def hinged(spin: float, rest: float = 0.0, **joint: float) -> Scene:
    """A wheel on a hinge with a spring that is deflected by -rest, and a damper."""
    hinge = {"name": "hinge", "kind": "revolute", "between": ["world", "wheel"], "rest": rest, **joint}
    return make.scene("hinged", [wheel(angular_velocity=[0, 0, spin])], joint=[hinge], gravity=STILL)


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.cases(5)
@pytest.mark.parametrize("rate", DECADES)
def test_a_damper_alone_is_the_pade_approximation_of_its_decay(rate: float, scheme: Scheme) -> None:
    """The spin after n steps is R^n of the first, R(z) = (6 - 2 z)/(6 + 4 z + z^2), whatever the stiffness.

    |R - exp(-z)| <= z^4/72 by Taylor's remainder for z <= 1, and <= 0.11 for all z.
    """
    spin, n, z = 3.0, 50, rate * STEP
    path = stepped(hinged(spin, damping=rate * INERTIA), n * STEP, scheme=scheme, samples=n)
    factor = (6 - 2 * z) / (6 + 4 * z + z * z)
    expected = spin * factor ** np.arange(n + 1)
    assert path.w[:, 0, 2] == pytest.approx(expected, rel=1e-9, abs=1e-12 * spin)
    exact = spin * np.exp(-rate * path.t)
    bound = n * z**4 / 72 if z <= 1 else 0.11
    assert np.abs(path.w[:, 0, 2] - exact).max() <= spin * bound + 1e-12
    assert path.energy_drift < 1e-12
    assert path.work[-1] == pytest.approx(INERTIA / 2 * (path.w[-1, 0, 2] ** 2 - spin**2), rel=1e-12)


@pytest.mark.cases(4)
@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize(("stiffness", "damping"), [(12.0, 0.0), (12.0, 0.6), (3.0, 9.0)])
def test_a_sprung_hinge_is_of_order_two(stiffness: float, damping: float, scheme: Scheme) -> None:
    """Against the exponential of its matrix."""
    matrix = np.array([[0, 1], [-stiffness / INERTIA, -damping / INERTIA]])
    angle, spin = expm(matrix) @ [-0.4, 1.5]
    errors = []
    for step in STEPS:
        path = stepped(hinged(1.5, 0.4, stiffness=stiffness, damping=damping), 1.0, step, scheme)
        errors.append(float(np.hypot(path.coordinates[-1, 0] - 0.4 - angle, path.w[-1, 0, 2] - spin)))
    assert order(errors) > 1.9
    assert errors[-1] < 1e-4


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.cases(6)
@pytest.mark.parametrize("stiffness", [INERTIA * rate**2 for rate in DECADES])
def test_an_undamped_spring_of_any_stiffness_keeps_what_is_its_energy_for_small_steps(
    stiffness: float, scheme: Scheme
) -> None:
    """The invariant of its 2 x 2 matrix, I (1 + y^2 / (4 (4 + y))) w^2 + k s^2 with y = h^2 k / I."""
    rest, spin = 1e-3 * min(1.0, (INERTIA / stiffness) ** 0.5), 1.5e-3
    path = stepped(hinged(spin, rest, stiffness=stiffness), 0.5, scheme=scheme, samples=100)
    off, y = path.coordinates[:, 0] - rest, STEP**2 * stiffness / INERTIA
    kept = INERTIA * (1 + y**2 / (4 * (4 + y))) * path.w[:, 0, 2] ** 2 + stiffness * off**2
    assert kept == pytest.approx(np.full(101, kept[0]), rel=1e-6)


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.cases(4)
@pytest.mark.parametrize("damping", [10.0**k for k in range(2, 9)])
def test_what_a_stiff_damper_lets_creep_creeps_as_it_should(damping: float, scheme: Scheme) -> None:
    """The angle follows exp(-k t / c) where the rate c/I of the damper is up to 1e6 times that of the step.

    The start of the creep is shifted by the decay of the first spin within some steps, at most I/c or a step.
    """
    slow = 4.0
    path = stepped(
        hinged(0.0, 0.4, stiffness=slow * damping, damping=damping), 0.5, scheme=scheme, samples=50
    )
    creep = -0.4 * np.exp(-slow * path.t)
    late = slow * (2 * STEP + INERTIA / damping)
    assert np.abs(path.coordinates[:, 0] - 0.4 - creep).max() < 0.4 * late


def pendulum(damping: float, stiffness: float, second: str = "revolute") -> Scene:
    """Two bars that fall, with dampers and springs in both hinges, whose axes are horizontal."""
    bars = [
        make.dynamic(f"bar{k}", mass=1.0 + k, inertia=[0.01, 0.2, 0.2], position=[0.5 + k, 0, 0])
        for k in range(2)
    ]
    across: dict[str, object] = {"rpy": ["pi/2", 0, 0]}
    yielding = {"damping": damping, "stiffness": stiffness}
    first = {"name": "a", "kind": "revolute", "between": ["world", "bar0"], **across}
    other = {"name": "b", "kind": second, "between": ["bar0", "bar1"], "position": [1.0, 0, 0], **across}
    return make.scene("bars", bars, joint=[first, other | (yielding if second == "revolute" else {})])


@pytest.mark.cases(5)
@pytest.mark.parametrize("rate", [10.0**k for k in range(-1, 11)])
def test_the_ledger_of_a_damped_linkage_drifts_with_the_order_of_the_scheme(rate: float) -> None:
    """Nothing but rounding where rows are taken in the middle of a step; else order 1, for any damper."""
    scene = pendulum(0.1 * rate, 0.05 * rate)
    assert stepped(scene, 0.6).energy_drift < 1e-11
    drifts = [stepped(scene, 0.6, step, "stewart-trinkle").energy_drift for step in STEPS]
    assert order(drifts) > 0.85
    assert drifts[-1] < 1e-2


@pytest.mark.cases(3)
@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("damping", [0.3, 3.0])
def test_a_damped_linkage_converges_to_the_event_driven_run(damping: float, scheme: Scheme) -> None:
    scene = pendulum(damping, 2.0)
    exact = simulate(library_of(scene), until=0.6, samples=1, accuracy=Accuracy.of(1e-12), estimate=False)
    errors = [float(np.abs(stepped(scene, 0.6, step, scheme).p[-1] - exact.p[-1]).max()) for step in STEPS]
    assert order(errors) > (1.9 if scheme == "moreau" else 0.9)
    assert errors[-1] < (1e-5 if scheme == "moreau" else 2e-3)


@pytest.mark.parametrize("scheme", SCHEMES)
def test_a_hinge_with_a_huge_damper_is_a_weld(scheme: Scheme) -> None:
    """c = 1e12 N m s/rad lets the hinge turn by 1e-11 rad in the run."""
    library = library_of(pendulum(0, 0, "weld"))
    exact = simulate(library, until=0.6, samples=1, accuracy=Accuracy.of(1e-12), estimate=False)
    scene = pendulum(1e12, 0.0)
    errors = [float(np.abs(stepped(scene, 0.6, step, scheme).p[-1] - exact.p[-1]).max()) for step in STEPS]
    assert order(errors) > (1.9 if scheme == "moreau" else 0.9)
    assert errors[-1] < (1e-5 if scheme == "moreau" else 2e-3)


def tree(seed: int) -> tuple[Scene, float]:
    """Four bodies on hinges and slides with springs and dampers by decades, lines across; energy stored, J.

    Each spring stores a joule or less at the start.
    """
    random = np.random.default_rng(seed)
    centres, bodies, joints = [np.zeros(3)], [], []
    for k in range(4):
        parent = int(random.integers(0, k + 1))
        centres.append(centres[parent] + random.normal(size=3))
        mass, stiffness = 10 ** random.uniform(-1, 1), 10 ** random.uniform(-1, 11)
        inertia = mass * np.sort(random.uniform(0.05, 0.1, 3))
        bodies.append(
            make.dynamic(f"b{k + 1}", mass=mass, inertia=inertia.tolist(), position=centres[-1].tolist())
        )
        joints.append({
            "kind": ("revolute", "prismatic")[k % 2],
            "between": [f"b{parent}" if parent else "world", f"b{k + 1}"],
            "position": ((centres[-1] + centres[parent]) / 2).tolist(),
            "rpy": random.uniform(-1, 1, 3).tolist(),
            "stiffness": stiffness, "damping": 10 ** random.uniform(-3, 8) * int(random.random() < 0.6),
            "rest": min(0.5, (2 / stiffness) ** 0.5),
        })  # fmt: skip
    lines, stored = [], sum(0.5 * j["stiffness"] * j["rest"] ** 2 for j in joints)
    for _ in range(2):
        a, b = 1 + random.choice(4, 2, replace=False)
        stiffness = 10 ** random.uniform(0, 9)
        off = min(0.2, (2 / stiffness) ** 0.5)
        lines.append({
            "between": [f"b{a}", f"b{b}"], "stiffness": stiffness, "damping": 10 ** random.uniform(-3, 6),
            "rest_length": float(np.linalg.norm(centres[a] - centres[b])) + off,
        })  # fmt: skip
        stored += 0.5 * stiffness * off**2
    return make.scene("tree", bodies, joint=joints, spring=lines, gravity=STILL), stored


@pytest.mark.cases(4)
@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("seed", range(40))
def test_no_linkage_gains_energy_from_springs_and_dampers_of_any_stiffness(seed: int, scheme: Scheme) -> None:
    """The kinetic energy never exceeds what the springs stored: rates reach 1e8 per step."""
    scene, stored = tree(seed)
    path = stepped(scene, 0.5, scheme=scheme, samples=100)
    assert path.energy.max() <= 1.001 * stored
    assert path.joint_error_max < 1e-9
