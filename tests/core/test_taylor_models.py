"""Bounds of functions over boxes contain the functions and are tight to third order (taylor_models.c)."""

from __future__ import annotations

import ctypes
import re
from collections.abc import Callable
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from scipy.optimize import linprog

from modelgen.codegen.bounds_programs import bounds_program
from modelgen.scene.expression import Cubic, Name
from tests.c_compiler import needs_c
from tests.core.compiling import CORE, compile_core

pytestmark = needs_c

HEADER = (CORE / "base" / "taylor_models.h").read_text()
CODES = {name: code for code, name in enumerate(re.findall(r"^  MG_OP_(\w+)", HEADER, re.MULTILINE))}
INPUTS: dict[str, Callable[[ca.SX, ca.SX], ca.SX]] = {
    "sum": lambda u, v: 2 * u - v + 0.5,
    "product": lambda u, v: u * v * (u - 3 * v),
    "quotient": lambda u, v: (u - v) / (2 + u * v),
    "inverse": lambda u, v: 1 / (1.5 + u),
    "square": lambda u, v: (u + v) ** 2,
    "cube": lambda u, v: (u - v) ** 3,
    "negative power": lambda u, v: (2 + u + v / 2) ** -2,
    "power": lambda u, v: (1.5 + u * v) ** 2.7,
    "root": lambda u, v: ca.sqrt(1.3 + u),
    "exponential": lambda u, v: ca.exp(u - v),
    "logarithm": lambda u, v: ca.log(2.2 + u + v),
    "sine": lambda u, v: ca.sin(3 * u + v),
    "cosine": lambda u, v: ca.cos(u - 5 * v),
    "tangent": lambda u, v: ca.tan(u / 2 + v / 3),
    "arcs": lambda u, v: ca.asin(u / 2) + ca.acos(v / 2) + ca.atan(u * v),
    "angle": lambda u, v: ca.atan2(1.2 + u, v - 0.3),
    "hyperbolic": lambda u, v: ca.sinh(u) + ca.cosh(v) - ca.tanh(u - v),
    "absolute": lambda u, v: ca.fabs(u - v / 3),
    "sign": lambda u, v: ca.sign(u) * v,
    "least": lambda u, v: ca.fmin(u, v) + ca.fmax(u * u, 0.2),
    "cubic with a knot": lambda u, v: ca.jacobian(ca.fmax(u - 0.2, 0) ** 3, u) + v,
    "choice": lambda u, v: ca.if_else(u < v, u * u, v),
    "cap": lambda u, v: ca.sqrt(4 - u * u - v * v) * ca.cos(u * v),
}  # fmt: skip


class Model(ctypes.Structure):
    _fields_ = (("middle", ctypes.c_double), ("slope", ctypes.c_double * 2), ("bend", ctypes.c_double * 3),
                ("rest", ctypes.c_double))  # fmt: skip


@pytest.fixture(scope="module")
def core() -> ctypes.CDLL:
    text = (Path(__file__).parent / "taylor_driver.c").read_text()
    return ctypes.CDLL(str(compile_core(text, "-O0", "-shared", "-fPIC")))


def bounds(core: ctypes.CDLL, function: ca.Function, box: np.ndarray) -> tuple[list[Model], list[float]]:
    """Bounds of a function over a box, and the places of its kinks along both coordinates."""
    instructions, constants = bounds_program(function)
    rows = np.array([(CODES[code], *places) for code, *places in instructions], dtype=np.uint16)
    numbers = np.array(constants or [0.0])
    out, kink = (Model * function.numel_out(0))(), (ctypes.c_double * 2)()
    memory = (Model * (function.sz_w() + 1))()
    core.bound_over_box(
        rows.ctypes.data_as(ctypes.c_void_p), len(rows), numbers.ctypes.data_as(ctypes.c_void_p),
        box.ctypes.data_as(ctypes.c_void_p), None, len(out), memory, function.sz_w() + 1, out, kink,
    )  # fmt: skip
    return list(out), list(kink)


@pytest.mark.cases(12)
@pytest.mark.parametrize("name", INPUTS)
def test_a_model_contains_the_function_and_its_rest_falls_with_the_cube_of_the_box(
    core: ctypes.CDLL, name: str
) -> None:
    uv = ca.SX.sym("uv", 2)
    function = ca.Function("f", [uv, ca.SX(0, 1)], [ca.densify(INPUTS[name](uv[0], uv[1]))])
    rng = np.random.default_rng(7)
    for _ in range(40):
        middle = rng.uniform(-0.9, 0.9, 2)
        rests = []
        for half in (0.1, 0.01, 0.001):
            box = np.array([middle[0] - half, middle[0] + half, middle[1] - half, middle[1] + half])
            (model,), _ = bounds(core, function, box)
            places = np.vstack([rng.uniform(-1, 1, (200, 2)), [(a, b) for a in (-1, 1) for b in (-1, 1)]])
            exact = np.asarray(function((middle + half * places).T, ca.DM(0, len(places)))).ravel()
            r, s = places.T
            polynomial = model.middle + model.slope[0] * r + model.slope[1] * s
            polynomial += model.bend[0] * r * r + model.bend[1] * r * s + model.bend[2] * s * s
            assert np.all(np.abs(exact - polynomial) <= model.rest)
            rests.append(model.rest)
        smooth = rests[2] < 1e-2 * rests[1]
        assert (
            smooth or name in ("absolute", "sign", "least", "cubic with a knot", "choice") or rests[1] < 1e-12
        )


@pytest.mark.parametrize("place", [0.0, 0.25, -0.7, 1 - 1e-9, -1 + 1e-9])
@pytest.mark.parametrize("kind", ["max", "min", "absolute"])
def test_a_kink_is_placed_and_leaves_open_half_of_what_lies_beyond_it(
    core: ctypes.CDLL, kind: str, place: float
) -> None:
    uv = ca.SX.sym("uv", 2)
    x = uv[1] - place
    text = {"max": ca.fmax(x, 0), "min": ca.fmin(x, 0), "absolute": ca.fabs(x) / 2}[kind]
    function = ca.Function("f", [uv, ca.SX(0, 1)], [text + uv[0]])
    (model,), kink = bounds(core, function, np.array([-1.0, 1.0, -1.0, 1.0]))
    assert kink == [1.0, pytest.approx(place, abs=1e-15)]
    assert model.rest == pytest.approx((1 - abs(place)) / 2, abs=1e-13)


@pytest.mark.parametrize("order", [0, 1, 2])
@pytest.mark.parametrize("coordinate", [0, 1])
@pytest.mark.parametrize("pieces", [1, 2, 7, 300])
def test_a_spline_over_a_box_is_bounded_as_tightly_as_it_bends(
    core: ctypes.CDLL, order: int, coordinate: int, pieces: int
) -> None:
    """Random splines with uneven knots, over boxes from a thousandth of a piece to twice the domain: the rest
    is no more than 2.5 times the least largest error of a quadratic function, by a linear program over
    samples (that through three points has 2.25 times at most) where the box meets up to 16 pieces, and 6
    times where blocks of pieces are seen as chords, and the kink is the knot nearest to the middle."""
    rng = np.random.default_rng([order, coordinate, pieces])
    for _ in range(20):
        knots = np.concatenate([[0.0], np.cumsum(10 ** rng.uniform(-1.5, 0, pieces))]) / pieces
        spline = CubicSpline(knots, rng.normal(size=pieces + 1), bc_type="natural")
        cubic = Cubic(Name("t"), "x", pieces)
        named = {f"k_{k}": float(knot) for k, knot in enumerate(knots)} | cubic.numbers(*spline.c[::-1])
        numbers = np.array(list((named | cubic.deviations(named)).values()))
        half = np.exp(rng.uniform(np.log(1e-3 * np.diff(knots).min()), np.log(knots[-1])))
        middle = rng.uniform(0, knots[-1])
        box = np.tile([-1.0, 1.0], 2)
        box[2 * coordinate : 2 * coordinate + 2] = middle - half, middle + half
        model, kink = Model(), (ctypes.c_double * 2)()
        core.bound_spline(
            coordinate, order, pieces, numbers.ctypes.data_as(ctypes.c_void_p),
            box.ctypes.data_as(ctypes.c_void_p), ctypes.byref(model), kink,
        )  # fmt: skip
        inner = (knots[1:-1] - middle) / half
        r = np.concatenate([np.linspace(-1, 1, 2001), inner[np.abs(inner) < 1]])
        met = inner[np.abs(inner) < 1]
        exact = spline(middle + half * r, order)
        found = model.middle + model.slope[coordinate] * r + model.bend[2 * coordinate] * r * r
        assert np.all(np.abs(exact - found) <= model.rest)
        assert model.slope[1 - coordinate] == model.bend[1] == model.bend[2 - 2 * coordinate] == 0
        most = sum(np.abs(spline(middle + half * r, order + k)).max() * (1 + half) ** k for k in (0, 1))
        assert (
            model.rest <= (2.5 if len(met) < 15 else 6) * _least_error(r, exact) + 1e-13 * (8 + pieces) * most
        )
        nearest = inner[np.argmin(np.abs(inner))] if len(inner) else 1.0
        assert kink[1 - coordinate] == 1.0
        assert kink[coordinate] == pytest.approx(nearest if abs(nearest) < 1 else 1.0, abs=1e-6)


def _least_error(r: np.ndarray, values: np.ndarray) -> float:
    """The least largest error of a quadratic function at some places."""
    columns = np.stack([np.ones_like(r), r, r * r], axis=1)
    left = values - columns @ np.linalg.lstsq(columns, values)[0]
    size = np.abs(left).max() or 1.0
    ones = np.ones((len(r), 1))
    rows = np.vstack([np.hstack([columns, -ones]), np.hstack([-columns, -ones])])
    done = linprog([0, 0, 0, 1], rows, np.concatenate([left, -left]) / size, bounds=[(None, None)] * 4)
    return float(done.fun) * size
