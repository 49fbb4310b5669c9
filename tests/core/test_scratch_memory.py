"""Scratch memory: sizes do not overflow or change results, and are refused where memory is too small."""

from __future__ import annotations

import ctypes
from functools import cache

import numpy as np
import pytest

from modelgen import simulate
from modelgen.codegen.library import Library
from modelgen.errors import SimulationError
from modelgen.runtime.tables import library_tables as tables_module
from modelgen.runtime.tables.library_tables import library_tables
from modelgen.runtime.tables.scratch_memory import ROWS_MAX, fit_scratch, scratch_sizes
from modelgen.runtime.trajectory import Outcome, Trajectory
from tests.benchmarks.many_contacts import heap
from tests.core.compiling import CoreBuild
from tests.running import library_of

SPHERES = 6


@cache
def built() -> Library:
    return library_of(heap(SPHERES))


def in_memory(most: int, monkeypatch: pytest.MonkeyPatch) -> Library:
    """The library of the heap with tables of its own, on a machine whose runs may take `most` bytes."""
    monkeypatch.setattr(tables_module, "memory_of_run", lambda: most)
    return built().with_instance(built().manifest.instance)


def bytes_of(library: Library, capacity: int) -> int:
    system = type(library_tables(library).system).from_buffer_copy(library_tables(library).system)
    system.closed_capacity = capacity
    work, iwork = scratch_sizes(library.cdll, system)
    return work * library.dtype.itemsize + iwork * 4


def run(library: Library) -> Trajectory:
    return simulate(library, until=0.3, method="time-stepping", step=0.005, samples=4, estimate=False)


def test_sizes_are_those_of_unbounded_integers(lcp: CoreBuild) -> None:
    functions = lcp.cdll.mg_lcp_work_size, lcp.cdll.mg_friction_work_size
    for function in functions:
        function.restype = ctypes.c_longlong
    for n in (1, 92 * 36, 200 * 36, 16_384, ROWS_MAX):
        assert functions[0](n) == 8 * n**2 + 24 * n + 16
        assert functions[1](n, n // 3) == 9 * n**2 + 48 * (n + 1) + 3 * (n // 3) + functions[0](n)
    assert 3 * ROWS_MAX**2 < 2**31  # which the core keeps in int


@pytest.mark.parametrize("share", [0.2, 0.5, 0.9])
def test_capacity_is_the_largest_that_fits(share: float, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = int(library_tables(built()).system.closed_capacity)
    most = int(share * bytes_of(built(), whole))
    fitted = int(library_tables(in_memory(most, monkeypatch)).system.closed_capacity)
    assert 1 <= fitted < whole
    assert bytes_of(built(), fitted) <= most < bytes_of(built(), fitted + 1)


def test_capacity_changes_no_bit(monkeypatch: pytest.MonkeyPatch) -> None:
    free = run(built())
    closed = int((np.nan_to_num(free.force) > 0).sum(axis=1).max())
    for capacity in (2 * closed + 4, 3 * closed):
        narrow = run(in_memory(bytes_of(built(), capacity), monkeypatch))
        assert narrow.outcome is Outcome.DONE
        assert np.array_equal(narrow.p, free.p)
        assert np.array_equal(narrow.force, free.force, equal_nan=True)


def test_more_contacts_than_fit_end_the_run(monkeypatch: pytest.MonkeyPatch) -> None:
    path = run(in_memory(bytes_of(built(), 1), monkeypatch))
    assert path.outcome is Outcome.TOO_MANY_CLOSED
    assert not path.outcome.succeeded


def test_too_little_memory_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(
        SimulationError, match=r"needs .* GiB of memory.*it may take .* GiB.*list fewer pairs"
    ):
        run(in_memory(1000, monkeypatch))


def test_more_rows_than_the_core_can_number_never_fit() -> None:
    shared = library_tables(built())
    system = type(shared.system).from_buffer_copy(shared.system)
    system.closed_capacity = 2**31 - 1
    assert scratch_sizes(built().cdll, system) == (-1, -1)
    fit_scratch(built().cdll, system, shared.tables.dtype, 2**62)
    n = ROWS_MAX / 3
    assert n - 1 <= system.closed_capacity <= ROWS_MAX  # no friction rows beyond those of the scene
