"""The runs of a sweep on the workers of a Dask scheduler (extra `dask`).

A worker gets the text of a scene and compiles it once. Chunks are pure functions of their numbers: one whose
worker dies is run again on another.
"""

from __future__ import annotations

import hashlib
import pickle
import tempfile
import time
from atexit import register
from collections.abc import Iterator
from pathlib import Path
from shutil import rmtree
from threading import Lock
from typing import Any

from modelgen.codegen.build import build
from modelgen.codegen.emit import Package
from modelgen.codegen.library import Library
from modelgen.errors import ModelgenError, install
from modelgen.parameter_study.chunk_runs import Chunk, Study, run_chunk
from modelgen.parameter_study.run_queue import RunQueue, Span
from modelgen.runtime.arguments import shown
from modelgen.runtime.trajectory import Array

ANSWER_S = 10.0  # time in which a scheduler must answer, and have a worker
AHEAD = 2  # chunks that each thread of a worker is given at a time
_BUILT: dict[str, Library] = {}  # of this process, by the hash of what it was given
_BUILDING = Lock()


def require_distributed() -> Any:
    """The module distributed, or an error that names the extra."""
    try:
        import distributed
    except ImportError:
        raise ModelgenError("scheduler", "no package 'distributed'", "", install("dask")) from None
    return distributed


def connected(address: object) -> Any:
    """A client of a scheduler; raises ModelgenError where it does not answer, or has no workers."""
    if not isinstance(address, str):
        remedy = "give the address of a Dask scheduler"
        raise ModelgenError("scheduler", shown(address), "a text, tcp://HOST:PORT", remedy)
    distributed = require_distributed()
    try:
        distributed.comm.addressing.parse_host_port(address)  # a client that is refused it cannot be closed
        client = distributed.Client(address, timeout=ANSWER_S, set_as_default=False)
    except (OSError, ValueError, TimeoutError) as error:
        remedy = "start one with: dask scheduler, and workers with: dask worker tcp://HOST:8786"
        raise ModelgenError(
            "scheduler", f"{address!r} does not answer: {error}", "tcp://HOST:PORT", remedy
        ) from None
    try:
        client.wait_for_workers(1, timeout=ANSWER_S)
    except TimeoutError:
        client.close()
        found = f"{address!r} has no workers"
        raise ModelgenError("scheduler", found, "", f"start some: dask worker {address}") from None
    return client


def worker_threads(client: Any) -> int:
    """How many chunks the workers of a client run at a time."""
    return max(1, sum(map(int, client.nthreads().values())))


def chunks_of_workers(
    client: Any, queue: RunQueue, library: Library, study: Study, values: Array
) -> Iterator[Chunk]:
    """The chunks of the queued runs, as they come from the workers; raises ModelgenError where workers fail
    again and again, or the scheduler is lost."""
    distributed = require_distributed()
    payload = pickle.dumps((_package(library), library.real, study))
    ahead = AHEAD * worker_threads(client)
    spans: dict[Any, Span] = {}
    try:
        flow = distributed.as_completed([], loop=client.loop)
        _hand_out(client, queue, payload, values, spans, flow, ahead)
        for future in flow:
            span = spans.pop(future)
            chunk, seconds = future.result()
            queue.note(span.size, seconds)
            yield chunk
            _hand_out(client, queue, payload, values, spans, flow, ahead)
    except distributed.KilledWorker as error:
        found = f"workers died while they ran: {error}"
        raise ModelgenError("scheduler", found, "", "look at their logs; the same command goes on") from None
    except (distributed.CancelledError, distributed.comm.CommClosedError, OSError) as error:
        found = f"the scheduler was lost: {type(error).__name__} {error}"
        raise ModelgenError("scheduler", found, "", "start it again; the same command goes on") from None
    finally:
        queue.stop()
        for future in spans:
            future.release()


def _hand_out(
    client: Any,
    queue: RunQueue,
    payload: bytes,
    values: Array,
    spans: dict[Any, Span],
    flow: Any,
    ahead: int,
) -> None:
    """Give workers chunks until they have `ahead`."""
    while len(spans) < ahead and (span := queue.take()) is not None:
        part = values[span.first : span.first + span.size]
        future = client.submit(chunk_on_worker, payload, span.first, part, pure=False)
        spans[future] = span
        flow.add(future)


def chunk_on_worker(payload: bytes, first: int, values: Array) -> tuple[Chunk, float]:
    """What a worker does: a chunk, and the time that it took, s."""
    package, real, study = pickle.loads(payload)
    library = _library(hashlib.sha256(payload).hexdigest(), package, real)
    begun = time.perf_counter()
    chunk = run_chunk(library, study, first, values)
    return chunk, time.perf_counter() - begun


def _library(key: str, package: Package, real: str) -> Library:
    """The library of a package in this process, built at the first call."""
    with _BUILDING:
        if key not in _BUILT:
            folder = Path(tempfile.mkdtemp(prefix="modelgen-worker-"))
            register(rmtree, folder, ignore_errors=True)
            _BUILT[key] = build(package, real=real, folder=folder)
        return _BUILT[key]


def _package(library: Library) -> Package:
    """The text of a library, as its folder has it."""
    folder = library.path.parent
    files = {path.name: path.read_text(encoding="utf-8") for path in sorted(folder.glob("*.[ch]"))}
    return Package(library.manifest.name, files, library.manifest)
