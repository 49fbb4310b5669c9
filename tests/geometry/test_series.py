"""Power series of expressions: the derivatives of mpmath, and a refusal where there are none."""

from __future__ import annotations

from collections.abc import Callable
from math import factorial
from typing import Any

import mpmath as mp
import numpy as np
import pytest

from modelgen.errors import ExpressionError
from modelgen.geometry.power_series import taylor
from modelgen.scene.expression import parse_expression

ORDER = 12
FUNCTIONS: dict[str, Callable[[Any], Any]] = {
    "sin(s)*exp(s)": lambda s: mp.sin(s) * mp.exp(s),
    "cos(2*s)/(1 + s**3)": lambda s: mp.cos(2 * s) / (1 + s**3),
    "atan2(sin(s) + 1, 2 + s)": lambda s: mp.atan2(mp.sin(s) + 1, 2 + s),
    "atan(s) - tan(s)": lambda s: mp.atan(s) - mp.tan(s),
    "sqrt(1 + s)*log(2 + s)": lambda s: mp.sqrt(1 + s) * mp.log(2 + s),
    "(1 + s)**1.5 + (2 + s)**-2": lambda s: (1 + s) ** 1.5 + (2 + s) ** -2,
    "(2 + s)**s": lambda s: (2 + s) ** s,
    "acos(s/2) + asin(s/3)": lambda s: mp.acos(s / 2) + mp.asin(s / 3),
    "tanh(s)*cosh(s) - sinh(s)**2": lambda s: mp.tanh(s) * mp.cosh(s) - mp.sinh(s) ** 2,
    "abs(s - 1) + max(s, s*s)*sign(-s)": lambda s: 1 - s - s,
    "min(s, 3)**5": lambda s: s**5,
}


@pytest.mark.parametrize("text", FUNCTIONS)
@pytest.mark.parametrize("at", [0.2, 0.45])
def test_coefficients_are_derivatives(text: str, at: float) -> None:
    s = np.zeros((ORDER + 1, 2))
    s[0], s[1] = at, 1.0
    found = taylor(parse_expression(text, ["s"]), {"s": s})
    with mp.workdps(40):
        wanted = [float(mp.diff(FUNCTIONS[text], mp.mpf(at), n) / factorial(n)) for n in range(ORDER + 1)]
    np.testing.assert_allclose(found.T, [wanted, wanted], rtol=1e-12, atol=1e-14)


def test_a_speed_of_the_variable_scales_the_coefficients() -> None:
    slow, fast = np.zeros((2, 6, 1))
    slow[1], fast[1] = 1, 3
    one, other = (taylor(parse_expression("exp(s)", ["s"]), {"s": s}) for s in (slow, fast))
    np.testing.assert_allclose(other[:, 0], one[:, 0] * 3.0 ** np.arange(6))


@pytest.mark.parametrize(
    "text", ["abs(s)", "sqrt(s)", "1/s", "log(s)", "s**1.5", "max(s, -s)", "asin(1 + s)"]
)
def test_what_has_no_series_is_refused(text: str) -> None:
    s = np.zeros((4, 1))
    s[1] = 1
    with pytest.raises(ExpressionError, match="no power series"):
        taylor(parse_expression(text, ["s"]), {"s": s})
