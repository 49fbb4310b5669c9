"""The estimated error of derivatives covers their error, and not by far."""

from __future__ import annotations

import numpy as np
import pytest

from modelgen import sensitivity
from tests.sensitivity.differences import shipped
from tests.sensitivity.test_differences import moving

FAR = 300.0  # times the largest error; the estimate is safe by 2, the rest is luck of rounding and steps


@pytest.mark.cases(3)
@pytest.mark.parametrize("accuracy", ["fast", "balanced"])
@pytest.mark.parametrize(
    ("name", "t"), [("double_pendulum", 1.2), ("egg_on_spline", 0.8), ("bouncing_ellipsoid", 0.5)]
)
def test_the_estimate_is_an_error_bound(name: str, t: float, accuracy: str) -> None:
    library = shipped(name)
    body = moving(library)[0]
    of, by = [f"{body}.position", f"{body}.velocity"], [f"{body}.velocity", f"{body}.angular_velocity"]
    found = sensitivity(library, [t / 2, t], of=of, by=by, accuracy=accuracy)
    exact = sensitivity(library, [t / 2, t], of=of, by=by, accuracy="tight", estimate=False)
    assert exact.error is None
    assert found.error is not None
    assert found.error.shape == found.jacobian.shape
    error = np.max(np.abs(found.jacobian - exact.jacobian), axis=(1, 2))
    told = np.max(found.error, axis=(1, 2))
    size = np.max(np.abs(exact.jacobian), axis=(1, 2))
    assert np.all(error <= told + 1e-10 * size)
    assert np.all(told <= FAR * error + 1e-10 * size)
