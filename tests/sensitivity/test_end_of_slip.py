"""Where slip ends, changes of its direction are quotients of two numbers that vanish."""

from __future__ import annotations

import pytest

from modelgen import sensitivity
from tests.sensitivity.differences import shipped

SPEED, MU, GRAVITY = 3.0, 0.2, 9.81
END = 2 * SPEED / (7 * MU * GRAVITY)  # s: from then on the ball rolls


@pytest.mark.parametrize("t", [END - 1e-2, END - 1e-4, END - 1e-6, 2 * END])
def test_derivatives_hold_shortly_before_the_end_of_slip_and_after_it(t: float) -> None:
    """Slip of a ball keeps its direction, so that friction slows a velocity across it as it slows the slip;
    how the ball is turned makes no difference."""
    library = shipped("sphere_slide_to_roll")
    of, by = ["ball.velocity"], ["ball.velocity", "ball.orientation"]
    found = sensitivity(library, [t], of=of, by=by, accuracy="tight")
    left = 1 - MU * GRAVITY * min(t, END) / SPEED
    assert found.verdict
    assert found.jacobian[0, 1] == pytest.approx([0, left, 0, 0, 0, 0], abs=1e-9)
    assert found.jacobian[0, 1, 1] == pytest.approx(left, rel=1e-12)
