"""A chunk of the runs of a sweep: run together, as rows of the table, and as files of whole runs if kept."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from operator import itemgetter
from threading import Lock
from typing import Any, NamedTuple

import numpy as np

from modelgen.codegen.library import Library
from modelgen.errors import ModelgenError, SimulationError
from modelgen.parameter_study.rows import Row, refused_row, row_of, varied_columns
from modelgen.parameter_study.varied_numbers import VariedNumber
from modelgen.report.run_files import run_bytes
from modelgen.report.run_record import record_of
from modelgen.runtime.accuracy import Accuracy
from modelgen.runtime.arguments import with_parameters
from modelgen.runtime.settings import accuracy_of
from modelgen.runtime.simulate import simulate
from modelgen.runtime.simulate_lanes import Ended, LaneRuns, run_lanes
from modelgen.runtime.tables.library_tables import library_tables
from modelgen.runtime.trajectory import Array
from modelgen.scene.scene_types import Scene

PYTHON_WORK = Lock()  # before and after runs: one thread at a time, while the core runs in the others


@dataclass(frozen=True)
class Study:
    """What the runs of a sweep have in common."""

    numbers: tuple[VariedNumber, ...]
    until: float  # s
    accuracy: Accuracy | str | None  # as given: the scene's own numbers of [run] are those of each run
    stepping: Mapping[str, Any]
    estimate: bool
    seed: int
    parameters: Mapping[str, float]  # that do not vary
    inputs: Mapping[str, float]
    keep: bool = False  # whole runs, as files
    scene: Scene | None = None  # which these hold


class Chunk(NamedTuple):
    """What came of some runs."""

    first: int  # run
    rows: list[Row]
    files: list[bytes | None]  # of whole runs; none where they are not kept, or a run could not start


def run_chunk(library: Library, study: Study, first: int, values: Array) -> Chunk:
    """Run some of the runs of a sweep, in this thread.

    Args:
        first: the number of the first run.
        values: (n, number of varied numbers).
    """
    with PYTHON_WORK:
        variants = [_variant(library, study, row) for row in values.tolist()]
    libraries = [each for each in variants if isinstance(each, Library)]
    going = [isinstance(each, Library) for each in variants]
    runs = _run(study, libraries, values[going]) if libraries else None
    instance, names = library.manifest.instance, varied_columns([each.name for each in study.numbers])
    with PYTHON_WORK:
        ended: Iterator[Ended] = iter(() if runs is None else runs.results())
        results = [next(ended) if isinstance(each, Library) else each for each in variants]
        rows = [
            {"run": first + k, "seed": study.seed, **dict(zip(names, row, strict=True))}
            | (refused_row(result) if isinstance(result, ModelgenError) else row_of(result, instance))
            for k, (result, row) in enumerate(zip(results, values.tolist(), strict=True))
        ]
    files = [
        _whole_run(variant, study, row)
        if study.keep and isinstance(variant, Library) and not isinstance(result, ModelgenError)
        else None
        for variant, result, row in zip(variants, results, values.tolist(), strict=True)
    ]
    return Chunk(first, rows, files)


def _variant(library: Library, study: Study, row: Sequence[float]) -> Library | ModelgenError:
    """The library with the numbers of a run, or why there is none."""
    own = {each.name: value for each, value in _of_kind(study, "parameter", row)}
    try:
        variant = with_parameters(library, {**study.parameters, **own})
        library_tables(variant)
    except ModelgenError as error:
        return error
    return variant


def _run(study: Study, libraries: Sequence[Library], values: Array) -> LaneRuns:
    """Runs with these libraries and values (n, number of varied numbers)."""
    columns = list(zip(study.numbers, values.T, strict=True))
    inputs = {name: np.full(len(values), value) for name, value in study.inputs.items()}
    inputs |= {each.name: column for each, column in columns if each.kind == "input"}
    return run_lanes(
        libraries,
        until=study.until,
        accuracies=_accuracies(study, libraries),
        estimate=study.estimate,
        inputs=inputs,
        starts={each.place: column for each, column in columns if each.kind == "start"},
    )


def _accuracies(study: Study, libraries: Sequence[Library]) -> list[Accuracy]:
    """The record of each run; one of runs in a row that have the same [run]."""
    found: list[Accuracy] = []
    for _, group in groupby((each.manifest.instance for each in libraries), key=itemgetter("run")):
        alike = list(group)
        found += [accuracy_of(alike[0], study.accuracy, study.stepping)] * len(alike)
    return found


def _of_kind(study: Study, kind: str, row: Sequence[float]) -> list[tuple[VariedNumber, float]]:
    return [(each, value) for each, value in zip(study.numbers, row, strict=True) if each.kind == kind]


def _whole_run(variant: Library, study: Study, row: Sequence[float]) -> bytes | None:
    """The file of the run, as `simulate` and `save` make it."""
    library = _started(variant, [(each.place, value) for each, value in _of_kind(study, "start", row)])
    inputs = {**study.inputs, **{each.name: value for each, value in _of_kind(study, "input", row)}}
    try:
        path = simulate(
            library,
            until=study.until,
            accuracy=study.accuracy,
            estimate=study.estimate,
            inputs=inputs,
            **study.stepping,
        )
    except SimulationError:
        return None
    with PYTHON_WORK:
        return run_bytes(record_of(path, library, study.scene))


def _started(library: Library, starts: Sequence[tuple[int, float]]) -> Library:
    """The library with other numbers in its start, by their place in the state."""
    if not starts:
        return library
    instance = library.manifest.instance
    state = [*instance["initial_q"], *instance["initial_u"]]
    for place, value in starts:
        state[place] = value
    n_q = instance["n_q"]
    return library.with_instance(instance | {"initial_q": state[:n_q], "initial_u": state[n_q:]})
