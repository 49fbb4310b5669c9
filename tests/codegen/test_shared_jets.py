"""Kernels that call the jets of their shapes compute what they compute alone."""

from __future__ import annotations

from pathlib import Path

import casadi as ca
import numpy as np
import pytest

import modelgen
from modelgen.codegen.shared_jets import LEAST, shared_kernels

SCENES = Path(__file__).parents[2] / "scenes"
LONG = {  # kernels that hold a jet of at least LEAST instructions
    "bean_with_poles": {"mg_cap_surface", "mg_plane_cap_block_rates", "mg_plane_cap_block_place"},
    "egg_on_spline": {
        "mg_bezier_surface",
        "mg_ellipsoid_bezier_mixed_rates",
        "mg_ellipsoid_bezier_mixed_place",
    },
    "rolling_ellipsoid": set(),
}


@pytest.mark.parametrize("name", LONG)
def test_kernels_equal_their_parts_to_the_last_bit(name: str) -> None:
    derivation = modelgen.derive(modelgen.require(modelgen.read(SCENES / f"{name}.toml")))
    shared = shared_kernels(derivation.model, derivation.formulas)
    assert shared.keys() == LONG[name]
    drawn = np.random.default_rng(5)
    for formula in derivation.formulas:
        if formula.name not in shared:
            continue
        whole, kernel = formula.function, shared[formula.name]
        assert whole.n_instructions() - kernel.rest.n_instructions() >= LEAST
        given = [ca.DM(drawn.uniform(-1.0, 1.0, whole.numel_in(k))) for k in range(whole.n_in())]
        jets = ca.vertcat(*(call.values(given) for call in kernel.calls))
        together = kernel.rest(*given, jets)
        for k, expected in enumerate(whole.call(given)):
            assert np.array_equal(np.array(together[k]), np.array(expected), equal_nan=True)
