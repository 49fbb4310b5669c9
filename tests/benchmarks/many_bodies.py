"""What many bodies cost from the scene file to their first step.

Run with `python -m tests.benchmarks.many_bodies [COUNT ..]`, 100, 500 and 2000 by default: bodies of six
shapes over a floor, with friction, by time-stepping. Each count is run twice, each in a process of its own,
so that the kinds are compiled the second time. Told are CPU time beyond imports, by stage, and the largest
memory.
"""

from __future__ import annotations

import json
import resource
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time
from typing import Any

import numpy as np

STAGES = ("read", "require", "derive", "emit", "build", "tables", "begin", "first step")
COUNTS = ("100", "500", "2000")
SPACING = 0.16  # m
FLOOR = 'motion = "fixed"\n[[body.shape]]\nkind = "plane"\n'
SHAPES = (
    'kind = "sphere"\nradius = 0.05',
    'kind = "ellipsoid"\nsemi_axes = [0.06, 0.05, 0.04]',
    'kind = "box"\nsize = [0.1, 0.09, 0.08]',
    'kind = "capsule"\nradius = 0.04\nlength = 0.04',
    'kind = "cylinder"\nradius = 0.04\nlength = 0.09',
    'kind = "frustum"\nradius_bottom = 0.05\nradius_top = 0.03\nlength = 0.08',
)


def scene_text(count: int) -> str:
    """Bodies on a grid over a floor."""
    width = max(int(np.ceil((count / 2) ** (1 / 3))), 1)
    text = f'[[body]]\nname = "floor"\n{FLOOR}'
    for k in range(count):
        x, y, z = k % width, k // width % width, k // width**2
        place = f"[{x * SPACING:.4f}, {y * SPACING:.4f}, {z * SPACING + 0.12:.4f}]"
        text += f'[[body]]\nname = "body{k}"\nmotion = "dynamic"\ndensity = 1000.0\nposition = {place}\n'
        text += f"[[body.shape]]\n{SHAPES[k % len(SHAPES)]}\n"
    return text + '[contacts]\nbetween = "all"\nfriction = 0.5\n'


def measured(path: Path) -> dict[str, Any]:
    """CPU time of each stage, s, and the largest memory, bytes, of this process."""
    from modelgen import build, derive, emit, read, require
    from modelgen.runtime.core_session import Session
    from modelgen.runtime.recording import Recording
    from modelgen.runtime.settings import accuracy_of
    from modelgen.runtime.start import begin
    from modelgen.runtime.tables.library_tables import library_tables

    times: list[float] = []

    def timed(stage: Callable[[], Any]) -> Any:
        before = process_time()
        made = stage()
        times.append(process_time() - before)
        return made

    scene = timed(lambda: read(path))
    model = timed(lambda: require(scene))
    derivation = timed(lambda: derive(model))
    package = timed(lambda: emit(derivation))
    library = timed(lambda: build(package, folder=path.parent / "built"))
    timed(lambda: library_tables(library))
    session = Session(library, accuracy_of(library.manifest.instance, "coarse", {}))
    timed(lambda: begin(session))
    recording = Recording(session, np.array([1.0]))
    timed(lambda: session.advance(1.0, 1, recording.record))
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
    return {"times": times, "memory": memory, "pairs": int(session.system.n_pair)}


def main() -> None:
    if sys.argv[1:2] == ["--measure"]:
        print(json.dumps(measured(Path(sys.argv[2]))))
        return
    counts = [int(word) for word in sys.argv[1:] or COUNTS]
    print(
        "bodies  "
        + "".join(f"{stage:>11}" for stage in STAGES)
        + "   all (s)   memory (MB)   pairs with entries"
    )
    with TemporaryDirectory() as folder:
        for count in counts:
            path = Path(folder) / f"bodies_{count}.toml"
            path.write_text(scene_text(count))
            command = [sys.executable, "-m", "tests.benchmarks.many_bodies", "--measure", str(path)]
            for _ in range(2):
                done = subprocess.run(command, capture_output=True, text=True, check=True)
            found = json.loads(done.stdout.splitlines()[-1])
            row = "".join(f"{each:11.2f}" for each in found["times"])
            total, memory = sum(found["times"]), found["memory"] / 1e6
            print(f"{count:6d}  {row} {total:9.2f} {memory:13.0f} {found['pairs']:20d}", flush=True)


if __name__ == "__main__":
    main()
