"""A run as a C program that needs no Python: the tables and the start as initialisers."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping
from typing import Any

import numpy as np

from modelgen.codegen.amalgamation import SOURCE
from modelgen.codegen.library import REAL_FLAGS, Library
from modelgen.runtime.accuracy import Accuracy
from modelgen.runtime.recording import Recording
from modelgen.runtime.session import CONTINUE, FULL, Session
from modelgen.runtime.settings import accuracy_of
from modelgen.runtime.tables.ctypes_structures import KERNELS, Array

CHUNK = 20_000  # steps between two drains of the events
ENTRY = "mg_advance"  # the function that does the work

MAIN = """
static mg_real work[{work}];
static int iwork[{iwork}];
static mg_record the_record{record};

int main(void) {{
  the_system.kernels = mg_kernel_table();
  int code = mg_begin(&the_system, &the_settings, &the_run, &the_events, work, iwork);
  if (code == 0) do {{
    the_events.count = 0;
    code = {entry}(&the_system, &the_settings, &the_run, {until}, {chunk}, &the_record, &the_events,
      work, iwork);
  }} while (code == {again} || code == {full});{tell}
  return code;
}}
"""

TELL = """
  for (int k = 0; k < the_record.count; k++) {{
    printf("%.17g", (double)the_record.t[k]);
    for (int i = 0; i < {n}; i++)
      for (int j = 0; j < 12; j++)
        printf(" %.17g", (double)the_record.pose[12 * ({n_body} * k + moving[i]) + j]);
    printf("\\n");
  }}
  if (code) fprintf(stderr, "ended early at t = %g s: code %d of modelgen.h\\n", (double)the_run.t, code);"""

HEAD = """/* {scene}, from its start to t = {until:g} s, with the tables and settings of its scene file.

   {command}

   Prints {lines} lines: t, s; then for each of {names}: centre of mass p, m, and the columns of
   the rotation matrix R, world axes. Exit code 0: done; others are in modelgen.h. */
#include <stdio.h>
"""


def driver_text(library: Library, accuracy: Accuracy, until: float) -> str:
    """C99 text that, linked with the scene's `model.c` and the core, runs the scene to `until`, s."""
    session = Session(library, accuracy)
    return _program(session, session.arrays(), until, " = {0}", "")


def compile_command(library: Library, name: str) -> str:
    """How a program of a scene is compiled in the folder of its library."""
    program = name.removesuffix(".c")
    words = ["cc", "-O2", *REAL_FLAGS[library.real], name, "model.c", SOURCE, "-lm", "-o", program]
    return f"{' '.join(words)} && ./{program}"


def program_text(library: Library, name: str) -> str:
    """C99 text of a whole program, a file `name` beside the library's `model.c`: it runs the scene as its
    file says and prints its samples. Raises ModelgenError where the scene's settings cannot be."""
    instance = library.manifest.instance
    run, bodies = instance["run"], instance["bodies"]
    session = Session(library, accuracy_of(instance, None, {}))
    recording = Recording(session, np.linspace(0.0, run["until"], run["samples"] + 1))
    arrays = session.arrays() | recording.placed
    moving = [k for k, body in enumerate(bodies) if body["motion"] != "fixed"]
    head = HEAD.format(
        scene=instance["name"],
        until=run["until"],
        command=compile_command(library, name),
        lines=run["samples"] + 1,
        names=", ".join(bodies[k]["name"] for k in moving) or "no body",
    )
    index = f"static const int moving[] = {{{', '.join(map(str, [*moving, -1]))}}};\n"
    tell = TELL.format(n=len(moving), n_body=len(bodies))
    record = _values(recording.record, _numbers(arrays))
    return head + index + _program(session, arrays, run["until"], f" = {record}", tell)


def _program(session: Session, arrays: Mapping[int, Array], until: float, record: str, tell: str) -> str:
    parts = ['#include "modelgen.h"']
    numbers = _numbers(arrays)
    parts += [_array(f"a{numbers[at]}", array) for at, array in arrays.items()]
    for name in ("system", "settings", "run", "events"):
        parts.append(f"static mg_{name} the_{name} = {_values(getattr(session, name), numbers)};")
    sizes = {"work": len(session.work) + 1, "iwork": len(session.iwork) + 1}
    loop = {"entry": ENTRY, "until": float(until).hex(), "chunk": CHUNK, "again": CONTINUE, "full": FULL}
    return "\n".join([*parts, MAIN.format(**sizes, **loop, record=record, tell=tell)])


def _numbers(arrays: Mapping[int, Array]) -> dict[int, int]:
    """The numbers of the arrays, by address."""
    return {at: number for number, at in enumerate(arrays)}


def _array(name: str, array: Array) -> str:
    kind = "int" if array.dtype == np.intc else "mg_real"
    size = max(array.size, 1)
    if not array.any():
        return f"static {kind} {name}[{size}];"
    return f"static {kind} {name}[{size}] = {{{', '.join(map(_number, array.ravel()))}}};"


def _number(value: Any) -> str:
    if isinstance(value, np.integer):
        return str(int(value))
    if abs(value) >= np.finfo(type(value)).max:
        return "MG_MAX" if value > 0 else "-MG_MAX"
    return float(value).hex()


def _values(record: ctypes.Structure, numbers: Mapping[int, int]) -> str:
    """The initialiser of a structure, in the order of the header."""
    values = []
    for field, kind in record._fields_:  # type: ignore[misc]
        value = getattr(record, field)
        if field == KERNELS:
            values.append("0")
        elif kind is ctypes.c_void_p:
            values.append(f"a{numbers[value]}" if value else "0")
        elif kind is ctypes.c_ulonglong:
            values.append(f"{value}ULL")
        elif isinstance(value, ctypes.Array):
            values.append("{" + ", ".join(float(each).hex() for each in value) + "}")
        else:
            values.append(float(value).hex() if isinstance(value, float) else str(value))
    return f"{{{', '.join(values)}}}"
