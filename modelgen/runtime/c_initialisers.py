"""A run in C: the tables and the start of a scene as initialisers."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from modelgen.codegen.library import Library
from modelgen.errors import SimulationError
from modelgen.runtime.accuracy import Accuracy
from modelgen.runtime.core_session import CONTINUE, FULL, Session
from modelgen.runtime.tables.ctypes_structures import KERNELS, Array, address

CHUNK = 20_000  # steps between two drains of the events
ENTRY = "mg_advance"  # the function that does the work

MAIN = """
static mg_real work[{work}];
static int iwork[{iwork}];
static mg_record the_record;

int main(void) {{
  the_system.kernels = mg_kernel_table();
  int code = mg_begin(&the_system, &the_settings, &the_run, &the_events, work, iwork);
  if (code == 0) do {{
    the_events.count = 0;
    code = {entry}(&the_system, &the_settings, &the_run, {until}, {chunk}, &the_record, &the_events,
      work, iwork);
  }} while (code == {again} || code == {full});
  return code;
}}
"""


def driver_text(library: Library, accuracy: Accuracy, until: float) -> str:
    """C99 text that, linked with the scene's `model.c` and the core, runs the scene to `until`, s."""
    session = Session(library, accuracy)
    arrays = session.arrays()
    names = {at: f"a{number}" for number, at in enumerate(arrays)}
    parts = ['#include "modelgen.h"']
    parts += [array_text(names[at], array) for at, array in arrays.items()]
    for name in ("system", "settings", "run", "events"):
        parts.append(f"static mg_{name} the_{name} = {values_text(getattr(session, name), names)};")
    sizes = {"work": len(session.work) + 1, "iwork": len(session.iwork) + 1}
    loop = {"entry": ENTRY, "until": float(until).hex(), "chunk": CHUNK, "again": CONTINUE, "full": FULL}
    return "\n".join([*parts, MAIN.format(**sizes, **loop)])


@dataclass(frozen=True, slots=True)
class RunArray:
    """An array of an mg_run or an mg_events, with what it holds before the run begins."""

    owner: str  # "run" or "events"
    field: str
    start: Array

    @property
    def type(self) -> str:
        return type_of(self.start)


@dataclass(frozen=True, slots=True)
class SceneTables:
    """The tables of a scene as C text, constant, and the arrays of its runs.

    Attributes:
        constants: definitions of the arrays to which the system points.
        system, settings: initialisers of an mg_system and an mg_settings.
        arrays: of a run.
    """

    constants: str
    system: str
    settings: str
    arrays: tuple[RunArray, ...]


def scene_tables(session: Session, kernels: str, system: Any) -> SceneTables:
    """The tables of a session that has not begun; `kernels` is the C expression of its mg_kernels, `system`
    its mg_system, or a copy with another closed_capacity."""
    if session.settings.outer_solver:
        found, allowed = repr(session.accuracy.solver), "coulomb, qp or relaxation, which the core has"
        raise SimulationError("run.solver", found, allowed, "choose one of these: others need Python")
    shared = {address(array): array for array in session.shared.arrays}
    names = {at: f"table_{number}" for number, at in enumerate(shared)}
    constants = [array_text(names[at], array, "static const") for at, array in shared.items()]
    every = session.arrays()
    arrays = [
        RunArray(owner, field, every[getattr(record, field)])
        for owner, record in (("run", session.run), ("events", session.events))
        for field, kind in record._fields_
        if kind is ctypes.c_void_p
    ]
    return SceneTables(
        constants="\n".join(constants),
        system=values_text(system, names, kernels),
        settings=values_text(session.settings, names),
        arrays=tuple(arrays),
    )


def type_of(array: Array) -> str:
    """The C type of the entries of an array."""
    return "int" if array.dtype == np.intc else "mg_real"


def array_text(name: str, array: Array, storage: str = "static") -> str:
    """The definition of an array in C; one without entries gets one."""
    size = max(array.size, 1)
    if not array.any() and storage == "static":
        return f"{storage} {type_of(array)} {name}[{size}];"
    values = ", ".join(map(number_text, array.ravel())) or "0"
    return f"{storage} {type_of(array)} {name}[{size}] = {{{values}}};"


def number_text(value: Any) -> str:
    """A number of an array as C has it, to the last bit."""
    if isinstance(value, np.integer):
        return str(int(value))
    if abs(value) >= np.finfo(type(value)).max:
        return "MG_MAX" if value > 0 else "-MG_MAX"
    return float(value).hex()


def values_text(record: ctypes.Structure, names: Mapping[int, str], kernels: str = "0") -> str:
    """The initialiser of a structure, in the order of the header; `names` has its arrays by address."""
    values = []
    for field, kind in record._fields_:  # type: ignore[misc]
        value = getattr(record, field)
        if field == KERNELS:
            values.append(kernels)
        elif kind is ctypes.c_void_p:
            values.append(names[value] if value else "0")
        elif kind is ctypes.c_ulonglong:
            values.append(f"{value}ULL")
        elif isinstance(value, ctypes.Structure):
            values.append(values_text(value, names))
        elif isinstance(value, ctypes.Array):
            values.append("{" + ", ".join(map(_value_text, value)) + "}")
        else:
            values.append(_value_text(value))
    return f"{{{', '.join(values)}}}"


def _value_text(value: float) -> str:
    return float(value).hex() if isinstance(value, float) else str(value)
