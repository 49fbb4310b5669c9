"""200 runs with different starts, on one thread and on two: python -m tests.benchmarks.threads [--threads 2]

Prints for each scene the wall time on one thread over that on several, and the CPU time on several over that
on one, each the best of `--rounds` that alternate. Where other programs use the processors, the first figure
falls and the second does not. On free cores the first is the number of threads over the second.
"""

from __future__ import annotations

import time
from argparse import ArgumentParser

from modelgen.runtime.session_group import SessionGroup
from tests.running import scene_of

SCENES = {"ellipsoid_on_plane": 2.0, "cube_toss": 1.0, "gripper": 1.0}
LANES = 200
CALLS = 100  # in which each run is advanced


def measured(name: str, threads: int) -> tuple[float, float]:
    """Wall and CPU time in s of all runs, from their start."""
    group = SessionGroup(scene_of(name), n=LANES)
    n_q, n_u = (group.library.manifest.instance[key] for key in ("n_q", "n_u"))
    group.x[:, n_q : n_q + n_u] *= [[1 + 1e-3 * lane] for lane in range(LANES)]
    wall, cpu = time.perf_counter(), time.process_time()
    group.begin(threads)
    for call in range(CALLS):
        group.advance(SCENES[name] * (call + 1) / CALLS, threads)
    assert (group.codes == 0).all()
    return time.perf_counter() - wall, time.process_time() - cpu


def main() -> None:
    parser = ArgumentParser(description=__doc__)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--rounds", type=int, default=5)
    given = parser.parse_args()
    print(f"{LANES} runs, {CALLS} calls each; {given.threads} threads against 1")
    for name in SCENES:
        rounds = [(measured(name, 1), measured(name, given.threads)) for _ in range(given.rounds)]
        one, many = (tuple(min(each[k][i] for each in rounds) for i in range(2)) for k in range(2))
        print(
            f"{name:20s} wall {one[0]:.3f} s / {many[0]:.3f} s = {one[0] / many[0]:.2f}"
            f"   CPU {many[1]:.3f} s / {one[1]:.3f} s = {many[1] / one[1]:.2f}"
        )


if __name__ == "__main__":
    main()
