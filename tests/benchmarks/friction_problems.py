"""How many friction problems the core leaves unsolved, and to what residual.

    python -m tests.benchmarks.friction_problems random
    python -m tests.benchmarks.friction_problems siconos FOLDER
    python -m tests.benchmarks.friction_problems heaps [--problems 1000] [--seed 0] [--starts 3]

`random`: the 5,600 problems of `tests.benchmarks.friction_solvers`, solved to rounding.

`siconos`: the public problems of Coulomb's friction in three dimensions among the test data of Siconos
(numerics/src/FrictionContact/test/data of github.com/siconos/siconos, files .dat); FOLDER is a copy of that
folder. Up to 150 contacts to rounding, larger ones to a residual of 1e-6 from one starting point. The larger
collection FCLIB (github.com/FrictionalContactLibrary/fclib-library) keeps its problems in Git LFS.

`heaps`: problems of bodies that fall into a heap, as `tests.benchmarks.many_contacts` makes them, written
down by the core in runs by time-stepping at `coarse` and at `balanced` with steps of 2 ms. Of the islands
with 10 to 500 contacts as many are taken from each run as from the others, at equal distances in the run.
Each is solved cold, from no forces, and warm, from those of the step before, to the residual of `coarse`,
1e-2, of `balanced`, 1e-6, and to 1e-8. What is not solved is listed, with the residual that is reached;
every solution up to 60 contacts is checked by the certificate of the matrix of the problem.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time
from typing import Any

import numpy as np

from modelgen import simulate
from modelgen.codegen.compiler import NATIVE
from modelgen.runtime.friction import FrictionProblem, Outcome, coulomb
from tests.benchmarks.friction_solvers import classes
from tests.benchmarks.many_contacts import heap
from tests.benchmarks.recorded_problems import STARTS, Recorded, Solves, read_recorded, recorded, recording
from tests.core.compiling import core_in
from tests.core.frictional import natural_map

LARGE, ACCEPTED = (
    150,
    1e-6,
)  # contacts of a problem of Siconos that is solved to a residual alone, and to which
HEAPS = {"sphere": (20, 100, 200), "ellipsoid": (20, 100), "capsule": (20, 100), "box": (20, 60)}
RUNS: dict[str, dict[str, Any]] = {"coarse": {}, "balanced": {"step": 0.002}}
UNTIL = 0.5  # s; the bodies come to rest at about 0.4 s
CONTACTS = (10, 500)
TOLERANCES = (1e-2, 1e-6, 1e-8)
TITLES = ("residual", "from", "solves", "failures", "part", "Newton steps", "most", "CPU s")
CHECKED = 60  # contacts of a problem whose solutions are checked by its matrix


def solvers() -> Any:
    return core_in("double", *NATIVE, "-ffp-contract=off")


def random(core: Any) -> None:
    whole, failed = 0, 0
    for kind, problems in classes():
        answers = [coulomb(problem, core) for problem in problems]
        for problem, answer in zip(problems, answers, strict=True):
            if answer.outcome is Outcome.SOLVED:
                assert natural_map(problem, answer.z) <= 1e-9, "a false success"
        left = [answer.residual for answer in answers if answer.outcome is not Outcome.SOLVED]
        told = f", residuals {', '.join(f'{r:.1e}' for r in left)}" if left else ""
        print(f"{kind}: {len(problems)} problems, {len(left)} not solved{told}", flush=True)
        whole, failed = whole + len(problems), failed + len(left)
    print(f"{failed} of {whole} not solved ({failed / whole:.2%})")


def of_siconos(file: Path) -> FrictionProblem | None:
    """The problem of a file of Siconos; None if it is none in three dimensions."""
    words = file.read_text(errors="replace").split()
    dimension, count, storage = (int(float(word)) for word in words[:3])
    if dimension != 3 or storage > 1:
        return None
    n, values = 3 * count, [float(word) for word in words[3:]]
    if (int(values[0]), int(values[1])) != (n, n):
        return None
    if storage == 0:
        at = 4  # its sizes stand there twice
        A = np.array(values[at : at + n * n]).reshape(n, n).T
        at += n * n
    else:
        A, at = _blocks(values, n)
    return FrictionProblem.of(A, values[at : at + n], values[at + n : at + n + count])


def _blocks(values: list[float], n: int) -> tuple[np.ndarray, int]:
    """The matrix of blocks by rows, each by columns, and where it ends."""
    filled, lines = int(values[2]), int(values[3])
    at = 5 + 2 * lines  # behind the ends of the rows and columns of blocks
    starts, listed = int(values[at]), int(values[at + 1])
    begin = [int(value) for value in values[at + 2 : at + 2 + starts]]
    column = [int(value) for value in values[at + 2 + starts : at + 2 + starts + listed]]
    at += 2 + starts + listed
    A = np.zeros((n, n))
    for row in range(starts - 1):
        for k in range(begin[row], begin[row + 1]):
            A[3 * row : 3 * row + 3, 3 * column[k] : 3 * column[k] + 3] = np.reshape(
                values[at + 1 : at + 10], (3, 3)
            ).T
            at += 10  # a number stands before each block
    assert begin[-1] == filled
    return A, at


def siconos(core: Any, folder: Path) -> None:
    print("| problem | contacts | residual | solved to | CPU s |\n|---|---|---|---|---|")
    for file in sorted(folder.glob("*.dat")):
        if file.name.startswith("GFC3D") and "condensed" not in file.name:
            continue  # a problem in the velocities of bodies, of another form
        try:
            problem = of_siconos(file)
        except (ValueError, IndexError):
            problem = None
        if problem is None:
            continue
        is_large, begun = len(problem.first) > LARGE, process_time()
        answer = coulomb(problem, core, starts=1, accepted=ACCEPTED) if is_large else coulomb(problem, core)
        told = (
            "not solved"
            if answer.outcome is not Outcome.SOLVED
            else f"{ACCEPTED:.0e}"
            if is_large
            else "rounding"
        )
        cells = (
            file.name,
            len(problem.first),
            f"{answer.residual:.1e}",
            told,
            f"{process_time() - begun:.2g}",
        )
        print(f"| {' | '.join(map(str, cells))} |", flush=True)


def problems_of_heaps(seed: int, count: int) -> Iterator[tuple[str, Recorded]]:
    """About `count` problems, with the run from which each is taken."""
    runs = [(kind, stones, name) for kind in HEAPS for stones in HEAPS[kind] for name in RUNS]
    for k, (kind, stones, name) in enumerate(runs):
        with TemporaryDirectory() as folder:
            library, file = recording(heap(stones, seed, kind), folder), Path(folder) / "problems.bin"
            with recorded(file):
                simulate(
                    library, until=UNTIL, accuracy=name, method="time-stepping", samples=1, estimate=False,
                    **RUNS[name],
                )  # fmt: skip
            found = [
                p for p in read_recorded(file) if p.law == 0 and CONTACTS[0] <= p.contacts <= CONTACTS[1]
            ]
        wanted = count * (k + 1) // len(runs) - count * k // len(runs)
        for at in np.unique(np.linspace(0, len(found) - 1, min(wanted, len(found))).round().astype(int)):
            yield f"{stones} of {kind}, {name}", found[at]


def heaps(core: Any, count: int, seed: int, starts: int) -> None:
    solve, problems = Solves(core, starts), list(problems_of_heaps(seed, count))
    sizes = [problem.contacts for _, problem in problems]
    print(f"{len(problems)} problems of {min(sizes)} to {max(sizes)} contacts, median {np.median(sizes):.0f}")
    print(f"| {' | '.join(TITLES)} |\n|{' --- |' * len(TITLES)}")
    listed = []
    for tolerance in TOLERANCES:
        for start in ("cold", "warm"):
            answers = []
            for run, problem in problems:
                answer = solve(problem, tolerance, problem.guess * (start == "warm"))
                answers.append(answer)
                if not answer.is_solved:
                    listed.append((tolerance, start, run, problem.contacts, answer.residual))
                elif problem.contacts <= CHECKED:
                    told = natural_map(problem.matrix(), answer.z)
                    assert told <= 2 * max(tolerance, 1e-9), "a false success"
            failed, newton = sum(not a.is_solved for a in answers), [a.newton for a in answers]
            print(
                f"| {tolerance:.0e} | {start} | {len(answers)} | {failed} | {failed / len(answers):.2%} "
                f"| {np.mean(newton):.1f} | {max(newton)} | {sum(a.seconds for a in answers):.2f} |",
                flush=True,
            )
    for tolerance, start, run, contacts, residual in listed:
        print(
            f"not solved to {tolerance:.0e}, {start}: {contacts} contacts of {run}: residual {residual:.1e}"
        )


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parts = parser.add_subparsers(dest="part", required=True)
    parts.add_parser("random")
    parts.add_parser("siconos").add_argument("folder", type=Path)
    of_heaps = parts.add_parser("heaps")
    of_heaps.add_argument("--problems", type=int, default=1000)
    of_heaps.add_argument("--seed", type=int, default=0)
    of_heaps.add_argument(
        "--starts", type=int, default=STARTS, help="most starting points of a problem on its graph"
    )
    given, core = parser.parse_args(), solvers()
    if given.part == "random":
        random(core)
    elif given.part == "siconos":
        siconos(core, given.folder)
    else:
        heaps(core, given.problems, given.seed, given.starts)


if __name__ == "__main__":
    main()
