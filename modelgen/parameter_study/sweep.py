"""A sweep: the runs of a design, in threads or on the workers of a scheduler, kept as they come."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import asdict
from pathlib import Path
from typing import Any, Unpack

from modelgen import __version__
from modelgen.codegen.library import Library
from modelgen.codegen.manifest_repeated_pairs import without_repeats
from modelgen.errors import ModelgenError, expect, path_of
from modelgen.name_suggestions import nearest
from modelgen.parameter_study.chunk_runs import Chunk, Study, run_chunk
from modelgen.parameter_study.dask_workers import chunks_of_workers, connected, worker_threads
from modelgen.parameter_study.design import Variation, design_points, variations_of
from modelgen.parameter_study.local_threads import chunks_of_threads
from modelgen.parameter_study.outcome_table import Sweep, table_of
from modelgen.parameter_study.rows import Row, columns_of, sensor_columns, varied_columns
from modelgen.parameter_study.run_queue import RunQueue, Span
from modelgen.parameter_study.sweep_folder import SweepFolder
from modelgen.parameter_study.varied_numbers import varied_numbers
from modelgen.runtime.accuracy import Accuracy
from modelgen.runtime.arguments import (
    check_flag,
    check_function,
    check_keywords,
    check_span,
    names_in,
    values_by_name,
    with_parameters,
)
from modelgen.runtime.core_session import Session
from modelgen.runtime.inputs import Inputs
from modelgen.runtime.settings import STEPPING, Stepping, accuracy_of
from modelgen.runtime.trajectory import Array
from modelgen.scene.scene_types import Scene

KEPT = ("trajectories",)  # what `keep` may name
FORMAT = 1  # of the folder
KEYWORDS = (
    *("vary", "samples", "design", "seed", "until", "accuracy", "estimate", "parameters", "inputs"),
    *("threads", "scheduler", "out", "keep", "scene", "on_progress", *STEPPING),
)


def sweep(
    library: Library,
    vary: Mapping[str, str | Sequence[float]],
    *,
    samples: int | None = None,
    design: str | None = None,
    seed: int = 0,
    until: float | None = None,
    accuracy: Accuracy | str | None = None,
    estimate: bool | None = None,
    parameters: Mapping[str, float] | None = None,
    inputs: Mapping[str, float] | None = None,
    threads: int | None = None,
    scheduler: str | None = None,
    out: str | Path | None = None,
    keep: Sequence[str] = (),
    scene: Scene | None = None,
    on_progress: Callable[[float], None] | None = None,
    **stepping: Unpack[Stepping],
) -> Sweep:
    """Run a scene many times with other numbers.

    Args:
        library: what `build` returned.
        vary: by name of a parameter, of an input, or of a component of a start such as "ball.velocity_x":
            "0:1:11" (11 values), "0:1" (any value between), "1e3:1e6:4:log", "0.1,0.5", or a sequence.
        samples: number of runs that are drawn; None: all combinations of the values.
        design: "grid", "sobol", "latin" or "random"; a grid, or sobol where samples are given, when None.
        seed: of the draws.
        until, accuracy, estimate, stepping: as those of `simulate`.
        parameters, inputs: values that do not vary.
        threads: in which the runs go; as many as there are processors when None.
        scheduler: the address of a Dask scheduler, tcp://.., on whose workers they go instead.
        out: a folder for the table, in which the same call goes on after an interruption.
        keep: ("trajectories",) keeps each whole run in the folder too.
        scene: what `read` returned, kept with whole runs so that their bodies can be drawn.
        on_progress: called with the share of the runs that are done.

    Returns:
        The table: numbers, outcome, final state, sensors, events, estimated error, energy, cost of each run.
        A run that cannot start, or fails, is a row too, with its numbers and the reason.

    Raises:
        ModelgenError: an argument is not what it says, the folder holds another sweep, or pyarrow or
            distributed is missing.
    """
    expect("sweep", library, Library)
    check_keywords("sweep", stepping, KEYWORDS)
    check_flag("estimate", estimate)
    check_function("on_progress", on_progress)
    parameters, inputs = values_by_name("parameters", parameters), values_by_name("inputs", inputs)
    variations = variations_of(vary)
    kind, values = design_points(variations, samples, design, _checked_seed(seed))
    fixed = {**parameters, **inputs}
    instance = with_parameters(library, parameters).manifest.instance
    chosen = accuracy_of(instance, accuracy, stepping)
    Inputs(Session(library, chosen)).update(inputs)
    study = Study(
        numbers=varied_numbers(library, variations, fixed),
        until=float(_checked_until(instance["run"]["until"] if until is None else until)),
        accuracy=accuracy,
        stepping=dict(stepping),
        estimate=bool(instance["run"].get("estimate", True) if estimate is None else estimate),
        seed=seed,
        parameters=dict(parameters),
        inputs=dict(inputs),
        keep=_checked_keep(keep, out),
        scene=scene,
    )
    plan = _plan(
        library, study, chosen, variations, {"design": kind, "samples": samples, "seed": seed}, values
    )
    folder = None if out is None else SweepFolder(path_of("sweep", out))
    client = None if scheduler is None else connected(scheduler)
    workers = _checked_threads(threads) if client is None else worker_threads(client)
    try:
        with nullcontext() if folder is None else folder.held(plan):
            done = [] if folder is None else folder.done()
            queue = RunQueue(len(values), done, workers)
            if client is None:
                chunks = chunks_of_threads(queue, _runner(library, study, values), workers)
            else:
                chunks = chunks_of_workers(client, queue, library, study, values)
            known = sum(span.size for span in done)
            return _collected(plan, chunks, known, folder, on_progress)
    finally:
        if client is not None:
            client.close()


def _runner(library: Library, study: Study, values: Array) -> Callable[[Span], Chunk]:
    def run(span: Span) -> Chunk:
        return run_chunk(library, study, span.first, values[span.first : span.first + span.size])

    return run


def _collected(
    plan: Mapping[str, Any],
    chunks: Iterator[Chunk],
    known: int,
    folder: SweepFolder | None,
    on_progress: Callable[[float], None] | None,
) -> Sweep:
    """The table of all chunks, each kept as it comes."""
    rows: list[Row] = []
    count = known
    for chunk in chunks:
        if folder is None:
            rows += chunk.rows
        else:
            folder.put(*chunk)
        count += len(chunk.rows)
        if on_progress is not None:
            on_progress(count / plan["runs"])
    if folder is not None:
        folder.finish()
        return table_of(plan, folder.table(), folder.path, known)
    rows.sort(key=lambda row: int(row["run"]))
    return table_of(plan, {name: [row.get(name) for row in rows] for name in plan["columns"]}, None)


def _plan(
    library: Library,
    study: Study,
    accuracy: Accuracy,
    variations: Sequence[Variation],
    design: Mapping[str, Any],
    values: Array,
) -> dict[str, Any]:
    """All that decides the table, as JSON."""
    instance = library.manifest.instance
    names = [each.name for each in study.numbers]
    whole = without_repeats(instance)
    own = {key: value for key, value in whole.items() if key not in ("run", "source")}
    return {
        "format": FORMAT,
        "scene": instance["name"],
        "scene_content": _hash(own),
        "program": f"modelgen {__version__}, {library.record.source}, {library.real}",
        "vary": {each.name: each.text for each in variations},
        "design": dict(design),
        "values": hashlib.sha256(values.astype("<f8").tobytes()).hexdigest(),
        "settings": {
            "until": study.until,
            **asdict(accuracy),
            "estimate": study.estimate,
            "parameters": dict(study.parameters),
            "inputs": dict(study.inputs),
        },
        "keep": list(KEPT) if study.keep else [],
        "runs": len(values),
        "varied": varied_columns(names),
        "sensors": sensor_columns(instance),
        "columns": columns_of(instance, names),
    }


def _hash(value: Any) -> str:
    return hashlib.sha256(json.dumps(value, sort_keys=True).encode()).hexdigest()


def _checked_seed(seed: object) -> int:
    if isinstance(seed, bool) or not isinstance(seed, int) or not 0 <= seed < 2**31:
        raise ModelgenError("seed", repr(seed), "a whole number from 0 on", "")
    return seed


def _checked_until(until: object) -> Any:
    check_span("until", until, "give the end of the runs")
    return until


def _checked_threads(threads: object) -> int:
    if threads is None:
        return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    if isinstance(threads, bool) or not isinstance(threads, int) or threads < 1:
        raise ModelgenError("threads", repr(threads), "a whole number, at least 1", "")
    return threads


def _checked_keep(keep: Sequence[str], out: object) -> bool:
    names = names_in("keep", [keep] if isinstance(keep, str) else keep)
    for name in names:
        if name not in KEPT:
            raise ModelgenError("keep", repr(name), f"{', '.join(KEPT)} are allowed", nearest(name, KEPT))
    if names and out is None:
        raise ModelgenError("keep", "no folder to keep them in", "", "name one with out")
    return bool(names)
