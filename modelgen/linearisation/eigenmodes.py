"""Modes of y'' + C y' + K y = 0, each with a shape that is well defined; K need not be symmetric."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from modelgen.linearisation.rest_linearisation import Place
from modelgen.linearisation.touching_contact import Array

Solver = Callable[..., Iterator["Mode"]]  # (place, moved, still, slow)

SAME = 1e-9  # relative: frequencies this near belong to one space of shapes
AS_NEAR = 1e-9  # of two coordinates that lie equally near a space of shapes the first is taken


@dataclass(frozen=True, slots=True)
class Mode:
    """A small motion exp(growth t) cos(frequency t); neither: the equilibrium may be moved along it.

    Where several motions share a frequency, or are neutral, their shapes are the motions of that space that
    are nearest to single coordinates: the nearest first, the next across it by the mass, and so on.
    """

    frequency: float  # rad/s
    growth: float  # 1/s, negative of a motion that dies out
    shape: Array  # (n,) complex, along u: of each body v in world axes (m), then w in body axes (rad)

    @property
    def hertz(self) -> float:
        return self.frequency / (2 * np.pi)

    @property
    def kind(self) -> str:
        if self.frequency:
            return "oscillation"
        return "neutral" if not self.growth else "growth" if self.growth > 0 else "decay"


def small_motions(place: Place, time: float, neutral: float) -> tuple[Mode, ...]:
    """The modes at a place, by frequency; stiffness and damping below `neutral` count as none, with the
    characteristic time in s."""
    K, C, slow = place.stiffness, place.damping, neutral / time
    _, sizes, vectors = np.linalg.svd(np.vstack([K * time**2, C * time, np.zeros((1, len(K)))]))
    rank = int((sizes > neutral).sum())
    moved, still = vectors[:rank].T, vectors[rank:].T
    found = [Mode(0.0, 0.0, shape) for shape in _nearest_to_coordinates(place.motions @ still, place.mass)]
    found += _moving(K, C, slow, slow / time)(place, moved, still, slow)
    return tuple(sorted(found, key=lambda mode: (mode.frequency, mode.growth)))


def _moving(K: Array, C: Array, slow: float, soft: float) -> Solver:
    """The modes, by the method that suits the matrices."""
    if np.abs(C).max(initial=0.0) >= slow:
        return _damped
    return _undamped if np.abs(K - K.T).max(initial=0.0) < soft else _circulating


def _undamped(place: Place, moved: Array, still: Array, slow: float) -> Iterator[Mode]:
    K = moved.T @ place.stiffness @ moved
    values, vectors = np.linalg.eigh((K + K.T) / 2)
    shapes, first = place.motions @ moved @ vectors, 0
    while first < len(values):
        last = first + 1
        while last < len(values) and values[last] - values[first] <= SAME * abs(values[first]):
            last += 1
        for shape in _nearest_to_coordinates(shapes[:, first:last], place.mass):
            rate = float(np.sqrt(np.abs(values[first:last]).mean()))
            yield from (
                [Mode(rate, 0.0, shape)]
                if values[first] > 0
                else (Mode(0.0, sign * rate, shape) for sign in (-1, 1))
            )
        first = last


def _circulating(place: Place, moved: Array, still: Array, slow: float) -> Iterator[Mode]:
    """Modes without damping, K of any form: s^2 = -value of each eigenvalue; then the neutral motions."""
    values, vectors = np.linalg.eig(moved.T @ place.stiffness @ moved)
    for value, z in zip(values, vectors.T, strict=True):
        if value.imag < 0:
            continue
        rate = np.sqrt(np.complex128(-value))
        frequency, growth = (float(x) if abs(x) > slow else 0.0 for x in (rate.imag, rate.real))
        shape = moved @ z
        if frequency or growth:
            shape = shape + still @ (still.T @ (place.stiffness @ shape)) / value
        shape = place.motions @ (shape if value.imag else np.real(shape))
        if not growth:
            yield Mode(abs(frequency), 0.0, shape)
            continue
        turned = shape if rate.imag > 0 else shape.conj()
        yield Mode(abs(frequency), growth, turned)
        yield Mode(abs(frequency), -growth, turned.conj())


def _damped(place: Place, moved: Array, still: Array, slow: float) -> Iterator[Mode]:
    """Damped modes of the motions across the neutral ones, from s^2 y + still^T (s C + K) moved z = 0; then
    the neutral motions."""
    K, C = (moved.T @ matrix @ moved for matrix in (place.stiffness, place.damping))
    k = len(K)
    values, vectors = np.linalg.eig(np.block([[np.zeros((k, k)), np.eye(k)], [-K, -C]]))
    for value, z in zip(values, vectors[:k].T, strict=True):
        if value.imag < 0:
            continue
        frequency, growth = (float(x) if abs(x) > slow else 0.0 for x in (value.imag, value.real))
        shape = moved @ z
        if frequency or growth:
            shape = shape - still @ (still.T @ ((place.damping * value + place.stiffness) @ shape)) / value**2
        yield Mode(frequency, growth, place.motions @ shape)


def _nearest_to_coordinates(space: Array, mass: Array) -> Iterator[Array]:
    """A basis of the columns of `space`, for which space^T mass space = 1, and it for the basis."""
    while space.shape[1]:
        parts = space.T @ mass
        near = np.sqrt(np.sum(parts**2, axis=0) / np.diag(mass))
        along = parts[:, int(np.argmax(near >= near.max() - AS_NEAR))]
        along = along / np.linalg.norm(along)
        yield space @ along
        space = space @ np.linalg.svd(along[None, :])[2][1:].T
