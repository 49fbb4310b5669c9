"""What is told of the minima of the distance of two circles without finding them, against dense points."""

from __future__ import annotations

import ctypes
from collections.abc import Callable

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.c_compiler import CC
from tests.core.compiling import compile_text, includes

EXPORT = """
MG_API int tell(const mg_real *place, const mg_real *size, mg_real gap) {
  mg_centred_feature of[2];
  for (int side = 0; side < 2; side++) {
    of[side].curve.kind = MG_SPINE_CIRCLE, of[side].curve.radius = size[2 * side];
    of[side].curve.tube = size[2 * side + 1];
    for (int k = 0; k < 3; k++) of[side].centre[k] = place[12 * side + k];
    for (int k = 0; k < 9; k++) of[side].axes[k] = place[12 * side + 3 + k];
  }
  return mg_have_circles_one_minimum(of, gap);
}
"""
TURN = np.linspace(0, 2 * np.pi, 2**14, endpoint=False)

Circles = tuple[np.ndarray, np.ndarray]  # place (2, 12), radius and tube (2, 2)
Tell = Callable[[Circles, float], int]


@pytest.fixture(scope="module")
def tell() -> Tell:
    if not CC:
        pytest.skip("needs a C compiler")
    files = ("spine_stationary_points.c", "circle_pair_single_minimum.c")
    text = includes("elementary", "base") + "".join(f'#include "closest/{name}"\n' for name in files)
    function = ctypes.CDLL(str(compile_text(text + EXPORT, "-O1", "-w", "-shared", "-fPIC"))).tell

    def call(circles: Circles, gap: float) -> int:
        place, size = (np.ascontiguousarray(each, dtype=float) for each in circles)
        addresses = [ctypes.c_void_p(each.ctypes.data) for each in (place, size)]
        return int(function(*addresses, ctypes.c_double(gap)))

    return call


def placed(centres: np.ndarray, turns: list[Rotation], size: np.ndarray) -> Circles:
    axes = [turn.as_matrix().T.ravel() for turn in turns]
    return np.array([np.append(c, a) for c, a in zip(centres, axes, strict=True)]), size


def anywhere(rng: np.random.Generator) -> Circles:
    size = np.array([[1.0, 0.0], [10 ** rng.uniform(-1, 1), 0.0]]) + [[0, 0.1], [0, 0.1]] * rng.uniform(
        size=(2, 2)
    )
    centres = rng.normal(size=(2, 3)) * size[:, 0].max()
    return placed(centres, list(Rotation.random(2, random_state=rng)), size)


def linked(rng: np.random.Generator) -> Circles:
    """Circles through each other that touch or almost touch at one point, at any angle."""
    size = np.stack([rng.uniform(0.5, 2, size=2), rng.uniform(0, 0.2, size=2)], axis=1)
    lean = rng.uniform(0.3, np.pi - 0.3)
    spin = Rotation.from_euler("y", rng.normal(scale=0.3)) * Rotation.from_euler("x", lean)
    inner = Rotation.from_euler("z", rng.uniform(0, 2 * np.pi))
    touch = np.array([size[0, 0] - size[:, 1].sum() - 0.01 * rng.uniform(), 0, 0])
    centre = touch + spin.apply([size[1, 0], 0, 0])
    return placed(np.array([np.zeros(3), centre]), [inner, spin], size)


def almost_coaxial(rng: np.random.Generator) -> Circles:
    size = np.array([[1.0, 0.05], [rng.uniform(0.8, 1.2), 0.05]])
    small = 10 ** rng.uniform(-12, -1)
    centres = np.array([np.zeros(3), small * rng.normal(size=3) + [0, 0, rng.uniform(0, 0.2)]])
    return placed(centres, [Rotation.identity(), Rotation.from_rotvec(small * rng.normal(size=3))], size)


def coplanar(rng: np.random.Generator) -> Circles:
    size = np.array([[1.0, 0.02], [rng.uniform(0.2, 2), 0.02]])
    centres = np.array([np.zeros(3), [rng.uniform(0, 2), 0, 0]])
    return placed(centres, [Rotation.from_euler("z", rng.uniform(0, 6)), Rotation.identity()], size)


def number_of_minima(circles: Circles, gap: float) -> int:
    """Least distances of dense points of the first circle from the second one, up to the bound."""
    (o, f), ((r, a), (radius, b)) = circles
    u, v = o[3:6], o[6:9]
    points = o[:3] + r * (np.outer(np.cos(TURN), u) + np.outer(np.sin(TURN), v)) - f[:3]
    height = points @ f[9:12]
    across = np.hypot(points @ f[3:6], points @ f[6:9])
    distance = np.hypot(height, across - radius)
    least = (distance < np.roll(distance, 1)) & (distance <= np.roll(distance, -1))
    return int((least & (distance <= gap + a + b)).sum())


@pytest.mark.parametrize("family", [anywhere, linked, almost_coaxial, coplanar], ids=lambda f: f.__name__)
def test_circles_said_to_have_one_minimum_have_no_more(
    tell: Tell, family: Callable[[np.random.Generator], Circles]
) -> None:
    rng = np.random.default_rng(11)
    for _ in range(400):
        circles, gap = family(rng), 10 ** rng.uniform(-3, 0.5)
        if tell(circles, gap):
            assert number_of_minima(circles, gap) <= 1


def test_the_only_minimum_of_linked_circles_is_told_mostly(tell: Tell) -> None:
    rng = np.random.default_rng(12)
    drawn = [linked(rng) for _ in range(300)]
    single = [circles for circles in drawn if number_of_minima(circles, 0.1) == 1]
    assert len(single) > 100
    assert sum(tell(circles, 0.1) for circles in single) >= 0.8 * len(single)


def test_circles_at_a_constant_distance_are_not_told_to_have_one_minimum(tell: Tell) -> None:
    size = np.array([[1.0, 0.1], [1.2, 0.05]])
    turns = [Rotation.identity(), Rotation.identity()]
    assert not tell(placed(np.array([[0.0, 0, 0], [0, 0, 0.3]]), turns, size), 0.5)
    assert tell(placed(np.array([[0.0, 0, 0], [0, 0, 3.0]]), turns, size), 0.5)  # none within the bound
