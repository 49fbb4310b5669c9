"""The first step of a contact that starts from flat, and the collocation that takes it."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import cache
from importlib.resources import files

import numpy as np
import pytest
from mpmath import mp, mpf
from scipy.spatial.transform import Rotation

from modelgen import Accuracy
from modelgen.runtime.thresholds import Thresholds
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Scene
from tests.oracles.flat_start import FLAT_START, Rolling, rolled, scene_of_glass
from tests.oracles.glass_reference import DIGITS, Glass, harmonics

RIM = make.circle(0.04, position=[0.0, 0.0, -0.05])
GLASS = Glass(
    harmonics(0.04), 0.3, (4e-4, 4.5e-4, 3e-4), 0.05, 0.03, ((3.924, 2.0), (0.0, 20.0)), velocity=(1.0, 0.5)
)
TWISTED = replace(GLASS, torque=((0.0,), (0.0,), (0.02, 0.01)), spin=5.0)
OUTWARD = (1.0, 0.0, 0.0)
TAU = np.linspace(0.0, 0.1, 11)[1:]
STAGES = 7
STEP_TOO_SMALL, YOUNG = 21, 2


@cache
def started(accuracy: Accuracy, step: float = 0.05, glass: Glass = TWISTED) -> Rolling:
    return rolled(scene_of_glass(glass, RIM), OUTWARD, TAU, accuracy, step=step)


def differ(a: Rolling, b: Rolling) -> float:
    assert a.code == b.code == 0
    return float(max(abs(a.p - b.p).max(), abs(a.rotation - b.rotation).max()))


def table(name: str, shape: tuple[int, ...]) -> np.ndarray:
    """A table of radau_coefficients.h as it is written."""
    text = (files("modelgen.core") / "integrate" / "radau_coefficients.h").read_text(encoding="utf-8")
    body = text.split(f"{name}[", 1)[1].split("= {", 1)[1].split("};", 1)[0]
    numbers = re.findall(r"-?\d+(?:\.\d+)?", body.replace("(mg_real)", "").replace("L", ""))
    return np.array([mpf(x) for x in numbers]).reshape(shape)


def test_the_nodes_are_the_zeros_of_radau() -> None:
    """(d/dx)^6 x^6 (x - 1)^7."""
    with mp.workdps(DIGITS):
        polynomial = np.poly1d([mpf(1)])
        for root in [0] * (STAGES - 1) + [1] * STAGES:
            polynomial = polynomial * np.poly1d([mpf(1), mpf(-root)])
        slope = np.polyder(polynomial, STAGES - 1)
        for node in table("mg_radau_time", (STAGES,)):
            assert abs(np.polyval(slope, node) / np.polyval(np.polyder(slope), node)) < mpf("1e-24")


def test_the_weights_integrate_what_they_interpolate_and_the_last_row_to_order_13() -> None:
    with mp.workdps(DIGITS):
        time, weight = table("mg_radau_time", (STAGES,)), table("mg_radau_weight", (STAGES, STAGES))
        for k in range(STAGES):
            assert max(abs(weight @ time**k - time ** (k + 1) / (k + 1))) < mpf("1e-22")
        for k in range(2 * STAGES - 1):
            assert abs(weight[-1] @ time**k - mpf(1) / (k + 1)) < mpf("1e-22")


def test_the_interpolant_of_the_stages_is_their_polynomial() -> None:
    """y = theta (d0 + (1 - theta) (d1 + theta (d2 + ...))) through theta^k at the nodes, k = 1 .. 7."""
    with mp.workdps(DIGITS):
        time, dense = table("mg_radau_time", (STAGES,)), table("mg_radau_dense", (STAGES, STAGES))
        for k in range(1, STAGES + 1):
            rows = dense @ time**k
            for theta in map(mpf, ("0.1", "0.37", "0.9")):
                y = mpf(0)
                for row in reversed(range(STAGES)):
                    y = (y + rows[row]) * (1 - theta if row % 2 else theta)
                assert abs(y - theta**k) < mpf("1e-19")


def test_the_slopes_at_the_stages_are_those_of_the_polynomial() -> None:
    with mp.workdps(DIGITS):
        time, slope = table("mg_radau_time", (STAGES,)), table("mg_radau_slope", (STAGES, STAGES))
        for k in range(STAGES):
            exact = k * time ** (k - 1) if k else 0 * time
            assert max(abs(slope @ time**k - exact)) < mpf("1e-21")


@pytest.mark.parametrize("step", [0.02, 0.005, 0.001])
def test_the_motion_does_not_depend_on_the_first_step(step: float) -> None:
    other = started(Accuracy.tight(), step)
    assert other.first <= step
    assert differ(started(Accuracy.tight()), other) < 1e-12


def test_the_first_step_grows_with_the_tolerance() -> None:
    firsts = [started(accuracy).first for accuracy in (Accuracy.tight(), Accuracy.of(1e-11), Accuracy.fast())]
    assert firsts == sorted(firsts)
    assert firsts[0] < firsts[-1]


def test_within_the_first_step_the_interpolant_is_the_series() -> None:
    tau = np.array([0.1, 0.3, 0.5, 0.8]) * started(Accuracy.tight(), 0.01).first
    run = rolled(scene_of_glass(TWISTED, RIM), OUTWARD, tau, Accuracy.tight(), step=0.01)
    assert run.session.run.steps <= 2
    with mp.workdps(DIGITS):
        theta, phi, _ = TWISTED.series(16)
        angles = [(float(theta.at(mpf(t))), float(phi.at(mpf(t)))) for t in tau.tolist()]
    leans = run.rotation[:, :2, 2]
    for lean, (size, azimuth) in zip(leans, angles, strict=True):
        assert lean == pytest.approx(np.sin(size) * np.array([np.cos(azimuth), np.sin(azimuth)]), abs=1e-12)


def test_the_rim_point_does_not_swing() -> None:
    """Off the smooth solution a start swings ever faster towards tau = 0; the azimuth here does not."""
    tau = np.linspace(0.002, 0.02, 40)
    run = rolled(scene_of_glass(GLASS, RIM), OUTWARD, tau, Accuracy.tight(), step=0.002)
    x, y = run.rotation[:, 0, 2], run.rotation[:, 1, 2]
    smooth = np.polynomial.Polynomial.fit(tau, np.arctan2(y, x), 9)
    assert abs(np.arctan2(y, x) - smooth(tau)).max() < 1e-9


def test_the_way_out_need_only_be_near() -> None:
    aside = rolled(scene_of_glass(TWISTED, RIM), (np.cos(0.3), np.sin(0.3), 0.0), TAU, Accuracy.tight())
    assert differ(started(Accuracy.tight()), aside) < 1e-12


def test_a_load_that_jumps_beyond_the_rim_starts_too() -> None:
    """Then the lean begins with the square of the time."""
    jump = replace(GLASS, force=((4.4, 2.0), (0.8, 5.0)))
    assert differ(started(Accuracy.tight(), glass=jump), started(Accuracy.tight(), 0.003, jump)) < 1e-11


@pytest.mark.parametrize("force", [((3.924, -2.0), (0.0,)), ((-3.924, -2.0), (0.0,))], ids=["in", "far side"])
def test_a_load_that_does_not_go_out_there_is_refused(force: tuple[tuple[float, ...], ...]) -> None:
    run = started(replace(Accuracy.balanced(), fallback=False), glass=replace(GLASS, force=force))
    assert run.code == STEP_TOO_SMALL
    assert float(run.session.run.t) == 0.0


def test_a_start_is_excused_from_the_bound_on_margins_until_it_is_above() -> None:
    """After 1 ms the lean is 1e-8, far below the margin at which a contact is refused."""
    tau = np.array([0.001, 0.1])
    run = rolled(scene_of_glass(GLASS, RIM), OUTWARD, tau[:1], Accuracy.tight(), step=0.001)
    assert run.session.rolling_start[0] == YOUNG
    assert run.session.margin[0] < Thresholds().margin_refuse
    later = rolled(scene_of_glass(GLASS, RIM), OUTWARD, tau, Accuracy.tight(), step=0.001)
    assert later.code == 0
    assert later.session.rolling_start[0] == 0
    assert later.session.run.report.margin_min >= Thresholds().margin_refuse
    assert FLAT_START != YOUNG


def test_two_glasses_start_at_once_as_each_alone() -> None:
    scene = scene_of_glass(TWISTED, RIM)
    table, one = scene.bodies
    other = replace(one, name="other", pose=replace(one.pose, position=(1.0, 0.0, 0.05)))
    pair = replace(scene.contacts[0], between=(("other", "circle"), scene.contacts[0].between[1]))
    loads = tuple(replace(load, body="other") for load in scene.loads)
    both = replace(
        scene, bodies=(table, one, other), contacts=(*scene.contacts, pair), loads=(*scene.loads, *loads)
    )
    run = rolled(both, OUTWARD, TAU, Accuracy.tight())
    assert differ(started(Accuracy.tight()), run) < 1e-12
    assert abs(run.session.x[7:10] - run.session.x[:3] - [1.0, 0.0, 0.0]).max() < 1e-12


def plate(world: Rotation) -> Scene:
    """A plate that tips over the round rim of a post: the plane moves, the rim rests."""
    x, y, z, w = world.as_quat().tolist()
    to = {"quaternion": [w, x, y, z]}
    e1, e2, e3 = world.as_matrix().T.tolist()
    weight = 0.4 * 9.81
    torque = [
        f"({a!r})*0.4*t + ({b!r})*({0.05 * weight!r} + 0.5*t) + ({c!r})*0.05"
        for a, b, c in zip(e1, e2, e3, strict=True)
    ]
    body = make.dynamic(
        "plate",
        make.plane(position=[0.0, 0.0, -0.02], rpy=["pi", 0.0, 0.0]),
        mass=0.4,
        inertia=[8e-4, 9e-4, 1.2e-3],
        position=[0.02 * c for c in e3],
        **to,
    )
    post = make.fixed("post", make.circle(0.05), **to)
    gravity = [-9.81 * c for c in e3]
    contact = [{"between": ["plate", "post"]}]
    return make.scene(
        "plate", [post, body], contact=contact, torque=[{"body": "plate", "torque": torque}], gravity=gravity
    )


def tipped(world: Rotation, accuracy: Accuracy, step: float = 0.05) -> np.ndarray:
    """(n, 3) m, the centre of the plate in the world's own axes."""
    run = rolled(plate(world), world.apply([1.0, 0.0, 0.0]).tolist(), TAU, accuracy, step=step)
    assert run.code == 0
    assert run.session.run.report.energy_error_max < 1e-11
    return world.inv().apply(run.p)


def test_a_plane_may_lean_on_a_rim_that_rests() -> None:
    one, other = (tipped(Rotation.identity(), Accuracy.tight(), step) for step in (0.05, 0.004))
    assert abs(one - other).max() < 1e-14


def test_turning_the_world_changes_a_start_by_rounding_only() -> None:
    """Where the upright pose is no round number, rounding turns a small lean: 1e-16 over the lean."""
    turned = tipped(Rotation.from_rotvec([0.3, -0.7, 0.4]), Accuracy.tight())
    assert abs(turned - tipped(Rotation.identity(), Accuracy.tight())).max() < 1e-10
