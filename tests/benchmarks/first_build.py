"""What a new scene costs before it runs: `python -m tests.benchmarks.first_build [SCENE ...]`.

Of each shipped scene, compiled for the first time while the compiled core is present: CPU seconds of
the C compiler, and the wall time of `modelgen simulate` with its parts, each scene in a process of its own.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import Any

SCENES = Path(__file__).parents[2] / "scenes"
CORE_S, SCENE_S, MEDIAN_S, WALL_S = 10.0, 0.6, 0.3, 2.5  # budgets on a quiet machine
PARTS = ("import", "symbols", "C text", "compiler", "run")

STAGES = """
import json, resource, sys, time
began = time.perf_counter()
import modelgen
import modelgen.cli
from modelgen.cli import pipeline
imported = time.perf_counter()
scene = modelgen.read(sys.argv[1])
derivation = modelgen.derive(modelgen.require(scene))
derived = time.perf_counter()
package = modelgen.emit(derivation)
emitted = time.perf_counter()
library = modelgen.build(package, folder="built")
built = time.perf_counter()
spent = resource.getrusage(resource.RUSAGE_CHILDREN)
modelgen.simulate(library)
ended = time.perf_counter()
times = [began, imported, derived, emitted, built, ended]
parts = [end - begin for begin, end in zip(times, times[1:])]
print(json.dumps({"parts": parts, "cpu": spent.ru_utime + spent.ru_stime}))
"""


def in_new_process(command: list[str], cache: Path) -> str:
    with TemporaryDirectory() as folder:
        environment = {**os.environ, "MODELGEN_CACHE": str(cache), "PYTHONPATH": str(SCENES.parent)}
        done = subprocess.run(
            command, cwd=folder, env=environment, check=True, stdout=subprocess.PIPE, text=True
        )
    return done.stdout


def stages(scene: Path, cache: Path) -> dict[str, Any]:
    """Wall seconds of the parts, CPU seconds of the compiler."""
    found: dict[str, Any] = json.loads(in_new_process([sys.executable, "-c", STAGES, str(scene)], cache))
    return found


def whole(scene: Path, cache: Path) -> float:
    """Wall seconds of the command line's `simulate`."""
    began = perf_counter()
    command = "from modelgen.cli import main; main()"
    in_new_process([sys.executable, "-c", command, "simulate", str(scene), "--no-estimate"], cache)
    return perf_counter() - began


def main() -> None:
    chosen = sys.argv[1:] or [path.stem for path in sorted(SCENES.glob("*.toml"))]
    with TemporaryDirectory() as name:
        cache = Path(name)
        first = stages(SCENES / f"{chosen[0]}.toml", cache)
        core = first["cpu"] - stages(SCENES / f"{chosen[0]}.toml", cache)["cpu"]
        print(f"core: {core:.1f} s of CPU (budget {CORE_S:g})")
        print(f"{'scene':28}{'compiler CPU':>13}{'simulate':>10}  parts, s wall: {', '.join(PARTS)}")
        cpu, walls = [], []
        for scene in chosen:
            found = stages(SCENES / f"{scene}.toml", cache)
            cpu.append(found["cpu"])
            walls.append(whole(SCENES / f"{scene}.toml", cache))
            parts = "  ".join(f"{part:.2f}" for part in found["parts"])
            print(f"{scene:28}{cpu[-1]:13.2f}{walls[-1]:10.2f}  {parts}", flush=True)
    over = [scene for scene, spent in zip(chosen, cpu, strict=True) if spent > SCENE_S]
    print(f"compiler CPU: median {median(cpu):.2f} s (budget {MEDIAN_S:g}), over {SCENE_S:g} s: {over}")
    print(f"simulate: median {median(walls):.2f} s, largest {max(walls):.2f} s (budget {WALL_S:g})")


if __name__ == "__main__":
    main()
