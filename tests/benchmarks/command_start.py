"""Start of the command, in turn with what it must import: `python -m tests.benchmarks.command_start`.

Each line: the least wall and CPU time of several processes, s. A scene that was run before is run again, with
nothing derived; the last line compiles nothing either, but derives the scene, which it does not know. Python
keeps its bytecode, as it does of an installed package, whatever PYTHONDONTWRITEBYTECODE says.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from resource import RUSAGE_CHILDREN, getrusage
from tempfile import TemporaryDirectory
from time import perf_counter

from modelgen.cli.built_library_lookup import NAME

SCENE = Path(__file__).parents[2] / "scenes" / "ellipsoid_on_plane.toml"
REPEATS = 9
COMMAND = (
    "from modelgen.cli import main; import sys; sys.argv = ['modelgen', 'simulate', sys.argv[1]]; main()"
)
CODES = {
    "python": "",
    "numpy": "import numpy",
    "numpy, casadi": "import casadi",
    "numpy, click": "import numpy, click",
    "modelgen simulate, known": COMMAND,
    "modelgen simulate, not known": COMMAND,
}


def spent(code: str, folder: Path) -> tuple[float, float]:
    """Wall and CPU time of one process, s."""
    own = {
        "PYTHONPATH": str(SCENE.parents[1]),
        "PYTHONPYCACHEPREFIX": str(folder / "bytecode"),
        "PYTHONDONTWRITEBYTECODE": "",
    }
    before, begun = getrusage(RUSAGE_CHILDREN), perf_counter()
    subprocess.run(
        [sys.executable, "-c", code, str(SCENE)],
        cwd=folder,
        check=True,
        capture_output=True,
        env=os.environ | own,
    )
    wall, after = perf_counter() - begun, getrusage(RUSAGE_CHILDREN)
    return wall, after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def main() -> None:
    with TemporaryDirectory() as name:
        folder = Path(name)
        known = folder / "generated" / SCENE.stem / NAME
        spent(COMMAND, folder)
        found: dict[str, list[tuple[float, float]]] = {each: [] for each in CODES}
        for _ in range(REPEATS):
            for each, code in CODES.items():
                if each.endswith("not known"):
                    known.unlink()
                found[each].append(spent(code, folder))
    for each, times in found.items():
        wall, cpu = (min(column) for column in zip(*times, strict=True))
        print(f"{each}: wall {wall:.2f}, CPU {cpu:.2f}")


if __name__ == "__main__":
    main()
