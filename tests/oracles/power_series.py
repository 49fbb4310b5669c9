"""Truncated power series in one variable, in the arithmetic of mpmath."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from mpmath import cos, mpf, sin, sqrt

Number = int | float | mpf


@dataclass(frozen=True)
class Series:
    """The sum of c[k] tau^k; operations keep the fewer coefficients of the two."""

    c: tuple[mpf, ...]

    @classmethod
    def of(cls, coefficients: Iterable[Number], size: int) -> Series:
        known = [mpf(x) for x in coefficients][:size]
        return cls((*known, *[mpf(0)] * (size - len(known))))

    def like(self, other: Series | Number) -> Series:
        return other if isinstance(other, Series) else Series.of([other], len(self.c))

    def __add__(self, other: Series | Number) -> Series:
        return Series(tuple(a + b for a, b in zip(self.c, self.like(other).c, strict=False)))

    def __neg__(self) -> Series:
        return Series(tuple(-a for a in self.c))

    def __sub__(self, other: Series | Number) -> Series:
        return self + -self.like(other)

    def __mul__(self, other: Series | Number) -> Series:
        if not isinstance(other, Series):
            return Series(tuple(a * other for a in self.c))
        n = min(len(self.c), len(other.c))
        return Series(tuple(sum(self.c[i] * other.c[k - i] for i in range(k + 1)) for k in range(n)))

    __radd__ = __add__
    __rmul__ = __mul__

    def __rsub__(self, other: Number) -> Series:
        return self.like(other) - self

    def __truediv__(self, other: Number) -> Series:
        return Series(tuple(a / other for a in self.c))

    def derivative(self) -> Series:
        return Series(tuple(k * a for k, a in enumerate(self.c))[1:])

    def integral(self, start: Number = 0) -> Series:
        return Series((mpf(start), *(a / (k + 1) for k, a in enumerate(self.c))))

    def sin_cos(self) -> tuple[Series, Series]:
        """s' = c x', c' = -s x'."""
        s, c = [sin(self.c[0])], [cos(self.c[0])]
        for k in range(1, len(self.c)):
            turn = [j * self.c[j] for j in range(1, k + 1)]
            s.append(sum(x * c[k - j] for j, x in enumerate(turn, 1)) / k)
            c.append(-sum(x * s[k - j] for j, x in enumerate(turn, 1)) / k)
        return Series(tuple(s)), Series(tuple(c))

    def root(self) -> Series:
        r = [sqrt(self.c[0])]
        for k in range(1, len(self.c)):
            r.append((self.c[k] - sum(r[i] * r[k - i] for i in range(1, k))) / (2 * r[0]))
        return Series(tuple(r))

    def inverse(self) -> Series:
        r = [1 / self.c[0]]
        for k in range(1, len(self.c)):
            r.append(-r[0] * sum(self.c[i] * r[k - i] for i in range(1, k + 1)))
        return Series(tuple(r))

    def at(self, tau: Number) -> mpf:
        total = mpf(0)
        for a in reversed(self.c):
            total = total * tau + a
        return total
