"""In words, what data cannot tell: directions in which unknowns change and nothing that was measured does."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import numpy as np

from modelgen.identification.recordings import Array

NEAR = 0.02  # an exponent, relative, to a fraction of small numbers
LARGEST = 4  # numerator and denominator of such a fraction
MENTIONED = 0.02  # share of the largest entry of a direction from which an unknown is named


def in_words(direction: Array, names: Sequence[str], relative: Sequence[bool]) -> str:
    """One direction (n,) in scales: `only the ratio of a and b is seen`.

    Args:
        direction: changes of the unknowns, each in its scale.
        names: (n,)
        relative: (n,) whether the scale of an unknown is its value, so that its change is one of its
            logarithm.
    """
    members = np.flatnonzero(np.abs(direction) > MENTIONED * np.abs(direction).max()).tolist()
    told = [names[k] for k in members]
    entries = direction[members]
    if len(members) == 1:
        return f"{told[0]} is not seen"
    if all(relative[k] for k in members):
        if len(members) == 2 and (power := _power(*entries)):
            return _product(told, power)
        if np.allclose(entries, entries[0], rtol=NEAR):
            return f"only the ratios of {_listed(told)} are seen"
    changes = [
        f"{entry:+.3g}{' %' if relative[k] else ''}" for k, entry in zip(members, entries, strict=True)
    ]
    units = "" if all(relative[k] for k in members) else " (of their scales)"
    return f"{_listed(told)} can change together, unseen, as {', '.join(changes)}{units}"


def _power(a: float, b: float) -> Fraction | None:
    """b/a as a fraction of small numbers, if it is near one."""
    fraction = Fraction(b / a).limit_denominator(LARGEST)
    near = abs(float(fraction) - b / a) <= NEAR * abs(b / a)
    return fraction if near and 0 < abs(fraction.numerator) <= LARGEST else None


def _product(names: Sequence[str], power: Fraction) -> str:
    """What stays while the logarithms of both change as 1 and `power`: a^p / b^q."""
    p, q = power.numerator, power.denominator
    if abs(p) == q == 1:
        return f"only the {'ratio' if p > 0 else 'product'} of {names[0]} and {names[1]} is seen"
    first, second = (f"{name}^{n}" if n > 1 else name for name, n in zip(names, (abs(p), q), strict=True))
    return f"only {first}{'/' if p > 0 else '*'}{second} is seen"


def _listed(names: Sequence[str]) -> str:
    return f"{', '.join(names[:-1])} and {names[-1]}"
