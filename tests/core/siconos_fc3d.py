"""Siconos on problems with friction: an independent nonsmooth library, in a Python of its own.

Run as a program, `python siconos_fc3d.py IN OUT`, it solves a JSON list of {A, b, mu, z} and writes {z, w,
info, seconds, error, given}: Siconos's answer, how it ended, its own error of it, and its error of the
forces z that were given.
"""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from functools import cache
from pathlib import Path
from time import perf_counter
from typing import Any

TOLERANCE, SWEEPS = 1e-10, 5_000


@cache
def interpreter() -> str | None:
    """A Python that knows Siconos (Debian: python3-siconos), if there is one."""
    for name in ("/usr/bin/python3", shutil.which("python3"), sys.executable):
        if name and Path(name).exists():
            done = subprocess.run([name, "-c", "import siconos.numerics"], capture_output=True, check=False)
            if done.returncode == 0:
                return name
    return None


def siconos(records: list[dict[str, Any]], folder: Path) -> list[dict[str, Any]]:
    """What the program below answers to {A, b, mu, z} of lists."""
    source, target = folder / "problems.json", folder / "answers.json"
    source.write_text(json.dumps(records))
    command = [str(interpreter()), str(Path(__file__).resolve()), str(source), str(target)]
    subprocess.run(command, check=True, capture_output=True)
    answers: list[dict[str, Any]] = json.loads(target.read_text())
    return answers


def _answer(numerics: Any, np: Any, record: dict[str, Any]) -> dict[str, Any]:
    A, b, mu, given = (np.array(record[name]) for name in ("A", "b", "mu", "z"))
    problem = numerics.FrictionContactProblem(3, len(mu), A, b, mu)
    options = numerics.SolverOptions(numerics.SICONOS_FRICTION_3D_NSGS)
    options.dparam[numerics.SICONOS_DPARAM_TOL] = TOLERANCE
    options.iparam[numerics.SICONOS_IPARAM_MAX_ITER] = SWEEPS
    z, w = np.zeros(len(b)), np.zeros(len(b))
    begun = perf_counter()
    info = numerics.fc3d_driver(problem, z, w, options)
    seconds = perf_counter() - begun

    def error(forces: Any) -> float:
        size, moves = float(np.linalg.norm(b)), np.zeros(len(b))
        found = numerics.fc3d_compute_error(problem, forces, moves, TOLERANCE, options, size)
        return float(found[1] if isinstance(found, (tuple, list)) else found)

    answer = {"z": z.tolist(), "w": w.tolist(), "info": int(info), "seconds": seconds}
    return {**answer, "error": error(z), "given": error(given)}


def main() -> None:
    import numpy as np
    import siconos.numerics as numerics

    source, target = map(Path, sys.argv[1:])
    records = json.loads(source.read_text())
    target.write_text(json.dumps([_answer(numerics, np, record) for record in records]))


if __name__ == "__main__":
    main()
