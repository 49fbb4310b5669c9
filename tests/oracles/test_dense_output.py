"""Samples within steps: motions that are polynomials of the interpolant's degree are met to rounding."""

from __future__ import annotations

import numpy as np
import pytest

from modelgen import simulate
from modelgen.runtime.trajectory import Trajectory
from modelgen.scene import python_scenes as make
from tests.oracles.pieces import ball
from tests.running import library_of


def pushed(degree: int, **keys: object) -> Trajectory:
    """A mass of 1 kg that moves as x = t^degree, sampled between the steps."""
    push = f"{degree * (degree - 1)}*t**{degree - 2}"
    body = make.scene(
        "polynomial", [ball("b", [0, 0, 0])], gravity=[0, 0, 0],
        force=[{"body": "b", "force": [push, "0.0", "0.0"]}],
    )  # fmt: skip
    return simulate(library_of(body), until=1.0, samples=97, estimate=False, **keys)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("degree", "keys"),
    [(3, {"method": "rk4", "step": 0.25}), (7, {"accuracy": "fast"})],
    ids=["cubic of rk4", "dop853"],
)
def test_polynomials_of_the_degree_of_the_interpolant_are_sampled_exactly(
    degree: int, keys: dict[str, object]
) -> None:
    path = pushed(degree, **keys)
    assert path.steps < 50
    assert np.abs(path.p[:, 0, 0] - path.t**degree).max() < 1e-14
    assert np.abs(path.v[:, 0, 0] - degree * path.t ** (degree - 1)).max() < 5e-14
