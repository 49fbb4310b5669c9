"""Instructions of a step of 1 ms: `python -m tests.benchmarks.small_steps [--keep FOLDER]`.

Of a pendulum on one hinge, and of a ball that rests or rolls on a plane with friction, at `fast`. The caller
advances the run by 1 ms at a time, event-driven and by time-stepping with steps of 1 ms, or takes all
time-steps in one call. Each is compiled as a library is, for Haswell, and as the README of exported C says.
Callgrind counts within the calls that advance the run. `--keep` leaves the programs in a folder.
"""

from __future__ import annotations

import argparse
import subprocess
from contextlib import nullcontext
from pathlib import Path
from tempfile import TemporaryDirectory

from modelgen import build, derive, emit, require
from modelgen.benchmark.callgrind_counts import counted
from modelgen.codegen.amalgamation import SOURCE
from modelgen.codegen.compiler import FLAGS as LIBRARY_FLAGS
from modelgen.codegen.compiler import LEVEL, NATIVE, QUICK_GCC
from modelgen.export.c_folder import program_files
from modelgen.export.memory_footprint import FLAGS as EXPORT_FLAGS
from modelgen.runtime.accuracy import Accuracy
from modelgen.runtime.core_session import Session
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Body, Scene
from tests.benchmarks.counting import COUNTED_CPU

STEP, STEPS = 0.001, 1000  # s; steps of each count
MAIN = f"""#include <stdlib.h>
#include "scene.h"
static scene_instance scene;
int main(int n, char **words) {{
  const long calls = atol(words[1]);
  (void)n;
  scene_init(&scene);
  int code = scene_begin(&scene);
  for (long k = 1; k <= calls && !code; k++) code = scene_advance(&scene, k * ({STEPS} / calls) * {STEP});
  return code;
}}
"""
FLAGS = {
    "library": (
        f"-{LEVEL}",
        *LIBRARY_FLAGS,
        *QUICK_GCC,
        *(COUNTED_CPU if flag == "-march=native" else flag for flag in NATIVE),
    ),
    "exported C": EXPORT_FLAGS,
}
METHODS = {
    "event-driven, a call a step": (Accuracy.fast(), STEPS),
    "time-stepping, a call a step": (Accuracy.fast().time_stepping(STEP), STEPS),
    "time-stepping, one call": (Accuracy.fast().time_stepping(STEP), 1),
}


def hinge() -> Scene:
    rod = make.dynamic("rod", mass=1.0, inertia=[0.0008, 0.0838, 0.0834], position=[0.5, 0.0, 0.0])
    turned = [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]
    joint = {"name": "hinge", "kind": "revolute", "between": ["world", "rod"], "rotation": turned}
    return make.scene("hinge", [rod], joint=[joint])


def ball(speed: float) -> Body:
    return make.dynamic(
        "ball",
        make.sphere(0.1),
        mass=1.0,
        inertia=[0.004, 0.004, 0.004],
        position=[0.0, 0.0, 0.1],
        velocity=[speed, 0.0, 0.0],
        angular_velocity=[0.0, speed / 0.1, 0.0],
    )


def on_plane(name: str, body: Body) -> Scene:
    contact = {"between": ["ball", "table"], "friction": 0.5}
    return make.scene(name, [make.fixed("table", make.plane()), body], contact=[contact])


SCENES = {
    "pendulum on a hinge": hinge(),
    "ball at rest": on_plane("ball_at_rest", ball(0.0)),
    "ball that rolls": on_plane("ball_that_rolls", ball(1.0)),
}


def write(scene: Scene, accuracy: Accuracy, folder: Path) -> None:
    """The exported C of a scene, with MAIN."""
    package = emit(derive(require(scene)))
    library = build(package, level="O1")
    folder.mkdir(parents=True)
    for name, text in {**program_files(Session(library, accuracy), package), "main.c": MAIN}.items():
        (folder / name).write_text(text)


def compiled(folder: Path, flags: tuple[str, ...], core: Path) -> Path:
    """The program in a folder, with the core, which is compiled by the first of those that share it."""
    if not core.exists():
        subprocess.run(["gcc", *flags, "-c", SOURCE, "-o", core], cwd=folder, check=True)
    target = folder / core.with_suffix("").name
    command = ["gcc", *flags, "scene.c", "main.c", str(core), "-lm", "-o", str(target)]
    subprocess.run(command, cwd=folder, check=True)
    return target


def step_instructions(program: Path, calls: int) -> float:
    """Instructions of a step of a program."""
    found = counted([str(program), str(calls)], "scene_advance")
    assert found is not None, program
    return found / STEPS


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--keep", type=Path)
    keep = parser.parse_args().keep
    print(f"| scene | compiled as | {' | '.join(METHODS)} |\n{'| --- ' * (2 + len(METHODS))}|")
    with nullcontext(keep) if keep else TemporaryDirectory() as text:
        for name, scene in SCENES.items():
            folders = [Path(text) / f"{scene.name}_{k}" for k in range(len(METHODS))]
            for folder, (accuracy, _) in zip(folders, METHODS.values(), strict=True):
                write(scene, accuracy, folder)
            for kind, flags in FLAGS.items():
                core = Path(text) / f"{kind.replace(' ', '_')}.o"
                programs = [compiled(folder, flags, core) for folder in folders]
                calls = [calls for _, calls in METHODS.values()]
                cells = map(step_instructions, programs, calls)
                print(f"| {name} | {kind} | {' | '.join(f'{each:,.0f}' for each in cells)} |", flush=True)


if __name__ == "__main__":
    main()
