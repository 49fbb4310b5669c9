"""The elementary functions of the core: within one unit in the last place, equal bits by any compiler."""

from __future__ import annotations

import ctypes
import math
import struct
import subprocess
from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from mpmath import mp, mpf

from tests.benchmarks import elementary_constants
from tests.benchmarks.same_bits import MACHINES
from tests.c_compiler import CC, needs_c
from tests.core.compiling import CORE, WARNINGS, includes
from tests.export.folders import ZIG, needs_zig, runner, said

pytestmark = needs_c

ONE = ("sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "exp", "log", "asinh")
TWO = ("atan2", "pow", "hypot")
POINTS = 60  # of each decade or place
PRECISION = 200  # bits of the reference; arguments are doubles, reduced by mpmath exactly


def compiled(folder: Path, command: Sequence[str], *flags: str, text: str = "") -> Path:
    """The room of the functions, and `text` after it, in one file."""
    unit, out = folder / "unit.c", folder / "unit.out"
    unit.write_text(includes("elementary") + text)
    words = [
        *command,
        *WARNINGS,
        "-ffp-contract=off",
        f"-I{CORE}",
        *flags,
        str(unit),
        "-o",
        str(out),
        "-lm",
    ]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return out


@pytest.fixture(scope="module")
def own(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Callable[..., float]]:
    """The functions of the core by name, each from doubles to a double."""
    folder = tmp_path_factory.mktemp("elementary")
    library = ctypes.CDLL(str(compiled(folder, CC, "-O2", "-shared", "-fPIC")))
    found = {}
    for name in (*ONE, *TWO):
        function = getattr(library, f"mg_{name}")
        function.restype = ctypes.c_double
        function.argtypes = [ctypes.c_double] * (1 if name in ONE else 2)
        found[name] = function
    return found


def decades(low: int, high: int) -> Iterator[float]:
    """Numbers of both signs, spread by decades from 10**low to 10**high."""
    draw = np.random.default_rng(1)
    for _ in range(POINTS * 8):
        yield float(draw.choice([-1.0, 1.0]) * 10 ** draw.uniform(low, high))


def beside(places: Iterator[float], widest: float) -> Iterator[float]:
    """Numbers at, right beside, and near some places."""
    draw = np.random.default_rng(2)
    for place in places:
        yield from (place, math.nextafter(place, math.inf), math.nextafter(place, -math.inf))
        for _ in range(4):
            yield place + float(draw.choice([-1.0, 1.0]) * 10 ** draw.uniform(-15, math.log10(widest)))


def multiples(step: float, count: int) -> Iterator[float]:
    draw = np.random.default_rng(3)
    return (float(k) * step for k in draw.integers(-count, count, POINTS))


CLOSEST_TO_MULTIPLES = (  # doubles that are nearest to a multiple of pi/2, of their size or of all
    *(6381956970095103 * 2.0**797, 5319372648326541 * 2.0**-2, 6134899525417045 * 2.0**-44),
    *(1.5707963267948966, 3.141592653589793, 22.0, 355.0, 103993.0, 1e22, 1.7976931348623157e308),
)
BINARY_STEPS = [k / 128 for k in range(80, 180, 3)]
ARGUMENTS: dict[str, tuple[Callable[[], Iterator[float]], ...]] = {
    "sin": (
        lambda: decades(-300, 308),
        lambda: decades(-3, 6),
        lambda: beside(multiples(math.pi / 2, 60000), 1e-3),
        lambda: beside(multiples(math.pi / 4, 20), 1.0),
        lambda: iter(CLOSEST_TO_MULTIPLES),
    ),
    "asin": (
        lambda: (x for x in decades(-300, 0) if abs(x) <= 1),
        lambda: (x for x in decades(-2, 0) if abs(x) <= 1),
        lambda: (x for x in beside(iter([k / 32 for k in range(-32, 33)]), 0.01) if abs(x) <= 1),
    ),
    "atan": (
        lambda: decades(-300, 308),
        lambda: decades(-3, 3),
        lambda: beside(iter([k / 64 for k in range(-64, 65)]), 0.01),
    ),
    "sinh": (
        lambda: decades(-300, 2.85),
        lambda: decades(-2, 2),
        lambda: beside(iter([0.26, 0.36, 40.0]), 0.1),
    ),
    "exp": (
        lambda: decades(-300, 2.85),
        lambda: beside(multiples(math.log(2) / 256, 200000), 1e-3),
        lambda: beside(iter([-708.4, -745.1, 709.78]), 0.3),
    ),
    "log": (
        lambda: (abs(x) for x in decades(-323, 308)),
        lambda: beside(iter(BINARY_STEPS), 1e-3),
        lambda: beside(iter([1.0, 0.9375, 1.0625, 0.6875, 1.375]), 0.1),
    ),
}  # fmt: skip
ARGUMENTS |= {"cos": ARGUMENTS["sin"], "tan": ARGUMENTS["sin"], "acos": ARGUMENTS["asin"]}
ARGUMENTS |= {"asinh": ARGUMENTS["atan"], "cosh": ARGUMENTS["sinh"], "tanh": ARGUMENTS["sinh"]}


def error_in_units(found: float, exact: mpf) -> float:
    """The error of a double in units in the last place of the exact result."""
    if not math.isfinite(found):
        return 0.0 if abs(exact) > mpf(1.7976931348623157e308) and (found > 0) == (exact > 0) else math.inf
    if exact == 0:
        return abs(found) / 5e-324
    exponent = max(int(mp.floor(mp.log(abs(exact), 2))) - 52, -1074)
    return float(abs(mpf(found) - exact) / mp.ldexp(1, exponent))


@pytest.mark.parametrize("name", ONE)
def test_a_function_of_one_number_is_within_one_unit(name: str, own: dict[str, Callable[..., float]]) -> None:
    exact = getattr(mp, name)
    with mp.workprec(PRECISION):
        for group in ARGUMENTS[name]:
            errors = {x: error_in_units(own[name](x), exact(mpf(x))) for x in group()}
            worst = max(errors, key=lambda x: errors[x])
            assert errors[worst] < 1, f"{name}({worst!r}) is off by {errors[worst]:.3f} units"


def pairs(name: str) -> Iterator[tuple[float, float]]:
    """Arguments of a function of two numbers."""
    draw = np.random.default_rng(4)
    for _ in range(POINTS * 8):
        x, y = (10 ** draw.uniform(-300, 300, 2)).tolist()
        near = float(draw.uniform(0.5, 2.0))
        sign, other = draw.choice([-1.0, 1.0], 2).tolist()
        if name == "pow":
            slow = 1 + sign * 10 ** draw.uniform(-15, -1)
            yield from ((x, other * 10 ** draw.uniform(-3, 0.3)), (slow, 10 ** draw.uniform(0, 14)))
            yield from ((sign * near * 10, float(draw.integers(-40, 40))), (near, 1000 * other * near))
        else:
            yield from (
                (sign * x, other * y),
                (sign * x, other * near * x),
                (sign * 5e-324 * 10**near, 1e-321),
            )
    if name == "atan2":
        for k in range(-32, 33):
            yield from ((k / 32, 1.0), (1.0, k / 32), (k / 32 + 1 / 64, -1.0), (k * 5e-324, -1e-323))


@pytest.mark.parametrize("name", TWO)
def test_a_function_of_two_numbers_is_within_one_unit(
    name: str, own: dict[str, Callable[..., float]]
) -> None:
    exact = {"atan2": mp.atan2, "pow": mp.power, "hypot": mp.hypot}[name]
    with mp.workprec(PRECISION):
        for x, y in pairs(name):
            if name == "pow" and abs(y * math.log(abs(x))) > 745:
                continue
            error = error_in_units(own[name](x, y), mp.re(exact(mpf(x), mpf(y))))
            assert error < 1, f"{name}({x!r}, {y!r}) is off by {error:.3f} units"


NAN, INF, HALF = math.nan, math.inf, math.pi / 2
SPECIAL: dict[str, list[tuple[tuple[float, ...], float]]] = {  # C99, annex F.9
    "sin": [((0.0,), 0.0), ((-0.0,), -0.0), ((INF,), NAN), ((NAN,), NAN)],
    "cos": [((0.0,), 1.0), ((-INF,), NAN), ((NAN,), NAN)],
    "tan": [((0.0,), 0.0), ((-0.0,), -0.0), ((INF,), NAN), ((NAN,), NAN)],
    "asin": [((0.0,), 0.0), ((-0.0,), -0.0), ((1.0,), HALF), ((1.0000000000000002,), NAN), ((NAN,), NAN)],
    "acos": [((1.0,), 0.0), ((-1.0,), math.pi), ((0.0,), HALF), ((-INF,), NAN), ((NAN,), NAN)],
    "atan": [((0.0,), 0.0), ((-0.0,), -0.0), ((INF,), HALF), ((-INF,), -HALF), ((NAN,), NAN)],
    "sinh": [((0.0,), 0.0), ((-0.0,), -0.0), ((-INF,), -INF), ((1e300,), INF), ((NAN,), NAN)],
    "cosh": [((0.0,), 1.0), ((-INF,), INF), ((-1e300,), INF), ((NAN,), NAN)],
    "tanh": [((0.0,), 0.0), ((-0.0,), -0.0), ((INF,), 1.0), ((-INF,), -1.0), ((NAN,), NAN)],
    "exp": [((-0.0,), 1.0), ((INF,), INF), ((-INF,), 0.0), ((1e300,), INF), ((-1e300,), 0.0), ((NAN,), NAN)],
    "log": [((0.0,), -INF), ((-0.0,), -INF), ((1.0,), 0.0), ((-1.0,), NAN), ((INF,), INF), ((NAN,), NAN)],
    "asinh": [((0.0,), 0.0), ((-0.0,), -0.0), ((INF,), INF), ((-INF,), -INF), ((NAN,), NAN)],
    "atan2": [
        *[((s * 0.0, x), s * math.pi) for s in (1.0, -1.0) for x in (-1.0, -0.0, -INF)],
        *[((s * 0.0, x), s * 0.0) for s in (1.0, -1.0) for x in (0.0, 1.0, INF)],
        *[((s, x), s * HALF) for s in (1.0, -1.0) for x in (0.0, -0.0)],
        *[((INF, INF), HALF / 2), ((-INF, -INF), -3 * HALF / 2), ((1.0, -INF), math.pi), ((INF, 1.0), HALF)],
        *[((NAN, 1.0), NAN), ((1.0, NAN), NAN), ((-1.0, INF), -0.0)],
    ],
    "hypot": [
        *[((INF, NAN), INF), ((NAN, -INF), INF), ((NAN, 1.0), NAN), ((0.0, -0.0), 0.0), ((3.0, -4.0), 5.0)],
        *[((5e-324, 0.0), 5e-324), ((1.7e308, 1.7e308), INF)],
    ],
    "pow": [
        *[((x, 0.0), 1.0) for x in (0.0, -1.0, INF, NAN)],
        *[((1.0, y), 1.0) for y in (INF, NAN, -7.5)],
        *[((-1.0, y), 1.0) for y in (INF, -INF)],
        *[((-0.0, -3.0), -INF), ((-0.0, -2.0), INF), ((0.0, -0.5), INF), ((-0.0, 3.0), -0.0)],
        *[
            ((-0.0, 0.5), 0.0),
            ((0.0, INF), 0.0),
            ((0.0, -INF), INF),
            ((-8.0, 1 / 3), NAN),
            ((-2.0, 3.0), -8.0),
        ],
        *[((-2.0, 2.0), 4.0), ((2.0, 1024.0), INF), ((-2.0, 1025.0), -INF), ((2.0, -1080.0), 0.0)],
        *[((0.5, INF), 0.0), ((0.5, -INF), INF), ((2.0, -INF), 0.0), ((2.0, 1e300), INF), ((NAN, 1.0), NAN)],
        *[((-INF, 3.0), -INF), ((-INF, 2.0), INF), ((-INF, -3.0), -0.0), ((INF, -0.5), 0.0)],
        *[((2.0, NAN), NAN), ((2.0, -1074.0), 5e-324)],
    ],
}


@pytest.mark.parametrize("name", SPECIAL)
def test_special_values(name: str, own: dict[str, Callable[..., float]]) -> None:
    for given, expected in SPECIAL[name]:
        found = own[name](*given)
        if math.isnan(expected):
            assert math.isnan(found), (name, given, found)
        else:
            assert struct.pack("d", found) == struct.pack("d", expected), (name, given, found)


DIGEST = """
#include <stdio.h>
static unsigned long long seed = 88172645463325252ULL, digest;
static double draw(int is_any) { /* any double, or one of moderate size */
  seed ^= seed << 13, seed ^= seed >> 7, seed ^= seed << 17;
  const int exponent = is_any ? (int)(seed >> 52 & 2047) : 1023 - 12 + (int)(seed >> 52 & 15);
  return mg_from_bits((seed & 0x800fffffffffffffULL) | (unsigned long long)exponent << 52);
}
static void add(double x) {
  if (x == x) digest = (digest ^ mg_bits_of(x)) * 1099511628211ULL;
}
int main(void) {
  for (int k = 0; k < 40000; k++) {
    const double x = draw(k & 1), y = draw(k & 2);
    add(mg_sin(x)), add(mg_cos(x)), add(mg_tan(x)), add(mg_asin(x)), add(mg_acos(x)), add(mg_atan(x));
    add(mg_sinh(x)), add(mg_cosh(x)), add(mg_tanh(x)), add(mg_exp(x)), add(mg_log(x)), add(mg_asinh(x));
    add(mg_atan2(x, y)), add(mg_pow(x, y)), add(mg_hypot(x, y));
  }
  printf("%llx\\n", digest);
  return 0;
}
"""


@pytest.fixture(scope="module")
def digest(tmp_path_factory: pytest.TempPathFactory) -> str:
    return said(compiled(tmp_path_factory.mktemp("digest"), CC, "-O0", text=DIGEST))[0]


def test_bits_do_not_depend_on_optimisation(digest: str, tmp_path: Path) -> None:
    fast = compiled(tmp_path, CC, "-O3", "-march=native", text=DIGEST)
    assert said(fast)[0] == digest


@needs_zig
@pytest.mark.slow
@pytest.mark.parametrize("machine", MACHINES)
def test_bits_do_not_depend_on_the_machine(machine: str, digest: str, tmp_path: Path) -> None:
    by = runner(machine, tmp_path)
    if by is None:
        pytest.skip(f"nothing runs programs of {machine} here")
    program = compiled(tmp_path, ZIG, "-O2", "-target", machine, text=DIGEST)
    assert said(program, by=by)[0] == digest


def test_powers_that_are_doubles_are_exact(own: dict[str, Callable[..., float]]) -> None:
    for base in (3, 5, 7, -6, 10, 1001):
        power = 1
        while abs(base**power) < 2**53:
            assert own["pow"](float(base), float(power)) == float(base**power)
            power += 1
    assert own["pow"](0.25, 0.5) == 0.5
    assert own["pow"](2.0, -3.0) == float(Fraction(1, 8))


def test_the_constants_are_those_of_the_script_that_writes_them() -> None:
    written = elementary_constants.TARGET.read_text()
    assert "".join(written.split()) == "".join(elementary_constants.text().split())
