"""Kernels give the same through three doors: CasADi's interpreter, the library, and casadi.external."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import casadi as ca
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from modelgen import build, derive, emit, require
from modelgen.codegen.library import Library
from modelgen.errors import LibraryError
from modelgen.model import Rows
from tests.model.scenes import WIDE, contact, egg, scene
from tests.running import compiled, folder, library_of

Array = np.ndarray[Any, Any]
DERIVATION = derive(require(WIDE))
PACKAGE = emit(DERIVATION)
KERNELS = [formula.name for formula in DERIVATION.formulas if formula.role != "rhs"]


@cache
def wide() -> Library:
    """The library of all kernels, at the level that scenes have by default."""
    return build(PACKAGE, folder=folder() / "wide")


def arguments(name: str, dtype: Any = np.float64) -> list[Array]:
    """Points near the origin of every input; the seed is the name."""
    function = DERIVATION.function(name)
    random = np.random.default_rng(list(name.encode()))
    return [random.uniform(0.1, 0.9, function.numel_in(i)).astype(dtype) for i in range(function.n_in())]


@pytest.mark.cases(13)
@pytest.mark.parametrize("name", KERNELS)
def test_the_library_agrees_with_the_formula(name: str) -> None:
    given = arguments(name)
    found = wide().kernel(name)(*given)
    expected = DERIVATION.function(name).call([ca.DM(a) for a in given])
    for a, b in zip(found, expected, strict=True):
        np.testing.assert_allclose(a, np.array(b).ravel(), rtol=1e-11, atol=1e-12)


@pytest.mark.parametrize("name", KERNELS)
def test_casadi_loads_the_same_kernel_from_the_same_file(name: str) -> None:
    library, given = wide(), arguments(name)
    external = ca.external(name, str(library.path))
    reference = DERIVATION.function(name)
    assert (external.name_in(), external.name_out()) == (reference.name_in(), reference.name_out())
    loaded = external.call([ca.DM(a) for a in given])
    for a, b in zip(library.kernel(name)(*given), loaded, strict=True):
        np.testing.assert_array_equal(a, np.array(b).ravel())


@pytest.mark.cases(1)
@pytest.mark.parametrize("rows", [3, 6])
def test_tangential_rows_reach_the_library(rows: Rows) -> None:
    model = require(WIDE)
    derivation = derive(
        replace(model, contact_kinds=tuple(replace(kind, rows=rows) for kind in model.contact_kinds))
    )
    library = compiled(emit(derivation))
    for kind in library.manifest.kinds["contact"]:
        assert kind["rows"] == rows
        function = derivation.function(f"mg_{kind['name']}_rates")
        given = [np.random.default_rng(1).uniform(0.1, 0.9, function.numel_in(i)) for i in range(6)]
        found = library.kernel(function.name())(*given)
        for a, b in zip(found, function.call([ca.DM(a) for a in given]), strict=True):
            np.testing.assert_allclose(a, np.array(b).ravel(), rtol=1e-11, atol=1e-12)


@pytest.mark.cases(1)
@pytest.mark.parametrize(("real", "digits"), [("long double", 1e-11), ("float", 1e-3)])
def test_other_real_types_agree_to_their_digits(real: str, digits: float) -> None:
    library, double = compiled(PACKAGE, real), wide()
    for name in KERNELS:
        given = arguments(name, np.float32)  # numbers that every type holds
        found = library.kernel(name)(*(a.astype(library.dtype) for a in given))
        expected = double.kernel(name)(*(a.astype(np.float64) for a in given))
        for a, b in zip(found, expected, strict=True):
            assert a.dtype == library.dtype
            np.testing.assert_allclose(
                a.astype(float), b, rtol=digits, atol=digits * (1 + np.abs(b).max(initial=0))
            )


WRONG = {
    "a wrong shape": lambda a: np.zeros(a.size + 1),
    "a matrix": lambda a: a.reshape(1, -1),
    "a wrong type": lambda a: a.astype(np.float32),
    "gaps between entries": lambda a: np.repeat(a, 2)[::2],
    "a list": lambda a: a.tolist(),
}


@pytest.mark.parametrize("wrong", WRONG)
def test_a_kernel_refuses(wrong: str) -> None:
    name = "mg_free_full_loaded_pose"
    with pytest.raises(LibraryError, match=r"mg_free_full_loaded_pose: q: .*shape \(7,\)"):
        wide().kernel(name)(WRONG[wrong](arguments(name)[0]))


def test_a_kernel_refuses_too_few_arguments() -> None:
    with pytest.raises(LibraryError, match=r"0 arguments.*takes 1: q"):
        wide().kernel("mg_free_full_loaded_pose")()


def test_an_unknown_kernel_is_refused_with_the_nearest() -> None:
    with pytest.raises(LibraryError, match="did you mean 'mg_free_full_loaded_pose'"):
        wide().kernel("mg_free_full_loaded_posse")


PAPER = scene(
    egg("o"),
    egg("f", "[0.1, 0.2, 0.3]", "density = 500.0\nposition = [0.0, 0.0, 1.0]"),
    contact("o", "f", 'form = "paper"'),
)


def moved(pose: Array, twist: Array, h: float) -> Array:
    """The pose after h seconds, to second order in h; twist = [world velocity, body spin]."""
    turn = Rotation.from_rotvec(h * twist[3:]).as_matrix()
    return np.concatenate([pose[:3] + h * twist[:3], (pose[3:].reshape(3, 3).T @ turn).ravel(order="F")])


def test_the_contact_angle_of_the_paper_is_a_kernel_of_the_library() -> None:
    """(4.3): psi_dot is the rate of psi along a motion of an extremal pair, here along x."""
    library, name = library_of(PAPER), "mg_ellipsoid_ellipsoid_paper_angle"
    angle, rates = library.kernel(name), library.kernel(name.replace("angle", "rates"))
    rotation, parameters = np.eye(3).ravel(), np.array([0.12, 0.09, 0.07, 0.1, 0.2, 0.3])
    o, f = np.array([0.0, 0.0, 0.0, *rotation]), np.array([0.4, 0.0, 0.0, *rotation])
    u_o, u_f = np.array([0.1, 0.2, 0.3, 1.0, -0.5, 0.7]), np.array([0.3, -0.1, 0.2, 0.4, 0.2, -0.6])
    eta = np.array([0.0, 0.0, np.pi, 0.0])
    eta_dot = rates(o, u_o, f, u_f, eta, parameters)[4]
    psi, psi_dot = angle(o, u_o, f, u_f, eta, parameters)
    h = 1e-5
    after, before = (
        angle(moved(o, u_o, s), u_o, moved(f, u_f, s), u_f, eta + s * eta_dot, parameters)[0] for s in (h, -h)
    )
    assert abs(psi_dot[0]) > 0.1
    change = (after - before + np.pi) % (2 * np.pi) - np.pi  # psi is an angle
    np.testing.assert_allclose(change / (2 * h), psi_dot, rtol=1e-7)
    external = ca.external(name, str(library.path))
    assert external.name_out() == ["psi", "psi_dot"]
    assert [float(value) for value in external(o, u_o, f, u_f, eta, parameters)] == [psi[0], psi_dot[0]]
    entry = library.manifest.functions[name]
    assert [port["unit"] for port in entry["outputs"]] == ["rad", "rad/s"]
    assert "(4.3)" in entry["citation"]


def test_other_forms_have_no_contact_angle() -> None:
    assert not [name for name in KERNELS if name.endswith("_angle")]
