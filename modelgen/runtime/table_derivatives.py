"""Derivatives of the tables that the core reads by a parameter.

The numbers of a scene are expressions of its parameters, which are differentiated exactly; what the tables
make of these numbers (inverse masses, rotations, places of features) is differentiated by differences of
tables, of which all numbers have moved along their derivatives, extrapolated and tested.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from modelgen.errors import SimulationError
from modelgen.runtime.accuracy import RELATIVE_STEP, TABLE_BEND, TABLE_ERROR
from modelgen.runtime.tables.ctypes_structures import Array

SHORTER, STEPS = 8.0, 5  # times, from one try to the next; tries
LEVELS = 4  # of an extrapolation
ROUNDING = 4  # units of rounding of a number in the tables
Read = Callable[[float], Array]


@dataclass(frozen=True)
class Found:
    """A derivative, and whether differences of both sides and of all steps agree on it."""

    value: Array
    is_smooth: bool


@dataclass(frozen=True)
class Tables:
    """Tables as a function of a change."""

    read: Read  # (n,) after a change, of which 0 is always possible
    unit: float  # change by which numbers change by as much as themselves
    scale: float  # the largest number that moves: numbers that are small may be differences of such
    epsilon: float  # unit of rounding

    def derivative(self, relative_step: float = RELATIVE_STEP) -> Found:
        """The derivative at 0: central differences, with shorter and shorter steps until they agree; where
        one side is refused, those of the other.

        Raises SimulationError where both sides are refused, however short the step.
        """
        best: Found | None = None
        refused: SimulationError | None = None
        for k in range(STEPS):
            step = relative_step * self.unit / SHORTER**k
            for rule, h in ((self._central, step), (self._one_sided, step), (self._one_sided, -step)):
                try:
                    found = rule(h)
                except SimulationError as error:
                    refused = error
                    continue
                if found.is_smooth:
                    return found
                best = best or found
                break
        if best is None:
            assert refused is not None
            raise refused
        return best

    def _central(self, step: float) -> Found:
        """By differences of both sides; the first where they are those of a linear function. Beyond a kink
        within the step the extrapolation fails; on a kink the difference of both sides does not vanish with
        the step."""
        at_start, h = self.read(0.0), step
        largest = np.full_like(at_start, self.scale)
        table: list[Array] = []
        bends: list[Array] = []
        for k in range(LEVELS):
            h = step / 2**k
            above, below = self.read(h), self.read(-h)
            size = np.maximum(np.abs(above), np.abs(below))
            largest, rounding = np.maximum(largest, size), ROUNDING * self.epsilon * size
            table.append((above - below) / (2 * h))
            bends.append(((above - at_start) - (at_start - below)) / h)
            is_linear = k == 1 and np.all(np.abs(table[1] - table[0]) * h <= rounding)
            if is_linear and np.all(np.abs(bends[1]) * h <= 2 * rounding):
                return Found(table[0], True)
        value, change = _extrapolated(table, 4.0, 4.0)
        bend, _ = _extrapolated(bends, 2.0, 4.0)
        size, noise = self._size(value, at_start), 8 * ROUNDING * self.epsilon * largest / h
        is_bent = np.any(np.abs(bend) > TABLE_BEND * size + 8 * noise)
        return Found(value, bool(np.all(change <= TABLE_ERROR * size + noise) and not is_bent))

    def _one_sided(self, step: float) -> Found:
        """By differences with 0, of twice as many steps."""
        at_start = self.read(0.0)
        table = [(self.read(step / 2**k) - at_start) / (step / 2**k) for k in range(2 * LEVELS)]
        value, change = _extrapolated(table, 2.0, 2.0)
        largest = np.maximum(np.abs(at_start), self.scale)
        noise = 64 * ROUNDING * self.epsilon * largest * 2 ** (2 * LEVELS) / abs(step)
        return Found(value, bool(np.all(change <= TABLE_ERROR * self._size(value, at_start) + noise)))

    def _size(self, value: Array, at_start: Array) -> Array:
        """Sizes of derivatives: their own, and those of the tables, whose largest stand for infinity."""
        with np.errstate(over="ignore"):
            return np.abs(value) + np.abs(at_start) / self.unit


def _extrapolated(table: list[Array], first: float, base: float) -> tuple[Array, Array]:
    """The limit of differences with halved steps, and by how much the last step of the extrapolation changes
    it. The parts of their error fall by the factors `first`, `first` base, .. where the step is halved."""
    change = np.zeros_like(table[0])
    for order in range(1, len(table)):
        factor = first * base ** (order - 1)
        last = table[-1]
        table = [(factor * b - a) / (factor - 1) for a, b in pairwise(table)]
        change = np.abs(table[-1] - last)
    return table[0], change
