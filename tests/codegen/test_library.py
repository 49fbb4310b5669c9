"""Kernels give the same through three doors: CasADi's interpreter, the library, and casadi.external."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np
import pytest

from modelgen import derive, require
from modelgen.errors import LibraryError
from tests.model.scenes import WIDE
from tests.running import library_of

Array = np.ndarray[Any, Any]
DERIVATION = derive(require(WIDE))
KERNELS = [formula.name for formula in DERIVATION.formulas if formula.role != "rhs"]


def arguments(name: str, dtype: Any = np.float64) -> list[Array]:
    """Points near the origin of every input; the seed is the name."""
    function = DERIVATION.function(name)
    random = np.random.default_rng(list(name.encode()))
    return [random.uniform(0.1, 0.9, function.numel_in(i)).astype(dtype) for i in range(function.n_in())]


@pytest.mark.parametrize("name", KERNELS)
def test_the_library_agrees_with_the_formula(name: str) -> None:
    given = arguments(name)
    found = library_of(WIDE).kernel(name)(*given)
    expected = DERIVATION.function(name).call([ca.DM(a) for a in given])
    for a, b in zip(found, expected, strict=True):
        np.testing.assert_allclose(a, np.array(b).ravel(), rtol=1e-11, atol=1e-12)


@pytest.mark.parametrize("name", KERNELS)
def test_casadi_loads_the_same_kernel_from_the_same_file(name: str) -> None:
    library, given = library_of(WIDE), arguments(name)
    external = ca.external(name, str(library.path))
    reference = DERIVATION.function(name)
    assert (external.name_in(), external.name_out()) == (reference.name_in(), reference.name_out())
    loaded = external.call([ca.DM(a) for a in given])
    for a, b in zip(library.kernel(name)(*given), loaded, strict=True):
        np.testing.assert_array_equal(a, np.array(b).ravel())


@pytest.mark.parametrize(("real", "digits"), [("float", 1e-3), ("long double", 1e-11)])
def test_other_real_types_agree_to_their_digits(real: str, digits: float) -> None:
    library, double = library_of(WIDE, real), library_of(WIDE)
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
        library_of(WIDE).kernel(name)(WRONG[wrong](arguments(name)[0]))


def test_a_kernel_refuses_too_few_arguments() -> None:
    with pytest.raises(LibraryError, match=r"0 arguments.*takes 1: q"):
        library_of(WIDE).kernel("mg_free_full_loaded_pose")()


def test_an_unknown_kernel_is_refused_with_the_nearest() -> None:
    with pytest.raises(LibraryError, match="did you mean 'mg_free_full_loaded_pose'"):
        library_of(WIDE).kernel("mg_free_full_loaded_posse")
