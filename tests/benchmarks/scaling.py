"""Bodies in a bowl, 10, 40 and 160 of them: text, build time, and time per contact.

Run with `python -m tests.benchmarks.scaling`. Every body touches the bowl; neighbours are watched as well.
The kernels' time is that of a right-hand side without forces; with all bodies on the bowl, each an island of
its own, assembly and forces come on top. Instructions are counted by callgrind where valgrind is installed:
unlike times they do not know the size of the caches. The solver grows with the cube of an island, so it is
listed apart.
"""

from __future__ import annotations

import ctypes
import shutil
from itertools import pairwise
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from time import perf_counter

import numpy as np

from modelgen import Accuracy, build, derive, emit, require
from modelgen.codegen.library import Library
from modelgen.runtime.core_session import Session
from modelgen.runtime.start import begin
from modelgen.runtime.tables.ctypes_structures import address
from modelgen.scene import python_scenes as make
from modelgen.scene.scene_types import Scene
from tests.benchmarks.counting import callgrind, countable

CALLS = 2000
TITLES = (
    *("bodies", "contacts", "generated C (bytes)", "build (s)", "kernels (us)", "kernels per contact (ns)"),
    *("the same (instructions)", "assembly and forces per closed contact (ns)", "the same (instructions)"),
    "solver, were all in one island (us)",
)
STAGES = 4  # right-hand sides of an RK4 step


def scene_of(bodies: int) -> Scene:
    """Rings of ellipsoids a little above a wide paraboloid, each watched against its neighbour."""
    names = [f"stone{i}" for i in range(bodies)]
    stones = []
    for i, name in enumerate(names):
        ring, place = divmod(i, 10)
        radius, angle = 0.5 + 0.2 * ring, 2 * np.pi * place / 10
        x, y = radius * np.cos(angle), radius * np.sin(angle)
        z = (x * x + y * y) / (2 * 50.0) + 0.08
        stones.append(
            make.dynamic(
                name,
                make.ellipsoid(0.06, 0.05, 0.04),
                mass=0.5,
                inertia=[0.00041, 0.00052, 0.00061],
                position=[float(x), float(y), float(z)],
            )
        )
    bowl = make.fixed("bowl", make.paraboloid(50.0, 50.0))
    pairs = [{"between": [name, "bowl"]} for name in names]
    pairs += [{"between": list(pair)} for pair in pairwise(names)]
    return make.scene(f"bowl_of_{bodies}", [bowl, *stones], contact=pairs)


def evaluation_us(session: Session, active: int) -> float:
    """Median time of one right-hand side with the first `active` contacts carrying force, microseconds."""
    session.active[:] = 0
    session.active[:active] = 1
    slope = np.zeros_like(session.x)
    times = []
    for _ in range(9):
        begun = perf_counter()
        for _ in range(CALLS):
            session.evaluate(0.0, session.x, slope)
        times.append(perf_counter() - begun)
    return median(times) / CALLS * 1e6


def solver_us(session: Session, n: int) -> float:
    """Median time of the solver alone for n forces, microseconds."""
    A, b, z = np.eye(n) + 0.01, -np.ones(n), np.zeros(n)
    active = np.ones(n, dtype=np.intc)
    cdll = session.library.cdll
    work, iwork = np.zeros(cdll.mg_lcp_work_size(n)), np.zeros(cdll.mg_lcp_iwork_size(n), dtype=np.intc)
    pointers = [ctypes.c_void_p(address(array)) for array in (A, b, active, z, work, iwork)]
    times = []
    for _ in range(9):
        begun = perf_counter()
        for _ in range(CALLS // 10):
            cdll.mg_active_solve(n, *pointers)
        times.append(perf_counter() - begun)
    return median(times) / (CALLS // 10) * 1e6


def row(bodies: int, folder: Path) -> str:
    package = emit(derive(require(scene_of(bodies))))
    size = sum(len(text) for name, text in package.files.items() if name in ("kernels.c", "model.c"))
    begun = perf_counter()
    library = build(package, folder=folder)
    built = perf_counter() - begun
    session = Session(library, Accuracy.balanced())
    begin(session)
    contacts = session.n_contact
    free, loaded = evaluation_us(session, 0), evaluation_us(session, bodies)
    counts = instructions(library, folder, contacts, bodies) if shutil.which("valgrind") else ("", "")
    forces = (loaded - free) / bodies
    columns = (
        *(
            f"{bodies}",
            f"{contacts}",
            f"{size}",
            f"{built:.2f}",
            f"{free:.1f}",
            f"{free / contacts * 1e3:.0f}",
        ),
        *(counts[0], f"{forces * 1e3:.0f}", counts[1], f"{solver_us(session, bodies):.1f}"),
    )
    return f"| {' | '.join(columns)} |"


def instructions(library: Library, folder: Path, contacts: int, bodies: int) -> tuple[str, str]:
    """Of a right-hand side: per contact without forces, and what forces add per closed contact."""
    counted = folder / "counted"
    counted.mkdir()
    countable(library, counted)
    per_call = {}
    for which in ("free", "loaded"):
        few, many = (callgrind("tests.benchmarks.counted", which, counted, n) for n in (5, 1005))
        per_call[which] = (many - few) / 1000 / STAGES
    forces = (per_call["loaded"] - per_call["free"]) / bodies
    return f"{per_call['free'] / contacts:.0f}", f"{forces:.0f}"


def main() -> None:
    print(f"| {' | '.join(TITLES)} |")
    print("|---" * len(TITLES) + "|")
    with TemporaryDirectory() as name:
        for bodies in (10, 40, 160):
            print(row(bodies, Path(name) / str(bodies)))


if __name__ == "__main__":
    main()
