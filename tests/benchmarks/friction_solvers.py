"""Time and success of every friction solver. Run `python -m tests.benchmarks.friction_solvers`.

Success: the certificate of the law that the solver solves is at most 1e-9 (IPOPT: 1e-6; Siconos: its own
error at most 1e-9 of |b|); for the relaxation also a proof that its program is infeasible, which Coulomb's
law need not be. Times of `coulomb` and `relaxation` are those of the core, without the call from Python;
Siconos is Debian's python3-siconos, if installed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

from modelgen.runtime.friction import FrictionProblem, FrictionSolution, Outcome, coulomb, solver
from tests.core.compiling import core_in
from tests.core.frictional import drawn, impossible, natural_map
from tests.core.siconos_fc3d import interpreter, siconos

CONTACTS = (1, 3, 8, 20)
COUNTS = {"coulomb": 700, "relaxation": 200, "polyhedral": 40, "mpcc": 8}
IMPOSSIBLE = 500
MPCC_CONTACTS = 8  # seconds a problem beyond
ENOUGH = 1e-9


class Stopwatch:
    """A library that adds up the time inside `mg_friction`."""

    def __init__(self, core: Any) -> None:
        self.core, self.dtype, self.cdll, self.seconds = core, core.dtype, self, 0.0

    def mg_friction(self, *arguments: Any) -> None:
        begun = perf_counter()
        self.core.cdll.mg_friction(*arguments)
        self.seconds += perf_counter() - begun

    def __getattr__(self, name: str) -> Any:
        return getattr(self.core.cdll, name)


def classes() -> Iterator[tuple[str, list[FrictionProblem]]]:
    for contacts in CONTACTS:
        for deficient in (False, True):
            seeds = (np.random.default_rng([contacts, deficient, k]) for k in range(COUNTS["coulomb"]))
            kind = "deficient" if deficient else "generic"
            yield f"{contacts}, {kind}", [drawn(rng, contacts, deficient) for rng in seeds]


def succeeds(name: str, answer: FrictionSolution) -> bool:
    return answer.outcome is Outcome.SOLVED or (name == "relaxation" and answer.outcome is Outcome.INFEASIBLE)


def measured(name: Any, problems: list[FrictionProblem], core: Any) -> str:
    call: Callable[[FrictionProblem, Any], FrictionSolution] = solver(name)
    times, good = [], 0
    for problem in problems[: COUNTS[name]]:
        watch, begun = Stopwatch(core), perf_counter()
        answer = call(problem, watch)
        times.append(watch.seconds or perf_counter() - begun)
        good += succeeds(name, answer)
        if name == "coulomb" and answer.outcome is Outcome.SOLVED:
            assert natural_map(problem, answer.z) <= ENOUGH, "a false success"
    return cell(good / len(times), times)


def cell(success: float, times: list[float]) -> str:
    return f"{success:7.2%}  {scaled(median(times))}  {scaled(max(times))}"


def scaled(seconds: float) -> str:
    return f"{seconds * 1e6:6.0f} us" if seconds < 1e-2 else f"{seconds * 1e3:6.0f} ms"


def of_siconos(problems: list[FrictionProblem], core: Any) -> str:
    chosen = [p for p in problems[: COUNTS["polyhedral"]] if (p.cone[:, 0] > 0).all()]
    records = [
        {"A": p.A.tolist(), "b": p.b.tolist(), "mu": p.cone[:, 0].tolist(), "z": coulomb(p, core).z.tolist()}
        for p in chosen
    ]
    with TemporaryDirectory() as folder:
        answers = siconos(records, Path(folder))
    return cell(sum(a["error"] <= ENOUGH for a in answers) / len(answers), [a["seconds"] for a in answers])


def without_solution(core: Any) -> str:
    outcomes = [coulomb(impossible(seed), core).outcome for seed in range(IMPOSSIBLE)]
    proved, claimed = outcomes.count(Outcome.INFEASIBLE), outcomes.count(Outcome.SOLVED)
    return f"{IMPOSSIBLE} problems without a solution: {proved} proved to have none, {claimed} called solved"


def main() -> None:
    names = [*COUNTS, *(["Siconos NSGS"] if interpreter() else [])]
    table = Table(*("contacts, rank", *names), title="success, median and longest time of a problem")
    core = core_in("double", "-march=native")
    for kind, problems in classes():
        slow = len(problems[0].first) > MPCC_CONTACTS
        cells = ["" if slow and name == "mpcc" else measured(name, problems, core) for name in COUNTS]
        table.add_row(kind, *cells, *([of_siconos(problems, core)] if interpreter() else []))
    Console(width=180).print(table)
    print(without_solution(core))


if __name__ == "__main__":
    main()
