"""Friction problems of runs: a core that writes down what it solves on graphs, and what it wrote.

`recording` builds a scene with a core that appends each problem that a run solves on its graph to a file,
with the forces from which the run seeks its solution.
"""

from __future__ import annotations

import ctypes
import os
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from time import process_time
from typing import Any
from unittest.mock import patch

import numpy as np
from numpy.typing import NDArray

from modelgen import build, derive, emit, require
from modelgen.codegen import amalgamation, core_cache
from modelgen.codegen.library import Library
from modelgen.runtime.c_arrays import pointer
from modelgen.runtime.friction.compiled_solvers import problem_structure, report_structure
from modelgen.runtime.friction.problem import CONE, FrictionProblem
from modelgen.runtime.tables.scratch_memory import solver_scratch
from modelgen.scene.scene_types import Scene

Array = NDArray[Any]
MATRIX, NEAR, STARTS = 60, 100, 3  # MG_MATRIX_ISLAND, MG_NEAR_TOLERANCE, MG_GRAPH_STARTS of the core
FILE = "MODELGEN_RECORDED_PROBLEMS"  # environment variable: where a run writes
CALLER, CALL = "/* timestep/impulse_problem.c */\n", "return mg_friction_on_graph("
RECORD = r"""
#include <stdio.h>
#include <stdlib.h>
/* Appends a problem, its sizes before its arrays, and solves it. */
static int mg_recorded_on_graph(const mg_friction_problem *p, const mg_friction_graph *g, mg_real *z,
                                int *marks, mg_friction_report *report, mg_real *work, int *iwork) {
  const char *name = getenv("FILE_VARIABLE");
  FILE *file = name ? fopen(name, "ab") : 0;
  if (file) {
    const int head[] = {p->n, p->n_contact, p->law, p->from_last, g->n_body};
    fwrite(head, sizeof *head, 5, file);
    fwrite(p->first, sizeof *p->first, p->n_contact, file);
    fwrite(p->rows, sizeof *p->rows, p->n_contact, file);
    fwrite(g->body, sizeof *g->body, 2 * p->n, file);
    fwrite(p->cone, sizeof *z, MG_CONE * p->n_contact, file);
    fwrite(p->b, sizeof *z, p->n, file), fwrite(g->yield, sizeof *z, p->n, file);
    fwrite(z, sizeof *z, p->n, file);
    for (int r = 0; r < p->n; r++) fwrite(g->J + 12L * g->place[r], sizeof *z, 12, file);
    for (int r = 0; r < p->n; r++) fwrite(g->MJ + 12L * g->place[r], sizeof *z, 12, file);
    fclose(file);
  }
  return mg_friction_on_graph(p, g, z, marks, report, work, iwork);
}
""".replace("FILE_VARIABLE", FILE)


def recording(scene: Scene, folder: str | Path) -> Library:
    """The library of a scene with a core that writes down the problems it solves on graphs."""

    def text(derivatives: bool = False, lines: bool = False) -> str:
        before, found, rest = amalgamation.runtime_text(derivatives, lines).partition(CALLER)
        assert rest.count(CALL) == 1
        return before + RECORD + found + rest.replace(CALL, "return mg_recorded_on_graph(")

    with patch.object(core_cache, "runtime_text", text):
        return build(emit(derive(require(scene))), folder=folder)


@contextmanager
def recorded(file: Path) -> Iterator[None]:
    """Runs within write to `file`."""
    os.environ[FILE] = str(file)
    try:
        yield
    finally:
        del os.environ[FILE]


class Graph(ctypes.Structure):
    """`mg_friction_graph` of core/solve/friction/friction.h."""

    _fields_ = (
        ("n_body", ctypes.c_int),
        *((name, ctypes.c_void_p) for name in ("place", "body", "J", "MJ", "yields")),
    )


@dataclass(frozen=True)
class Recorded:
    """A problem by its graph; `J` and `MJ` (n, 12), `body` (n, 2), `guess` (n,) forces of the step before."""

    law: int
    from_last: int
    bodies: int
    first: Array
    rows: Array
    body: Array
    cone: Array
    b: Array
    yields: Array
    guess: Array
    J: Array
    MJ: Array

    @property
    def contacts(self) -> int:
        return len(self.first)

    @property
    def rows_in_all(self) -> int:
        return len(self.b)

    def matrix(self) -> FrictionProblem:
        """The problem with its matrix."""
        n = len(self.b)
        J, MJ = np.zeros((n, 6 * self.bodies)), np.zeros((n, 6 * self.bodies))
        for r, side in np.ndindex(n, 2):
            if self.body[r, side] >= 0:
                at, own = 6 * self.body[r, side], slice(6 * side, 6 * side + 6)
                J[r, at : at + 6] += self.J[r, own]
                MJ[r, at : at + 6] += self.MJ[r, own]
        return FrictionProblem(J @ MJ.T + np.diag(self.yields), self.b, self.first, self.rows, self.cone)


@dataclass(frozen=True)
class Answer:
    """Forces, the residual that the core tells, and what it took; `seconds` in the core alone."""

    z: Array
    is_solved: bool
    residual: float
    newton: int
    seconds: float


@dataclass(frozen=True)
class Solves:
    """A problem as the core's time-stepping solves it: on its graph; where that fails, up to `MATRIX` rows,
    by its matrix; where that fails too, on its graph from other starting points."""

    core: Any
    starts: int = STARTS

    def __call__(self, problem: Recorded, tolerance: float, guess: Array) -> Answer:
        is_small = problem.rows_in_all <= MATRIX
        answer = self._on_graph(problem, tolerance, guess, 1 if is_small else self.starts)
        if answer.is_solved or not is_small:
            return answer
        answer = self._by_matrix(problem, tolerance, answer.z)
        if answer.is_solved or self.starts == 1:
            return answer
        return self._on_graph(problem, tolerance, answer.z, self.starts)

    def _on_graph(self, of: Recorded, tolerance: float, guess: Array, starts: int) -> Answer:
        sizes = (of.rows_in_all, of.contacts, of.bodies)
        place = np.arange(of.rows_in_all, dtype=np.intc)
        arrays = (place, of.body, of.J, of.MJ, of.yields)
        graph = Graph(of.bodies, *(array.ctypes.data for array in arrays))
        problem, z = self._problem(of, tolerance, starts), np.array(guess)
        call = self.core.cdll.mg_friction_on_graph
        report, seconds = self._call(call, (problem, graph), z, of.contacts, "mg_friction_graph", sizes)
        return Answer(z, report.outcome == 0, report.residual, report.newton, seconds)

    def _by_matrix(self, of: Recorded, tolerance: float, guess: Array) -> Answer:
        A = np.asfortranarray(of.matrix().A)
        problem, z = self._problem(of, tolerance, 1), np.array(guess)
        problem.A = A.ctypes.data
        sizes = (of.rows_in_all, of.contacts)
        report, seconds = self._call(
            self.core.cdll.mg_friction, (problem,), z, of.contacts, "mg_friction", sizes
        )
        return Answer(z, report.outcome == 0, report.residual, report.newton, seconds)

    def _problem(self, of: Recorded, tolerance: float, starts: int) -> Any:
        arrays = (of.first, of.rows, of.cone)
        return problem_structure(np.dtype(np.float64))(
            of.rows_in_all, of.contacts, 0, 0, *(array.ctypes.data for array in arrays), None,
            of.b.ctypes.data, starts, tolerance, None, of.from_last, NEAR * tolerance, 0,
        )  # fmt: skip

    def _call(
        self,
        function: Any,
        given: tuple[Any, ...],
        z: Array,
        contacts: int,
        name: str,
        sizes: tuple[int, ...],
    ) -> tuple[Any, float]:
        work, iwork = solver_scratch(
            getattr(self.core.cdll, f"{name}_work_size"), getattr(self.core.cdll, f"{name}_iwork_size"),
            z.dtype, *sizes,
        )  # fmt: skip
        marks, report = np.zeros(contacts, dtype=np.intc), report_structure(z.dtype)()
        records = [ctypes.byref(each) for each in given]
        begun = process_time()
        function(*records, pointer(z), pointer(marks), ctypes.byref(report), pointer(work), pointer(iwork))
        return report, process_time() - begun


def read_recorded(file: Path) -> Iterator[Recorded]:
    """The problems of a file, in the order of the run."""
    data = np.memmap(file, dtype=np.uint8, mode="r")
    at = 0

    def take(count: int, kind: Any) -> Array:
        nonlocal at
        size = count * np.dtype(kind).itemsize
        found = np.frombuffer(data[at : at + size].tobytes(), dtype=kind)
        at += size
        return found

    while at < len(data):
        n, count, law, from_last, bodies = (int(x) for x in take(5, np.intc))
        first, rows = take(count, np.intc), take(count, np.intc)
        body = take(2 * n, np.intc).reshape(n, 2)
        cone = take(CONE * count, np.float64).reshape(count, CONE)
        b, yields, guess = (take(n, np.float64) for _ in range(3))
        J, MJ = (take(12 * n, np.float64).reshape(n, 12) for _ in range(2))
        yield Recorded(law, from_last, bodies, first, rows, body, cone, b, yields, guess, J, MJ)
