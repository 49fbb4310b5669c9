"""Derivatives by parameters through the numbers of a scene: of fast expressions, beside kinks and on them."""

from __future__ import annotations

from dataclasses import replace
from math import cos, pi, sin

import numpy as np
import pytest

from modelgen import sensitivity
from modelgen.runtime.finite_differences import APART, checked, compared
from modelgen.runtime.sensitivity import OF_NUMBERS
from modelgen.scene.read import read_text
from tests.sensitivity.differences import differentiable

SCENE = """
gravity = [0, 0, 0]
[[parameter]]
name = "s"
value = {s!r}
[constants]
twice = "2*half"
half = "{half}"
[[body]]
name = "ball"
mass = "1 + s*s"
inertia = [0.01, 0.01, 0.01]
rpy = ["half", 0, 0]
velocity = ["{fast}", "twice", 0]
[[force]]
body = "ball"
force = [0, 0, 1]
"""
OF = ["ball.position", "ball.orientation"]


def found_for(s: float, fast: str, half: str = "0.5*s"):  # type: ignore[no-untyped-def]
    library = differentiable(read_text(SCENE.format(s=s, fast=fast, half=half), "scene.toml"))
    return library, sensitivity(library, 0.5, of=OF, by=["s"], accuracy="tight", estimate=False)


@pytest.mark.parametrize("seed", range(3))
def test_fast_expressions(seed: int) -> None:
    """A flight with the velocity sin(w s), turned by s/2, of a force on the mass 1 + s^2."""
    random = np.random.default_rng(seed)
    s, w = float(random.uniform(0.1, 2)), float(random.uniform(500, 5000))
    _, found = found_for(s, f"sin({w!r}*s)")
    expected = [
        0.5 * w * cos(w * s),
        0.5,
        -(0.5**3) * s / (1 + s * s) ** 2 * 2,
        *(f * 0.25 for f in (-sin(s / 4), cos(s / 4), 0, 0)),
    ]
    assert found.verdict
    assert np.allclose(found.jacobian[0, :, 0], expected, rtol=1e-9, atol=1e-10)


@pytest.mark.parametrize("beside", [-1e-2, -1e-3, -1e-6, 0.0, 1e-6, 1e-3, 1e-2])
@pytest.mark.parametrize("in_constant", [False, True])
def test_numbers_beside_a_kink_and_on_it(in_constant: bool, beside: float) -> None:
    kink = "max(s, 0.1)"
    _, found = found_for(0.1 * (1 + beside), "s" if in_constant else kink, kink if in_constant else "s")
    assert bool(found.verdict) == bool(beside), found.verdict
    if beside:
        assert found.jacobian[0, int(in_constant), 0] == pytest.approx(
            (beside > 0) * (0.5 + 0.5 * in_constant)
        )
    else:
        assert found.verdict.reason == OF_NUMBERS
        assert found.verdict.contact == ("constants.half" if in_constant else "body[0].velocity[0]")


def test_what_differences_do_not_bear_out_is_undecided() -> None:
    library, found = found_for(0.3, "sin(pi*s)")
    same, differences = checked(found, library, 0.5, of=OF, by=["s"], accuracy="tight")
    assert same.verdict
    assert differences[0, 0, 0] == pytest.approx(0.5 * pi * cos(0.3 * pi), rel=1e-7)
    off = replace(found, jacobian=found.jacobian * (1 + 1e-4))
    assert compared(off, differences, np.zeros_like(differences)).verdict.reason == APART
