"""200 runs with different starts, on one thread and on two: python -m tests.benchmarks.threads [--threads 2]

Prints for each scene the wall time on one thread over that on several, and the CPU time on several over that
on one, each the best of `--rounds` that alternate. Where other programs use the processors, the first figure
falls and the second does not. Where Linux tells how long threads waited for a processor, the share of the
wall time in which the threads ran or waited for one is printed too: it is 1 if none waits for another. On
free cores the first figure is the number of threads times the share over the second.
"""

from __future__ import annotations

import time
from argparse import ArgumentParser
from pathlib import Path

from modelgen.runtime.session_group import SessionGroup
from tests.running import scene_of

SCENES = {"ellipsoid_on_plane": 2.0, "cube_toss": 1.0, "gripper": 1.0}
LANES = 200
TASKS = Path("/proc/self/task")


def runnable() -> dict[str, float]:
    """Of each thread the time in which it ran or waited for a processor, s."""
    found = {}
    for task in TASKS.iterdir() if TASKS.exists() else ():
        ran, waited, _ = (task / "schedstat").read_text().split()
        found[task.name] = 1e-9 * (int(ran) + int(waited))
    return found


def measured(name: str, threads: int, calls: int) -> tuple[float, float, float]:
    """Wall and CPU time in s of all runs, and the share of the wall time in which threads were runnable."""
    group = SessionGroup(scene_of(name), n=LANES)
    n_q, n_u = (group.library.manifest.instance[key] for key in ("n_q", "n_u"))
    group.x[:, n_q : n_q + n_u] *= [[1 + 1e-3 * lane] for lane in range(LANES)]
    group.begin(threads)
    before, wall, cpu = runnable(), time.perf_counter(), time.process_time()
    for call in range(calls):
        group.advance(SCENES[name] * (call + 1) / calls, threads)
    assert (group.codes == 0).all()
    wall, cpu = time.perf_counter() - wall, time.process_time() - cpu
    spent = sorted((end - before.get(task, 0.0) for task, end in runnable().items()), reverse=True)
    return wall, cpu, sum(spent[:threads]) / (threads * wall)


def main() -> None:
    parser = ArgumentParser(description=__doc__)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--calls", type=int, default=100, help="in which each run is advanced")
    given = parser.parse_args()
    print(f"{LANES} runs, {given.calls} calls each; {given.threads} threads against 1")
    for name in SCENES:
        rounds = [[measured(name, n, given.calls) for n in (1, given.threads)] for _ in range(given.rounds)]
        one, many = (tuple(min(each[k][i] for each in rounds) for i in range(2)) for k in range(2))
        share = max(each[1][2] for each in rounds)
        print(
            f"{name:20s} wall {one[0]:.3f} s / {many[0]:.3f} s = {one[0] / many[0]:.2f}"
            f"   CPU {many[1]:.3f} s / {one[1]:.3f} s = {many[1] / one[1]:.2f}   runnable {share:.2f}"
            f"   on free cores {given.threads * share * one[1] / many[1]:.2f}",
            flush=True,
        )


if __name__ == "__main__":
    main()
