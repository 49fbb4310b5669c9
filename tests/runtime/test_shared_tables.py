"""Runs of one library share its tables: no run changes them, and no result depends on another run."""

from __future__ import annotations

import gc
from concurrent.futures import ThreadPoolExecutor
from dataclasses import fields
from weakref import ref

import numpy as np
import pytest

from modelgen import Accuracy, simulate
from modelgen.codegen.library import Library
from modelgen.runtime.core_session import Session
from modelgen.runtime.tables.library_tables import library_tables
from modelgen.runtime.trajectory import Trajectory
from tests.running import scene_of

SCENES = ("rolling_disc", "double_pendulum", "cube_toss", "block_on_incline", "linked_rings", "turntable")


def run(library: Library, accuracy: str = "fast") -> Trajectory:
    return simulate(library, until=0.1, samples=8, accuracy=accuracy, estimate=False)


def columns(path: Trajectory) -> dict[str, np.ndarray]:
    values = {field.name: getattr(path, field.name) for field in fields(path)}
    return {name: value for name, value in values.items() if isinstance(value, np.ndarray)}


def assert_same_run(a: Trajectory, b: Trajectory) -> None:
    assert a.events == b.events
    for name, column in columns(a).items():
        np.testing.assert_array_equal(column, columns(b)[name], err_msg=name)


@pytest.mark.parametrize("name", SCENES)
def test_a_run_changes_no_table(name: str) -> None:
    library = scene_of(name)
    shared = library_tables(library)
    settings = Session(library, Accuracy.fast()).settings
    before = [array.tobytes() for array in shared.arrays], bytes(shared.system), bytes(settings)
    run(library)
    assert before == ([array.tobytes() for array in shared.arrays], bytes(shared.system), bytes(settings))
    assert library_tables(library) is shared
    assert Session(library, Accuracy.fast()).settings is settings


@pytest.mark.parametrize("name", SCENES)
def test_a_result_shares_no_memory_with_that_of_another_run(name: str) -> None:
    library = scene_of(name)
    first, second = run(library), run(library)
    for name_a, a in columns(first).items():
        for name_b, b in columns(second).items():
            assert not np.may_share_memory(a, b), (name_a, name_b)


@pytest.mark.parametrize("name", SCENES)
def test_a_run_is_the_same_after_runs_of_other_settings(name: str) -> None:
    library = scene_of(name)
    first = run(library)
    run(library, "tight")
    assert_same_run(run(library), first)


@pytest.mark.parametrize("name", SCENES)
def test_runs_in_threads_are_the_same_as_one_by_one(name: str) -> None:
    scene = scene_of(name)
    alone = run(scene)
    library = Library(scene.manifest, scene.record, scene.path.parent)  # whose tables are not made yet
    with ThreadPoolExecutor(8) as pool:
        for path in pool.map(run, [library] * 16):
            assert_same_run(path, alone)


def test_the_tables_go_with_their_library() -> None:
    scene = scene_of("rolling_disc")
    library = Library(scene.manifest, scene.record, scene.path.parent)
    run(library)
    table = ref(library_tables(library).arrays[0])
    del library
    gc.collect()
    assert table() is None
