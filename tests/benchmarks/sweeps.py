"""1000 runs of a sweep, on one thread and on two: python -m tests.benchmarks.sweeps [--threads 2]

Prints for each scene the wall time on one thread over that on several, and the CPU time on several over that
on one, each the least of `--rounds` that alternate. Where other programs use the processors, the first figure
falls and the second does not. Where Linux tells how long threads waited for a processor, the share of the
wall time in which the threads ran or waited for one is printed too: it is 1 if none waits for another, as for
Python's lock. On free cores the first figure is the number of threads times the share over the second.
"""

from __future__ import annotations

import time
from argparse import ArgumentParser
from collections.abc import Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import get_ident

from modelgen import build, derive, emit, read, require
from modelgen.codegen.library import Library
from modelgen.parameter_study.chunk_runs import Chunk, Study, run_chunk
from modelgen.parameter_study.design import design_points, variations_of
from modelgen.parameter_study.local_threads import chunks_of_threads
from modelgen.parameter_study.run_queue import RunQueue, Span
from modelgen.parameter_study.varied_numbers import varied_numbers
from modelgen.scene.read import read_text
from tests.benchmarks.parameters import SCENES, text_of
from tests.running import SCENES as SHIPPED

OWN = Path("/proc/thread-self/schedstat")
CASES: Mapping[str, tuple[float, Mapping[str, str]]] = {  # end, s, and what varies
    "cube_toss": (0.74, {"cube.velocity_x": "-1:1", "cube.velocity_z": "0:1"}),
    "gripper": (1.0, {"egg.velocity_x": "-0.02:0.02", "egg.velocity_y": "-0.02:0.02"}),
    "ellipsoid_on_plane": (2.0, {"egg.velocity_x": "-1:1", "egg.angular_velocity_z": "0:9"}),
    "egg": (2.0, {"friction": "0.1:0.5", "restitution": "0.1:0.8"}),
}


def library_of(name: str, folder: Path) -> Library:
    if name in SCENES:
        scene = read_text(text_of(name, SCENES[name][1]), f"{name}.toml")
    else:
        scene = read(SHIPPED / f"{name}.toml")
    return build(emit(derive(require(scene))), folder=folder / name)


def measured(library: Library, name: str, runs: int, threads: int) -> tuple[float, float, float]:
    """Wall and CPU time of all runs, s, and the share of the wall time in which the threads were runnable."""
    until, vary = CASES[name]
    variations = variations_of(vary)
    _, values = design_points(variations, runs, "sobol", 0)
    study = Study(varied_numbers(library, variations, {}), until, None, {}, True, 0, {}, {})
    spent: dict[int, float] = {}

    def run(span: Span) -> Chunk:
        chunk = run_chunk(library, study, span.first, values[span.first : span.first + span.size])
        if OWN.exists():
            ran, waited, _ = OWN.read_text().split()
            spent[get_ident()] = 1e-9 * (int(ran) + int(waited))
        return chunk

    wall, cpu = time.perf_counter(), time.process_time()
    queue = RunQueue(runs, (), threads)
    rows = [row for chunk in chunks_of_threads(queue, run, threads) for row in chunk.rows]
    wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
    assert len(rows) == runs
    return wall, cpu, sum(spent.values()) / (threads * wall)


def main() -> None:
    parser = ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=1000)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--rounds", type=int, default=2)
    parser.add_argument("--scenes", nargs="*", default=list(CASES))
    given = parser.parse_args()
    print(f"{given.runs} runs; {given.threads} threads against 1")
    with TemporaryDirectory() as folder:
        for name in given.scenes:
            library = library_of(name, Path(folder))
            measured(library, name, 8, 1)
            counts = (1, given.threads)
            rounds = [[measured(library, name, given.runs, n) for n in counts] for _ in range(given.rounds)]
            one, many = (tuple(min(each[k][i] for each in rounds) for i in range(2)) for k in range(2))
            share = max(each[1][2] for each in rounds)
            print(
                f"{name:20s} {1e3 * one[1] / given.runs:6.2f} ms a run"
                f"   wall {one[0]:.2f} s / {many[0]:.2f} s = {one[0] / many[0]:.2f}"
                f"   CPU {many[1]:.2f} s / {one[1]:.2f} s = {many[1] / one[1]:.2f}   runnable {share:.2f}"
                f"   on free cores {given.threads * share * one[1] / many[1]:.2f}",
                flush=True,
            )


if __name__ == "__main__":
    main()
