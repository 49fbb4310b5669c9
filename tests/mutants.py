"""Damaged copies of bytes."""

from __future__ import annotations

import struct
from collections.abc import Iterator
from math import inf, nan
from random import Random


def mutants(whole: bytes, count: int, seed: int = 50) -> Iterator[bytes]:
    """What errors of a disk or a hand leave: bits flipped, cut, longer, parts replaced, exchanged or zero."""
    draw, number = Random(seed), 0
    while number < count:
        a, b = sorted(draw.sample(range(len(whole)), 2))
        part = whole[a:b]
        mutant = (
            whole[:a] + bytes([whole[a] ^ 1 << draw.randrange(8)]) + whole[a + 1 :],
            whole[:b],
            whole + draw.randbytes(8),
            whole[:a] + draw.randbytes(len(part)) + whole[b:],
            whole[:a] + struct.pack("<d", draw.choice((-1e300, 1e-300, inf, nan))) + whole[a + 8 :],
            whole[:8] + part + whole[8 + len(part) :],
            whole[:a] + bytes(len(part)) + whole[b:],
        )[number % 7]
        if mutant != whole:
            number += 1
            yield mutant
