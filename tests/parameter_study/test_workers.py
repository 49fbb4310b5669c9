"""Chunks on the workers of a Dask scheduler: the table is that of threads, also where a worker is killed."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from modelgen import sweep
from modelgen.errors import ModelgenError
from modelgen.parameter_study import dask_workers, run_queue
from tests.parameter_study.scenes import ball

pytest.importorskip("pyarrow")
distributed = pytest.importorskip("distributed")

VARY = {"height": "0.02:0.3:4", "ball.velocity_x": "0.5:2"}
OPTIONS = ("--no-dashboard",)


def started(*words: str) -> subprocess.Popen[bytes]:
    command = [sys.executable, "-m", f"distributed.cli.dask_{words[0]}", *words[1:], *OPTIONS]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


@pytest.fixture
def processes(tmp_path: Path) -> Iterator[list[subprocess.Popen[bytes]]]:
    """A scheduler and two workers, in this order."""
    file = str(tmp_path / "scheduler.json")
    made = [started("scheduler", "--host", "127.0.0.1", "--port", "0", "--scheduler-file", file)]
    for _ in range(600):
        if os.path.exists(file) and os.path.getsize(file):
            break
        time.sleep(0.1)
    made += [started("worker", "--scheduler-file", file, "--nthreads", "1", "--no-nanny") for _ in range(2)]
    yield made
    for process in made:
        process.kill()
        process.wait()


def address(tmp_path: Path) -> str:
    with distributed.Client(scheduler_file=str(tmp_path / "scheduler.json"), set_as_default=False) as client:
        client.wait_for_workers(2, timeout=60)
        return str(client.scheduler.address)


@pytest.mark.slow
def test_a_killed_worker_changes_nothing(
    tmp_path: Path, processes: list[subprocess.Popen[bytes]], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(run_queue, "MOST", 8)
    killed = False

    def kill(share: float) -> None:
        nonlocal killed
        if share > 0.2 and not killed:
            killed = True
            processes[1].send_signal(signal.SIGKILL)

    there = address(tmp_path)
    sweep(ball(), VARY, samples=200, out=tmp_path / "a", scheduler=there, on_progress=kill)
    assert killed
    assert processes[1].wait() == -signal.SIGKILL
    sweep(ball(), VARY, samples=200, out=tmp_path / "b", threads=2)
    assert (tmp_path / "a" / "runs.parquet").read_bytes() == (tmp_path / "b" / "runs.parquet").read_bytes()


@pytest.mark.slow
def test_a_lost_scheduler_is_told_and_the_sweep_goes_on(
    tmp_path: Path, processes: list[subprocess.Popen[bytes]], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(run_queue, "MOST", 4)
    there = address(tmp_path)

    def kill(share: float) -> None:
        if share > 0.2:
            processes[0].kill()

    with pytest.raises(ModelgenError, match="the same command goes on"):
        sweep(ball(), VARY, samples=100, out=tmp_path / "a", scheduler=there, on_progress=kill)
    found = sweep(ball(), VARY, samples=100, out=tmp_path / "a", threads=2)
    assert 20 <= found.known < 100
    sweep(ball(), VARY, samples=100, out=tmp_path / "b", threads=2)
    assert (tmp_path / "a" / "runs.parquet").read_bytes() == (tmp_path / "b" / "runs.parquet").read_bytes()


def test_a_worker_builds_a_scene_once_and_runs_chunks_as_threads_do(monkeypatch: pytest.MonkeyPatch) -> None:
    """The function that workers run, in this process."""
    taken = []
    run = dask_workers.chunk_on_worker

    class Future:
        def __init__(self, *arguments: object) -> None:
            taken.append(arguments)
            self.made = run(*arguments)

        def result(self) -> object:
            return self.made

        def release(self) -> None:
            pass

    class Client:
        loop = None

        def nthreads(self) -> dict[str, int]:
            return {"tcp://one": 1}

        def submit(self, function: object, *arguments: object, pure: bool) -> Future:
            assert function is run
            return Future(*arguments)

        def close(self) -> None:
            pass

    class Flow(list[Future]):
        def __init__(self, futures: list[Future], loop: object) -> None:
            super().__init__(futures)

        def __iter__(self) -> Iterator[Future]:
            while self:
                yield self.pop(0)

        add = list.append

    monkeypatch.setattr(distributed, "as_completed", Flow)
    monkeypatch.setattr("modelgen.parameter_study.sweep.connected", lambda address: Client())
    there = sweep(ball(), VARY, samples=16, until=0.2, scheduler="tcp://one:1")
    here = sweep(ball(), VARY, samples=16, until=0.2, threads=1)
    assert dict(there.columns) == dict(here.columns)
    assert len(taken) > 1
    assert len(dask_workers._BUILT) == 1
