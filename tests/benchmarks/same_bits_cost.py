"""The price of the elementary functions of the core, beside another tree of this repository:

    python tests/benchmarks/same_bits_cost.py --against FOLDER [--scenes NAMES] [--pairs 20] [--out FILE]

Each scene is exported from both trees as C and run. Printed are the ratios of instructions, counted
by callgrind, and of CPU time (median of interleaved pairs), this tree over the other one, with the steps of
both runs. Programs that the folder of --keep holds from before are taken as they are.
"""

from __future__ import annotations

import argparse
import os
import re
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path

HERE = Path(__file__).resolve().parents[2]
FLAGS = ("-std=c99", "-O2", "-fno-math-errno", "-ffp-contract=off", "-march=x86-64-v2")
MAIN = """#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include "scene.h"
static scene_instance scene;
int main(int n, char **words) {
  const long times = n > 1 ? atol(words[1]) : 0;
  int code = 0;
  const clock_t before = clock();
  for (long k = 0; k < times; k++) {
    scene_init(&scene);
    code = scene_begin(&scene);
    if (!code) code = scene_advance(&scene, SCENE_UNTIL);
  }
  printf("%d %ld %.9f\\n", code, (long)scene.run.steps, (double)(clock() - before) / CLOCKS_PER_SEC);
  return 0;
}
"""


def write(names: Sequence[str], target: Path) -> None:
    """The C of scenes, each in a folder, by the package that Python finds."""
    from modelgen import build, derive, emit, read, require
    from modelgen.export.c_folder import program_files
    from modelgen.runtime.core_session import Session
    from modelgen.runtime.settings import accuracy_of

    for name in names:
        package = emit(derive(require(read(HERE / "scenes" / f"{name}.toml"))))
        library = build(package, level="O1", folder=target / "built" / name)
        session = Session(library, accuracy_of(library.manifest.instance, None, {}))
        folder = target / name
        folder.mkdir(parents=True)
        for file, text in program_files(session, package).items():
            (folder / file).write_text(text)
        (folder / "main.c").write_text(MAIN)


def programs(names: Sequence[str], target: Path, tree: Path) -> Mapping[str, Path]:
    new = [name for name in names if not (target / name / "main").exists()]
    environment = {**os.environ, "PYTHONPATH": str(tree)}
    words = [sys.executable, str(Path(__file__).resolve()), "--write", str(target), "--scenes", *new]
    if new:
        subprocess.run(words, check=True, env=environment, cwd=tree)
    core = target / "core.o"
    for name in new:
        if not core.exists():
            compiled = ["gcc", *FLAGS, "-c", "modelgen_runtime.c", "-o", str(core)]
            subprocess.run(compiled, cwd=target / name, check=True)
        linked = ["gcc", *FLAGS, "scene.c", "main.c", str(core), "-lm", "-o", "main"]
        subprocess.run(linked, cwd=target / name, check=True)
    return {name: target / name / "main" for name in names}


def counted(program: Path, times: int) -> int:
    tool = ["valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null"]
    done = subprocess.run([*tool, str(program), str(times)], capture_output=True, text=True, check=True)
    found = re.search(r"Collected : (\d+)", done.stderr)
    assert found, done.stderr
    return int(found[1])


def run(program: Path, times: int) -> tuple[int, int, float]:
    """Code, steps and CPU time, s."""
    done = subprocess.run([str(program), str(times)], capture_output=True, text=True, check=True)
    code, steps, time = done.stdout.split()
    return int(code), int(steps), float(time)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--against", type=Path)
    parser.add_argument("--write", type=Path)
    parser.add_argument("--scenes", nargs="*")
    parser.add_argument("--pairs", type=int, default=0)
    parser.add_argument("--out", type=Path)
    parser.add_argument("--keep", type=Path)
    given = parser.parse_args()
    if given.write:
        write(given.scenes, given.write)
        return
    from tests.registry import REGISTRY

    names, ratios = given.scenes or list(REGISTRY)[:30], []
    with tempfile.TemporaryDirectory(prefix="modelgen-") as scratch:
        folder = given.keep or scratch
        own = programs(names, Path(folder) / "own", HERE)
        other = programs(names, Path(folder) / "other", given.against)
        for name in names:
            (code, steps, _), (code_there, steps_there, _) = run(own[name], 1), run(other[name], 1)
            counts = [counted(each[name], 1) - counted(each[name], 0) for each in (own, other)]
            pairs = [run(own[name], 1)[2] / run(other[name], 1)[2] for _ in range(given.pairs)]
            ratios.append(counts[0] / counts[1])
            line = f"{name:24} {ratios[-1]:.3f} of {counts[1]:.3g} instructions, steps {steps} {steps_there}"
            line += f", codes {code} {code_there}"
            line += f", time {statistics.median(pairs):.3f}" if pairs else ""
            print(line, flush=True)
            if given.out:
                with given.out.open("a") as file:
                    file.write(line + "\n")
    print(f"median {statistics.median(ratios):.3f}, largest {max(ratios):.3f}")


if __name__ == "__main__":
    main()
