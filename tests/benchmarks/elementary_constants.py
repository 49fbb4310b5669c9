"""Writes the constants of the elementary functions: `python -m tests.benchmarks.elementary_constants`.

Tables and polynomials of modelgen/core/elementary, computed with 80 digits. Each polynomial interpolates at
the Chebyshev points of its interval; its error, relative to the function in which it is used, is printed.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from mpmath import mp, mpf

import modelgen

TARGET = Path(modelgen.__file__).parent / "core" / "elementary" / "elementary_constants.h"
STEPS = 128  # of the tables of exp and log, per binade
STEPS_ATAN = 32  # of the table of atan, from 0 to 1
LOG_START = mpf("0.6875")  # numbers are reduced to this .. twice this
GRID = -42  # log2 of the grid of those logarithms and of that ln 2 whose sums are to be exact
DIGITS, TERMS = 80, 70
WORDS = 42  # of 2/pi, 32 bits each

SERIES = """
/* Coefficients, the lowest first, of the rests of the series: of (sin x - x)/x^3 and (cos x - 1 + x^2/2)/x^4
   in x^2; of (exp x - 1 - x)/x^2 and (log(1 + x) - x + x^2/2)/x^3 in x, near 0 and up to 0.065; of
   (atan x - x)/x^3, (sinh x - x)/x^3 and (tanh x - x)/x^3 in x^2. */
"""
HEAD = """/* Tables and polynomials of the elementary functions: tests/benchmarks/elementary_constants.py. */
#ifndef MG_ELEMENTARY_CONSTANTS_H
#define MG_ELEMENTARY_CONSTANTS_H

"""


@dataclass(frozen=True)
class Polynomial:
    """What is interpolated where, with how many coefficients, and what share of the whole its error has."""

    function: Callable[[mpf], mpf]
    low: mpf
    high: mpf
    count: int
    share: Callable[[mpf], mpf]


def hexadecimal(x: mpf) -> str:
    return float(x).hex()


def pair(x: mpf) -> tuple[mpf, mpf]:
    """x as the sum of two doubles."""
    high = mpf(float(x))
    return high, mpf(float(x - high))


def on_grid(x: mpf, grid: int) -> tuple[mpf, mpf]:
    """x as the sum of a multiple of 2**grid and a double."""
    high = mp.nint(mp.ldexp(x, -grid)) * mp.ldexp(1, grid)
    return high, mpf(float(x - high))


def interpolated(function: Callable[[mpf], mpf], low: mpf, high: mpf, count: int) -> list[mpf]:
    """Coefficients, rounded to doubles, that interpolate a function at Chebyshev points."""
    nodes = [
        (low + high) / 2 + (high - low) / 2 * mp.cos(mp.pi * (2 * k + 1) / (2 * count)) for k in range(count)
    ]
    matrix = mp.matrix([[node**power for power in range(count)] for node in nodes])
    found = mp.lu_solve(matrix, mp.matrix([function(node) for node in nodes]))
    return [mpf(float(each)) for each in found]


def error(given: Polynomial) -> float:
    """log2 of the largest error of an interpolating polynomial with rounded coefficients."""
    found = interpolated(given.function, given.low, given.high, given.count)
    points = [given.low + (given.high - given.low) * mpf(k) / 400 for k in range(1, 400)]
    errors = [
        abs(given.share(x) * (mp.polyval(list(reversed(found)), x) - given.function(x))) for x in points
    ]
    return float(mp.log(max(errors), 2))


def series(first: int, step: int, alternating: bool, factorial: bool, sign: int = 1) -> Callable[[mpf], mpf]:
    """z -> sum of z^k / (first + step k), or over its factorial, with signs that may alternate."""

    def value(z: mpf) -> mpf:
        terms = []
        for k in range(TERMS):
            n = first + step * k
            divisor = mp.factorial(n) if factorial else mpf(n)
            terms.append((-z if alternating else z) ** k / divisor)
        return sign * mp.fsum(terms)

    return value


def log_centre(index: int) -> mpf:
    """The number near which the interval of an index lies; 1 for the two that touch 1."""
    bits = int(mp.ldexp(LOG_START, 8)) - 128 + index  # steps from 1/2 on
    low = mpf(128 + bits) / 256 if bits < 128 else mpf(bits) / 128
    width = mpf(1) / 256 if bits < 128 else mpf(1) / 128
    return mpf(1) if low == 1 or low + width == 1 else low + width / 2


def rows(name: str, values: Sequence[Sequence[mpf]]) -> str:
    lines = [f"    {{{', '.join(map(hexadecimal, row))}}}," for row in values]
    return f"static const double {name}[{len(values)}][{len(values[0])}] = {{\n" + "\n".join(lines) + "\n};\n"


def flat(name: str, values: Sequence[mpf]) -> str:
    return f"static const double {name}[{len(values)}] = {{{', '.join(map(hexadecimal, values))}}};\n"


def constants() -> dict[str, mpf]:
    ln2, half_pi = mp.log(2), mp.pi / 2
    step_high, step_low = on_grid(ln2 / STEPS, GRID)  # 35 bits: exact times numbers of 18 bits
    two_high, two_low = on_grid(ln2, GRID)
    first, _ = on_grid(half_pi, -32)
    second, _ = on_grid(half_pi - first, -65)
    third = mp.nint(mp.ldexp(half_pi - first - second, 98)) * mp.ldexp(1, -98)
    pi_high, pi_low = pair(half_pi)
    return {
        "MG_STEPS_PER_LN2": STEPS / ln2,
        "MG_STEP_LN2_HIGH": step_high,
        "MG_STEP_LN2_LOW": step_low,
        "MG_LN2_HIGH": two_high,
        "MG_LN2_LOW": two_low,
        "MG_PER_HALF_PI": 2 / mp.pi,
        "MG_HALF_PI_1": first,
        "MG_HALF_PI_2": second,
        "MG_HALF_PI_3": third,
        "MG_HALF_PI_4": half_pi - first - second - third,
        "MG_HALF_PI_HIGH": pi_high,
        "MG_HALF_PI_LOW": pi_low,
    }


def tables() -> str:
    exponentials = []
    for k in range(STEPS):
        high, low = pair(mp.power(2, mpf(k) / STEPS))
        exponentials.append((high, low / high))
    logarithms = []
    for k in range(STEPS):
        centre = log_centre(k)
        logarithms.append((centre, *pair(1 / centre), *on_grid(mp.log(centre), GRID)))
    angles = [pair(mp.atan(mpf(k) / STEPS_ATAN)) for k in range(STEPS_ATAN + 1)]
    return (
        "/* 2^(k/128) rounded, and what it lacks, as a part of it. */\n"
        + rows("mg_exp_table", exponentials)
        + "\n/* A number c for each interval of width 1/256 (below 1) or 1/128, 1/c as a sum of two, log c\n"
        + "   as a multiple of 2^-42 and the rest. */\n"
        + rows("mg_log_table", logarithms)
        + "\n/* atan(k/32) as a sum of two. */\n"
        + rows("mg_atan_table", angles)
    )


def two_over_pi() -> str:
    with mp.workprec(32 * WORDS + 64):
        whole = int(mp.floor(mp.ldexp(2 / mp.pi, 32 * WORDS)))
    words = [(whole >> (32 * (WORDS - 1 - k))) & 0xFFFFFFFF for k in range(WORDS)]
    lines = [", ".join(f"0x{word:08x}U" for word in words[k : k + 7]) for k in range(0, WORDS, 7)]
    return (
        "/* Binary digits of 2/pi, 32 in each. */\n"
        f"static const unsigned mg_two_over_pi[{WORDS}] = {{\n    " + ",\n    ".join(lines) + "};\n"
    )


def polynomials() -> dict[str, Polynomial]:
    quarter, step = (mp.pi / 4 + mpf(2) ** -20) ** 2, mp.log(2) / (2 * STEPS) * mpf("1.01")
    wide, sixth = mpf("0.065"), mpf("0.36")

    def tanh_rest(z: mpf) -> mpf:
        if z == 0:
            return -mpf(1) / 3
        x = mp.sqrt(z)
        return (mp.tanh(x) - x) / x**3

    return {
        "mg_sin_series": Polynomial(series(3, 2, True, True, -1), mpf(0), quarter, 7, lambda z: z),
        "mg_cos_series": Polynomial(series(4, 2, True, True), mpf(0), quarter, 6, lambda z: z * z),
        "mg_exp_series": Polynomial(series(2, 1, False, True), -step, step, 4, lambda x: x * x),
        "mg_log_series": Polynomial(
            series(3, 1, True, False), -mpf(1) / 250, mpf(1) / 127, 7, lambda x: x**2
        ),
        "mg_log_near_one": Polynomial(series(3, 1, True, False), -wide, wide, 11, lambda x: x**2),
        "mg_atan_series": Polynomial(series(3, 2, True, False, -1), mpf(0), mpf(1) / 63**2, 4, lambda z: z),
        "mg_sinh_series": Polynomial(series(3, 2, False, True), mpf(0), sixth**2, 6, lambda z: z),
        "mg_tanh_series": Polynomial(tanh_rest, mpf(0), mpf("0.26") ** 2, 9, lambda z: z),
    }


def text() -> str:
    """The header."""
    with mp.workdps(DIGITS):
        lines = [f"#define {name} {hexadecimal(value)}\n" for name, value in constants().items()]
        rest = [
            flat(name, interpolated(each.function, each.low, each.high, each.count))
            for name, each in polynomials().items()
        ]
        return "".join([HEAD, *lines, "\n", tables(), "\n", two_over_pi(), SERIES, *rest, "\n#endif\n"])


def main() -> None:
    TARGET.write_text(text())
    with mp.workdps(DIGITS):
        for name, each in polynomials().items():
            print(f"{name:20} 2^{error(each):.1f}")


if __name__ == "__main__":
    main()
