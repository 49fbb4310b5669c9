"""The rotation by which the projection corrects an orientation, against the exponential map."""

from __future__ import annotations

import ctypes
from collections.abc import Callable

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.c_compiler import CC
from tests.core.compiling import compile_text, includes

EXPORT = """
MG_API void rotate(mg_real *e, const mg_real *angle) { mg_rotate_quaternion(e, angle); }
"""


@pytest.fixture(scope="module")
def rotate() -> Callable[[np.ndarray, np.ndarray], np.ndarray]:
    """The core's first-order rotation of a quaternion (w, x, y, z) by a vector in body axes, rad."""
    if not CC:
        pytest.skip("needs a C compiler")
    function = ctypes.CDLL(str(compile_text(includes() + EXPORT, "-O0", "-w", "-shared", "-fPIC"))).rotate

    def call(quaternion: np.ndarray, angle: np.ndarray) -> np.ndarray:
        turned = np.array(quaternion, dtype=float)
        given = np.array(angle, dtype=float)
        function(ctypes.c_void_p(turned.ctypes.data), ctypes.c_void_p(given.ctypes.data))
        return turned

    return call


@pytest.mark.cases(1)
@pytest.mark.parametrize("size", [1e-1, 1e-2, 1e-4, 1e-6])
def test_a_small_rotation_is_that_of_the_exponential_map_to_second_order(
    rotate: Callable[[np.ndarray, np.ndarray], np.ndarray], size: float
) -> None:
    rng = np.random.default_rng(7)
    for _ in range(50):
        start = Rotation.random(random_state=rng)
        angle = rng.normal(size=3)
        angle *= size / np.linalg.norm(angle)
        found = rotate(start.as_quat()[[3, 0, 1, 2]], angle)
        expected = (start * Rotation.from_rotvec(angle)).as_quat()[[3, 0, 1, 2]]
        expected *= np.sign(expected @ found)
        assert np.abs(found - expected).max() <= size**2 / 4 + 1e-15
