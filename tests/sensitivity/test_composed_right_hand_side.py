"""Derivatives of the composed right-hand side, by its equations of forces, are those of its elimination."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

from modelgen import derive, require
from modelgen.differentiation import packed_formulas
from modelgen.scene.read import read_text
from tests.model.test_closed_form import SECOND
from tests.running import SCENES

NAMES = (
    *("ellipsoid_on_plane", "ellipsoid_on_ellipsoid", "coin_in_bowl", "linked_rings"),  # without friction
    *("rolling_ellipsoid", "coin", "tippe_top", "rolling_disc"),  # slip, spin and rolling held
)
AGREE = 1e-11  # relative
HUNG = """
[[body]]
name = "rod"
mass = 1.0
inertia = [0.2, 0.3, 0.4]
position = [0.5, 0.1, 0.2]

[[joint]]
name = "hinge"
kind = "revolute"
between = ["world", "rod"]
rpy = [0.1, 0.2, 0.3]
"""


@pytest.mark.parametrize("name", NAMES)
def test_tangent_and_adjoint(name: str) -> None:
    assert_derivatives((SCENES / f"{name}.toml").read_text())


def test_tangent_and_adjoint_of_two_contacts() -> None:
    assert_derivatives((SCENES / "ellipsoid_on_plane.toml").read_text() + SECOND)


@pytest.mark.parametrize("kind", ["revolute", "spherical", "cylindrical"])
def test_tangent_and_adjoint_of_a_body_on_one_joint(kind: str) -> None:
    assert_derivatives(HUNG.replace("revolute", kind))


def assert_derivatives(text: str) -> None:
    derivation = derive(require(read_text(text, "scene.toml")))
    formula = next(each for each in derivation.formulas if each.role == "rhs")
    (packed,) = packed_formulas(derivation, [formula])
    model, random = derivation.model, np.random.default_rng(5)
    symbols = [ca.SX.sym(each, formula.function.numel_in(each)) for each in formula.function.name_in()]
    x, gravity, parameters = ca.vertcat(*symbols[1:4]), *symbols[4:]
    given = [ca.SX.sym(f"{k}_dot", each.numel()) for k, each in enumerate((x, gravity, parameters))]
    slope = ca.vertcat(*formula.function.call(symbols)[:3])
    eliminated = ca.Function(
        "eliminated",
        [x, gravity, parameters, *given],
        [ca.jtimes(slope, ca.vertcat(x, gravity, parameters), ca.vertcat(*given))],
    )

    entries = [
        value for entry in (*model.bodies, *model.feature_pairs, *model.joints) for value in entry.parameters
    ]
    state = np.concatenate([model.initial_q, random.normal(size=model.n_u), random.normal(size=model.n_eta)])
    place = (state * (1 + 0.1 * random.normal(size=state.size)), random.normal(size=3), np.array(entries))
    change = [random.normal(size=each.size) for each in place]
    expected = np.array(eliminated(*place, *change)).ravel()
    found = np.array(packed.tangent(*place, *change)).ravel()
    assert np.max(np.abs(expected)) > 0
    np.testing.assert_allclose(found, expected, rtol=0, atol=AGREE * np.max(np.abs(expected)))

    bar = random.normal(size=slope.numel())
    back = np.array(packed.adjoint([], np.concatenate(place), bar)).ravel()
    products = back * np.concatenate(change), expected * bar
    scale = sum(np.sum(np.abs(each)) for each in products)
    assert abs(np.sum(products[0]) - np.sum(products[1])) <= AGREE * scale
